#include "renderer/view/see.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/color.h"
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

/// And they show no detail between them if their reflectances differ by less than this share of the larger one.
/// chosen: a tenth, of 0.03, 0.1, 0.25 (docs/fits/edge-samples.md).
constexpr float same_reflectance = 0.1f;

bool same_surface(const GatherPoint& a, const Fragment& b, float pixel_extent) {
    if (a.point.address.object != b.point.address.object || a.point.back_side != b.point.back_side) return false;
    if (a.way != b.way) return false;
    if (glm::dot(a.point.shading_normal, b.point.shading_normal) < same_normal) return false;
    const glm::vec3 apart = b.point.position - a.point.position;
    const float off = std::max(std::abs(glm::dot(apart, a.point.geometric_normal)),
                               std::abs(glm::dot(apart, b.point.geometric_normal)));
    return off <= same_plane * pixel_extent + a.point.position_error + b.point.position_error;
}

/// Whether two samples of one surface reflect white light alike: where they do not, a texture has detail.
bool reflect_alike(const Bsdf& a, const Bsdf& b) {
    const float x = core::luminance(a.diffuse + a.f0), y = core::luminance(b.diffuse + b.f0);
    return std::abs(x - y) <= same_reflectance * std::max(x, y);
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

/// Whether neighbouring pixels show one surface: what lies between them may be an edge.
bool goes_on(const core::Visible& visible, int x0, int y0, int x1, int y1) {
    if (visible.kind.at(x0, y0) != visible.kind.at(x1, y1)) return false;
    const core::PixelClass kind = visible.kind.at(x0, y0);
    if (kind != core::PixelClass::surface && kind != core::PixelClass::reflected) return true;
    return visible.address.at(x0, y0).object == visible.address.at(x1, y1).object &&
           glm::dot(visible.shading_normal.at(x0, y0).unpack(), visible.shading_normal.at(x1, y1).unpack()) >=
               same_normal;
}

/// Whether depth jumps between a pixel and one of its neighbours across or below. On a plane 1 / depth is linear in
/// the picture. `angle`: of a pixel.
bool jumps(const core::Visible& visible, int x, int y, glm::ivec2 step, float angle) {
    const int x0 = x - step.x, y0 = y - step.y, x1 = x + step.x, y1 = y + step.y;
    if (x0 < 0 || y0 < 0 || x1 >= visible.width() || y1 >= visible.height()) return false;
    const float here = visible.depth.at(x, y);
    const float bend = core::divide_or(here, visible.depth.at(x0, y0), 0.0f) +
                       core::divide_or(here, visible.depth.at(x1, y1), 0.0f) - 2.0f;
    return std::abs(bend) > same_plane * angle;
}

/// Whether an edge passes by a pixel, as the middles of the pixels about it tell.
bool is_at_edge(const core::Visible& visible, int x, int y, float angle) {
    const auto ends = [&](int dx, int dy) {
        const int x1 = x + dx, y1 = y + dy;
        return x1 >= 0 && y1 >= 0 && x1 < visible.width() && y1 < visible.height() && !goes_on(visible, x, y, x1, y1);
    };
    if (ends(-1, 0) || ends(1, 0) || ends(0, -1) || ends(0, 1)) return true;
    const core::PixelClass kind = visible.kind.at(x, y);
    if (kind != core::PixelClass::surface && kind != core::PixelClass::reflected) return false;
    return jumps(visible, x, y, {1, 0}, angle) || jumps(visible, x, y, {0, 1}, angle);
}

/// Looks through the pixels of a tile.
class TileLook {
  public:
    TileLook(const Looking& looking, Seen& seen, SeeCounts& counts) : looking_(looking), seen_(seen), counts_(counts) {}

    /// Pixels (first, y) to (end - 1, y), all of them; true in `edges`, by x % tile_size, where samples differ.
    void take(int first, int end, int y, GatherTile& tile, std::array<bool, tile_size>* edges) {
        look_.take(looking_, first, end, y);
        for (int x = first; x < end; ++x) {
            const bool edge =
                see_pixel(x, y, static_cast<std::size_t>(x - first) * looking_.pattern.size(), tile, edges != nullptr);
            if (edges != nullptr) (*edges)[static_cast<std::size_t>(x % tile_size)] = edge;
        }
    }

  private:
    /// `begin`: the index of the pixel's first ray. Returns whether its samples show different surfaces.
    bool see_pixel(int x, int y, std::size_t begin, GatherTile& tile, bool records) {
        const std::size_t first = tile.size();
        const auto share = 1.0f / static_cast<float>(looking_.pattern.size());
        glm::vec3 emitted{0.0f}, emitted_specular{0.0f};
        bool differ = false;
        std::size_t fragments = 0;
        for (std::size_t s = 0; s < looking_.pattern.size(); ++s) {
            const std::size_t ray = begin + s;
            looking_.paths.look(look_.rays[ray], look_.queries[ray].far, look_.hits[ray], sample_, counts_);
            if (s == 0 && records) record(seen_.visible, looking_.camera, x, y, sample_.main);
            emitted += sample_.emitted;
            emitted_specular += sample_.emitted_specular;
            differ = differ || (s > 0 && sample_.fragments.size() != fragments);
            fragments = sample_.fragments.size();
            for (const Fragment& fragment : sample_.fragments) {
                const glm::vec3 weight = share * fragment.weight;
                const float extent = core::divide_or(fragment.extent, looking_.spacing, 0.0f);
                const auto match =
                    std::find_if(tile.begin() + static_cast<std::ptrdiff_t>(first), tile.end(),
                                 [&](const GatherPoint& g) { return same_surface(g, fragment, extent); });
                if (match != tile.end()) {
                    differ = differ || !reflect_alike(match->point.bsdf, fragment.point.bsdf);
                    merge(*match, fragment, weight);
                    if (match->others < most_other_places)
                        match->elsewhere[match->others++] = shadow_origin(fragment.point);
                    continue;
                }
                differ = differ || s > 0;
                const auto pixel = static_cast<std::uint16_t>((y % tile_size) * tile_size + x % tile_size);
                tile.push_back({fragment.point, pixel, fragment.way, false, weight});
            }
        }
        seen_.emitted.at(x, y) = share * emitted;
        if (!seen_.emitted_specular.empty()) seen_.emitted_specular.at(x, y) = share * emitted_specular;
        return differ;
    }

    const Looking& looking_;
    Seen& seen_;
    SeeCounts& counts_;
    EyeSample sample_;
    FirstLook look_;
};

/// Which pixels of a tile show an edge, row by row.
using TileEdges = std::array<std::array<bool, tile_size>, tile_size>;

/// A tile's pixels in the picture, `end` not included.
struct TileArea {
    glm::ivec2 first, end;
};

TileArea area_of(const Seen& seen, std::size_t tile) {
    const int across = seen.tiles_across();
    const glm::ivec2 first = tile_size * glm::ivec2(static_cast<int>(tile) % across, static_cast<int>(tile) / across);
    return {first, glm::min(first + tile_size, glm::ivec2(seen.visible.width(), seen.visible.height()))};
}

/// Looks through all pixels of a tile, and says where samples differ.
void see_tile(const Looking& looking, std::size_t t, Seen& seen, TileEdges& edges, SeeCounts& counts) {
    const TileArea area = area_of(seen, t);
    const int together = std::max(1, static_cast<int>(most_rays / looking.pattern.size()));
    TileLook look(looking, seen, counts);
    GatherTile tile;
    for (int y = area.first.y; y < area.end.y; ++y)
        for (int x = area.first.x; x < area.end.x; x += together)
            look.take(x, std::min(x + together, area.end.x), y, tile, &edges[static_cast<std::size_t>(y % tile_size)]);
    seen.tiles[t] = GatherTile(tile);
}

/// Looks again through those pixels of a tile that show an edge; the others keep what they have.
void see_edges(const Looking& looking, std::size_t t, Seen& seen, const TileEdges& edges, SeeCounts& counts) {
    const TileArea area = area_of(seen, t);
    const scene::CameraLens& lens = looking.camera.lens();
    const float angle = lens.vertical_fov / static_cast<float>(seen.visible.height());
    TileLook look(looking, seen, counts);
    const GatherTile& before = seen.tiles[t];
    GatherTile tile;
    std::size_t next = 0;
    for (int y = area.first.y; y < area.end.y; ++y)
        for (int x = area.first.x; x < area.end.x; ++x) {
            const auto pixel = static_cast<std::uint16_t>((y % tile_size) * tile_size + x % tile_size);
            const std::size_t first = next;
            while (next < before.size() && before[next].pixel == pixel) ++next;
            if (edges[static_cast<std::size_t>(y % tile_size)][static_cast<std::size_t>(x % tile_size)] ||
                is_at_edge(seen.visible, x, y, angle)) {
                look.take(x, x + 1, y, tile, nullptr);
                seen.at_edge.at(x, y) = 1;
            } else {
                tile.insert(tile.end(), before.begin() + static_cast<std::ptrdiff_t>(first),
                            before.begin() + static_cast<std::ptrdiff_t>(next));
            }
        }
    seen.tiles[t] = GatherTile(tile);
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

    // Look tile by tile, then again at edges; counts are summed in the tiles' order.
    const EyePaths paths(posed_scene, settings, plan);
    const LobeRays lobes(posed_scene, settings, plan);
    const auto looking = [&](const std::vector<glm::vec2>& pattern) {
        return Looking{posed_scene.tracer(), paths, snapshot.camera, pattern,
                       1.0f / std::sqrt(static_cast<float>(pattern.size()))};
    };
    const std::vector<glm::vec2> pattern = sample_pattern(settings.samples);
    std::vector<SeeCounts> tile_counts(seen.tiles.size());
    std::vector<TileEdges> edges(seen.tiles.size());
    parallel::for_each(seen.tiles.size(),
                       [&](std::size_t t) { see_tile(looking(pattern), t, seen, edges[t], tile_counts[t]); });
    if (settings.edge_samples > settings.samples) {
        const std::vector<glm::vec2> finer = sample_pattern(settings.edge_samples);
        seen.at_edge = core::Plane<std::uint8_t>(width, height, std::uint8_t{0});
        parallel::for_each(seen.tiles.size(),
                           [&](std::size_t t) { see_edges(looking(finer), t, seen, edges[t], tile_counts[t]); });
    }
    if (lobes.trace_rays())
        parallel::for_each(seen.tiles.size(),
                           [&](std::size_t t) { tile_counts[t].specular_rays += lobes.light(t, seen); });
    for (const SeeCounts& c : tile_counts) {
        counts.primary_rays += c.primary_rays;
        counts.specular_rays += c.specular_rays;
    }
    counts.sky_seconds += paths.sky_seconds();
    return seen;
}

}  // namespace render2mpeg::renderer
