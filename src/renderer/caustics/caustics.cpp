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

/// Least semi-axis of a kernel in pixels: the kernel has the variance of a pixel, a sixth of its square for a twelfth.
constexpr float least_axis = 0.7071f;

/// Largest semi-axis, in diagonals of the scene's box: single photons that were spread wide are no light to see.
constexpr float largest_axis = 0.05f;

/// Photons stand evenly, so their light errs by this share of what as many random ones would.
/// fit: docs/measurements.md#caustics
constexpr float evenness = 0.3f;

/// Share of a pixel's tolerance that twice the standard error may take in 95 of 100 pixels with caustics. chosen: a
/// half.
constexpr float share_of_tolerance = 0.5f, share_of_pixels = 0.95f;

/// Caustics whose root mean square over the picture is below this share of the tolerance are left out: films lose 0.1
/// dB or so. fit: docs/measurements.md#caustics. A pixel counts as no more than a hundred tolerances.
constexpr float least_visible = 0.1f, most_of_pixel = 100.0f;

/// Twice the standard error of caustics is no more than this share of the tolerance, root mean square over the picture:
/// no more photons are followed than that takes. chosen: a third of `least_visible`.
constexpr float least_error = 0.03f;

/// Photons by which each frame of a chunk without visible caustics asks whether there are any now. chosen: 2,048, a
/// hundredth of a CPU second.
constexpr std::uint64_t asking_photons = 1u << 11;

/// A frame without tolerance of its own.
constexpr core::Tolerance rough{0.0f, 0.05f};

class Splatting {
  public:
    Splatting(const PosedScene& posed_scene, const Casters& casters, const SplatTree& tree,
              const CausticSettings& settings)
        : posed_scene_(posed_scene), casters_(casters), tree_(tree), settings_(settings) {
        const scene::Camera& camera = posed_scene.posed().camera;
        eye_ = camera.position();
        angle_ = camera.pixel_angle();
        const scene::Animation& film = posed_scene.animation();
        limit_ = largest_axis * glm::length(film.bounds_max - film.bounds_min);
    }

    /// `dim`: landings that bring less irradiance are thinned out to fewer of so much; 0: none.
    std::vector<CausticLight> light(std::uint64_t count, float dim, CausticCounts& counts) const {
        std::vector<CausticLight> light(tree_.size());
        for (std::uint64_t first = 0; first < count; first += batch) {
            std::vector<Landing> landings = follow(first, std::min(first + batch, count), count, counts);
            std::vector<Footprint> footprints(landings.size());
            for (std::size_t i = 0; i < landings.size(); ++i)
                footprints[i] =
                    footprint_of(landings[i], least_axis * angle_ * glm::distance(landings[i].position, eye_), limit_);
            if (dim > 0.0f) thin_out(dim, landings, footprints);
            tree_.add(posed_scene_, landings, footprints, settings_.visibility, light, counts.splats);
            counts.landings += landings.size();
        }
        return light;
    }

  private:
    /// Photons that are wide spread bring little each, and touch many points: a few of them tell as much.
    static void thin_out(float dim, std::vector<Landing>& landings, std::vector<Footprint>& footprints) {
        // chosen: the plastic number's power -2 [Roberts2018], of four that were tried (docs/measurements.md#caustics).
        constexpr double step = 0.5698402909980532;
        for (std::size_t i = 0; i < landings.size(); ++i) {
            Landing& landing = landings[i];
            const float cosine = std::abs(glm::dot(landing.direction, landing.normal));
            const float share = core::luminance(landing.flux) * footprints[i].peak * cosine / dim;
            if (!(share < 1.0f)) continue;
            // Kronecker's sequence stands well with Halton's, which chose the way.
            const double at = step * static_cast<double>(landing.photon % (1u << 20));
            if (static_cast<float>(at - std::floor(at)) < share)
                landing.flux /= share;
            else
                footprints[i].widest = 0.0f;
        }
    }

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
std::size_t pixel_of(const Frame& seen, std::uint32_t tile, const GatherPoint& g) {
    const glm::ivec2 place = seen.place_of(tile, g.pixel);
    return static_cast<std::size_t>(place.y) * static_cast<std::size_t>(seen.visible.width()) +
           static_cast<std::size_t>(place.x);
}

/// Light of caustics in a pixel.
struct PixelCaustic {
    float luminance = 0, irradiance = 0;  ///< sums over its points; of white
    float variance = 0;                   ///< of the luminance
    float squares = 0;                    ///< of photons' irradiances
};

std::vector<PixelCaustic> pixel_caustics(const Frame& seen, const SplatTree& tree,
                                         const std::vector<CausticLight>& light) {
    std::vector<PixelCaustic> pixels(seen.emitted.size());
    for (std::size_t i = 0; i < tree.size(); ++i) {
        if (!(light[i].sum > 0.0f)) continue;
        PixelCaustic& pixel = pixels[pixel_of(seen, tree.tile(i), tree[i])];
        const float luminance = core::luminance(scattered(tree[i], light[i]));
        const float relative = light[i].relative_variance();
        const float error = evenness * luminance * std::sqrt(relative);
        pixel.luminance += luminance;
        pixel.irradiance += light[i].sum;
        pixel.variance += error * error;
        pixel.squares += relative * light[i].sum * light[i].sum;
    }
    return pixels;
}

/// Of values from 0 up, the one that so many are below; there is one.
float quantile(std::vector<float>& values, float share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<float>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// How many photons keep the tolerance, and which of them are too dim to be spread one by one, by what so many did.
/// `shown`: what the tolerance was found for has caustics.
CausticBudget budget_of(const Frame& seen, const SplatTree& tree, const std::vector<CausticLight>& light,
                        const core::ToleranceMap* tolerance, std::uint64_t photons, bool shown) {
    const std::vector<PixelCaustic> pixels = pixel_caustics(seen, tree, light);
    const auto tolerance_of = [&](std::size_t p) {
        return tolerance != nullptr ? tolerance->pixels.values()[p] : rough;
    };
    // The rest of its light is not known yet, but for what the tolerance was found for.
    const auto without = [&](std::size_t p) {
        const float known = std::max(core::luminance(seen.emitted.values()[p]), 0.0f);
        return std::max(known, tolerance_of(p).background - (shown ? pixels[p].luminance : 0.0f));
    };
    const auto tolerated = [&](std::size_t p) { return tolerance_of(p).allows(without(p) + pixels[p].luminance); };
    std::vector<float> excess;
    double visible = 0, errors = 0;
    for (std::size_t p = 0; p < pixels.size(); ++p) {
        if (!(pixels[p].luminance > 0.0f)) continue;
        const float t = tolerated(p), allowed = share_of_tolerance * t;
        // So many tolerances lie between the light without it and with it, about.
        const float between = std::sqrt(t * tolerance_of(p).allows(without(p)));
        const float shares = std::min(core::divide_or(pixels[p].luminance, between, most_of_pixel), most_of_pixel);
        visible += static_cast<double>(shares * shares);
        const float error =
            std::min(core::divide_or(2.0f * std::sqrt(pixels[p].variance), t, most_of_pixel), most_of_pixel);
        errors += static_cast<double>(error * error);
        if (pixels[p].luminance > allowed)
            excess.push_back(core::divide_or(2.0f * std::sqrt(pixels[p].variance), allowed, 1e3f));
    }
    CausticBudget budget;
    budget.visible = visible > static_cast<double>(least_visible * least_visible) * static_cast<double>(pixels.size());
    budget.photons = least_photons;
    if (excess.empty()) return budget;
    // Errors fall with the root of the number, and slower than that where kernels narrow
    // (docs/measurements.md#caustics).
    const auto worst = static_cast<double>(quantile(excess, share_of_pixels));
    const double mean = errors / (static_cast<double>(least_error * least_error) * static_cast<double>(pixels.size()));
    const double wanted = static_cast<double>(photons) * std::min({1e6, worst * worst, mean});
    while (budget.photons < most_photons && static_cast<double>(budget.photons) < wanted) budget.photons *= 2;

    // Photons of one irradiance v, at random, that bring E together err by sqrt(v E).
    const float narrower = std::sqrt(static_cast<float>(photons) / static_cast<float>(budget.photons));
    std::vector<float> dim;
    for (std::size_t p = 0; p < pixels.size(); ++p) {
        const PixelCaustic& c = pixels[p];
        const float allowed = share_of_tolerance * tolerated(p);
        if (!(c.luminance > allowed)) continue;
        const float allowed_irradiance = 0.5f * allowed * c.irradiance / c.luminance;
        dim.push_back(
            std::max(allowed_irradiance * allowed_irradiance / c.irradiance, narrower * c.squares / c.irradiance));
    }
    budget.dim = quantile(dim, 1.0f - share_of_pixels);
    return budget;
}

}  // namespace

void Caustics::add(const PosedScene& posed_scene, std::span<const LightPoint> lights,
                   const core::ToleranceMap* tolerance, const Frame& seen, UngatheredLight& sum,
                   CausticCounts& counts) {
    const int width = seen.visible.width(), height = seen.visible.height();
    const float sky_of_rays = settings_.rays_see_sky_in_panes ? brightest_of_rays(posed_scene.sky()) : 0.0f;
    const Casters casters(posed_scene, lights, sky_of_rays);
    if (casters.empty()) return;
    const SplatTree tree(seen);
    const Splatting splatting(posed_scene, casters, tree, settings_);

    // Choose the number of photons at the chunk's first frame.
    CausticBudget budget{settings_.photons};
    if (budget.photons == 0 && tolerance != nullptr && tolerance->is_reference()) budget.photons = reference_photons;
    if (budget.photons == 0 && tolerance == nullptr) budget.photons = pilot_photons;
    if (budget.photons == 0) {
        // The rough look that a first frame's tolerance was found for has caustics.
        const bool first = budget_.photons == 0;
        const auto look = [&](std::uint64_t photons) {
            return budget_of(seen, tree, splatting.light(photons, 0.0f, counts), tolerance, photons, first);
        };
        if (first || (!budget_.visible && look(asking_photons).visible)) budget_ = look(pilot_photons);
        if (!budget_.visible) return;
        budget = budget_;
    }

    const std::vector<CausticLight> light = splatting.light(budget.photons, budget.dim, counts);
    EffectLight of_pixels{core::Plane<glm::vec3>(width, height, glm::vec3(0)), {}, {}};
    if (!seen.emitted_specular.empty()) of_pixels.specular = of_pixels.all;
    std::vector<PointCaustic> of_points(seen.exposure ? seen.exposure->first_point.back() : 0);
    for (std::size_t i = 0; i < tree.size(); ++i) {
        if (!(light[i].sum > 0.0f)) continue;
        const glm::vec3 sent = scattered(tree[i], light[i]);
        if (!core::is_finite(sent)) continue;
        if (seen.exposure) {
            const auto of_tile = static_cast<std::size_t>(&tree[i] - seen.tiles[tree.tile(i)].data());
            of_points[seen.exposure->first_point[tree.tile(i)] + of_tile] = {light[i].irradiance, light[i].glossy};
        }
        const std::size_t pixel = pixel_of(seen, tree.tile(i), tree[i]);
        of_pixels.all.values()[pixel] += sent;
        if (tree[i].reached_by_specular() && !of_pixels.specular.empty()) of_pixels.specular.values()[pixel] += sent;
    }
    sum.add_caustics(std::move(of_pixels), std::move(of_points));
}

}  // namespace render2mpeg::renderer
