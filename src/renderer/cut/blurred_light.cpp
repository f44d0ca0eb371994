#include "renderer/cut/blurred_light.h"

#include <algorithm>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cut/point_light.h"

namespace render2mpeg::renderer {
namespace {

/// Which tile a point of the frame is in.
std::size_t tile_of(const Exposure& exposure, std::uint32_t point) {
    const auto after = std::upper_bound(exposure.first_point.begin(), exposure.first_point.end(), point);
    return static_cast<std::size_t>(after - exposure.first_point.begin()) - 1;
}

/// Calls `visit(x, y, tile, pixel)` for all exposed pixels of a tile.
template <class Visit>
void for_each_exposed(const Frame& seen, std::size_t tile, Visit visit) {
    const Exposure& exposure = *seen.exposure;
    if (!exposure.is_exposed(tile)) return;
    for (int pixel = 0; pixel < tile_size * tile_size; ++pixel) {
        const glm::ivec2 at = seen.place_of(tile, pixel);
        if (at.x < seen.visible.width() && at.y < seen.visible.height() && exposure.exposed.at(at.x, at.y) != 0)
            visit(at.x, at.y, pixel);
    }
}

/// One pixel's light.
class PixelSum {
  public:
    void add(const Contribution& c, const GatherPoint& p, const PointLight& l, const PointCaustic& caustic) {
        const glm::vec3 shine = c.weight * (l.glossy + caustic.glossy), fallen = l.direct + caustic.irradiance,
                        scattered = c.diffuse * (fallen + l.indirect) + shine;
        combined += scattered;
        ++count_;
        direct_cut_ += l.direct_cut;
        indirect_cut_ += l.indirect_cut;
        const float part = core::divide_or(core::luminance(c.weight), core::luminance(p.weight), 0.0f);
        error_ += part * l.error;
        shared_ += part * l.shared;
        age_ += l.age;
        reused_ += l.served ? 1.0f : 0.0f;
        if (p.reached_by_specular()) {
            specular_ += scattered;
            return;
        }
        weight_ += c.weight;
        albedo_ += c.diffuse;
        direct_ += c.diffuse * fallen;
        indirect_ += c.diffuse * l.indirect;
        plain_direct_ += c.weight * fallen;
        plain_indirect_ += c.weight * l.indirect;
        glossy_ += shine;
    }

    void write_layers(int x, int y, core::Radiance& radiance) const {
        const auto mean = [&](glm::vec3 sum, glm::vec3 plain) {
            glm::vec3 r;
            for (int k = 0; k < 3; ++k)
                r[k] = core::divide_or(sum[k], albedo_[k], core::divide_or(plain[k], weight_[k], 0.0f));
            return r;
        };
        radiance.albedo.at(x, y) = albedo_;
        radiance.direct_irradiance.at(x, y) = mean(direct_, plain_direct_);
        radiance.indirect_irradiance.at(x, y) = mean(indirect_, plain_indirect_);
        radiance.glossy.at(x, y) = glossy_;
        radiance.specular.at(x, y) += specular_;
        const auto points = static_cast<float>(std::max(count_, 1));
        radiance.direct_cut.at(x, y) = direct_cut_ / points;
        radiance.indirect_cut.at(x, y) = indirect_cut_ / points;
        radiance.record_age.at(x, y) = age_ / points;
        radiance.record_reuse.at(x, y) = reused_ / points;
    }

    /// An error that neighbours do not share.
    void add_error(float alone) {
        PointLight light;
        light.add_alone({alone});
        error_ += light.error;
        shared_ += light.shared;
    }

    void write_errors(int x, int y, core::Radiance& radiance) const {
        radiance.error.at(x, y) = error_.value;
        radiance.shared_error.at(x, y) = shared_.value;
    }

    glm::vec3 combined{0};

  private:
    glm::vec3 weight_{0}, albedo_{0}, direct_{0}, indirect_{0}, plain_direct_{0}, plain_indirect_{0}, glossy_{0},
        specular_{0};
    float direct_cut_ = 0, indirect_cut_ = 0, age_ = 0, reused_ = 0;
    core::StandardError error_{}, shared_{};
    int count_ = 0;
};

bool is_finite(const core::Radiance& radiance, int x, int y) {
    bool finite = core::is_finite(radiance.combined.at(x, y));
    for (const auto* layer : {&radiance.emission, &radiance.direct_irradiance, &radiance.indirect_irradiance,
                              &radiance.albedo, &radiance.glossy, &radiance.specular})
        finite = finite && (layer->empty() || core::is_finite(layer->at(x, y)));
    return finite;
}

void blacken(core::Radiance& radiance, int x, int y) {
    for (auto* layer : {&radiance.combined, &radiance.emission, &radiance.direct_irradiance,
                        &radiance.indirect_irradiance, &radiance.albedo, &radiance.glossy, &radiance.specular})
        if (!layer->empty()) layer->at(x, y) = glm::vec3(0);
}

}  // namespace

core::ToleranceMap tolerance_of_points(const Frame& seen, const core::ToleranceMap& tolerance) {
    if (!seen.exposure || tolerance.is_reference()) return tolerance;
    const Exposure& exposure = *seen.exposure;
    core::ToleranceMap least = tolerance;
    for (std::size_t t = 0; t < seen.tiles.size(); ++t)
        for_each_exposed(seen, t, [&](int x, int y, int pixel) {
            const core::Tolerance& own = tolerance.pixels.at(x, y);
            for (const Contribution& c : exposure.of_pixel(t, pixel)) {
                const std::size_t tile = tile_of(exposure, c.point);
                const GatherPoint& p = seen.tiles[tile][c.point - exposure.first_point[tile]];
                const glm::ivec2 place = seen.place_of(tile, p.pixel);
                core::Tolerance& cell = least.pixels.at(place.x, place.y);
                const float relative = std::min(cell.relative, own.relative);
                if (own.absolute < cell.absolute) cell = own;
                cell.relative = relative;
            }
        });
    return least;
}

void spread_light(const Frame& seen, const UngatheredLight& ungathered, const FrameLight& light, bool layers,
                  core::Radiance& radiance, ShadeCounts& counts) {
    if (!seen.exposure) return;
    const Exposure& exposure = *seen.exposure;
    struct Found {
        std::uint64_t non_finite = 0;
        std::int64_t first = -1;
    };
    if (layers) radiance.coverage = exposure.coverage;
    const std::vector<PointCaustic>& caustics = ungathered.caustics_of_points();
    std::vector<Found> of_tile(seen.tiles.size());
    parallel::for_each(seen.tiles.size(), [&](std::size_t t) {
        for_each_exposed(seen, t, [&](int x, int y, int pixel) {
            PixelSum sum;
            for (const Contribution& c : exposure.of_pixel(t, pixel)) {
                const std::size_t tile = tile_of(exposure, c.point);
                const std::size_t index = c.point - exposure.first_point[tile];
                sum.add(c, seen.tiles[tile][index], light[tile][index],
                        caustics.empty() ? PointCaustic() : caustics[c.point]);
            }
            const glm::vec3 air = value_or_zero(ungathered.air().exposed, x, y);
            const glm::vec3 hair = value_or_zero(ungathered.hair().exposed, x, y);
            const glm::vec3 emitted = exposure.emitted.at(x, y) + air + hair;
            radiance.combined.at(x, y) = glm::max(emitted + sum.combined, glm::vec3(0));
            sum.add_error(value_or_zero(ungathered.hair().exposed_error, x, y));
            sum.write_errors(x, y, radiance);
            if (layers) {
                const glm::vec3 specular = value_or_zero(exposure.emitted_specular, x, y);
                radiance.emission.at(x, y) = glm::max(emitted - specular - hair, glm::vec3(0));
                radiance.specular.at(x, y) = specular;
                sum.write_layers(x, y, radiance);
                radiance.glossy.at(x, y) += hair;
            }
            if (is_finite(radiance, x, y)) return;
            if (of_tile[t].non_finite++ == 0)
                of_tile[t].first = static_cast<std::int64_t>(y) * seen.visible.width() + x;
            blacken(radiance, x, y);
        });
    });
    for (const Found& found : of_tile) {
        if (counts.non_finite == 0) counts.first_non_finite = found.first;
        counts.non_finite += found.non_finite;
    }
}

}  // namespace render2mpeg::renderer
