#include "tests/reference/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "parallel/loops.h"
#include "tests/reference/random.h"
#include "tests/reference/scattering.h"

namespace render2mpeg::reference {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr double no_end = std::numeric_limits<double>::infinity();

/// Roulette begins after so many surfaces, so that short paths have none of its noise.
constexpr int safe_surfaces = 4;

/// Shadow rays end this share before a lamp's surface.
constexpr double before_lamp = 1e-5;

double largest(glm::dvec3 v) {
    return std::max({v.x, v.y, v.z});
}

class Sum {
  public:
    void add(glm::dvec3 value) {
        sum_ += value;
        squares_ += value * value;
        count_ += 1;
    }
    Estimate estimate() const {
        Estimate e;
        e.mean = sum_ / count_;
        for (int k = 0; k < 3; ++k)
            e.error[k] = std::sqrt(std::max(0.0, squares_[k] / count_ - e.mean[k] * e.mean[k]) / count_);
        return e;
    }

  private:
    glm::dvec3 sum_{0}, squares_{0};
    double count_ = 0;
};

}  // namespace

/// One path, backwards from where light arrives.
class PathTracer::Path {
  public:
    Path(const PathTracer& tracer, const PathSettings& settings, std::uint64_t seed, std::uint64_t path)
        : t_(tracer), fog_(tracer.fog_), settings_(settings), random_(seed, path) {}

    /// Follows a ray through all that it meets.
    glm::dvec3 from_ray(glm::vec3 origin, glm::dvec3 direction) {
        origin_ = origin;
        direction_ = direction;
        return go_on();
    }

    /// Scatters at a surface first.
    glm::dvec3 from_surface(const Surface& surface) {
        const Scattering f = scattering_of(surface.look, glm::dot(surface.normal, surface.outgoing));
        return scatter(surface, f) ? go_on() : light_;
    }

  private:
    glm::dvec3 go_on() {
        for (int surfaces = 0;; ++surfaces) {
            const renderer::Hit hit = t_.posed_scene_.tracer().nearest(origin_, glm::vec3(direction_), infinity);
            if (fog_) pass_fog(hit.found() ? static_cast<double>(hit.distance) : no_end);
            if (!hit.found()) {
                meet_sky();
                return light_;
            }
            const Surface surface = t_.surfaces_.at(hit.address, -direction_);
            pass_bodies(surface, hit.distance);
            if (!meet(surface)) return light_;
            if (surfaces < safe_surfaces) continue;
            const double lasts = std::min(1.0, largest(throughput_));
            if (!(random_.one() < lasts)) return light_;
            throughput_ /= lasts;
        }
    }

    /// Light that fog scatters once on the eye's way, from lamps without a size; and what fog leaves of the rest.
    void pass_fog(double distance) {
        const glm::dvec3 from(origin_);
        if (scatterings_ == 0 && settings_.least_bounces == 0) {
            const double far = std::min(distance, fog_->endless());
            const double t = random_.one() * far;
            const glm::dvec3 place = from + t * direction_;
            for (const Connection& c : t_.lamps_.punctual(place)) {
                const double scattered = fog_->extinction(place) * fog_->left(from, direction_, t) *
                                         fog_->phase(glm::dot(-c.to_light, -direction_)) *
                                         fog_->left(place, c.to_light, c.distance);
                const glm::dvec3 light = throughput_ * fog_->albedo() * c.light * (far * scattered);
                if (largest(light) > 0) light_ += light * passing(glm::vec3(place), place, c);
            }
        }
        throughput_ *= fog_->left(from, direction_, distance);
    }

    /// Whether light that is met now, after the last scattering, counts.
    bool counts() const {
        if (connected_) return false;
        if (scatterings_ == 0) return settings_.least_bounces == 0;
        return is_within_bounces();
    }
    bool is_within_bounces() const {
        return scatterings_ - 1 >= settings_.least_bounces && scatterings_ - 1 <= settings_.bounces;
    }

    /// Whether the first surface that scatters is not to see lamps and the sky by mirrors and bodies.
    bool lacks_caustics() const { return scatterings_ == 1 && !settings_.caustics; }

    void meet_sky() {
        if (!counts()) return;
        light_ += throughput_ * t_.lamps_.sky(direction_);
        if (scatterings_ > 0) light_ += throughput_ * t_.lamps_.suns(direction_);
    }

    /// What a surface sends, and where the path goes on; false: nowhere.
    bool meet(const Surface& s) {
        // Alpha hides what is seen of a lamp, not what it shines.
        if (scatterings_ > 0 && !s.look.unlit && counts()) light_ += throughput_ * s.look.emission;
        if (s.look.coverage < 1 && !(random_.one() < s.look.coverage)) {
            origin_ = s.origin(direction_);
            return true;
        }
        if (s.look.unlit) {
            if (scatterings_ == 0) light_ += throughput_ * s.look.emission;
            return false;
        }
        if (scatterings_ == 0 && counts()) light_ += throughput_ * s.look.emission;
        if (s.look.solid) return bend(s);

        // Choose what light did here: mirrored, passed or scattered.
        const double cosine = glm::dot(s.normal, s.outgoing);
        const Scattering f = scattering_of(s.look, cosine);
        const double mirrored = largest(f.mirror), passed = largest(f.transmission);
        const double scattered = f.has_lobe() ? 1.0 : largest(f.diffuse), all = mirrored + passed + scattered;
        if (!(all > 0)) return false;
        const double u = random_.one() * all;
        if (u < mirrored) {
            throughput_ *= f.mirror * (all / mirrored);
            direction_ = glm::normalize(2 * cosine * s.normal - s.outgoing);
            origin_ = s.origin(direction_);
            connected_ = lacks_caustics();
            return glm::dot(direction_, s.front) > 0;
        }
        if (u < mirrored + passed) {
            throughput_ *= f.transmission * (all / passed);
            origin_ = s.origin(direction_);
            return true;
        }
        throughput_ *= all / scattered;
        return scatter(s, f);
    }

    /// A body of glass that the path is in.
    struct Inside {
        std::uint32_t object;
        double index;
        glm::dvec3 absorption;
    };
    double index_now() const { return inside_.empty() ? 1.0 : inside_.back().index; }

    /// What bodies take on the way to a surface; one whose back is met first was there from the beginning.
    void pass_bodies(const Surface& s, double distance) {
        const auto own = [&](const Inside& i) { return i.object == s.object; };
        if (s.look.solid && s.from_behind && std::none_of(inside_.begin(), inside_.end(), own))
            inside_.push_back({s.object, s.look.ior, s.look.absorption});
        if (!inside_.empty()) throughput_ *= glm::exp(-distance * inside_.back().absorption);
    }

    /// At a boundary of glass, chooses by Fresnel's equations whether light was mirrored or bent.
    bool bend(const Surface& s) {
        std::vector<Inside> beyond = inside_;
        if (s.from_behind)
            std::erase_if(beyond, [&](const Inside& i) { return i.object == s.object; });
        else
            beyond.push_back({s.object, s.look.ior, s.look.absorption});
        const double n1 = index_now(), n2 = beyond.empty() ? 1.0 : beyond.back().index, eta = n1 / n2;
        const double c1 = glm::dot(s.normal, s.outgoing), sine2 = eta * eta * (1 - c1 * c1);
        const double c2 = std::sqrt(std::max(0.0, 1 - sine2));
        const double rs = (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2), rp = (n2 * c1 - n1 * c2) / (n2 * c1 + n1 * c2);
        const double reflected = sine2 >= 1 ? 1.0 : 0.5 * (rs * rs + rp * rp);
        connected_ = lacks_caustics();
        if (random_.one() < reflected) {
            direction_ = glm::normalize(2 * c1 * s.normal - s.outgoing);
            origin_ = s.origin(direction_);
            return glm::dot(direction_, s.front) > 0;
        }
        throughput_ *= s.look.base;
        direction_ = glm::normalize(eta * direction_ + (eta * c1 - c2) * s.normal);
        origin_ = s.origin(direction_);
        inside_ = std::move(beyond);
        return glm::dot(direction_, s.front) < 0;
    }

    bool scatter(const Surface& s, const Scattering& f) {
        ++scatterings_;
        if (scatterings_ - 1 > settings_.bounces) return false;
        if (is_within_bounces()) {
            connect(s, f, t_.lamps_.punctual(s.position));
            if (settings_.finding == Finding::by_connection)
                connect(s, f, t_.lamps_.extended(s.position, s.normal, random_));
        }
        connected_ = settings_.finding == Finding::by_connection;
        direction_ = f.sample(s.normal, s.outgoing, random_.three());
        if (!(glm::dot(direction_, s.front) > 0) || !(glm::dot(direction_, s.normal) > 0)) return false;
        throughput_ *= f.times_cosine(s.normal, s.outgoing, direction_) / f.density(s.normal, s.outgoing, direction_);
        origin_ = s.origin(direction_);
        return largest(throughput_) > 0;
    }

    void connect(const Surface& s, const Scattering& f, const std::vector<Connection>& connections) {
        for (const Connection& c : connections) {
            if (!(glm::dot(c.to_light, s.front) > 0)) continue;
            const glm::dvec3 weight = throughput_ * f.times_cosine(s.normal, s.outgoing, c.to_light) * c.light;
            if (!(largest(weight) > 0)) continue;
            const double left = fog_ ? fog_->left(s.position, c.to_light, c.distance) : 1.0;
            light_ += left * weight * passing(s.origin(c.to_light), s.position, c);
        }
    }

    /// Share of light that passes layers and glass on a straight way.
    glm::dvec3 passing(glm::vec3 origin, glm::dvec3 position, const Connection& c) const {
        glm::dvec3 share(1), direction = c.to_light;
        double left = c.distance;
        if (std::isfinite(c.distance)) {
            // From where the ray begins: else it would meet a lamp seen from the side before its end.
            const glm::dvec3 d = position + c.distance * c.to_light - glm::dvec3(origin);
            left = glm::length(d) * (1 - before_lamp);
            direction = glm::normalize(d);
        }
        while (largest(share) > 0) {
            const renderer::Hit hit =
                t_.posed_scene_.tracer().nearest(origin, glm::vec3(direction), static_cast<float>(left));
            if (!hit.found()) return share;
            const Surface s = t_.surfaces_.at(hit.address, -direction);
            const Scattering f = scattering_of(s.look, glm::dot(s.normal, s.outgoing));
            // By chance alone light comes through bodies.
            if (s.look.solid && settings_.caustics) return glm::dvec3(0);
            share *= 1 - s.look.coverage + s.look.coverage * f.transmission;
            origin = s.origin(direction);
            left -= hit.distance;
        }
        return glm::dvec3(0);
    }

    const PathTracer& t_;
    const std::optional<Fog>& fog_;
    const PathSettings& settings_;
    Random random_;
    glm::vec3 origin_{0};
    glm::dvec3 direction_{0}, light_{0}, throughput_{1};
    std::vector<Inside> inside_;
    int scatterings_ = 0;
    bool connected_ = false;  ///< lamps that are met next have been connected to
};

PathTracer::PathTracer(const renderer::PosedScene& posed_scene)
    : posed_scene_(posed_scene), surfaces_(posed_scene), lamps_(surfaces_) {
    if (posed_scene.animation().fog.shows()) fog_.emplace(posed_scene.animation());
}

Estimate PathTracer::radiance(glm::vec3 origin, glm::vec3 direction, const PathSettings& settings, std::uint64_t paths,
                              std::uint64_t seed) const {
    Sum sum;
    for (std::uint64_t i = 0; i < paths; ++i)
        sum.add(Path(*this, settings, seed, i).from_ray(origin, glm::normalize(glm::dvec3(direction))));
    return sum.estimate();
}

Estimate PathTracer::scattered(const core::SurfaceAddress& address, glm::vec3 outgoing, const PathSettings& settings,
                               std::uint64_t paths, std::uint64_t seed) const {
    const Surface surface = surfaces_.at(address, glm::normalize(glm::dvec3(outgoing)));
    Sum sum;
    for (std::uint64_t i = 0; i < paths; ++i) sum.add(Path(*this, settings, seed, i).from_surface(surface));
    return sum.estimate();
}

std::vector<Estimate> PathTracer::picture(int width, int height, const PathSettings& settings,
                                          std::uint64_t paths_per_pixel, std::uint64_t seed) const {
    std::vector<Estimate> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const scene::Camera& camera = posed_scene_.posed().camera;
    parallel::for_each(pixels.size(), [&](std::size_t i) {
        const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
        const scene::Ray ray = camera.ray_through({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
        pixels[i] = radiance(ray.origin, ray.direction, settings, paths_per_pixel, core::mix(seed) + i);
    });
    return pixels;
}

Estimate scattered_light(const renderer::PosedScene& posed_scene, const renderer::SurfacePoint& point, int bounces,
                         std::uint64_t paths, std::uint64_t seed, int least_bounces) {
    PathSettings settings;
    settings.bounces = bounces;
    settings.least_bounces = least_bounces;
    return PathTracer(posed_scene).scattered(point.address, point.outgoing, settings, paths, seed);
}

}  // namespace render2mpeg::reference
