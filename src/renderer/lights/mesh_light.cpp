// Light of surfaces that shine: all triangles of an object, and places among them.
#include "core/box.h"
#include "renderer/base/stream.h"
#include "renderer/lights/light_points.h"
#include "renderer/lights/shining_surface.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/discrete_distribution.h"
#include "renderer/base/lobe.h"

namespace render2mpeg::renderer {
namespace {

/// Cells into which all textured emissive triangles together are cut, about, and the finest cut of one triangle's edge:
/// so a screen that is one quad still lights its room from where its picture is bright. chosen: as many cells as texels
/// of a small picture, and 16 to an edge, which a photograph's large features need; not tuned.
constexpr std::size_t most_cells = 1u << 16;
constexpr int finest = 16;

/// Shadow rays end so far before a surface, as a share of their length (docs/model/visibility.md).
constexpr float before_surface = 1.0f - 0x1p-18f;

float area_of(const scene::Triangle& t) {
    return 0.5f * glm::length(glm::cross(t.b - t.a, t.c - t.a));
}

glm::vec3 place_on(const scene::Triangle& t, float u, float v) {
    return (1.0f - u - v) * t.a + u * t.b + v * t.c;
}

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

/// A triangle that shines: of an object that is switched off, which still gets its points, of its own size.
scene::Triangle emitting_triangle(const scene::Snapshot& s, std::uint32_t object, std::uint32_t primitive) {
    if (s.objects[object].present) return scene::triangle_of(s, object, primitive);
    const scene::Object& o = s.animation->objects[object];
    const scene::Mesh& mesh = s.animation->meshes[static_cast<std::size_t>(o.mesh)];
    const glm::uvec3 t = mesh.triangles[primitive];
    return {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
}

float emitting_area(const scene::Snapshot& s, std::uint32_t object, std::uint32_t primitive) {
    const float area = area_of(emitting_triangle(s, object, primitive));
    return std::isfinite(area) ? area : 0.0f;
}

/// The corner of a triangle that lies opposite of its shortest edge.
int apex_of(const scene::Triangle& t) {
    const std::array<float, 3> opposite{glm::length(t.c - t.b), glm::length(t.a - t.c), glm::length(t.b - t.a)};
    return static_cast<int>(std::ranges::min_element(opposite) - opposite.begin());
}

/// Place k of n in a triangle, as weights of its second and third corner. Hammersley's, whose steps go from the apex
/// along the triangle's length: of a strip's light a few points for each of its widths are even.
glm::vec2 place_in_triangle(int apex, int k, int n, const Stream& numbers) {
    const float along = (static_cast<float>(k) + 0.5f) / static_cast<float>(n);
    const glm::vec2 far = core::sample_triangle({along, numbers.halton(0, static_cast<std::uint64_t>(k))});
    std::array<float, 3> weights{};
    for (int i = 0; i < 3; ++i)
        weights[static_cast<std::size_t>((apex + i) % 3)] = i == 0 ? 1.0f - far.x - far.y : far[i - 1];
    return {weights[1], weights[2]};
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

/// The mean radiance of a cell: the texture, filtered over the parallelogram that the cell is half of, seen from all
/// sides.
glm::vec3 radiance_of(const PosedScene& posed_scene, const scene::Triangle& t, std::uint32_t object, const Cell& cell) {
    const glm::vec2 middle = cell.corner + (cell.edge_u + cell.edge_v) / 3.0f;
    const glm::vec3 edge1 = t.b - t.a, edge2 = t.c - t.a;
    const SurfaceFootprint footprint{edge1 * cell.edge_u.x + edge2 * cell.edge_u.y,
                                     edge1 * cell.edge_v.x + edge2 * cell.edge_v.y};
    return posed_scene.mean_emission({object, cell.primitive, middle.x, middle.y}, footprint);
}

/// Cells of an edge, where so many textured triangles are cut.
int cells_per_edge(std::size_t textured) {
    const double per_triangle = core::divide_or(static_cast<double>(most_cells), static_cast<double>(textured), 1.0);
    return std::clamp(static_cast<int>(std::sqrt(per_triangle)), 1, finest);
}

Emitter emitter_of(const PosedScene& posed_scene, const scene::Snapshot& snapshot, std::uint32_t object, int per_edge) {
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
            if (!material.emission_texture.present() || per_edge == 1 || !snapshot.objects[object].present) {
                emitter.cells.push_back(whole);
                continue;
            }
            // Give every cell its own mean, then the whole its exact power.
            const scene::Triangle t = scene::triangle_of(snapshot, object, p);
            const std::size_t first = emitter.cells.size();
            cut(whole, per_edge, emitter.cells);
            double power = 0;
            for (std::size_t c = first; c < emitter.cells.size(); ++c) {
                emitter.cells[c].radiance = radiance_of(posed_scene, t, object, emitter.cells[c]);
                power += emitter.cells[c].power();
            }
            const auto scale = static_cast<float>(core::divide_or(whole.power(), power, 0.0));
            for (std::size_t c = first; c < emitter.cells.size(); ++c) emitter.cells[c].radiance *= scale;
            if (scale > 0.0f) continue;
            emitter.cells.resize(first);
            emitter.cells.push_back(whole);
        }
    }
    for (const Cell& cell : emitter.cells) emitter.power += cell.power();
    return emitter;
}

/// Stratified points of one emitter: each stands for the same power.
void place_points(const scene::Snapshot& snapshot, const Emitter& emitter, int count, std::uint64_t seed,
                  std::vector<EmitterPoint>& out) {
    const Stream numbers = Stream(Purpose::lamp_points, {.index = seed}).at(emitter.object);
    const double shift = numbers.uniform(0);
    double passed = 0;
    int next = 0;
    for (std::size_t c = 0; c < emitter.cells.size() && next < count; ++c) {
        const Cell& cell = emitter.cells[c];
        passed += cell.power();
        const bool last = c + 1 == emitter.cells.size();
        const Stream of_cell = numbers.at(1 + c);
        int end = last ? count : next;
        while (end < count && (end + shift) * emitter.power < passed * count) ++end;
        const int apex = apex_of(emitting_triangle(snapshot, emitter.object, cell.primitive));
        for (int k = 0, n = end - next; next < end; ++k, ++next) {
            const glm::vec2 place = place_in_triangle(apex, k, n, of_cell);
            const glm::vec2 uv = cell.corner + place.x * cell.edge_u + place.y * cell.edge_v;
            const double share = emitter.power / count / core::luminance(cell.radiance) * cell.share / cell.area;
            out.push_back(
                {emitter.object, cell.primitive, uv.x, uv.y, cell.front, static_cast<float>(share), cell.radiance});
        }
    }
}

/// Objects that shine at some time, perhaps.
std::vector<std::uint32_t> shining_objects(const scene::Animation& film) {
    std::vector<std::uint32_t> objects;
    for (std::uint32_t i = 0; i < film.objects.size(); ++i) {
        const scene::Material& material = film.materials[static_cast<std::size_t>(film.objects[i].material)];
        if (material.emits() && !material.unlit) objects.push_back(i);
    }
    return objects;
}

/// All triangles of an object.
class MeshLight final : public Light {
  public:
    MeshLight(const PosedScene& posed_scene, std::uint32_t object) : posed_scene_(posed_scene), object_(object) {
        const scene::Animation& film = posed_scene.animation();
        const scene::Mesh& mesh = film.meshes[static_cast<std::size_t>(film.objects[object].mesh)];
        core::Box box;
        for (std::uint32_t p = 0; p < mesh.triangles.size(); ++p) {
            const scene::Triangle t = scene::triangle_of(posed_scene.posed(), object, p);
            const float area = area_of(t);
            float shines =
                std::isfinite(area) && area > 0.0f ? core::luminance(posed_scene.mean_emission(object, p)) : 0.0f;
            if (!std::isfinite(shines)) shines = 0.0f;
            if (shines > 0.0f) box.hold(t.a), box.hold(t.b), box.hold(t.c);
            luminance_.push_back(shines);
            triangles_.add(shines > 0.0f ? static_cast<double>(area) * static_cast<double>(shines) : 0.0);
        }
        centre_ = box.middle();
        radius_ = 0.5f * glm::length(box.size());
    }

    SourceExtent extent() const override { return {centre_, radius_, triangles_.total()}; }
    /// About its irradiance, if it faced the surface and was seen.
    double weight(const LightQuery& query) const override {
        const glm::vec3 d = centre_ - query.position;
        // Wholly behind.
        if (!query.may_see(d, 1.001f * radius_)) return 0.0;
        return triangles_.total() / std::max(static_cast<double>(glm::dot(d, d)),
                                             static_cast<double>(radius_) * static_cast<double>(radius_));
    }
    LightSample sample(const LightQuery& query, double part, glm::vec2 u) const override {
        const glm::vec2 place = core::sample_triangle(u);
        const core::SurfaceAddress address{object_, static_cast<std::uint32_t>(triangles_.pick(part)), place.x,
                                           place.y};
        const scene::Triangle t = scene::triangle_of(posed_scene_.posed(), object_, address.primitive);
        LightSample sample;
        sample.direction = core::normalize_or(place_on(t, place.x, place.y) - query.position, query.normal);
        if (!query.may_see(sample.direction)) return {};
        sample.density = density(query, sample.direction, address);
        if (!(sample.density > 0.0f) || !std::isfinite(sample.density)) return {};
        const SurfacePoint point = posed_scene_.surface_at(address, -sample.direction);
        sample.light = point.unlit ? glm::vec3(0) : point.emission / sample.density;
        const glm::vec3 way = offset_origin(point, -sample.direction) - query.origin;
        sample.far = before_surface * glm::length(way);
        sample.ray = core::normalize_or(way, sample.direction);
        return sample;
    }
    float density(const LightQuery& query, glm::vec3, const core::SurfaceAddress& address) const override {
        const double shines = static_cast<double>(luminance_[address.primitive]);
        if (!(shines > 0.0)) return 0.0f;
        const scene::Triangle t = scene::triangle_of(posed_scene_.posed(), object_, address.primitive);
        const glm::dvec3 d(place_on(t, address.u, address.v) - query.position),
            normal(glm::cross(t.b - t.a, t.c - t.a));
        const double distance2 = glm::dot(d, d), length = std::sqrt(distance2);
        const double cosine = core::divide_or(std::abs(glm::dot(d, normal)), length * glm::length(normal), 0.0);
        return static_cast<float>(core::divide_or(shines / triangles_.total() * distance2, cosine, 0.0));
    }
    std::uint32_t object() const override { return object_; }

  private:
    const PosedScene& posed_scene_;
    std::uint32_t object_;
    glm::vec3 centre_{0};
    float radius_ = 0;
    DiscreteDistribution triangles_;  ///< by area x luminance
    std::vector<float> luminance_;    ///< of each triangle
};

}  // namespace

ShiningSurface::ShiningSurface(const PosedScene& posed_scene, std::uint32_t object)
    : posed_scene_(&posed_scene), object_(object) {
    const scene::Animation& film = posed_scene.animation();
    const auto triangles = film.meshes[static_cast<std::size_t>(film.objects[object].mesh)].triangles.size();
    glm::dvec3 sum(0);
    glm::dmat3 squares(0);
    for (const Cell& cell : emitter_of(posed_scene, posed_scene.posed(), object, cells_per_edge(triangles)).cells) {
        const double light = cell.power();
        const scene::Triangle t = scene::triangle_of(posed_scene.posed(), object, cell.primitive);
        cells_.push_back(
            {cell.primitive, cell.front, cell.corner, cell.edge_u, cell.edge_v, core::luminance(cell.radiance)});
        light_.add(light);
        // Second moments of a triangle [polyhedral mass properties]: (s s' + sum of v v') / 12 of its corners v.
        const auto corner = [&](glm::vec2 edge) {
            const glm::vec2 place = cell.corner + edge;
            return glm::dvec3(place_on(t, place.x, place.y));
        };
        const std::array<glm::dvec3, 3> corners{corner({0, 0}), corner(cell.edge_u), corner(cell.edge_v)};
        const glm::dvec3 s = corners[0] + corners[1] + corners[2];
        sum += light / 3.0 * s;
        squares += light / 12.0 * glm::outerProduct(s, s);
        for (const glm::dvec3& v : corners) squares += light / 12.0 * glm::outerProduct(v, v);
    }
    if (!(power() > 0.0)) return;
    const glm::dvec3 mean = sum / power();
    covariance_ = glm::mat3(squares / power() - glm::outerProduct(mean, mean));
}

LightPoint ShiningSurface::at(glm::vec2 u) const {
    const std::size_t k = light_.pick(static_cast<double>(u.x));
    const LitCell& cell = cells_[k];
    const glm::vec2 within =
        core::sample_triangle({static_cast<float>(light_.within(k, static_cast<double>(u.x))), u.y});
    const glm::vec2 place = cell.corner + within.x * cell.edge_u + within.y * cell.edge_v;
    const glm::vec3 front = posed_scene_->front_normal(object_, cell.primitive);
    LightPoint p;
    p.normal = cell.front ? front : -front;
    const SurfacePoint surface = posed_scene_->surface_at({object_, cell.primitive, place.x, place.y}, p.normal);
    p.position = offset_origin(surface, p.normal);
    p.intensity = surface.unlit ? glm::vec3(0) : surface.emission * (static_cast<float>(power()) / cell.luminance);
    p.object = object_;
    return p;
}

Lights surfaces_of(const PosedScene& posed_scene) {
    Lights surfaces;
    for (const std::uint32_t object : shining_objects(posed_scene.animation())) {
        if (!posed_scene.posed().objects[object].present) continue;
        auto light = std::make_unique<MeshLight>(posed_scene, object);
        if (light->extent().power > 0.0) surfaces.push_back(std::move(light));
    }
    return surfaces;
}

std::vector<EmitterPoint> place_emitters(const PosedScene& posed_scene, const scene::Snapshot& snapshot, int count,
                                         std::uint64_t seed) {
    const scene::Animation& film = *snapshot.animation;
    const std::vector<std::uint32_t> objects = shining_objects(film);
    std::size_t textured = 0;
    for (const std::uint32_t i : objects)
        if (film.materials[static_cast<std::size_t>(film.objects[i].material)].emission_texture.present())
            textured += film.meshes[static_cast<std::size_t>(film.objects[i].mesh)].triangles.size();
    const int per_edge = cells_per_edge(textured);

    std::vector<Emitter> emitters(objects.size());
    parallel::for_each(objects.size(),
                       [&](std::size_t i) { emitters[i] = emitter_of(posed_scene, snapshot, objects[i], per_edge); });
    double power = 0;
    for (const Emitter& emitter : emitters) power += emitter.power;
    std::vector<EmitterPoint> points;
    for (const Emitter& emitter : emitters) {
        if (!(emitter.power > 0.0)) continue;
        const double wanted = core::divide_or(emitter.power, power, 0.0) * count;
        place_points(snapshot, emitter, std::max(1, static_cast<int>(std::lround(wanted))), seed, points);
    }
    return points;
}

LightPoint point_at(const PosedScene& posed_scene, const EmitterPoint& e, std::uint32_t id) {
    const scene::Snapshot& now = posed_scene.posed();
    const scene::Object& object = posed_scene.animation().objects[e.object];
    const scene::Triangle t = scene::triangle_of(now, e.object, e.primitive);
    const float area = area_of(t) * e.share;
    const glm::vec3 front = posed_scene.front_normal(e.object, e.primitive);
    LightPoint p;
    p.normal = e.front ? front : -front;
    const SurfacePoint surface = posed_scene.surface_at({e.object, e.primitive, e.u, e.v}, p.normal);
    p.position = offset_origin(surface, p.normal);
    p.intensity = e.radiance * (now.emission_factor[static_cast<std::size_t>(object.material)] * area);
    p.disc2 = area * lobe::inverse_pi;
    p.id = id;
    p.object = e.object;
    return p;
}

}  // namespace render2mpeg::renderer
