#include "tests/reference/lamps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "image/image.h"

namespace render2mpeg::reference {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double endless = std::numeric_limits<double>::infinity();

double sum_of(glm::dvec3 v) {
    return v.x + v.y + v.z;
}

/// A direction within the cone about an axis, uniform by solid angle.
glm::dvec3 within_cone(glm::dvec3 axis, double cos_angle, double u1, double u2) {
    const glm::dvec3 other = std::abs(axis.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 t = glm::normalize(glm::cross(other, axis)), b = glm::cross(axis, t);
    const double cosine = 1 - u1 * (1 - cos_angle), sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const double phi = 2 * pi * u2;
    return glm::normalize(sine * std::cos(phi) * t + sine * std::sin(phi) * b + cosine * axis);
}

/// A direction about an axis, with density cos / pi.
glm::dvec3 by_cosine(glm::dvec3 axis, double u1, double u2) {
    return within_cone(axis, 0, 1 - std::sqrt(1 - u1), u2);
}

bool has_size(const scene::LightState& light) {
    return light.kind == scene::LightKind::directional && light.angle > 0;
}

/// Of a sun whose disc spans twice this angle, so that its irradiance across the beam is `intensity`.
glm::dvec3 radiance_of(const scene::LightState& sun) {
    const double sine = std::sin(static_cast<double>(sun.angle));
    return glm::dvec3(sun.intensity) / (pi * sine * sine);
}

/// The sky image's pixel of a direction: -z in the middle, +x at three quarters, turned about +y.
glm::dvec2 sky_place(glm::dvec3 d, double rotation) {
    const double c = std::cos(rotation), s = std::sin(rotation);
    const double x = c * d.x - s * d.z, z = s * d.x + c * d.z;
    return {0.5 + std::atan2(x, -z) / (2 * pi), std::acos(std::clamp(d.y, -1.0, 1.0)) / pi};
}

glm::dvec3 sky_direction(glm::dvec2 place, double rotation) {
    const double phi = (place.x - 0.5) * 2 * pi, theta = place.y * pi;
    const double x = std::sin(theta) * std::sin(phi), z = -std::sin(theta) * std::cos(phi);
    const double c = std::cos(rotation), s = std::sin(rotation);
    return {c * x + s * z, std::cos(theta), -s * x + c * z};
}

/// Of an image as wide as 2 pi and as high as pi.
double pixel_solid_angle(int row, int width, int height) {
    return 2 * pi / width * (std::cos(pi * row / height) - std::cos(pi * (row + 1) / height));
}

}  // namespace

Lamps::Lamps(const Surfaces& surfaces) : surfaces_(surfaces) {
    find_emitters();
    const scene::Animation& film = surfaces.posed_scene().animation();
    if (film.sky.image < 0 || !film.sky.shines()) return;
    const scene::ImageSource& source = film.images[static_cast<std::size_t>(film.sky.image)];
    sky_image_.emplace(image::read_image(source.path, source.bytes, source.name), true);
    measure_sky();
}

void Lamps::find_emitters() {
    const scene::Animation& film = surfaces_.posed_scene().animation();
    const scene::Snapshot& now = surfaces_.posed_scene().posed();
    double sum = 0;
    for (std::uint32_t o = 0; o < film.objects.size(); ++o) {
        const auto material = static_cast<std::size_t>(film.objects[o].material);
        const scene::Material& m = film.materials[material];
        if (m.unlit || !m.emits() || !now.objects[o].present) continue;
        const auto mesh = static_cast<std::size_t>(film.objects[o].mesh);
        for (std::uint32_t p = 0; p < film.meshes[mesh].triangles.size(); ++p) {
            const scene::Triangle t = scene::triangle_of(now, o, p);
            const double area =
                0.5 * glm::length(glm::cross(glm::dvec3(t.b) - glm::dvec3(t.a), glm::dvec3(t.c) - glm::dvec3(t.a)));
            sum += area * sum_of(glm::dvec3(m.emission)) * now.emission_factor[material];
            emitters_.push_back({o, p, area, sum});
        }
    }
    if (!(sum > 0)) emitters_.clear();
    for (Emitter& e : emitters_) e.upto /= sum;
}

/// Interpolation reaches into neighbours, so a pixel counts by the brightest of the nine about it.
void Lamps::measure_sky() {
    const int w = sky_image_->width(), h = sky_image_->height();
    double sum = 0;
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            double most = 0;
            for (int j = std::max(y - 1, 0); j <= std::min(y + 1, h - 1); ++j)
                for (int i = -1; i <= 1; ++i)
                    most = std::max(most, sum_of(glm::dvec3(sky_image_->texel((x + i + w) % w, j))));
            sum += most * pixel_solid_angle(y, w, h);
            sky_upto_.push_back(sum);
        }
    for (double& s : sky_upto_) s /= sum;
}

glm::dvec3 Lamps::sky(glm::dvec3 direction) const {
    const scene::Sky& sky = surfaces_.posed_scene().animation().sky;
    const glm::dvec3 color(sky.color);
    if (!sky_image_) return color;
    const glm::dvec2 place = sky_place(direction, sky.rotation);
    return color * glm::dvec3(sky_image_->at(place, core::Wrap::repeat, core::Wrap::clamp_to_edge, false, false));
}

glm::dvec3 Lamps::suns(glm::dvec3 direction) const {
    glm::dvec3 sum(0);
    for (const scene::LightState& light : surfaces_.posed_scene().posed().lights)
        if (has_size(light) &&
            glm::dot(direction, -glm::dvec3(light.direction)) > std::cos(static_cast<double>(light.angle)))
            sum += radiance_of(light);
    return sum;
}

/// [KHR_lights_punctual]
std::vector<Connection> Lamps::punctual(glm::dvec3 place) const {
    std::vector<Connection> connections;
    for (const scene::LightState& light : surfaces_.posed_scene().posed().lights) {
        if (has_size(light)) continue;
        Connection c{-glm::dvec3(light.direction), endless, glm::dvec3(light.intensity)};
        if (light.kind != scene::LightKind::directional) {
            const glm::dvec3 d = glm::dvec3(light.position) - place;
            c.distance = glm::length(d);
            c.to_light = d / c.distance;
            c.light /= c.distance * c.distance;
            if (light.range > 0) c.light *= std::clamp(1.0 - std::pow(c.distance / light.range, 4.0), 0.0, 1.0);
        }
        if (light.kind == scene::LightKind::spot) {
            const double cosine = glm::dot(-c.to_light, glm::dvec3(light.direction));
            const double scale = 1.0 / std::max(1e-3, static_cast<double>(light.cos_inner) - light.cos_outer);
            const double falloff = std::clamp((cosine - light.cos_outer) * scale, 0.0, 1.0);
            c.light *= falloff * falloff * (light.smooth_cosine ? cosine * (3.0 - 2.0 * falloff) : 1.0);
        }
        connections.push_back(c);
    }
    return connections;
}

std::vector<Connection> Lamps::extended(glm::dvec3 place, glm::dvec3 normal, Random& random) const {
    std::vector<Connection> connections;
    connect_surface(place, random, connections);
    connect_sky(normal, random, connections);
    for (const scene::LightState& light : surfaces_.posed_scene().posed().lights) {
        if (!has_size(light)) continue;
        const double cosine = std::cos(static_cast<double>(light.angle)), solid_angle = 2 * pi * (1 - cosine);
        const glm::dvec3 u = random.three();
        const glm::dvec3 to_light = within_cone(-glm::dvec3(light.direction), cosine, u.x, u.y);
        connections.push_back({to_light, endless, radiance_of(light) * solid_angle});
    }
    return connections;
}

/// A point of a triangle that is chosen by power, uniform on it.
void Lamps::connect_surface(glm::dvec3 place, Random& random, std::vector<Connection>& connections) const {
    if (emitters_.empty()) return;
    const glm::dvec3 u = random.three();
    const auto above = std::upper_bound(emitters_.begin(), emitters_.end(), u.x,
                                        [](double x, const Emitter& e) { return x < e.upto; });
    const auto i = static_cast<std::size_t>(std::min(above, emitters_.end() - 1) - emitters_.begin());
    const Emitter& e = emitters_[i];
    const double share = e.upto - (i > 0 ? emitters_[i - 1].upto : 0.0);
    const double root = std::sqrt(u.y);
    const core::SurfaceAddress address{e.object, e.primitive, static_cast<float>(root * (1 - u.z)),
                                       static_cast<float>(root * u.z)};
    const scene::Triangle t = scene::triangle_of(surfaces_.posed_scene().posed(), e.object, e.primitive);
    const double v = address.u, w = address.v;
    const glm::dvec3 d = (1 - v - w) * glm::dvec3(t.a) + v * glm::dvec3(t.b) + w * glm::dvec3(t.c) - place;
    const double distance = glm::length(d);
    if (!(distance > 0) || !(share > 0)) return;
    const Surface s = surfaces_.at(address, -d / distance);
    const double cosine = glm::dot(s.front, s.outgoing);
    const glm::dvec3 light = s.look.emission * (cosine * e.area / (distance * distance * share));
    connections.push_back({d / distance, distance, light});
}

/// A direction by the cosine to the normal, or of a pixel that is chosen by power, uniform within it.
void Lamps::connect_sky(glm::dvec3 normal, Random& random, std::vector<Connection>& connections) const {
    const scene::Sky& sky = surfaces_.posed_scene().animation().sky;
    if (!sky.shines()) return;
    const glm::dvec3 u = random.three();
    if (!sky_image_) {
        const glm::dvec3 to_light = by_cosine(normal, u.x, u.y);
        const double density = glm::dot(normal, to_light) / pi;
        if (density > 0) connections.push_back({to_light, endless, glm::dvec3(sky.color) / density});
        return;
    }
    const int w = sky_image_->width(), h = sky_image_->height();
    const auto above = std::upper_bound(sky_upto_.begin(), sky_upto_.end(), u.x);
    const auto i = static_cast<std::size_t>(std::min(above, sky_upto_.end() - 1) - sky_upto_.begin());
    const double share = sky_upto_[i] - (i > 0 ? sky_upto_[i - 1] : 0.0);
    const int x = static_cast<int>(i) % w, y = static_cast<int>(i) / w;
    const double top = std::cos(pi * y / h), bottom = std::cos(pi * (y + 1) / h);
    const glm::dvec2 place{(x + u.y) / w, std::acos(top + u.z * (bottom - top)) / pi};
    const glm::dvec3 direction = sky_direction(place, sky.rotation);
    if (share > 0)
        connections.push_back({direction, endless, this->sky(direction) * (pixel_solid_angle(y, w, h) / share)});
}

}  // namespace render2mpeg::reference
