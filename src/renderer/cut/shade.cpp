#include "renderer/cut/shade.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cut/gather_groups.h"

namespace render2mpeg::renderer {
namespace {

/// Gathers the light of one tile's points.
class TileGatherer {
  public:
    TileGatherer(const LightingContext& context, const CutLimits& limits)
        : context_(context), limits_(limits), gatherer_(context.light_trees, context.tracer) {}

    std::vector<PointLight> gather(std::size_t tile_index);
    const ShadeCounts& counts() const { return counts_; }

  private:
    void gather(const GatherTile& tile, const GatherGroup& group, const std::vector<PointTolerance>& tolerances);

    const LightingContext& context_;
    const CutLimits& limits_;
    Gatherer gatherer_;
    GatherLanes lanes_;
    GatheredLight gathered_;
    std::vector<PointLight> light_;
    ShadeCounts counts_;
};

void TileGatherer::gather(const GatherTile& tile, const GatherGroup& group,
                          const std::vector<PointTolerance>& tolerances) {
    const GatherPoint* points[lane_count] = {};
    for (std::size_t i = 0; i < group.points.size(); ++i) points[i] = &tile[group.points[i]];
    fill(lanes_, std::span<const GatherPoint* const>(points, group.points.size()));
    lanes_.set = group.set;
    if (context_.tolerance.is_reference()) {
        gatherer_.gather_all(lanes_, gathered_);
    } else {
        GroupTolerance tolerance;
        for (std::size_t i = 0; i < lane_count; ++i)
            tolerance.set(static_cast<int>(i), tolerances[group.points[std::min(i, group.points.size() - 1)]]);
        gatherer_.gather(lanes_, tolerance, limits_, gathered_);
    }
    counts_.add(gathered_, group.points.size());
    for (std::size_t i = 0; i < group.points.size(); ++i)
        light_[group.points[i]] = point_light(gathered_, static_cast<int>(i), *points[i]);
}

std::vector<PointLight> TileGatherer::gather(std::size_t tile_index) {
    const GatherTile& tile = context_.seen.tiles[tile_index];
    light_.assign(tile.size(), {});
    std::vector<PointTolerance> tolerances;
    if (!context_.tolerance.is_reference()) tolerances = point_tolerances(context_, tile_index, false);
    for (const GatherGroup& group : group_points(tile, context_.eye, representative_sets))
        gather(tile, group, tolerances);
    return std::move(light_);
}

/// Adds up the light of one tile's points in their pixels.
class TileShader {
  public:
    TileShader(const LightingContext& context, const FrameLight& light, bool layers, core::Radiance& radiance)
        : seen_(context.seen),
          ungathered_(context.ungathered),
          tolerance_(context.tolerance),
          light_of_frame_(light),
          layers_(layers),
          radiance_(radiance) {}

    ShadeCounts shade(std::size_t tile_index);

  private:
    void add_to_pixels(const GatherTile& tile);
    void add_layers(const GatherTile& tile, std::size_t first, std::size_t last, int x, int y);
    void check(int x, int y);
    /// Tolerance of a lit pixel, as a share of its luminance; 1 where it is black.
    float allowed_share(int x, int y) const;
    int x_of(const GatherPoint& p) const { return tile_x_ + p.pixel % tile_size; }
    int y_of(const GatherPoint& p) const { return tile_y_ + p.pixel / tile_size; }

    const Frame& seen_;
    const UngatheredLight& ungathered_;
    const core::ToleranceMap& tolerance_;
    const FrameLight& light_of_frame_;
    const bool layers_;
    core::Radiance& radiance_;
    std::span<const PointLight> light_;  ///< of the tile
    ShadeCounts counts_;
    int tile_x_ = 0, tile_y_ = 0;
};

void TileShader::add_layers(const GatherTile& tile, std::size_t first, std::size_t last, int x, int y) {
    // Weight irradiance by what it lights, so that albedo x irradiance is the pixel's diffuse light exactly.
    glm::vec3 share(0), albedo(0), direct(0), indirect(0), plain_direct(0), plain_indirect(0), glossy(0), specular(0);
    float direct_cut = 0, indirect_cut = 0, age = 0, reused = 0;
    for (std::size_t i = first; i < last; ++i) {
        const GatherPoint& p = tile[i];
        const PointLight& l = light_[i];
        const glm::vec3 scattered = l.scattered(p);
        direct_cut += l.direct_cut;
        indirect_cut += l.indirect_cut;
        age += l.age;
        reused += l.served ? 1.0f : 0.0f;
        if (p.reached_by_specular()) {
            specular += scattered;
            continue;
        }
        const glm::vec3 reflects = p.weight * p.point.bsdf.diffuse;
        share += p.weight;
        albedo += reflects;
        direct += reflects * l.direct;
        indirect += reflects * l.indirect;
        plain_direct += p.weight * l.direct;
        plain_indirect += p.weight * l.indirect;
        glossy += p.weight * l.glossy;
    }
    const auto mean = [](glm::vec3 sum, glm::vec3 weight, glm::vec3 plain, glm::vec3 plain_weight) {
        glm::vec3 r;
        for (int k = 0; k < 3; ++k)
            r[k] = core::divide_or(sum[k], weight[k], core::divide_or(plain[k], plain_weight[k], 0.0f));
        return r;
    };
    direct += ungathered_.caustics().straight_at(x, y);
    radiance_.albedo.at(x, y) = albedo;
    radiance_.direct_irradiance.at(x, y) = mean(direct, albedo, plain_direct, share);
    radiance_.indirect_irradiance.at(x, y) = mean(indirect, albedo, plain_indirect, share);
    radiance_.glossy.at(x, y) += glossy;
    const auto count = static_cast<float>(std::max<std::size_t>(last - first, 1));
    radiance_.direct_cut.at(x, y) = direct_cut / count;
    radiance_.indirect_cut.at(x, y) = indirect_cut / count;
    radiance_.record_age.at(x, y) = age / count;
    radiance_.record_reuse.at(x, y) = reused / count;
    radiance_.specular.at(x, y) += specular;
}

void TileShader::add_to_pixels(const GatherTile& tile) {
    for (std::size_t first = 0; first < tile.size();) {
        std::size_t last = first;
        const int x = x_of(tile[first]), y = y_of(tile[first]);
        glm::vec3 sum(0);
        float clusters = 0;
        core::StandardError error{radiance_.error.at(x, y)}, shared{radiance_.shared_error.at(x, y)};
        for (; last < tile.size() && tile[last].pixel == tile[first].pixel; ++last) {
            const GatherPoint& p = tile[last];
            const PointLight& l = light_[last];
            sum += l.scattered(p);
            clusters += l.direct_cut + l.indirect_cut;
            error += l.error;
            shared += l.shared;
            if (std::isfinite(l.clamped)) counts_.clamped += l.clamped;
            if (l.capped) {
                radiance_.capped.at(x, y) = 1;
                ++counts_.capped_points;
            }
        }
        radiance_.combined.at(x, y) += sum;
        radiance_.error.at(x, y) = error.value;
        radiance_.shared_error.at(x, y) = shared.value;
        const float luminance = core::luminance(sum);
        if (std::isfinite(luminance)) counts_.gathered += luminance;
        counts_.bands.add(allowed_share(x, y), last - first, static_cast<std::uint64_t>(clusters));
        if (layers_) add_layers(tile, first, last, x, y);
        first = last;
    }
}

float TileShader::allowed_share(int x, int y) const {
    if (tolerance_.is_reference()) return 0.0f;
    const core::Tolerance& t = tolerance_.pixels.at(x, y);
    const float luminance = core::luminance(radiance_.combined.at(x, y));
    return core::divide_or(t.allows(luminance), luminance, 1.0f);
}

void TileShader::check(int x, int y) {
    bool finite = core::is_finite(radiance_.combined.at(x, y));
    core::Plane<glm::vec3>* layers[] = {
        &radiance_.emission, &radiance_.direct_irradiance, &radiance_.indirect_irradiance, &radiance_.albedo,
        &radiance_.glossy,   &radiance_.specular};
    if (layers_)
        for (const auto* layer : layers) finite = finite && core::is_finite(layer->at(x, y));
    if (finite) {
        radiance_.combined.at(x, y) = glm::max(radiance_.combined.at(x, y), glm::vec3(0));
        return;
    }
    if (counts_.non_finite++ == 0) counts_.first_non_finite = static_cast<std::int64_t>(y) * seen_.visible.width() + x;
    radiance_.combined.at(x, y) = glm::vec3(0);
    if (layers_)
        for (auto* layer : layers) layer->at(x, y) = glm::vec3(0);
}

ShadeCounts TileShader::shade(std::size_t tile_index) {
    tile_x_ = seen_.corner_of(tile_index).x;
    tile_y_ = seen_.corner_of(tile_index).y;
    counts_ = {};
    const GatherTile& tile = seen_.tiles[tile_index];
    const int x_end = std::min(tile_x_ + tile_size, seen_.visible.width());
    const int y_end = std::min(tile_y_ + tile_size, seen_.visible.height());
    // Start from what needs no gathering.
    for (int y = tile_y_; y < y_end; ++y) {
        for (int x = tile_x_; x < x_end; ++x) {
            const glm::vec3 all = ungathered_.all().at(x, y);
            radiance_.combined.at(x, y) = all;
            PointLight alone;
            alone.add_alone({value_or_zero(ungathered_.hair().error, x, y)});
            radiance_.error.at(x, y) = alone.error.value;
            radiance_.shared_error.at(x, y) = alone.shared.value;
            if (!layers_) continue;
            const glm::vec3 specular = value_or_zero(ungathered_.specular(), x, y);
            const glm::vec3 caustics = ungathered_.caustics().straight_at(x, y);
            const glm::vec3 hair = ungathered_.hair().straight_at(x, y);
            radiance_.emission.at(x, y) = glm::max(all - specular - caustics - hair, glm::vec3(0));
            radiance_.glossy.at(x, y) = hair;
            radiance_.specular.at(x, y) = specular;
        }
    }
    light_ = light_of_frame_[tile_index];
    add_to_pixels(tile);
    for (int y = tile_y_; y < y_end; ++y)
        for (int x = tile_x_; x < x_end; ++x) check(x, y);
    return counts_;
}

}  // namespace

void ShadeCounts::add(const GatheredLight& light, std::size_t points) {
    const auto size = static_cast<std::uint64_t>(points);
    groups += 1;
    gather_points += size;
    shadow_rays += light.shadow_rays;
    direct_clusters += size * static_cast<std::uint64_t>(light.direct_clusters);
    indirect_clusters += size * static_cast<std::uint64_t>(light.indirect_clusters);
}

void ShadeCounts::add(const ShadeCounts& more) {
    if (non_finite == 0) first_non_finite = more.first_non_finite;
    gather_points += more.gather_points;
    capped_points += more.capped_points;
    groups += more.groups;
    direct_clusters += more.direct_clusters;
    indirect_clusters += more.indirect_clusters;
    shadow_rays += more.shadow_rays;
    non_finite += more.non_finite;
    gathered += more.gathered;
    clamped += more.clamped;
    bands.add(more.bands);
}

FrameLight gather_light(const LightingContext& context, const CutLimits& limits, ShadeCounts& counts) {
    FrameLight light(context.seen.tiles.size());
    std::vector<ShadeCounts> of_tile(light.size());
    parallel::for_each(light.size(), [&](std::size_t i) {
        TileGatherer gatherer(context, limits);
        light[i] = gatherer.gather(i);
        of_tile[i] = gatherer.counts();
    });
    for (const ShadeCounts& c : of_tile) counts.add(c);
    return light;
}

core::Radiance shade(const LightingContext& context, const FrameLight& light, bool layers, ShadeCounts& counts) {
    const Frame& seen = context.seen;
    const core::ToleranceMap& tolerance = context.tolerance;
    EXPECTS(light.size() == seen.tiles.size());
    const int width = seen.visible.width(), height = seen.visible.height();
    EXPECTS(tolerance.is_reference() || (tolerance.pixels.width() == width && tolerance.pixels.height() == height));
    core::Radiance radiance;
    radiance.frame = seen.visible.frame;
    radiance.combined = core::Plane<glm::vec3>(width, height, glm::vec3(0));
    radiance.capped = core::Plane<std::uint8_t>(width, height, 0);
    for (auto* errors : {&radiance.error, &radiance.shared_error}) *errors = core::Plane<float>(width, height, 0.0f);
    if (layers) {
        for (auto* layer : {&radiance.emission, &radiance.direct_irradiance, &radiance.indirect_irradiance,
                            &radiance.albedo, &radiance.glossy, &radiance.specular})
            *layer = core::Plane<glm::vec3>(width, height, glm::vec3(0));
        for (auto* layer : {&radiance.direct_cut, &radiance.indirect_cut, &radiance.record_age, &radiance.record_reuse})
            *layer = core::Plane<float>(width, height, 0.0f);
    }
    std::vector<ShadeCounts> of_tile(seen.tiles.size());
    parallel::for_each(seen.tiles.size(),
                       [&](std::size_t i) { of_tile[i] = TileShader(context, light, layers, radiance).shade(i); });
    for (const ShadeCounts& c : of_tile) counts.add(c);
    return radiance;
}

}  // namespace render2mpeg::renderer
