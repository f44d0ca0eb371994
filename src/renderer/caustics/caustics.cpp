#include "renderer/caustics/caustics.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/caustics/casters.h"
#include "renderer/caustics/caustic_photons.h"

namespace render2mpeg::renderer {
namespace {

/// Photons of a rough look, which also tells how many a frame needs; and the least and the most of those. chosen: at
/// most 131,072, which take some CPU seconds a frame.
constexpr std::uint64_t pilot_photons = 1u << 14, least_photons = 1u << 13, most_photons = 1u << 17;

/// Photons of a frame that nothing bounds.
constexpr std::uint64_t reference_photons = 1u << 20;

/// Photons that are kept at a time, and that one thread follows in a row.
constexpr std::uint64_t batch = 1u << 16, grain = 1u << 9;

/// Least semi-axis of a kernel in pixels. chosen: 0.4, what the eye's samples of a pixel span.
constexpr float least_axis = 0.4f;

/// Largest semi-axis, in diagonals of the scene's box: single photons that were spread wide are no light to see.
constexpr float largest_axis = 0.05f;

/// Photons stand evenly, so their light errs by this share of what as many random ones would.
/// fit: docs/fits/caustics.md
constexpr float evenness = 0.3f;

/// What of a pixel's tolerance twice the standard error may take in 95 of 100 pixels with caustics. chosen: a half.
constexpr float share_of_tolerance = 0.5f, share_of_pixels = 0.95f;

/// A frame without tolerance of its own.
constexpr core::Tolerance rough{0.0f, 0.05f};

class Splatting {
  public:
    Splatting(const PosedScene& posed_scene, const Casters& casters, const SplatTree& tree, int height,
              const CausticSettings& settings)
        : posed_scene_(posed_scene), casters_(casters), tree_(tree), settings_(settings) {
        const scene::Camera& camera = posed_scene.posed().camera;
        eye_ = camera.position();
        angle_ = camera.lens().vertical_fov / static_cast<float>(height);
        const scene::Animation& film = posed_scene.animation();
        limit_ = largest_axis * glm::length(film.bounds_max - film.bounds_min);
    }

    std::vector<CausticLight> light(std::uint64_t count, CausticCounts& counts) const {
        std::vector<CausticLight> light(tree_.size());
        for (std::uint64_t first = 0; first < count; first += batch) {
            const std::vector<Landing> landings = follow(first, std::min(first + batch, count), count, counts);
            std::vector<Footprint> footprints(landings.size());
            for (std::size_t i = 0; i < landings.size(); ++i)
                footprints[i] =
                    footprint_of(landings[i], least_axis * angle_ * glm::distance(landings[i].position, eye_), limit_);
            tree_.add(posed_scene_, landings, footprints, settings_.visibility, light, counts.splats);
            counts.landings += landings.size();
        }
        return light;
    }

  private:
    std::vector<Landing> follow(std::uint64_t first, std::uint64_t end, std::uint64_t count,
                                CausticCounts& counts) const {
        const std::size_t runs = (end - first + grain - 1) / grain;
        std::vector<std::vector<Landing>> parts(runs);
        std::vector<LandingCounts> part_counts(runs);
        parallel::for_each(runs, [&](std::size_t i) {
            const std::uint64_t from = first + i * grain;
            follow_photons(posed_scene_, casters_, from, std::min(from + grain, end), count, parts[i], part_counts[i]);
        });
        std::vector<Landing> landings;
        for (std::size_t i = 0; i < runs; ++i) {
            landings.insert(landings.end(), parts[i].begin(), parts[i].end());
            counts.followed.photons += part_counts[i].photons;
            counts.followed.rays += part_counts[i].rays;
        }
        return landings;
    }

    const PosedScene& posed_scene_;
    const Casters& casters_;
    const SplatTree& tree_;
    const CausticSettings& settings_;
    glm::vec3 eye_{0};
    float angle_ = 0, limit_ = 0;
};

glm::vec3 scattered(const GatherPoint& g, const CausticLight& light) {
    return g.weight * (g.point.bsdf.diffuse * light.irradiance + light.glossy);
}

/// A pixel's place in the picture, row by row.
std::size_t pixel_of(const Seen& seen, std::uint32_t tile, const GatherPoint& g) {
    const auto across = static_cast<std::uint32_t>(seen.tiles_across());
    const std::uint32_t x = tile % across * tile_size + g.pixel % tile_size;
    const std::uint32_t y = tile / across * tile_size + g.pixel / tile_size;
    return std::size_t{y} * static_cast<std::size_t>(seen.visible.width()) + x;
}

/// How many photons keep the tolerance, by what so many did.
std::uint64_t photons_needed(const Seen& seen, const SplatTree& tree, const std::vector<CausticLight>& light,
                             const core::ToleranceMap* tolerance, std::uint64_t photons) {
    std::vector<float> sums(seen.emitted.size()), variances(seen.emitted.size());
    for (std::size_t i = 0; i < tree.size(); ++i) {
        if (!(light[i].sum > 0.0f)) continue;
        const std::size_t pixel = pixel_of(seen, tree.tile(i), tree[i]);
        const float luminance = core::luminance(scattered(tree[i], light[i]));
        const float error = evenness * luminance * std::sqrt(light[i].squares) / light[i].sum;
        sums[pixel] += luminance;
        variances[pixel] += error * error;
    }
    std::vector<float> excess;
    for (std::size_t p = 0; p < sums.size(); ++p) {
        if (!(sums[p] > 0.0f)) continue;
        const core::Tolerance& t = tolerance != nullptr ? tolerance->pixels.values()[p] : rough;
        const float shown = std::max(core::luminance(seen.emitted.values()[p]), 0.0f) + sums[p];
        const float allowed = share_of_tolerance * t.allows(shown);
        if (sums[p] > allowed) excess.push_back(core::divide_or(2.0f * std::sqrt(variances[p]), allowed, 1e3f));
    }
    if (excess.empty()) return least_photons;
    const auto at =
        excess.begin() + static_cast<std::ptrdiff_t>(share_of_pixels * static_cast<float>(excess.size() - 1));
    std::nth_element(excess.begin(), at, excess.end());
    // Errors fall with the root of the number, and slower than that where kernels narrow (docs/fits/caustics.md).
    const double wanted =
        static_cast<double>(photons) * std::min(1e6, static_cast<double>(*at) * static_cast<double>(*at));
    std::uint64_t count = least_photons;
    while (count < most_photons && static_cast<double>(count) < wanted) count *= 2;
    return count;
}

}  // namespace

void Caustics::add(const PosedScene& posed_scene, std::span<const LightPoint> lights,
                   const core::ToleranceMap* tolerance, Seen& seen, CausticCounts& counts) {
    const int width = seen.visible.width(), height = seen.visible.height();
    seen.caustics = seen.caustics_specular = core::Plane<glm::vec3>(width, height, glm::vec3{0.0f});
    const Casters casters(posed_scene, lights);
    if (casters.empty()) return;
    const SplatTree tree(seen);
    const Splatting splatting(posed_scene, casters, tree, height, settings_);

    // Choose the number of photons at the chunk's first frame.
    std::uint64_t count = settings_.photons;
    if (count == 0 && tolerance != nullptr && tolerance->is_reference()) count = reference_photons;
    if (count == 0 && tolerance == nullptr) count = pilot_photons;
    if (count == 0 && photons_ == 0)
        photons_ = photons_needed(seen, tree, splatting.light(pilot_photons, counts), tolerance, pilot_photons);
    if (count == 0) count = photons_;

    const std::vector<CausticLight> light = splatting.light(count, counts);
    if (seen.exposure) seen.thrown.assign(seen.exposure->first_point.back(), {});
    for (std::size_t i = 0; i < tree.size(); ++i) {
        if (!(light[i].sum > 0.0f)) continue;
        const glm::vec3 sent = scattered(tree[i], light[i]);
        if (!core::is_finite(sent)) continue;
        if (seen.exposure) {
            const auto of_tile = static_cast<std::size_t>(&tree[i] - seen.tiles[tree.tile(i)].data());
            seen.thrown[seen.exposure->first_point[tree.tile(i)] + of_tile] = {light[i].irradiance, light[i].glossy};
        }
        const std::size_t pixel = pixel_of(seen, tree.tile(i), tree[i]);
        seen.emitted.values()[pixel] += sent;
        if (tree[i].reached_by_specular() && !seen.emitted_specular.empty()) {
            seen.emitted_specular.values()[pixel] += sent;
            seen.caustics_specular.values()[pixel] += sent;
        } else {
            seen.caustics.values()[pixel] += sent;
        }
    }
}

glm::vec3 caustic_light_at(const Seen& seen, glm::ivec2 place) {
    glm::vec3 sum(0);
    for (const auto* plane : {&seen.caustics, &seen.caustics_specular})
        if (!plane->empty()) sum += plane->at(place.x, place.y);
    return sum;
}

}  // namespace render2mpeg::renderer
