#include "renderer/gather/gather_ray.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/color.h"
#include "core/sampling.h"
#include "renderer/base/lobe.h"
#include "renderer/geometry/strands.h"
#include "renderer/surface/light_ray.h"
#include "scene/model/curves.h"

namespace render2mpeg::renderer {
namespace {

/// Layers and mirrors that a ray passes one after another, holes beside them, and the share of it below which it ends.
/// chosen: 8, 88, 0.02, as rays of the eye have; what is lost is a fiftieth of what is behind eight panes.
constexpr int most_surfaces = 8, most_holes = 88;
constexpr float least_passing = 0.02f;

/// A ray goes on beyond a surface with so many times the chance of what goes on there. chosen: 4, so that one ray in
/// six follows a polished floor's reflection; not tuned.
constexpr float often = 4.0f;

/// Cells among strands are half as large as light goes between them, within so many radii. chosen: of a whole way, fur
/// that is deep and dark is a fifth too dark where it shades itself, of half a tenth; 16 and 64, where fur is thin.
constexpr float ways_to_cell = 0.5f, least_fibre_cell = 16.0f, most_fibre_cell = 64.0f;

/// Least size of cells among an object's strands, in its own space; 0: they are no fibres.
float fibre_cell_of(const scene::Mesh& mesh, const scene::Material& material) {
    if (!mesh.has_curves() || !material.hair) return 0.0f;
    const double sum = std::accumulate(mesh.radii.begin(), mesh.radii.end(), 0.0);
    const float radius = static_cast<float>(sum) / static_cast<float>(mesh.radii.size());
    return std::clamp(ways_to_cell * free_path_among(mesh), least_fibre_cell * radius, most_fibre_cell * radius);
}

/// Own cells beyond this many in a row share the cells of others. chosen: 3, so that rays between two walls that nearly
/// touch end.
constexpr std::uint8_t most_own_cells = 3;

/// Interleaves the lower six bits.
std::uint64_t spread_bits(std::uint64_t v) {
    std::uint64_t bits = 0;
    for (unsigned i = 0; i < 6; ++i) bits |= (v >> i & 1u) << (3 * i);
    return bits;
}

/// One of the surfaces that a ray passes stands for all, as likely as it weighs, so that their number does not multiply
/// from bounce to bounce.
class TermReservoir {
  public:
    TermReservoir(std::uint32_t ray, float number)
        : term_{.ray = ray, .weight = glm::vec3(0), .place = {}}, number_(number) {}

    void offer(glm::vec3 weight, const CellQuery& place) {
        const float own = core::luminance(weight);
        if (!(own > 0.0f)) return;
        sum_ += own;
        const float likely = own / sum_;
        const bool taken = number_ < likely;
        number_ = taken ? number_ / likely : (number_ - likely) / (1.0f - likely);
        if (taken) term_ = {.ray = term_.ray, .weight = weight / own, .place = place};
    }
    void put(std::vector<RayTerm>& terms) {
        term_.weight *= sum_;
        term_.place.carried = core::luminance(term_.weight);
        if (sum_ > 0.0f) terms.push_back(term_);
    }

  private:
    RayTerm term_;
    float number_, sum_ = 0;
};

/// Share of a shining surface that rays of lobes see. `intensity`: RayRules::shining.
float by_lobe_rays(glm::vec3 emission, float distance, float intensity) {
    const float disc2 = core::divide_or(intensity, core::luminance(emission) * distance * distance, 0.0f);
    return 1.0f - lobe::by_trees(disc2, 1.0f / lobe::lobe_rays_disc2);
}

/// Light of a surface that shines, as far as rays count it that asked for lights, or those of lobes.
glm::vec3 shining(glm::vec3 passing, const SurfacePoint& p, float distance, const RayRules& rules, bool behind_body) {
    if (const AskedLights* asked = rules.asked)
        return passing * p.emission *
               asked->share(asked->lights.surface_density(asked->query, p.address), asked->choices.surfaces);
    if (behind_body) return glm::vec3(0);
    return passing * p.emission * by_lobe_rays(p.emission, distance, rules.shining[p.address.object]);
}

/// Turns a ray of this weight straight on or mirrored, as likely as either is; false: it ends, as most do where little
/// goes on.
bool go_on(const PosedScene& scene, const SurfacePoint& p, float choice, glm::vec3& direction, glm::vec3& weight,
           bool& mirrored) {
    const glm::vec3 ahead = weight * scene.transmittance_at(p.address, direction),
                    back = weight * p.alpha * mirrored_beside_straight(scene, p);
    const float going = core::luminance(ahead + back);
    const float chance = std::min(often * core::divide_or(going, core::luminance(weight), 0.0f), 1.0f);
    if (!(going > least_passing) || !(choice < chance)) return false;
    const float share_back = core::luminance(back) / going;
    const bool turns = choice < chance * share_back;
    weight = (turns ? back / share_back : ahead / (1.0f - share_back)) / chance;
    if (turns)
        direction = core::normalize_or(2.0f * glm::dot(p.shading_normal, p.outgoing) * p.shading_normal - p.outgoing,
                                       p.geometric_normal);
    mirrored = mirrored || turns;
    return true;
}

/// Whether its lobe may be narrower than those of shared cells.
bool may_be_polished(const scene::Material& m) {
    return m.roughness * m.roughness < least_alpha_of_cells || m.metallic_roughness_texture.present() ||
           m.curve_of(scene::AngledInput::roughness) != nullptr;
}

bool scatters(const SurfacePoint& p) {
    return p.bsdf.has_diffuse() || p.bsdf.has_glossy() || p.bsdf.has_diffuse_transmission() || p.fibre;
}

/// The place; where the surface is nothing but a lobe narrower than shared cells have, in a cell of its own.
CellQuery polished(CellQuery place, const SurfacePoint& p, const RayRules& rules, const Stream& numbers) {
    if (rules.depth >= most_own_cells || p.bsdf.has_diffuse() || !(p.bsdf.alpha < least_alpha_of_cells)) return place;
    place.key = numbers.bits() | own_cell;
    place.depth = static_cast<std::uint8_t>(rules.depth + 1);
    place.polished = true;
    return place;
}

/// Takes what the air on the way to the hit leaves of light, and adds what it sends if it is `bright`.
void pass_air(const Air& air, const RayQuery& ray, const Hit& hit, bool bright, glm::vec3& passing, glm::vec3& known) {
    const float way = hit.found() ? hit.distance : std::numeric_limits<float>::infinity();
    if (bright) known += passing * air.light_for_rays(ray.origin, ray.direction, way);
    passing *= air.left_of_light(ray.origin, ray.direction, way);
}

}  // namespace

GatherRays::GatherRays(const PosedScene& posed_scene, const Plan& plan)
    : posed_scene_(posed_scene),
      sky_light_(plan.runs(Pass::sky_light) && posed_scene.sky() != nullptr),
      bounces_(plan.runs(Pass::indirect_tree)),
      sky_in_panes_(plan.rays_see_sky_in_panes() ? brightest_of_rays(posed_scene.sky()) : 0.0f) {
    const scene::Animation& film = posed_scene.animation();
    extent_ = glm::length(film.bounds_max - film.bounds_min);
    extent_level_ = extent_ > 0.0f ? std::ilogb(extent_) : 0;
    for (const scene::Material& m : film.materials) {
        const bool plain = m.transmission == 0.0f && !m.unlit &&
                           !(plan.runs(Pass::mirrors) && scene::mirrored_share(m) > least_passing);
        plain_.push_back(plain && m.alpha_mode == scene::AlphaMode::opaque);
        cut_out_.push_back(plain && m.alpha_mode != scene::AlphaMode::opaque);
        shines_.push_back(m.emits() && !m.unlit);
        metal_.push_back(m.metallic >= 1.0f && !m.unlit && may_be_polished(m));
    }
    if (!plan.runs(Pass::hair)) return;
    for (const scene::Object& object : film.objects) {
        fibre_cells_.push_back(fibre_cell_of(film.meshes[static_cast<std::size_t>(object.mesh)],
                                             film.materials[static_cast<std::size_t>(object.material)]));
    }
}

/// The cell of a hit: of one object, one of six directions that its normal is nearest to, a cube of the world whose
/// size is a power of two. Size and place are dithered, so that edges of cells are noise and no pattern. The key's
/// upper bits are the place in the scene, the lower ones a hash of all.
CellQuery GatherRays::cell_query(const RayQuery& ray, const Hit& hit, float distance, const RayRules& rules,
                                 const Stream& numbers) const {
    CellQuery s;
    s.address = hit.address;
    s.outgoing = -ray.direction;
    const bool is_fibre = !fibre_cells_.empty() && fibre_cells_[hit.address.object] > 0.0f;
    s.fibre = is_fibre;
    if (distance < rules.near && rules.depth < most_own_cells && !is_fibre) {
        s.key = numbers.bits() | own_cell;
        s.size = rules.spread * distance;
        s.depth = static_cast<std::uint8_t>(rules.depth + 1);
        return s;
    }
    const std::uint64_t dither = numbers.bits();
    const auto part = [&](unsigned shift) { return static_cast<float>(dither >> shift & 0xffffu) * 0x1p-16f - 0.5f; };
    float size = rules.spread * distance;
    if (is_fibre) size = std::max(size, fibre_cell(hit.address.object));
    const int level = std::ilogb(std::max(std::exp2(part(0)) * size, std::numeric_limits<float>::min()));
    s.size = std::ldexp(1.0f, level);
    glm::vec3 at = ray.origin + hit.distance * ray.direction;
    at += s.size * glm::vec3(part(16), part(32), part(48));
    const float facing = glm::dot(hit.geometric_normal, ray.direction) > 0.0f ? -1.0f : 1.0f;
    // Fibres send other light to other sides; their normals say nothing.
    const glm::vec3 n = is_fibre ? -ray.direction : facing * hit.geometric_normal, a = glm::abs(n);
    const int axis = a.x > a.y && a.x > a.z ? 0 : a.y > a.z ? 1 : 2;
    const std::uint64_t face = static_cast<std::uint64_t>(2 * axis + (n[axis] < 0 ? 1 : 0));
    std::uint64_t hash = core::mix(static_cast<std::uint64_t>(hit.address.object) << 16 ^ face << 12 ^
                                   static_cast<std::uint64_t>(level - extent_level_ + 2048));
    std::uint64_t place = 0;
    for (int k = 0; k < 3; ++k) {
        const auto cell = static_cast<std::int64_t>(std::floor(std::ldexp(static_cast<double>(at[k]), -level)));
        hash = core::mix(hash ^ static_cast<std::uint64_t>(cell));
        const float part = core::divide_or(
            std::ldexp(static_cast<float>(cell), level) - posed_scene_.animation().bounds_min[k], extent_, 0.0f);
        place |= spread_bits(static_cast<std::uint64_t>(std::clamp(part, 0.0f, 1.0f) * 63.0f)) << k;
    }
    s.key = (place << 45 | hash >> 19) & ~own_cell;
    return s;
}

float GatherRays::fibre_cell(std::uint32_t object) const {
    const scene::ObjectState& state = posed_scene_.posed().objects[object];
    return fibre_cells_[object] * (state.deformed >= 0 ? 1.0f : scene::width_scale(state.to_world));
}

/// Radiance of the sky, and of suns that were asked.
glm::vec3 GatherRays::escaped(glm::vec3 direction, const RayRules& rules, bool mirrored) const {
    glm::vec3 sky(0);
    if (sky_light_) sky = posed_scene_.sky()->radiance_of_ray(direction, rules.solid_angle);
    const AskedLights* asked = rules.asked;
    const float most = asked != nullptr && mirrored ? brightest_of_rays(posed_scene_.sky()) : rules.brightest;
    sky *= std::min(core::divide_or(most, core::luminance(sky), 1.0f), 1.0f);
    if (asked == nullptr || mirrored) return sky;
    sky *= asked->share(asked->lights.sky_density(direction), 1);
    return sky + asked->lights.suns(asked->query, direction,
                                    [&](float other) { return asked->share(other, asked->choices.lamps); });
}

/// Light of the sky that a pane mirrors straight to where it is seen from. Smooth light needs no photons.
glm::vec3 GatherRays::sky_in_pane(const SurfacePoint& pane, float solid_angle, std::uint64_t& rays) const {
    const glm::vec3 share = pane.alpha * mirrored_by_pane(posed_scene_, pane);
    if (!(core::luminance(share) > 0.0f)) return glm::vec3(0);
    LightRay ray;
    ray.reflect(pane, pane.shading_normal);
    glm::vec3 sky = posed_scene_.sky()->radiance_of_ray(ray.direction, solid_angle);
    sky *= std::min(core::divide_or(sky_in_panes_, core::luminance(sky), 1.0f), 1.0f);
    if (const Air* air = posed_scene_.air())
        sky *= air->left_of_light(ray.origin, ray.direction, std::numeric_limits<float>::infinity());
    ++rays;
    return share * sky *
           posed_scene_.tracer().passes(ray.origin, ray.direction, std::numeric_limits<float>::infinity(),
                                        Bodies::block);
}

glm::vec3 GatherRays::follow(RayQuery ray, Hit hit, const RayRules& rules, const Stream& numbers, std::uint32_t index,
                             std::vector<RayTerm>& terms, std::uint64_t& rays) const {
    const Air* air = posed_scene_.air();
    const AskedLights* asked = rules.asked;
    glm::vec3 passing(1), known(0);
    TermReservoir chosen(index, numbers.uniform(0));
    float distance = 0;
    // Lamps and the sky in mirrors are caustics on what gathers by hemispheres.
    const bool sees_lights = asked != nullptr || rules.is_lobe;
    bool mirrored = false, behind_body = false;
    const LayerLimit& limit = posed_scene_.tracer().limit();
    int covers = 0;
    for (int step = 0, holes = 0; step < most_surfaces + holes; ++step) {
        if (step > 0) {
            hit = posed_scene_.tracer().nearest(ray.origin, ray.direction, ray.far);
            ++rays;
        }
        if (air != nullptr && !(step == 0 && rules.own_volume))
            pass_air(*air, ray, hit, bounces_ && rules.bounces, passing, known);
        if (!hit.found()) {
            if (!behind_body && (!mirrored || sees_lights)) known += passing * escaped(ray.direction, rules, mirrored);
            break;
        }
        distance += hit.distance;
        const auto material = static_cast<std::size_t>(posed_scene_.animation().objects[hit.address.object].material);
        const bool shines = shines_[material] && (asked != nullptr || !rules.shining.empty());
        const bool is_black = limit.ends(covers);  // but may shine
        covers += limit.counts(hit.address.object) ? 1 : 0;
        // What is cut out is plain, or not there.
        const bool cut_out = cut_out_[material] && !shines && !is_black;
        const float ahead = cut_out ? posed_scene_.transmittance_at(hit.address, ray.direction).x : 0.0f;
        if (ahead == 1.0f) {
            if (!(core::luminance(passing) > least_passing) || ++holes > most_holes) break;
            ray.origin = posed_scene_.origin_behind(hit.address, ray.direction);
            continue;
        }
        const auto at = static_cast<std::uint64_t>(step);
        const CellQuery place = cell_query(ray, hit, distance, rules, numbers.at(at));
        const bool metal = rules.is_lobe && metal_[material];
        if ((plain_[material] || cut_out) && ahead == 0.0f && !mirrored && !shines && !is_black && !metal) {
            chosen.offer(passing, place);
            break;
        }
        // Look at what passes or mirrors.
        const SurfacePoint p = posed_scene_.surface_at(hit.address, -ray.direction);
        // Lamps in mirrors would be found by one ray in thousands.
        if (shines && !mirrored) known += shining(passing, p, distance, rules, behind_body);
        if (is_black) break;
        if (asked == nullptr && sky_in_panes_ > 0.0f && !behind_body && !mirrored)
            known += passing * sky_in_pane(p, rules.solid_angle, rays);
        const glm::vec3 shown = passing * p.alpha;
        if (rules.is_lobe && p.unlit) known += shown * p.emission;
        if (scatters(p)) chosen.offer(shown, metal ? polished(place, p, rules, numbers.at(at)) : place);
        behind_body = behind_body || (rules.bodies_block && bends_light(posed_scene_, p));
        if (!go_on(posed_scene_, p, numbers.uniform(1, at), ray.direction, passing, mirrored)) break;
        ray.origin = offset_origin(p, ray.direction);
    }
    if (bounces_ && rules.bounces) chosen.put(terms);
    return known;
}

}  // namespace render2mpeg::renderer
