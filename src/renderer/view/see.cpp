#include "renderer/view/see.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/view/eye_path.h"
#include "renderer/view/lobe_rays.h"

namespace render2mpeg::renderer {
namespace {

/// Two samples of a pixel lie on one surface if their normals are the same, and if neither lies off the other's plane
/// by more than this share of the distance between neighbouring pixels. chosen: steps lower than that are not seen as
/// steps; tried 0.1..1.
constexpr float same_plane = 0.5f;

bool same_surface(const GatherPoint& a, const Fragment& b, float pixel_extent) {
    if (a.point.address.object != b.point.address.object || a.point.back_side != b.point.back_side) return false;
    if (a.reached_by_specular != b.specular) return false;
    if (glm::dot(a.point.shading_normal, b.point.shading_normal) < same_normal) return false;
    const glm::vec3 apart = b.point.position - a.point.position;
    const float off = std::max(std::abs(glm::dot(apart, a.point.geometric_normal)),
                               std::abs(glm::dot(apart, b.point.geometric_normal)));
    return off <= same_plane * pixel_extent + a.point.position_error + b.point.position_error;
}

/// Takes b into a: the weights add, and the reflectances become their means by weight.
void merge(GatherPoint& a, const Fragment& b, glm::vec3 weight) {
    const glm::vec3 sum = a.weight + weight;
    const auto mean = [&](glm::vec3 x, glm::vec3 y) {
        glm::vec3 m;
        for (int c = 0; c < 3; ++c) m[c] = core::divide_or(a.weight[c] * x[c] + weight[c] * y[c], sum[c], x[c]);
        return m;
    };
    Bsdf& bsdf = a.point.bsdf;
    const float heavy = a.weight.x + a.weight.y + a.weight.z, light = weight.x + weight.y + weight.z;
    bsdf.alpha = core::divide_or(heavy * bsdf.alpha + light * b.point.bsdf.alpha, heavy + light, bsdf.alpha);
    bsdf.diffuse = mean(bsdf.diffuse, b.point.bsdf.diffuse);
    bsdf.f0 = mean(bsdf.f0, b.point.bsdf.f0);
    bsdf.f90 = mean(bsdf.f90, b.point.bsdf.f90);
    a.weight = sum;
}

/// Records what the sample at the pixel's centre shows.
void record(core::Visible& visible, const scene::Camera& camera, int x, int y, const MainSurface& main) {
    visible.kind.at(x, y) = main.kind;
    if (main.kind != core::PixelClass::surface && main.kind != core::PixelClass::reflected) return;
    const SurfacePoint& point = main.point;
    visible.address.at(x, y) = point.address;
    visible.material.at(x, y) = point.material;
    visible.geometric_normal.at(x, y) = core::PackedNormal(point.geometric_normal);
    visible.shading_normal.at(x, y) = core::PackedNormal(point.shading_normal);
    const glm::vec3 from_eye = point.position - camera.position();
    visible.depth.at(x, y) = std::max(glm::dot(from_eye, camera.forward()), std::numeric_limits<float>::min());
}

/// Pixels whose rays are traced together have at most so many samples. chosen: rows of a tile with 64 samples.
constexpr std::size_t most_rays = 1024;

/// What all tiles share.
struct Looking {
    const RayTracer& tracer;
    const EyePaths& paths;
    const scene::Camera& camera;
    const std::vector<glm::vec2>& pattern;
    float spacing;  ///< of samples, pixels
};

/// Rays of neighbouring pixels, sample by sample, and what they meet first.
struct FirstLook {
    std::vector<EyeRay> rays;
    std::vector<RayQuery> queries;
    std::vector<Hit> hits;

    /// Looks through pixels (first, y) to (end - 1, y).
    void take(const Looking& looking, int first, int end, int y) {
        rays.clear();
        queries.clear();
        for (int x = first; x < end; ++x) {
            for (const glm::vec2 place : looking.pattern) {
                float far = 0.0f;
                const glm::vec2 position = glm::vec2{static_cast<float>(x), static_cast<float>(y)} + place;
                const EyeRay& ray = rays.emplace_back(eye_ray(looking.camera, position, looking.spacing, far));
                queries.push_back({ray.origin, ray.direction, far});
            }
        }
        hits.resize(queries.size());
        looking.tracer.nearest(queries, hits);
    }
};

/// `begin`: the index of the pixel's first ray.
void see_pixel(const Looking& looking, int x, int y, const FirstLook& look, std::size_t begin, EyeSample& sample,
               Seen& seen, GatherTile& tile, SeeCounts& counts) {
    const std::size_t first = tile.size();
    const auto share = 1.0f / static_cast<float>(looking.pattern.size());
    glm::vec3 emitted{0.0f}, emitted_specular{0.0f};
    for (std::size_t s = 0; s < looking.pattern.size(); ++s) {
        const std::size_t ray = begin + s;
        looking.paths.look(look.rays[ray], look.queries[ray].far, look.hits[ray], sample, counts);
        if (s == 0) record(seen.visible, looking.camera, x, y, sample.main);
        emitted += sample.emitted;
        emitted_specular += sample.emitted_specular;
        for (const Fragment& fragment : sample.fragments) {
            const glm::vec3 weight = share * fragment.weight;
            const float extent = core::divide_or(fragment.extent, looking.spacing, 0.0f);
            const auto match = std::find_if(tile.begin() + static_cast<std::ptrdiff_t>(first), tile.end(),
                                            [&](const GatherPoint& g) { return same_surface(g, fragment, extent); });
            if (match != tile.end()) {
                merge(*match, fragment, weight);
                continue;
            }
            const auto pixel = static_cast<std::uint16_t>((y % tile_size) * tile_size + x % tile_size);
            tile.push_back({fragment.point, pixel, fragment.specular, false, weight});
        }
    }
    seen.emitted.at(x, y) = share * emitted;
    if (!seen.emitted_specular.empty()) seen.emitted_specular.at(x, y) = share * emitted_specular;
}

}  // namespace

std::vector<glm::vec2> sample_pattern(int samples) {
    EXPECTS(samples >= 1);
    // The additive sequence by powers of the plastic number [Roberts2018], from the centre.
    constexpr double a1 = 0.7548776662466927, a2 = 0.5698402909980532;
    std::vector<glm::dvec2> places;
    glm::dvec2 sum{0.0, 0.0};
    for (int i = 0; i < samples; ++i) {
        const glm::dvec2 p{0.5 + a1 * i, 0.5 + a2 * i};
        places.push_back(p - glm::floor(p));
        sum += places.back();
    }

    // Move all but the centre so that their mean is the centre: else the picture would be shifted against its motion. A
    // single other sample cannot do that.
    const glm::dvec2 shift =
        samples > 2 ? (0.5 * samples - sum) / static_cast<double>(samples - 1) : glm::dvec2{0.0, 0.0};
    std::vector<glm::vec2> pattern(1, glm::vec2{0.5f, 0.5f});
    for (int i = 1; i < samples; ++i) pattern.emplace_back(places[static_cast<std::size_t>(i)] + shift);
    return pattern;
}

Seen see(const PosedScene& posed_scene, const SeeSettings& settings, const Plan& plan, SeeCounts& counts) {
    EXPECTS(settings.samples >= 1 && settings.format.width > 0 && settings.format.height > 0);
    const scene::Snapshot& snapshot = posed_scene.posed();
    const int width = settings.format.width, height = settings.format.height;
    Seen seen;
    seen.visible = core::Visible(snapshot.frame, width, height);
    seen.emitted = core::Plane<glm::vec3>(width, height, glm::vec3{0.0f});
    if (plan.runs(Pass::mirrors) || plan.runs(Pass::glass))
        seen.emitted_specular = core::Plane<glm::vec3>(width, height, glm::vec3{0.0f});
    if (plan.runs(Pass::lobe_rays)) seen.emitted_glossy = core::Plane<glm::vec3>(width, height, glm::vec3{0.0f});
    const int across = seen.tiles_across(), down = (height + tile_size - 1) / tile_size;
    seen.tiles.resize(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));

    // Look tile by tile; counts are summed in the tiles' order.
    const EyePaths paths(posed_scene, settings, plan);
    const LobeRays lobes(posed_scene, settings, plan);
    const std::vector<glm::vec2> pattern = sample_pattern(settings.samples);
    const Looking looking{posed_scene.tracer(), paths, snapshot.camera, pattern,
                          1.0f / std::sqrt(static_cast<float>(settings.samples))};
    const int together = std::max(1, static_cast<int>(most_rays / pattern.size()));
    std::vector<SeeCounts> tile_counts(seen.tiles.size());
    parallel::for_each(seen.tiles.size(), [&](std::size_t t) {
        const int x0 = static_cast<int>(t) % across * tile_size, y0 = static_cast<int>(t) / across * tile_size;
        const int x1 = std::min(x0 + tile_size, width), y1 = std::min(y0 + tile_size, height);
        EyeSample sample;
        FirstLook look;
        GatherTile tile;
        for (int y = y0; y < y1; ++y) {
            for (int first = x0; first < x1; first += together) {
                const int end = std::min(first + together, x1);
                look.take(looking, first, end, y);
                for (int x = first; x < end; ++x)
                    see_pixel(looking, x, y, look, static_cast<std::size_t>(x - first) * pattern.size(), sample, seen,
                              tile, tile_counts[t]);
            }
        }
        seen.tiles[t] = GatherTile(tile);
        if (lobes.trace_rays()) tile_counts[t].specular_rays += lobes.light(t, seen);
    });
    for (const SeeCounts& c : tile_counts) {
        counts.primary_rays += c.primary_rays;
        counts.specular_rays += c.specular_rays;
    }
    counts.sky_seconds += paths.sky_seconds();
    return seen;
}

}  // namespace render2mpeg::renderer
