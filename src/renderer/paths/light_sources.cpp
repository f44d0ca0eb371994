#include "renderer/paths/light_sources.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/light_point.h"

namespace render2mpeg::renderer {
namespace {

constexpr float unlimited = std::numeric_limits<float>::infinity();
constexpr float two_pi = 2.0f * std::numbers::pi_v<float>;

/// Cells of the sky that directions are chosen from: 0.7 degrees, since a sun of half a degree should fill one.
constexpr int sky_columns = 512, sky_rows = 256;

/// Shadow rays end so far before a surface, as a share of their length (docs/model/visibility.md).
constexpr float before_surface = 1.0f - 0x1p-18f;

/// Which of the rising sums a number in [0, 1) falls to.
std::size_t chosen(const std::vector<double>& sums, double number) {
    const auto found = std::upper_bound(sums.begin(), sums.end(), number * sums.back());
    return std::min(static_cast<std::size_t>(found - sums.begin()), sums.size() - 1);
}

double share_of(const std::vector<double>& sums, std::size_t i) {
    return core::divide_or(sums[i] - (i > 0 ? sums[i - 1] : 0.0), sums.back(), 0.0);
}

/// Falloff of a punctual light at a distance, towards `from_light` (unit). [KHR_lights_punctual]
float falloff(const scene::LightState& light, float distance, glm::vec3 from_light) {
    float share = core::divide_or(1.0f, distance * distance, 0.0f);
    if (light.range > 0.0f) share *= std::clamp(1.0f - std::pow(distance / light.range, 4.0f), 0.0f, 1.0f);
    return share * spot_share(light, from_light);
}

glm::vec3 sky_direction(float cos_polar, float azimuth) {
    const float sine = core::sqrt_or_zero(1.0f - cos_polar * cos_polar);
    return {sine * std::cos(azimuth), cos_polar, sine * std::sin(azimuth)};
}

float row_edge(int row) {
    return std::cos(std::numbers::pi_v<float> * static_cast<float>(row) / sky_rows);
}

float cell_angle(int row) {
    return (row_edge(row) - row_edge(row + 1)) * two_pi / sky_columns;
}

}  // namespace

LightSources::LightSources(const PosedScene& posed_scene, const Plan& plan) : posed_scene_(posed_scene) {
    emitter_of_.assign(posed_scene.animation().objects.size(), -1);
    if (plan.runs(Pass::punctual_lights)) find_lamps();
    if (plan.runs(Pass::emissive_lights)) find_surfaces();
    if (plan.runs(Pass::sky_light)) find_sky();
}

void LightSources::find_lamps() {
    std::vector<SourceExtent> extents;
    for (const scene::LightState& light : posed_scene_.posed().lights) {
        if (!core::is_finite(light.intensity) || !(core::luminance(light.intensity) > 0.0f)) continue;
        Lamp lamp;
        lamp.state = light;
        lamp.to_light = -light.direction;
        if (light.kind == scene::LightKind::directional && light.angle > 0.0f) {
            lamp.sine = std::sin(light.angle);
            lamp.cosine = std::cos(light.angle);
            lamp.cone = two_pi * lamp.sine * lamp.sine / (1.0f + lamp.cosine);  // 1 - cos without its cancellation
            lamp.radiance = light.intensity / (std::numbers::pi_v<float> * lamp.sine * lamp.sine);
        }
        if (lamp.sine > 0.0f) suns_.push_back(lamps_.size());
        const bool distant = light.kind == scene::LightKind::directional;
        extents.push_back({distant ? glm::vec3(0) : light.position, 0,
                           static_cast<double>(core::luminance(light.intensity)), distant});
        lamps_.push_back(lamp);
    }
    lamp_tree_ = SourceTree(std::move(extents));
}

void LightSources::find_surfaces() {
    const scene::Snapshot& now = posed_scene_.posed();
    const scene::Animation& film = posed_scene_.animation();
    std::vector<SourceExtent> extents;
    for (std::uint32_t o = 0; o < film.objects.size(); ++o) {
        const scene::Material& material = film.materials[static_cast<std::size_t>(film.objects[o].material)];
        if (!material.emits() || material.unlit || !now.objects[o].present) continue;
        const scene::Mesh& mesh = film.meshes[static_cast<std::size_t>(film.objects[o].mesh)];
        Emitter emitter;
        emitter.object = o;
        glm::vec3 low(unlimited), high(-unlimited);
        for (std::uint32_t p = 0; p < mesh.triangles.size(); ++p) {
            const scene::Triangle t = scene::triangle_of(now, o, p);
            const float area = 0.5f * glm::length(glm::cross(t.b - t.a, t.c - t.a));
            float shines =
                std::isfinite(area) && area > 0.0f ? core::luminance(posed_scene_.mean_emission(o, p)) : 0.0f;
            if (!std::isfinite(shines)) shines = 0.0f;
            if (shines > 0.0f) {
                emitter.power += static_cast<double>(area) * static_cast<double>(shines);
                low = glm::min(low, glm::min(t.a, glm::min(t.b, t.c)));
                high = glm::max(high, glm::max(t.a, glm::max(t.b, t.c)));
            }
            emitter.luminance.push_back(shines);
            emitter.sums.push_back(emitter.power);
        }
        if (!(emitter.power > 0.0)) continue;
        emitter.centre = 0.5f * (low + high);
        emitter.radius = 0.5f * glm::length(high - low);
        emitter_of_[o] = static_cast<int>(emitters_.size());
        extents.push_back({emitter.centre, emitter.radius, emitter.power});
        emitters_.push_back(std::move(emitter));
    }
    emitter_tree_ = SourceTree(std::move(extents));
}

void LightSources::find_sky() {
    const image::SkyMap* sky = posed_scene_.sky();
    if (sky == nullptr || sky->uniform()) return;
    double sum = 0;
    for (int row = 0; row < sky_rows; ++row) {
        const float angle = cell_angle(row), cosine = 0.5f * (row_edge(row) + row_edge(row + 1));
        for (int column = 0; column < sky_columns; ++column) {
            const float azimuth = two_pi * (static_cast<float>(column) + 0.5f) / sky_columns;
            sum += static_cast<double>(angle * core::luminance(sky->radiance(sky_direction(cosine, azimuth), angle)));
            sky_.push_back(sum);
        }
    }
    if (!(sum > 0.0)) sky_.clear();
}

/// Irradiance if nothing is in the way and the surface faces it; 0 where it is behind.
float LightSources::lamp_weight(const LightQuery& query, const Lamp& lamp) const {
    const float strength = core::luminance(lamp.state.intensity);
    if (lamp.state.kind == scene::LightKind::directional)
        return query.may_see(lamp.to_light, lamp.sine) ? strength : 0.0f;
    const glm::vec3 d = lamp.state.position - query.position;
    const float distance = glm::length(d);
    if (!query.may_see(d)) return 0.0f;
    return strength * falloff(lamp.state, distance, -d / distance);
}

float LightSources::lamp_density(const LightQuery& query, std::size_t index) const {
    const double chance =
        lamp_tree_.chance_of(query, index, [&](std::size_t i) { return lamp_weight(query, lamps_[i]); });
    return core::divide_or(static_cast<float>(chance), lamps_[index].cone, 0.0f);
}

LightSample LightSources::to_lamp(const LightQuery& query, float choice, glm::vec2 u) const {
    const SourceTree::Choice lamp =
        lamp_tree_.choose(query, choice, [&](std::size_t i) { return lamp_weight(query, lamps_[i]); });
    if (!(lamp.chance > 0.0)) return {};
    return lamp_sample(query, lamps_[lamp.source], static_cast<float>(lamp.chance), u);
}

LightSample LightSources::lamp_sample(const LightQuery& query, const Lamp& lamp, float chance, glm::vec2 u) const {
    LightSample sample;
    sample.light = lamp.state.intensity / chance;
    if (lamp.state.kind != scene::LightKind::directional) {
        const glm::vec3 d = lamp.state.position - query.position;
        const float distance = glm::length(d);
        sample.direction = core::normalize_or(d, query.normal);
        sample.light *= falloff(lamp.state, distance, -sample.direction);
        const glm::vec3 way = lamp.state.position - query.origin;
        sample.far = glm::length(way);
        sample.ray = core::normalize_or(way, query.normal);
        return sample;
    }
    sample.direction = lamp.to_light;
    sample.far = unlimited;
    if (lamp.sine > 0.0f) {
        // Evenly by solid angle.
        const float down = u.x * lamp.cone / two_pi, sine = core::sqrt_or_zero(down * (2.0f - down));
        const float phi = two_pi * u.y;
        glm::vec3 t, b;
        core::make_frame(lamp.to_light, t, b);
        sample.direction = core::normalize_or(
            (1.0f - down) * lamp.to_light + sine * (std::cos(phi) * t + std::sin(phi) * b), lamp.to_light);
        sample.density = chance / lamp.cone;
        sample.light = lamp.radiance / sample.density;
    }
    sample.ray = sample.direction;
    return sample;
}

/// About its irradiance, if it faced the surface and was seen.
double LightSources::emitter_weight(const LightQuery& query, const Emitter& emitter) {
    const glm::vec3 d = emitter.centre - query.position;
    // Wholly behind.
    if (!query.may_see(d, 1.001f * emitter.radius)) return 0.0;
    return emitter.power / std::max(static_cast<double>(glm::dot(d, d)),
                                    static_cast<double>(emitter.radius) * static_cast<double>(emitter.radius));
}

double LightSources::emitter_chance(const LightQuery& query, std::size_t index) const {
    return emitter_tree_.chance_of(query, index, [&](std::size_t i) { return emitter_weight(query, emitters_[i]); });
}

LightSample LightSources::to_surface(const LightQuery& query, float choice, glm::vec2 u) const {
    // Choose a surface, then, with what is left of the number, a triangle.
    const SourceTree::Choice surface =
        emitter_tree_.choose(query, choice, [&](std::size_t i) { return emitter_weight(query, emitters_[i]); });
    if (!(surface.chance > 0.0)) return {};
    const Emitter& emitter = emitters_[surface.source];
    const std::size_t triangle = chosen(emitter.sums, surface.left);
    const glm::vec2 place = core::sample_triangle(u);
    const core::SurfaceAddress address{emitter.object, static_cast<std::uint32_t>(triangle), place.x, place.y};
    const scene::Triangle t = scene::triangle_of(posed_scene_.posed(), address.object, address.primitive);
    const glm::vec3 at = (1.0f - place.x - place.y) * t.a + place.x * t.b + place.y * t.c;

    LightSample sample;
    sample.direction = core::normalize_or(at - query.position, query.normal);
    if (!query.may_see(sample.direction)) return {};
    sample.density = surface_density(query, address);
    if (!(sample.density > 0.0f) || !std::isfinite(sample.density)) return {};
    const SurfacePoint point = posed_scene_.surface_at(address, -sample.direction);
    sample.light = point.unlit ? glm::vec3(0) : point.emission / sample.density;
    const glm::vec3 way = offset_origin(point, -sample.direction) - query.origin;
    sample.far = before_surface * glm::length(way);
    sample.ray = core::normalize_or(way, sample.direction);
    return sample;
}

float LightSources::surface_density(const LightQuery& query, const core::SurfaceAddress& address) const {
    const int index = emitter_of_[address.object];
    if (index < 0) return 0.0f;
    const Emitter& emitter = emitters_[static_cast<std::size_t>(index)];
    const double shines = static_cast<double>(emitter.luminance[address.primitive]);
    if (!(shines > 0.0)) return 0.0f;
    const scene::Triangle t = scene::triangle_of(posed_scene_.posed(), address.object, address.primitive);
    const glm::vec3 at = (1.0f - address.u - address.v) * t.a + address.u * t.b + address.v * t.c;
    const glm::dvec3 d(at - query.position), normal(glm::cross(t.b - t.a, t.c - t.a));
    const double distance2 = glm::dot(d, d), length = std::sqrt(distance2);
    const double cosine = core::divide_or(std::abs(glm::dot(d, normal)), length * glm::length(normal), 0.0);
    const double by_area = emitter_chance(query, static_cast<std::size_t>(index)) * shines / emitter.power;
    return static_cast<float>(core::divide_or(by_area * distance2, cosine, 0.0));
}

LightSample LightSources::to_sky(const LightQuery& query, float choice, glm::vec2 u) const {
    if (sky_.empty()) return {};
    const std::size_t cell = chosen(sky_, static_cast<double>(choice));
    const int row = static_cast<int>(cell) / sky_columns, column = static_cast<int>(cell) % sky_columns;
    LightSample sample;
    const float cosine = row_edge(row) + u.x * (row_edge(row + 1) - row_edge(row));
    sample.direction = sample.ray = sky_direction(cosine, two_pi * (static_cast<float>(column) + u.y) / sky_columns);
    if (!query.may_see(sample.direction)) return {};
    sample.far = unlimited;
    sample.density = static_cast<float>(share_of(sky_, cell)) / cell_angle(row);
    if (!(sample.density > 0.0f)) return {};
    sample.light = posed_scene_.sky()->radiance_of_ray(sample.direction, 0.0f) / sample.density;
    return sample;
}

float LightSources::sky_density(glm::vec3 direction) const {
    if (sky_.empty()) return 0.0f;
    const float polar = core::acos_clamped(direction.y) / std::numbers::pi_v<float>;
    float turn = std::atan2(direction.z, direction.x) / two_pi;
    if (turn < 0.0f) turn += 1.0f;
    const int row = std::clamp(static_cast<int>(polar * sky_rows), 0, sky_rows - 1);
    const int column = std::clamp(static_cast<int>(turn * sky_columns), 0, sky_columns - 1);
    const auto cell = static_cast<std::size_t>(row) * sky_columns + static_cast<std::size_t>(column);
    return static_cast<float>(share_of(sky_, cell)) / cell_angle(row);
}

}  // namespace render2mpeg::renderer
