// What shadows of bounced light cost on the lattice of a draft in a room where sixty balls fly about, and how many of
// them are wrong: by rays, by imperfect shadow maps [Ritschel2008, 5] and by occluding spheres. One
// thread. Everything is done anew for the frame: the pose of what rays meet, the maps' points, the spheres' centres.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <ctime>
#include <numbers>
#include <vector>

#include "core/isa.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/geometry/ray_tracer.h"
#include "scene/pose/snapshot.h"
#include "tests/bench/mover_scenes.h"

namespace render2mpeg::bench {
namespace {

constexpr int lattice_points = 14400;  // 640x360, one in 4x4
constexpr int vpls = 256, vpls_each = 16;
constexpr float clear = 0.01f;  // metres that a ray begins and ends off surfaces

struct Oriented {
    glm::vec3 position{0}, normal{0};
};

double cpu_now() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// On the walls of the room, by stratified numbers.
Oriented on_walls(std::uint64_t seed, std::uint64_t i) {
    const float u = core::uniform(seed, i, 0), v = core::uniform(seed, i, 1);
    switch (static_cast<int>(5 * core::uniform(seed, i, 2))) {
        case 0:
            return {{5 * u, 0, 5 * v}, {0, 1, 0}};
        case 1:
            return {{5 * u, 3, 5 * v}, {0, -1, 0}};
        case 2:
            return {{0, 3 * u, 5 * v}, {1, 0, 0}};
        case 3:
            return {{5, 3 * u, 5 * v}, {-1, 0, 0}};
        default:
            return {{5 * u, 3 * v, 0}, {0, 0, 1}};
    }
}

struct Task {
    std::vector<Oriented> receivers, lights;
    /// Light k of receiver i: sets are interleaved over neighbours.
    int light_of(int i, int k) const { return (i / 16 % (vpls / vpls_each)) * vpls_each + k; }
};

using Answers = std::vector<std::uint8_t>;  // by receiver and light: 1 occluded

Answers by_rays(const renderer::RayTracer& tracer, const Task& task) {
    Answers answers(std::size_t{lattice_points} * vpls_each);
    for (int i = 0; i < lattice_points; i += 16)
        for (int k = 0; k < vpls_each; ++k) {
            renderer::ShadowPacket packet;
            packet.active = 0xffff;
            const Oriented& light = task.lights[static_cast<std::size_t>(task.light_of(i, k))];
            for (int lane = 0; lane < 16; ++lane) {
                const Oriented& r = task.receivers[static_cast<std::size_t>(i + lane)];
                const glm::vec3 from = r.position + clear * r.normal, to = light.position + clear * light.normal - from;
                packet.origin_x[lane] = from.x, packet.origin_y[lane] = from.y, packet.origin_z[lane] = from.z;
                packet.direction_x[lane] = to.x, packet.direction_y[lane] = to.y, packet.direction_z[lane] = to.z;
                packet.far[lane] = 1.0f;
            }
            const std::uint32_t hidden = tracer.occluded(packet, nullptr);
            for (int lane = 0; lane < 16; ++lane)
                answers[static_cast<std::size_t>((i + lane) * vpls_each + k)] = (hidden >> lane & 1u) != 0;
        }
    return answers;
}

/// Paraboloid maps of distances, one for each light, made of few points and filled where they left holes.
class ImperfectMaps {
  public:
    explicit ImperfectMaps(int side) : side_(side) {}

    void draw(const std::vector<Oriented>& points, const std::vector<Oriented>& lights, int each) {
        maps_.assign(lights.size(), std::vector<float>(static_cast<std::size_t>(side_ * side_), far_away));
        for (std::size_t m = 0; m < lights.size(); ++m) {
            // Points are dealt out among the maps [Ritschel2008, 5.2].
            for (int n = 0; n < each; ++n) {
                const Oriented& p = points[(m + static_cast<std::size_t>(n) * lights.size()) % points.size()];
                splat(maps_[m], lights[m], p.position, 0.5f * area_ / static_cast<float>(each));
            }
            fill_holes(maps_[m]);
        }
    }
    bool hides(std::size_t map, const Oriented& light, glm::vec3 place) const {
        glm::vec2 at;
        float distance = 0;
        if (!project(light, place, at, distance)) return true;
        const int x = std::clamp(static_cast<int>(at.x), 0, side_ - 1),
                  y = std::clamp(static_cast<int>(at.y), 0, side_ - 1);
        return maps_[map][static_cast<std::size_t>(y * side_ + x)] < distance * (1 - bias) - bias;
    }
    /// Square metres that all points together stand for.
    void set_area(float area) { area_ = area; }

  private:
    static constexpr float far_away = 1e30f, bias = 0.04f;

    bool project(const Oriented& light, glm::vec3 place, glm::vec2& at, float& distance) const {
        const glm::vec3 to = place - light.position;
        distance = glm::length(to);
        const glm::vec3 d = to / std::max(distance, 1e-6f);
        const float z = glm::dot(d, light.normal);
        if (z <= 0) return false;
        const glm::vec3 tangent =
            glm::normalize(std::abs(light.normal.y) < 0.9f ? glm::cross(light.normal, glm::vec3(0, 1, 0))
                                                           : glm::cross(light.normal, glm::vec3(1, 0, 0)));
        const glm::vec3 bitangent = glm::cross(light.normal, tangent);
        at = (0.5f + 0.5f * glm::vec2(glm::dot(d, tangent), glm::dot(d, bitangent)) / (1 + z)) *
             static_cast<float>(side_);
        return true;
    }
    void splat(std::vector<float>& map, const Oriented& light, glm::vec3 place, float area) const {
        glm::vec2 at;
        float distance = 0;
        if (!project(light, place, at, distance)) return;
        const float width = std::clamp(std::sqrt(area) / distance * static_cast<float>(side_) / 4, 1.0f, 8.0f);
        for (int y = static_cast<int>(at.y - width / 2); y <= static_cast<int>(at.y + width / 2); ++y)
            for (int x = static_cast<int>(at.x - width / 2); x <= static_cast<int>(at.x + width / 2); ++x)
                if (x >= 0 && y >= 0 && x < side_ && y < side_) {
                    float& there = map[static_cast<std::size_t>(y * side_ + x)];
                    there = std::min(there, distance);
                }
    }
    /// One level of pull and push: a hole takes the mean of what lies in its block of four by four, if half of that is
    /// there.
    void fill_holes(std::vector<float>& map) const {
        for (int top = 0; top < side_; top += 4)
            for (int left = 0; left < side_; left += 4) {
                float sum = 0;
                int count = 0;
                for (int i = 0; i < 16; ++i) {
                    const float v = map[static_cast<std::size_t>((top + i / 4) * side_ + left + i % 4)];
                    if (v < far_away) sum += v, ++count;
                }
                if (count < 8) continue;
                for (int i = 0; i < 16; ++i) {
                    float& v = map[static_cast<std::size_t>((top + i / 4) * side_ + left + i % 4)];
                    if (v == far_away) v = sum / static_cast<float>(count);
                }
            }
    }

    int side_;
    float area_ = 1;
    std::vector<std::vector<float>> maps_;
};

Answers by_maps(const ImperfectMaps& maps, const Task& task) {
    Answers answers(std::size_t{lattice_points} * vpls_each);
    for (int i = 0; i < lattice_points; ++i)
        for (int k = 0; k < vpls_each; ++k) {
            const auto light = static_cast<std::size_t>(task.light_of(i, k));
            answers[static_cast<std::size_t>(i * vpls_each + k)] =
                maps.hides(light, task.lights[light], task.receivers[static_cast<std::size_t>(i)].position);
        }
    return answers;
}

struct Spheres {
    std::vector<float> x, y, z, r2;
    void add(glm::vec3 c, float r) { x.push_back(c.x), y.push_back(c.y), z.push_back(c.z), r2.push_back(r * r); }
};

/// Every sphere against sixteen rays at a time.
Answers by_spheres(const Spheres& spheres, const Task& task) {
    Answers answers(std::size_t{lattice_points} * vpls_each);
    for (int i = 0; i < lattice_points; i += 16)
        for (int k = 0; k < vpls_each; ++k) {
            alignas(64) float ox[16], oy[16], oz[16], dx[16], dy[16], dz[16], inverse[16];
            alignas(64) std::uint32_t hidden[16] = {};
            const glm::vec3 to = task.lights[static_cast<std::size_t>(task.light_of(i, k))].position;
            for (int lane = 0; lane < 16; ++lane) {
                const glm::vec3 from = task.receivers[static_cast<std::size_t>(i + lane)].position;
                ox[lane] = from.x, oy[lane] = from.y, oz[lane] = from.z;
                dx[lane] = to.x - from.x, dy[lane] = to.y - from.y, dz[lane] = to.z - from.z;
                inverse[lane] = 1 / (dx[lane] * dx[lane] + dy[lane] * dy[lane] + dz[lane] * dz[lane]);
            }
            for (std::size_t s = 0; s < spheres.x.size(); ++s)
                for (int lane = 0; lane < 16; ++lane) {
                    const float cx = spheres.x[s] - ox[lane], cy = spheres.y[s] - oy[lane],
                                cz = spheres.z[s] - oz[lane];
                    const float along = (cx * dx[lane] + cy * dy[lane] + cz * dz[lane]) * inverse[lane];
                    const float fx = cx - along * dx[lane], fy = cy - along * dy[lane], fz = cz - along * dz[lane];
                    const bool hit = (along > 0) & (along < 1) & (fx * fx + fy * fy + fz * fz < spheres.r2[s]);
                    hidden[lane] |= hit ? 1u : 0u;
                }
            for (int lane = 0; lane < 16; ++lane)
                answers[static_cast<std::size_t>((i + lane) * vpls_each + k)] = hidden[lane] != 0;
        }
    return answers;
}

void print_row(const char* name, double prepared, double asked, const Answers& answers, const Answers& truth) {
    std::size_t lost = 0, invented = 0, shadows = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        shadows += truth[i];
        lost += truth[i] > answers[i];
        invented += truth[i] < answers[i];
    }
    const auto share = [&](std::size_t n) {
        return 100.0 * static_cast<double>(n) / static_cast<double>(truth.size());
    };
    fmt::print("| {} | {:.1f} | {:.1f} | {:.1f} | {:.2f} | {:.2f} | {:.2f} |\n", name, 1e3 * prepared, 1e3 * asked,
               1e3 * (prepared + asked), share(shadows), share(lost), share(invented));
}

void compare_shadows() {
    const scene::Animation film = mover_scene("swarm").build();
    renderer::RayTracer tracer(film, core::detect_isa(), std::vector<bool>(film.materials.size(), false), {});
    const auto at = [&](std::int64_t frame) {
        return scene::snapshot_at(film, frame, core::time_of(frame, core::frame_rate_from("25")), {64, 64, 1.0f});
    };
    tracer.pose(at(0));
    const scene::Snapshot now = at(20);

    Task task;
    for (std::uint64_t i = 0; i < lattice_points; ++i) task.receivers.push_back(on_walls(1, i / 16 * 16 + 0));
    for (std::size_t i = 0; i < task.receivers.size(); ++i) {  // sixteen neighbours
        const glm::vec3 n = task.receivers[i].normal;
        const glm::vec3 step =
            0.02f * glm::vec3(core::uniform(3, i, 0), core::uniform(3, i, 1), core::uniform(3, i, 2));
        task.receivers[i].position += step - glm::dot(step, n) * n;
    }
    for (std::uint64_t i = 0; i < vpls; ++i) task.lights.push_back(on_walls(2, i));

    double start = cpu_now();
    tracer.pose(now);
    const double posed = cpu_now() - start;
    start = cpu_now();
    const Answers truth = by_rays(tracer, task);
    fmt::print(
        "| shadows by | prepare, CPU ms | ask | both | in shadow, % | lost | invented "
        "|\n|---|---|---|---|---|---|---|\n");
    print_row("rays", posed, cpu_now() - start, truth, truth);

    // Points on what hides light: walls of a room hide nothing in it, and would only take points.
    std::vector<Oriented> points;
    constexpr int most = 1 << 18;
    Spheres spheres;
    std::vector<glm::vec3> centres;
    for (std::size_t o = 0; o < now.objects.size(); ++o)
        if (film.objects[o].mobility != scene::Mobility::still)
            centres.push_back(glm::vec3(now.objects[o].to_world[3]));
    for (int each : {1000, 4000}) {
        for (const int side : {64, 128}) {
            start = cpu_now();
            points.clear();
            const int wanted = std::min(most, each * vpls);
            const float ball_area = 4 * std::numbers::pi_v<float> * 0.08f * 0.08f * static_cast<float>(centres.size());
            const float box_area = 5 * 1.5f;
            for (int i = 0; i < wanted; ++i) {
                const auto n = static_cast<std::uint64_t>(i);
                const float u = core::uniform(5, n, 0), v = core::uniform(5, n, 1), w = core::uniform(5, n, 2);
                if (w * (ball_area + box_area) < ball_area) {
                    const float z = 2 * u - 1, r = std::sqrt(1 - z * z), a = 2 * std::numbers::pi_v<float> * v;
                    points.push_back(
                        {centres[n % centres.size()] + 0.08f * glm::vec3(r * std::cos(a), r * std::sin(a), z), {}});
                } else {
                    const std::array<glm::vec3, 5> faces{glm::vec3{3 + u, 1.5f, 1 + v},
                                                         {3, 1.5f * u, 1 + v},
                                                         {4, 1.5f * u, 1 + v},
                                                         {3 + u, 1.5f * v, 1},
                                                         {3 + u, 1.5f * v, 2}};
                    points.push_back({faces[n % 5], {}});
                }
            }
            ImperfectMaps maps(side);
            maps.set_area(ball_area + box_area);
            maps.draw(points, task.lights, each);
            const double drawn = cpu_now() - start;
            start = cpu_now();
            const Answers answers = by_maps(maps, task);
            print_row(fmt::format("{} maps of {}x{}, {} points each", vpls, side, side, each).c_str(), drawn,
                      cpu_now() - start, answers, truth);
        }
    }

    start = cpu_now();
    for (const glm::vec3& c : centres) spheres.add(c, 0.08f);
    for (int i = 0; i < 12; ++i)  // the box of 1 x 1.5 x 1
        spheres.add({3.25f + 0.5f * static_cast<float>(i % 2), 0.25f + 0.5f * static_cast<float>(i / 4),
                     1.25f + 0.5f * static_cast<float>(i / 2 % 2)},
                    0.31f);
    const double placed = cpu_now() - start;
    start = cpu_now();
    const Answers answers = by_spheres(spheres, task);
    print_row(fmt::format("{} spheres, each against each ray", spheres.x.size()).c_str(), placed, cpu_now() - start,
              answers, truth);
}

}  // namespace
}  // namespace render2mpeg::bench

int main() {
    const render2mpeg::parallel::ThreadLimit one(1);
    render2mpeg::bench::compare_shadows();
    return 0;
}
