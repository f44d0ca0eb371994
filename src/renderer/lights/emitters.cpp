#include "renderer/lights/emitters.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// Cells into which all textured emissive triangles together are cut, about, and the finest cut of one triangle's edge:
/// so a screen that is one quad still lights its room from where its picture is bright. chosen: as many cells as texels
/// of a small picture, and 16 to an edge, which a photograph's large features need; not tuned.
constexpr std::size_t most_cells = 1u << 16;
constexpr int finest = 16;

/// A piece of one side of an emissive triangle with about one radiance.
struct Cell {
    std::uint32_t primitive = 0;
    bool front = true;
    glm::vec2 corner{0, 0}, edge_u{1, 0}, edge_v{0, 1};  ///< in barycentrics of the triangle
    float share = 1;                                     ///< of the triangle's area
    float area = 0;                                      ///< world
    glm::vec3 radiance{0};
    double power() const { return static_cast<double>(area) * core::luminance(radiance); }
};

struct Emitter {
    std::uint32_t object = 0;
    std::vector<Cell> cells;
    double power = 0;
};

float emitting_area(const scene::Snapshot& s, std::uint32_t object, std::uint32_t primitive) {
    // An object that is switched off still gets its points: take its own size then.
    const scene::Object& o = s.animation->objects[object];
    const scene::Mesh& mesh = s.animation->meshes[static_cast<std::size_t>(o.mesh)];
    const glm::uvec3 t = mesh.triangles[primitive];
    scene::Triangle triangle{mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
    if (s.objects[object].present) triangle = scene::triangle_of(s, object, primitive);
    const float area = 0.5f * glm::length(glm::cross(triangle.b - triangle.a, triangle.c - triangle.a));
    return std::isfinite(area) ? area : 0.0f;
}

/// Cuts a triangle's edges into n: n x n small triangles, upright and turned ones.
void cut(const Cell& whole, int n, std::vector<Cell>& out) {
    const float step = 1.0f / static_cast<float>(n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; i + j < n; ++j)
            for (int turned = 0; turned < (i + j + 1 < n ? 2 : 1); ++turned) {
                Cell cell = whole;
                cell.corner = glm::vec2(i + turned, j + turned) * step;
                cell.edge_u = glm::vec2(turned ? -step : step, 0);
                cell.edge_v = glm::vec2(0, turned ? -step : step);
                cell.share = step * step;
                cell.area = whole.area * cell.share;
                out.push_back(cell);
            }
}

/// The mean radiance of a cell: the texture, filtered over the parallelogram that the cell is half of, seen along the
/// normal.
glm::vec3 radiance_of(const PosedScene& posed_scene, const scene::Triangle& t, std::uint32_t object, const Cell& cell) {
    const glm::vec2 middle = cell.corner + (cell.edge_u + cell.edge_v) / 3.0f;
    const glm::vec3 normal = posed_scene.front_normal(object, cell.primitive);
    const glm::vec3 edge1 = t.b - t.a, edge2 = t.c - t.a;
    const SurfaceFootprint footprint{edge1 * cell.edge_u.x + edge2 * cell.edge_u.y,
                                     edge1 * cell.edge_v.x + edge2 * cell.edge_v.y};
    return posed_scene
        .surface_at({object, cell.primitive, middle.x, middle.y}, cell.front ? normal : -normal, footprint)
        .emission;
}

Emitter emitter_of(const PosedScene& posed_scene, const scene::Snapshot& snapshot, std::uint32_t object,
                   int cells_per_edge) {
    const scene::Animation& film = *snapshot.animation;
    const scene::Object& o = film.objects[object];
    const scene::Material& material = film.materials[static_cast<std::size_t>(o.material)];
    const auto triangles = static_cast<std::uint32_t>(film.meshes[static_cast<std::size_t>(o.mesh)].triangles.size());
    Emitter emitter;
    emitter.object = object;
    for (int side = 0; side < (material.double_sided ? 2 : 1); ++side) {
        for (std::uint32_t p = 0; p < triangles; ++p) {
            Cell whole;
            whole.primitive = p;
            whole.front = side == 0;
            whole.area = emitting_area(snapshot, object, p);
            whole.radiance = posed_scene.mean_emission(object, p);
            if (!(whole.power() > 0.0) || !std::isfinite(whole.power())) continue;
            if (!material.emission_texture.present() || cells_per_edge == 1 || !snapshot.objects[object].present) {
                emitter.cells.push_back(whole);
                continue;
            }
            // Give every cell its own mean, then the whole its exact power.
            const scene::Triangle t = scene::triangle_of(snapshot, object, p);
            const std::size_t first = emitter.cells.size();
            cut(whole, cells_per_edge, emitter.cells);
            double power = 0;
            for (std::size_t c = first; c < emitter.cells.size(); ++c) {
                emitter.cells[c].radiance = radiance_of(posed_scene, t, object, emitter.cells[c]);
                power += emitter.cells[c].power();
            }
            const auto scale = static_cast<float>(core::divide_or(whole.power(), power, 0.0));
            if (scale > 0.0f) {
                for (std::size_t c = first; c < emitter.cells.size(); ++c) emitter.cells[c].radiance *= scale;
            } else {
                emitter.cells.resize(first);
                emitter.cells.push_back(whole);
            }
        }
    }
    for (const Cell& cell : emitter.cells) emitter.power += cell.power();
    return emitter;
}

/// Stratified points of one emitter: each stands for the same power.
void place_on(const Emitter& emitter, int count, std::uint64_t seed, std::vector<EmitterPoint>& out) {
    const double shift = core::uniform(seed, emitter.object, 1);
    double passed = 0;
    int next = 0;
    for (std::size_t c = 0; c < emitter.cells.size() && next < count; ++c) {
        const Cell& cell = emitter.cells[c];
        passed += cell.power();
        const bool last = c + 1 == emitter.cells.size();
        const glm::vec2 offset{core::uniform(seed, emitter.object, 2 + c, 0),
                               core::uniform(seed, emitter.object, 2 + c, 1)};
        for (std::uint64_t k = 0; next < count && (last || (next + shift) * emitter.power < passed * count);
             ++k, ++next) {
            const glm::vec2 u = glm::fract(glm::vec2(core::halton(0, k), core::halton(1, k)) + offset);
            const glm::vec2 place = core::sample_triangle(u);
            const glm::vec2 uv = cell.corner + place.x * cell.edge_u + place.y * cell.edge_v;
            EmitterPoint point;
            point.object = emitter.object;
            point.primitive = cell.primitive;
            point.front = cell.front;
            point.u = uv.x;
            point.v = uv.y;
            point.radiance = cell.radiance;
            point.share =
                static_cast<float>(emitter.power / count / core::luminance(cell.radiance) * cell.share / cell.area);
            out.push_back(point);
        }
    }
}

}  // namespace

std::vector<EmitterPoint> place_emitters(const PosedScene& posed_scene, const scene::Snapshot& snapshot, int count,
                                         std::uint64_t seed) {
    const scene::Animation& film = *snapshot.animation;
    std::vector<std::uint32_t> objects;
    std::size_t textured = 0;
    for (std::uint32_t i = 0; i < film.objects.size(); ++i) {
        const scene::Material& material = film.materials[static_cast<std::size_t>(film.objects[i].material)];
        if (!material.emits() || material.unlit) continue;
        objects.push_back(i);
        if (material.emission_texture.present())
            textured += film.meshes[static_cast<std::size_t>(film.objects[i].mesh)].triangles.size();
    }
    const double per_triangle = core::divide_or(static_cast<double>(most_cells), static_cast<double>(textured), 1.0);
    const int cells_per_edge = std::clamp(static_cast<int>(std::sqrt(per_triangle)), 1, finest);

    std::vector<Emitter> emitters(objects.size());
    parallel::for_each(objects.size(), [&](std::size_t i) {
        emitters[i] = emitter_of(posed_scene, snapshot, objects[i], cells_per_edge);
    });
    double power = 0;
    for (const Emitter& emitter : emitters) power += emitter.power;
    std::vector<EmitterPoint> points;
    for (const Emitter& emitter : emitters) {
        if (!(emitter.power > 0.0)) continue;
        const double wanted = core::divide_or(emitter.power, power, 0.0) * count;
        place_on(emitter, std::max(1, static_cast<int>(std::lround(wanted))), seed, points);
    }
    return points;
}

}  // namespace render2mpeg::renderer
