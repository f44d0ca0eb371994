#include "renderer/view/see.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/view/eye_path.h"
#include "renderer/view/tile_visibility.h"

namespace render2mpeg::renderer {
namespace {

/// On one surface depth bends by no more than this share of a pixel's angle. chosen: as samples on one plane
/// (tile_visibility.cpp).
constexpr float same_depth = 0.5f;

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
    return std::abs(bend) > same_depth * angle;
}

/// Light in mirrors and glass that differs by more than this factor is an edge. chosen: 2, as rims of lamps have; what
/// mirrors show of the sky seldom does.
constexpr float same_light = 2.0f;

/// Whether mirrors show a lamp's rim in one of nine pixels. No sample may have met the part in this one.
bool shows_rim(const core::Plane<glm::vec3>& mirrored, int x, int y) {
    float darkest = std::numeric_limits<float>::infinity(), brightest = 0.0f;
    for (int y1 = std::max(y - 1, 0); y1 <= std::min(y + 1, mirrored.height() - 1); ++y1)
        for (int x1 = std::max(x - 1, 0); x1 <= std::min(x + 1, mirrored.width() - 1); ++x1) {
            const float light = core::luminance(mirrored.at(x1, y1));
            darkest = std::min(darkest, light);
            brightest = std::max(brightest, light);
        }
    return brightest > same_light * darkest;
}

/// Whether an edge passes by a pixel, as the middles of the pixels about it tell. `wraps`: on both sides of the seam.
bool is_at_edge(const Frame& seen, int x, int y, float angle, bool wraps) {
    const core::Visible& visible = seen.visible;
    const auto column = [&](int x1) { return wraps ? (x1 + visible.width()) % visible.width() : x1; };
    const auto ends = [&](int dx, int dy) {
        const int x1 = column(x + dx), y1 = y + dy;
        return x1 >= 0 && y1 >= 0 && x1 < visible.width() && y1 < visible.height() && !goes_on(visible, x, y, x1, y1);
    };
    if (ends(-1, 0) || ends(1, 0) || ends(0, -1) || ends(0, 1)) return true;
    // The corner of a lamp that no sample met shows, however small its share is.
    const auto shines = [&](int dx, int dy) {
        return ends(dx, dy) && visible.kind.at(column(x + dx), y + dy) == core::PixelClass::surface &&
               core::luminance(seen.emitted.at(column(x + dx), y + dy)) > 0.0f;
    };
    if (shines(-1, -1) || shines(1, -1) || shines(-1, 1) || shines(1, 1)) return true;
    if (!seen.emitted_specular.empty() && shows_rim(seen.emitted_specular, x, y)) return true;
    const core::PixelClass kind = visible.kind.at(x, y);
    if (kind != core::PixelClass::surface && kind != core::PixelClass::reflected) return false;
    return jumps(visible, x, y, {1, 0}, angle) || jumps(visible, x, y, {0, 1}, angle);
}

/// Marks the pixels of a tile that show an edge, those that are marked among them.
void mark_edges(const Frame& seen, std::size_t t, float angle, bool wraps, PixelMarks& marks) {
    const TileArea area = area_of(seen, t);
    for (int y = area.first.y; y < area.end.y; ++y)
        for (int x = area.first.x; x < area.end.x; ++x) {
            bool& mark = marks[static_cast<std::size_t>(y % tile_size)][static_cast<std::size_t>(x % tile_size)];
            mark = mark || is_at_edge(seen, x, y, angle, wraps);
        }
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

Frame see(const PosedScene& posed_scene, const SeeSettings& settings, const Plan& plan, SeeCounts& counts) {
    EXPECTS(settings.samples >= 1 && settings.format.width > 0 && settings.format.height > 0);
    const scene::Snapshot& snapshot = posed_scene.posed();
    const int width = settings.format.width, height = settings.format.height;
    Frame seen;
    seen.visible = core::Visible(snapshot.frame, width, height);
    seen.emitted = core::Plane<glm::vec3>(width, height, glm::vec3{0.0f});
    if (plan.runs(Pass::mirrors) || plan.runs(Pass::glass))
        seen.emitted_specular = core::Plane<glm::vec3>(width, height, glm::vec3{0.0f});
    if (plan.runs(Pass::mirrors)) seen.imaged = core::Plane<core::SurfaceAddress>(width, height);
    const int across = seen.tiles_across(), down = (height + tile_size - 1) / tile_size;
    if (posed_scene.air() != nullptr)
        seen.air.resize(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
    if (plan.runs(Pass::hair) || plan.runs(Pass::subsurface))
        seen.fibres.resize(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
    seen.tiles.resize(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
    if (settings.mattes) seen.mattes.resize(seen.tiles.size());

    // Look tile by tile, then again at edges; counts are summed in the tiles' order.
    const EyePaths paths(posed_scene, settings, plan);
    const auto looking = [&](const std::vector<glm::vec2>& pattern) {
        return Looking{
            posed_scene.tracer(), paths, snapshot.camera, pattern,
            1.0f / std::sqrt(static_cast<float>(std::max(settings.spaced_as, static_cast<int>(pattern.size()))))};
    };
    const std::vector<glm::vec2> pattern = sample_pattern(settings.samples);
    std::vector<SeeCounts> tile_counts(seen.tiles.size());
    std::vector<PixelMarks> edges(seen.tiles.size());
    parallel::for_each(seen.tiles.size(),
                       [&](std::size_t t) { edges[t] = look_through(looking(pattern), t, seen, tile_counts[t]); });
    if (settings.edge_samples > settings.samples) {
        const std::vector<glm::vec2> finer = sample_pattern(settings.edge_samples);
        seen.samples = core::Plane<std::uint16_t>(width, height, static_cast<std::uint16_t>(settings.samples));
        const float angle = snapshot.camera.pixel_angle();
        // Marks read what neighbouring tiles show by a first look.
        parallel::for_each(seen.tiles.size(),
                           [&](std::size_t t) { mark_edges(seen, t, angle, snapshot.camera.wraps(), edges[t]); });
        parallel::for_each(seen.tiles.size(),
                           [&](std::size_t t) { look_again(looking(finer), t, edges[t], seen, tile_counts[t]); });
    }
    for (const SeeCounts& c : tile_counts) counts.add(c);
    counts.sky_seconds += paths.sky_seconds();
    return seen;
}

}  // namespace render2mpeg::renderer
