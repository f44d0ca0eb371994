#include "renderer/caustics/casters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

#include "core/box.h"
#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/lights/light_points.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::renderer {
namespace {

/// Least reflectance at normal incidence for which caustics are seen. chosen: water's.
constexpr float least_reflectance = 0.02f;

/// Share of photons that all beams have alike. [Hesterberg1995] chosen: 0.1, as photons.
constexpr double even_share = 0.1;

/// Lamps with beams of their own; all others are one lamp. chosen: 16; not tuned.
constexpr std::size_t most_lamps = 16;

/// How far light of a sky's part spreads before it meets a thing, over half of the thing's diagonal. chosen: 2 of 1
/// to 3: at 1 light beside a ball of glass is mottled; at 3 a ball in a glass shell of twice its size lacks 9 % of its
/// light, at 2 5 %.
constexpr float sky_spread = 2.0f;

/// Halton dimensions of the place in the beam, and of that on the lamp; two each.
constexpr int place_dimension = 0, lamp_dimension = 2;

/// Semi-axis of a kernel in cells. fit: docs/measurements.md#caustics
float smoothness(float photons) {
    return std::clamp(2.8f * std::pow(1e-4f * photons, 0.25f), 2.0f, 8.0f);
}

/// Share of light that a material throws on, about; 0: it throws none.
float throws(const scene::Material& m, scene::Body body) {
    if (m.unlit) return 0.0f;
    if (body == scene::Body::solid) return m.transmission;
    const float share = scene::mirrored_share(m);
    return share >= least_reflectance ? share : 0.0f;
}

/// When a photon flies while the shutter is open: Kronecker's sequence beside Halton's, which choose its way.
float time_of(std::uint64_t number) {
    // chosen: [Roberts2018]'s third of three dimensions, the least error of twelve sequences
    // (docs/measurements.md#caustics).
    const double at = 0.5497004779019703 * static_cast<double>(number % (1u << 20));
    return static_cast<float>(at - std::floor(at));
}

/// Corners of the box about a mesh as it is posed. `posed`: a snapshot, or a knot of its sweep.
std::array<glm::vec3, 8> corners_of(const scene::Animation& film, const auto& posed, std::uint32_t object) {
    const scene::ObjectState& state = posed.objects[object];
    const bool deformed = state.deformed >= 0;
    const std::vector<glm::vec3>& positions =
        deformed ? posed.deformed[static_cast<std::size_t>(state.deformed)].positions
                 : film.meshes[static_cast<std::size_t>(film.objects[object].mesh)].positions;
    core::Box box;
    for (const glm::vec3& p : positions)
        if (core::is_finite(p)) box.hold(p);
    std::array<glm::vec3, 8> corners;
    for (std::size_t c = 0; c < 8; ++c) {
        const glm::vec3 p = box.corner(static_cast<int>(c));
        corners[c] = deformed ? p : glm::vec3(state.to_world * glm::vec4(p, 1));
    }
    return corners;
}

}  // namespace

Casters::Casters(const PosedScene& posed_scene, std::span<const LightPoint> lights, float sky_of_rays) {
    const scene::Snapshot& now = posed_scene.posed();
    const scene::Animation& film = posed_scene.animation();
    core::Box box{film.bounds_min, film.bounds_max};
    for (std::uint32_t i = 0; i < film.objects.size(); ++i) {
        const scene::Object& object = film.objects[i];
        const float weight = throws(film.materials[static_cast<std::size_t>(object.material)],
                                    posed_scene.has_bodies() ? object.body : scene::Body::none);
        if (!(weight > 0.0f) || !now.objects[i].present) continue;
        Thing& thing = things_.emplace_back(Thing{i, weight, posed_scene.passes_straight(i), corners_of(film, now, i)});
        if (now.sweep && now.sweep->object_moves(i))
            for (const scene::SweepKnot& knot : now.sweep->knots) thing.knots.push_back(corners_of(film, knot, i));
        for (const glm::vec3& corner : thing.corners) box.hold(corner);
    }
    if (things_.empty()) return;
    sweeps_ = now.sweep && !now.sweep->knots.empty();
    reach_ = 2.0f * glm::length(box.size());

    add_lamps(posed_scene, lights, sky_of_rays);
    double all = 0;
    for (std::uint32_t l = 0; l < lamps_.size(); ++l)
        for (std::uint32_t t = 0; t < things_.size(); ++t) {
            if (things_[t].pane ? lamps_[l].sky : lamps_[l].sky_of_panes) continue;
            const double light = caustic_flux(lamps_[l], things_[t]);
            if (light > 0.0) beams_.push_back({l, t, light, 0});
            all += light;
        }
    for (Beam& beam : beams_)
        beam.share = (1.0 - even_share) * beam.light / all + even_share / static_cast<double>(beams_.size());
}

/// Surfaces by object and punctual lights one by one, but the weakest together; and the sky.
void Casters::add_lamps(const PosedScene& posed_scene, std::span<const LightPoint> lights, float sky_of_rays) {
    std::vector<LightPoint> sky;
    std::set<std::uint32_t> shining;
    for (const LightPoint& light : lights) {
        if (!(core::luminance(light.intensity) > 0.0f)) continue;
        if (light.is_of_sky())
            sky.push_back(light);
        else if (light.is_of_surface())
            shining.insert(light.object);
        else
            lamps_.emplace_back().points.push_back(light);
    }
    for (const std::uint32_t object : shining) lamps_.emplace_back().surfaces.emplace_back(posed_scene, object);
    const auto light_of = [](const Lamp& lamp) {
        return lamp.points.empty() ? lamp.surfaces.front().power()
                                   : static_cast<double>(core::luminance(lamp.points.front().intensity));
    };
    if (lamps_.size() > most_lamps) {
        std::stable_sort(lamps_.begin(), lamps_.end(),
                         [&](const Lamp& a, const Lamp& b) { return light_of(a) > light_of(b); });
        Lamp& rest = lamps_[most_lamps - 1];
        for (std::size_t i = most_lamps; i < lamps_.size(); ++i) {
            rest.points.insert(rest.points.end(), lamps_[i].points.begin(), lamps_[i].points.end());
            rest.surfaces.insert(rest.surfaces.end(), lamps_[i].surfaces.begin(), lamps_[i].surfaces.end());
        }
        lamps_.resize(most_lamps);
    }
    lamps_.push_back({.points = beyond_rays(sky, sky_of_rays), .sky_of_panes = true});
    lamps_.push_back({.points = std::move(sky), .sky = true});
    for (Lamp& lamp : lamps_) {
        for (const LightPoint& p : lamp.points) lamp.choice.add(static_cast<double>(core::luminance(p.intensity)));
        for (const ShiningSurface& s : lamp.surfaces) lamp.choice.add(s.power());
    }
    std::erase_if(lamps_, [](const Lamp& lamp) { return !(lamp.choice.total() > 0.0); });
}

Casters::Origin Casters::origin_of(const Lamp& lamp, glm::vec2 u) {
    const auto number = static_cast<double>(u.x);
    const std::size_t i = lamp.choice.pick(number);
    Origin origin;
    origin.share = static_cast<float>(lamp.choice.chance(i));
    if (i < lamp.points.size()) {
        origin.light = lamp.points[i];
    } else {
        origin.surface = &lamp.surfaces[i - lamp.points.size()];
        origin.light = origin.surface->at({static_cast<float>(lamp.choice.within(i, number)), u.y});
    }
    origin.light.intensity *= core::divide_or(1.0f, origin.share, 0.0f);
    return origin;
}

/// Between two knots corners move straight, as all of the thing does.
Casters::Corners Casters::Thing::at(float time) const {
    if (knots.empty()) return corners;
    const scene::SweepPlace place(static_cast<int>(knots.size()) - 1, time);
    Corners moved;
    for (std::size_t c = 0; c < moved.size(); ++c)
        moved[c] = glm::mix(knots[place.knot][c], knots[place.knot + 1][c], place.share);
    return moved;
}

/// By a few of its places. chosen: 16, of which a closed lamp has some on each face.
double Casters::caustic_flux(const Lamp& lamp, const Thing& thing) {
    constexpr std::uint64_t probes = 16;
    double light = 0;
    for (std::uint64_t k = 0; k < probes; ++k) {
        const LightPoint p = origin_of(lamp, {(static_cast<float>(k) + 0.5f) / probes, core::halton(0, k + 1)}).light;
        const SeenBox seen = seen_from(p, thing.corners);
        const bool far = p.is_far();
        const glm::vec3 way = seen.middle - p.position;
        const float distance2 = far ? 1.0f : std::max(glm::dot(way, way), 1e-30f);
        const float beam = p.emitted(seen.towards, distance2) * seen.area() / distance2;
        light += static_cast<double>(core::luminance(p.intensity) *
                                     (seen.all_around ? 4.0f * std::numbers::pi_v<float> : beam));
    }
    return light / static_cast<double>(probes) * static_cast<double>(thing.weight);
}

const Casters::Beam& Casters::beam_of(std::uint64_t index, std::uint64_t count, std::uint64_t& first,
                                      std::uint64_t& end) const {
    first = end = 0;
    double sum = 0;
    for (const Beam& beam : beams_) {
        sum += beam.share;
        first = end;
        end = &beam == &beams_.back() ? count : static_cast<std::uint64_t>(sum * static_cast<double>(count));
        if (index < end) return beam;
    }
    return beams_.back();
}

/// Lets a photon leave for a place of the rectangle; returns the share of the light's intensity that all of them carry.
float Casters::leave(const LightPoint& light, const SeenBox& seen, glm::vec2 u, AimedPhoton& photon) const {
    const bool far = light.is_far();
    photon.origin = light.position;
    if (seen.all_around) {
        constexpr float whole = 4.0f * std::numbers::pi_v<float>;
        photon.direction = core::sample_sphere(u);
        core::make_frame(photon.direction, photon.turn[0], photon.turn[1]);
        for (std::size_t k = 0; k < 2; ++k) photon.turn[k] *= std::sqrt(whole);
        return whole * light.emitted(photon.direction, 1.0f);
    }
    const glm::vec3 at = seen.at(u);
    // Cells as wide as high.
    const float side = std::sqrt(seen.area());
    if (far) {
        photon.direction = light.normal;
        photon.place[0] = side * seen.right;
        photon.place[1] = side * seen.up;
        photon.origin = at - reach_ * photon.direction;
        return seen.area();
    }
    const glm::vec3 way = at - light.position;
    const float distance = glm::length(way);
    photon.direction = core::normalize_or(way, seen.towards);
    const auto turn = [&](glm::vec3 edge) {
        return side / distance * (edge - glm::dot(edge, photon.direction) * photon.direction);
    };
    photon.turn[0] = turn(seen.right);
    photon.turn[1] = turn(seen.up);
    return seen.area() * glm::dot(photon.direction, seen.towards) / (distance * distance) *
           light.emitted(photon.direction, distance * distance);
}

/// Tells how neighbours of a photon differ, as one of so many of its beam: the kernel has the covariance of all of
/// them, over their number.
void Casters::spread(const Origin& origin, const SeenBox& seen, float photons, AimedPhoton& photon) const {
    const LightPoint& light = origin.light;
    const float kernel = smoothness(photons) / std::sqrt(photons);
    for (std::size_t k = 0; k < 2; ++k) {
        photon.place[k] *= kernel;
        photon.turn[k] *= kernel;
    }
    glm::vec3 right, up;
    core::make_frame(photon.direction, right, up);
    if (origin.surface != nullptr) {
        // Edges of an even square with the variances of the lamp's places, which send light to one place of the thing.
        const glm::mat3& c = origin.surface->covariance();
        const float scale = std::sqrt(12.0f) * kernel, a = std::sqrt(std::max(glm::dot(right, c * right), 0.0f));
        const float b = core::divide_or(glm::dot(right, c * up), a, 0.0f);
        photon.place[2] = scale * (a * right + b * up);
        photon.place[3] = scale * std::sqrt(std::max(glm::dot(up, c * up) - b * b, 0.0f)) * up;
        if (seen.all_around) return;
        const float distance = glm::dot(seen.middle - light.position, seen.towards) /
                               std::max(glm::dot(photon.direction, seen.towards), 1e-3f);
        for (std::size_t k = 2; k < 4; ++k) photon.turn[k] = -1.0f / distance * photon.place[k];
        return;
    }
    // A disc that shines evenly has a quarter of its radius squared as variance, the kernel a sixth. Flames lie side by
    // side; far ones turn.
    constexpr float of_disc = 1.5f;
    auto& disc = light.is_far() ? photon.turn : photon.place;
    disc[2] = std::sqrt(of_disc * light.disc2) * right;
    disc[3] = std::sqrt(of_disc * light.disc2) * up;
    if (!light.is_far()) return;
    // A sun's other light goes to the same place of the thing. That of skies, whose photons stand less evenly, is
    // spread wider: it would be mottled. It spreads over a length of the thing's size, wherever the rays begin.
    for (std::size_t k = 2; k < 4; ++k)
        photon.place[k] = -(reach_ - (light.is_of_sky() ? sky_spread * glm::length(seen.half) : 0.0f)) * photon.turn[k];
}

AimedPhoton Casters::aim(std::uint64_t index, std::uint64_t count) const {
    // Each beam has a run of photons.
    std::uint64_t first = 0, end = 0;
    const Beam& beam = beam_of(index, count, first, end);
    AimedPhoton photon;
    photon.number = index - first + 1;
    const auto number = [&](int dimension) { return core::halton(dimension, photon.number); };
    const auto photons = static_cast<float>(end - first);
    const Thing& thing = things_[beam.thing];
    photon.object = thing.object;
    if (sweeps_) photon.time = time_of(photon.number);
    const Origin origin = origin_of(lamps_[beam.lamp], {number(lamp_dimension), number(lamp_dimension + 1)});
    const SeenBox seen = seen_from(origin.light, thing.at(photon.time));
    const float share = leave(origin.light, seen, {number(place_dimension), number(place_dimension + 1)}, photon);
    photon.from_far = origin.light.is_far();
    spread(origin, seen, std::max(origin.surface != nullptr ? origin.share * photons : photons, 1.0f), photon);
    photon.flux = origin.light.intensity * (share / photons);
    return photon;
}

}  // namespace render2mpeg::renderer
