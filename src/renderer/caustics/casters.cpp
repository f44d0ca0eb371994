#include "renderer/caustics/casters.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>

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

/// Lamps with beams of their own; the light points of all others are one lamp. chosen: 16; not tuned.
constexpr std::size_t most_lamps = 16;

/// How far light of a sky's part spreads before it meets a thing, over half of the thing's diagonal. chosen: 2 of 1
/// to 3: at 1 light beside a ball of glass is mottled; at 3 a ball in a glass shell of twice its size lacks 9 % of its
/// light, at 2 5 %.
constexpr float sky_spread = 2.0f;

/// Halton dimensions of the place in the beam, and of the lamp's point.
constexpr int place_dimension = 0, point_dimension = 2;

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

/// All but the sky.
std::vector<std::vector<LightPoint>> points_by_lamp(std::span<const LightPoint> lights) {
    // Surfaces by object, punctual lights one by one.
    std::map<std::uint64_t, std::vector<LightPoint>> by_lamp;
    for (const LightPoint& light : lights) {
        if (!(core::luminance(light.intensity) > 0.0f) || light.is_of_sky()) continue;
        const std::uint64_t key = light.is_of_surface() ? light.object : (std::uint64_t{1} << 32) + light.id;
        by_lamp[key].push_back(light);
    }
    std::vector<std::vector<LightPoint>> lamps;
    for (auto& [key, points] : by_lamp) lamps.push_back(std::move(points));
    if (lamps.size() <= most_lamps) return lamps;
    // The weakest together.
    const auto light_of = [](const std::vector<LightPoint>& lamp) {
        double sum = 0;
        for (const LightPoint& p : lamp) sum += static_cast<double>(core::luminance(p.intensity));
        return sum;
    };
    std::stable_sort(lamps.begin(), lamps.end(),
                     [&](const auto& a, const auto& b) { return light_of(a) > light_of(b); });
    std::vector<LightPoint>& rest = lamps[most_lamps - 1];
    for (std::size_t i = most_lamps; i < lamps.size(); ++i) rest.insert(rest.end(), lamps[i].begin(), lamps[i].end());
    lamps.resize(most_lamps);
    return lamps;
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

    for (std::vector<LightPoint>& points : points_by_lamp(lights)) lamps_.emplace_back().points = std::move(points);
    std::vector<LightPoint> sky;
    std::copy_if(lights.begin(), lights.end(), std::back_inserter(sky),
                 [](const LightPoint& p) { return p.is_of_sky(); });
    std::erase_if(sky, [](const LightPoint& p) { return !(core::luminance(p.intensity) > 0.0f); });
    lamps_.push_back({.points = beyond_rays(sky, sky_of_rays), .sky_of_panes = true});
    lamps_.push_back({.points = std::move(sky), .sky = true});
    std::erase_if(lamps_, [](const Lamp& lamp) { return lamp.points.empty(); });
    for (Lamp& lamp : lamps_)
        for (const LightPoint& p : lamp.points) lamp.choice.add(static_cast<double>(core::luminance(p.intensity)));
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

/// Between two knots corners move straight, as all of the thing does.
Casters::Corners Casters::Thing::at(float time) const {
    if (knots.empty()) return corners;
    const scene::SweepPlace place(static_cast<int>(knots.size()) - 1, time);
    Corners moved;
    for (std::size_t c = 0; c < moved.size(); ++c)
        moved[c] = glm::mix(knots[place.knot][c], knots[place.knot + 1][c], place.share);
    return moved;
}

/// By a few of its points.
double Casters::caustic_flux(const Lamp& lamp, const Thing& thing) {
    constexpr int probes = 4;
    double light = 0;
    for (int k = 0; k < probes; ++k) {
        const LightPoint& p = lamp.points[lamp.choice.pick((k + 0.5) / probes)];
        const SeenBox seen = seen_from(p, thing.corners);
        const bool far = p.is_far();
        const glm::vec3 way = seen.middle - p.position;
        const float distance2 = far ? 1.0f : std::max(glm::dot(way, way), 1e-30f);
        const float beam = p.emitted(seen.towards, distance2) * seen.area() / distance2;
        light += static_cast<double>(seen.all_around ? 4.0f * std::numbers::pi_v<float> : beam);
    }
    return light * lamp.choice.total() / probes * static_cast<double>(thing.weight);
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

AimedPhoton Casters::aim(std::uint64_t index, std::uint64_t count) const {
    // Each beam has a run of photons.
    std::uint64_t first = 0, end = 0;
    const Beam& beam = beam_of(index, count, first, end);
    const Lamp& lamp = lamps_[beam.lamp];
    AimedPhoton photon;
    photon.number = index - first + 1;
    photon.of = end - first;
    const Thing& thing = things_[beam.thing];
    photon.object = thing.object;
    if (sweeps_) photon.time = time_of(photon.number);
    const glm::vec2 u(core::halton(place_dimension, photon.number), core::halton(place_dimension + 1, photon.number));
    const std::size_t l = lamp.choice.pick(static_cast<double>(core::halton(point_dimension, photon.number)));
    const LightPoint& light = lamp.points[l];
    const SeenBox seen = seen_from(light, thing.at(photon.time));
    const float share = leave(light, seen, u, photon);

    // Lamp points of surfaces lie side by side; far ones turn.
    const bool far = light.is_far();
    photon.from_far = far;
    auto& neighbours = far ? photon.turn : photon.place;
    core::make_frame(photon.direction, neighbours[2], neighbours[3]);
    // The cell is parted among the beam's photons.
    const float cell = 1.0f / std::sqrt(static_cast<float>(photon.of));
    for (std::size_t k = 0; k < 2; ++k) {
        neighbours[k + 2] *= std::sqrt(light.disc2);
        // A sun's other light goes to the same place of the thing. That of skies and panels, whose photons stand less
        // evenly, is spread wider: it would be mottled. A sky's spreads over a length of the thing's size, wherever
        // the rays begin.
        if (far)
            photon.place[k + 2] =
                -(reach_ - (light.is_of_sky() ? sky_spread * glm::length(seen.half) : 0.0f)) * photon.turn[k + 2];
        photon.place[k] *= cell;
        photon.turn[k] *= cell;
    }
    const double density = lamp.choice.chance(l) * static_cast<double>(photon.of);
    photon.flux = light.intensity * static_cast<float>(core::divide_or(static_cast<double>(share), density, 0.0));
    return photon;
}

}  // namespace render2mpeg::renderer
