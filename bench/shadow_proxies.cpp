// What answers a draft's shadow rays fastest, and how wrongly, where everything moves: rays, spheres inside of things,
// imperfect shadow maps. bench_shadow_proxies SCENE|MOVERS [frame=0] [vpls=2048] [lights=128] [spheres=64,256]
// [splats=8000] [side=32]. Sixteen pixels of one tile of a draft's lattice ask for `lights` lights, drawn by their
// intensity, as cuts do. Prints CPU nanoseconds a ray of one thread, CPU milliseconds once a frame, rays that are
// answered otherwise than by tracing, and by how much the light of a place is wrong: its mean, and root mean square
// over the mean light.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "bench/imperfect_shadow_maps.h"
#include "bench/occluding_spheres.h"
#include "bench/subject.h"
#include "bench/wishes.h"
#include "core/color.h"
#include "core/error.h"
#include "core/sampling.h"
#include "renderer/base/stopwatch.h"
#include "renderer/lights/anchors.h"
#include "renderer/view/see.h"

namespace render2mpeg::bench {
namespace {

constexpr int width = 640, height = 360;

/// Sixteen rays towards one light, and what light each would bring.
struct Question {
    renderer::ShadowPacket packet;
    std::size_t light = 0, tile = 0;
    float worth[16] = {};
};

/// One tile's pixels of a lattice of one in 4x4, those on surfaces that the eye sees straight.
using Places = std::vector<const renderer::SurfacePoint*>;

std::vector<Places> lattice_of(const renderer::Seen& seen) {
    std::vector<Places> tiles;
    for (const renderer::GatherTile& tile : seen.tiles) {
        Places places;
        for (const renderer::GatherPoint& p : tile) {
            const int x = p.pixel % renderer::tile_size, y = p.pixel / renderer::tile_size;
            if (!p.reached_by_specular() && x % 4 == 2 && y % 4 == 2 && places.size() < 16) places.push_back(&p.point);
        }
        if (!places.empty()) tiles.push_back(std::move(places));
    }
    return tiles;
}

/// Random lines through a ball about what moves, lights and places that are seen.
SurfaceCloud cloud_of(const renderer::RayTracer& tracer, glm::vec3 low, glm::vec3 high) {
    SurfaceCloud cloud;
    cloud.middle = 0.5f * (low + high);
    cloud.radius = std::max(0.5f * glm::distance(low, high), 1e-3f);
    constexpr std::uint64_t lines = 400000;
    constexpr std::size_t most_places = 1u << 17, most_inside = 4096;
    std::uint64_t line = 0, hits = 0;
    for (; line < lines && cloud.places.size() < most_places; ++line) {
        const glm::vec3 d = core::sample_sphere({core::halton(0, line + 1), core::halton(1, line + 1)});
        glm::vec3 x, y;
        core::make_frame(d, x, y);
        const float r = cloud.radius * std::sqrt(core::uniform(3, line)),
                    turn = 2.0f * std::numbers::pi_v<float> * core::uniform(4, line);
        glm::vec3 at = cloud.middle + r * (std::cos(turn) * x + std::sin(turn) * y) - 1.01f * cloud.radius * d;
        float left = 2.02f * cloud.radius;
        glm::vec3 front{0};
        bool entered = false;
        for (int n = 0; n < 32; ++n) {
            const renderer::Hit hit = tracer.nearest(at, d, left);
            if (!hit.found()) break;
            const glm::vec3 place = at + hit.distance * d;
            ++hits;
            cloud.places.push_back(place);
            cloud.normals.push_back(glm::normalize(hit.geometric_normal));
            const bool leaves = glm::dot(hit.geometric_normal, d) > 0;
            if (leaves && entered && cloud.inside.size() < most_inside)
                cloud.inside.push_back(glm::mix(front, place, core::uniform(5, line, static_cast<std::uint64_t>(n))));
            entered = !leaves;
            front = place;
            at = place + 1e-5f * cloud.radius * d;
            left -= hit.distance + 1e-5f * cloud.radius;
        }
    }
    // A random line of the ball's meets an area A on the average A / (2 pi r^2) times [Cauchy, Crofton].
    cloud.area = static_cast<float>(hits) / static_cast<float>(line) * 2.0f * std::numbers::pi_v<float> * cloud.radius *
                 cloud.radius;
    return cloud;
}

/// A packet of a tile's places towards a light; light that cannot come is not asked for.
Question question_of(const Places& places, const renderer::LightPoint& l, std::size_t light, std::size_t tile,
                     float far) {
    Question q;
    q.light = light;
    q.tile = tile;
    for (std::size_t i = 0; i < 16; ++i) {
        const renderer::SurfacePoint& p = *places[std::min(i, places.size() - 1)];
        const bool directional = l.kind == renderer::LightPointKind::directional;
        const glm::vec3 to = directional ? -far * l.normal : l.position - p.position;
        const glm::vec3 origin = renderer::offset_origin(p, to);
        const float d2 = std::max(glm::dot(to, to), 1e-12f);
        const glm::vec3 direction = to / std::sqrt(d2);
        const float emitted =
            l.kind == renderer::LightPointKind::oriented ? std::max(0.0f, -glm::dot(l.normal, direction)) : 1.0f;
        q.worth[i] = core::luminance(l.intensity) * emitted * std::max(0.0f, glm::dot(p.geometric_normal, direction)) /
                     (directional ? 1.0f : std::max(d2, l.disc2));
        q.packet.origin_x[i] = origin.x;
        q.packet.origin_y[i] = origin.y;
        q.packet.origin_z[i] = origin.z;
        q.packet.direction_x[i] = to.x;
        q.packet.direction_y[i] = to.y;
        q.packet.direction_z[i] = to.z;
        q.packet.far[i] = 0.999f;
        if (i < places.size() && q.worth[i] > 0) q.packet.active |= 1u << i;
    }
    return q;
}

std::vector<Question> questions_of(const std::vector<Places>& tiles, const std::vector<renderer::LightPoint>& lights,
                                   int each, float far) {
    std::vector<double> sums;
    double sum = 0;
    for (const renderer::LightPoint& l : lights) sums.push_back(sum += core::luminance(l.intensity));
    std::vector<Question> questions;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        for (int k = 0; k < each; ++k) {
            const double at = sum * (k + core::uniform(9, t, static_cast<std::uint64_t>(k))) / each;
            const auto light = std::min<std::size_t>(
                static_cast<std::size_t>(std::upper_bound(sums.begin(), sums.end(), at) - sums.begin()),
                lights.size() - 1);
            Question q = question_of(tiles[t], lights[light], light, t, far);
            for (float& w : q.worth) w /= std::max(core::luminance(lights[light].intensity), 1e-30f);
            if (q.packet.active != 0) questions.push_back(q);
        }
    }
    return questions;
}

/// Prints how one way answers them. `once`: CPU seconds that it took before.
template <class Answer>
std::vector<std::uint32_t> judge(const std::string& way, const std::vector<Question>& questions, std::size_t tiles,
                                 double once, const std::vector<std::uint32_t>* truth, const Answer& answer) {
    std::vector<std::uint32_t> found(questions.size());
    const double start = renderer::cpu_seconds();
    for (std::size_t i = 0; i < questions.size(); ++i) found[i] = answer(questions[i]);
    const double seconds = renderer::cpu_seconds() - start;
    if (truth == nullptr) truth = &found;
    double rays = 0, otherwise = 0, light = 0, difference = 0, squares = 0;
    std::vector<double> right(16 * tiles, 0.0), wrong(16 * tiles, 0.0);
    for (std::size_t i = 0; i < questions.size(); ++i) {
        const Question& q = questions[i];
        rays += std::popcount(q.packet.active);
        otherwise += std::popcount((found[i] ^ (*truth)[i]) & q.packet.active);
        for (std::size_t k = 0; k < 16; ++k) {
            if ((q.packet.active >> k & 1u) == 0) continue;
            right[16 * q.tile + k] += ((*truth)[i] >> k & 1u) == 0 ? static_cast<double>(q.worth[k]) : 0.0;
            wrong[16 * q.tile + k] += (found[i] >> k & 1u) == 0 ? static_cast<double>(q.worth[k]) : 0.0;
        }
    }
    double places = 0;
    for (std::size_t p = 0; p < right.size(); ++p) {
        if (!(right[p] + wrong[p] > 0)) continue;
        places += 1;
        light += right[p];
        difference += wrong[p] - right[p];
        squares += (wrong[p] - right[p]) * (wrong[p] - right[p]);
    }
    light /= std::max(places, 1.0);
    fmt::print("| {} | {:.0f} | {:.1f} | {:.1f} % | {:+.1f} % | {:.1f} % |\n", way, 1e9 * seconds / rays, 1e3 * once,
               100 * otherwise / rays, 100 * difference / (places * light), 100 * std::sqrt(squares / places) / light);
    return found;
}

void compare_ways(const std::string& scene, const Wishes& wishes, const renderer::RayTracer& tracer,
                  const SurfaceCloud& cloud, const std::vector<renderer::LightPoint>& lights,
                  const std::vector<Question>& questions, std::size_t tiles) {
    fmt::print(
        "| {}: {} packets, {} lights | ns a ray | ms once a frame | answered otherwise | mean light | error |\n"
        "|---|---|---|---|---|---|\n",
        scene, questions.size(), lights.size());
    const auto truth = judge("rays", questions, tiles, 0, nullptr,
                             [&](const Question& q) { return tracer.occluded(q.packet, nullptr); });
    for (const int most : wishes.numbers("spheres", "64,256")) {
        const OccludingSpheres spheres(cloud, most);
        judge(fmt::format("{} spheres, fitted before", spheres.count()), questions, tiles, 0, &truth,
              [&](const Question& q) { return spheres.occluded(q.packet); });
    }
    for (const int splats : wishes.numbers("splats", "8000")) {
        const double start = renderer::cpu_seconds();
        const int side = wishes.number("side", 32);
        const ImperfectShadowMaps maps(cloud, lights, splats, side);
        const double once = renderer::cpu_seconds() - start;
        judge(fmt::format("maps of {0}x{0}, {1} points each", side, splats), questions, tiles, once, &truth,
              [&](const Question& q) { return maps.occluded(q.packet, q.light); });
    }
}

void run(const std::string& scene, const Wishes& wishes) {
    Subject s = subject(scene, wishes.number("frame", 0), width, height);
    renderer::PosedScene posed_scene(*s.animation, s.settings.isa, s.plan);
    posed_scene.pose(s.world);
    renderer::LightPoints points(posed_scene, s.plan, s.settings.direct_points, s.settings.seed);
    const renderer::Anchors anchors(posed_scene, points, {wishes.number("vpls", 2048), s.settings.bounces});
    points.place(posed_scene, s.world);
    std::vector<renderer::LightPoint> lights = points.at(posed_scene);
    const renderer::Anchors::Lit lit = anchors.at(posed_scene, lights);
    for (const auto* more : {&lit.still, &lit.moving}) lights.insert(lights.end(), more->begin(), more->end());
    std::erase_if(lights, [](const renderer::LightPoint& l) { return !(core::luminance(l.intensity) > 0); });

    renderer::SeeCounts counts;
    const renderer::Seen seen =
        renderer::see(posed_scene, {{width, height, 1.0f}, 1, 0, s.settings.specular_depth, {}, {}}, s.plan, counts);
    const std::vector<Places> tiles = lattice_of(seen);
    if (tiles.empty() || lights.empty()) throw core::Error(scene + ": no surface is seen, or no light shines");
    glm::vec3 low(std::numeric_limits<float>::infinity()), high = -low;
    const auto grow = [&low, &high](glm::vec3 p) { low = glm::min(low, p), high = glm::max(high, p); };
    for (const Places& places : tiles)
        for (const renderer::SurfacePoint* p : places) grow(p->position);
    for (const renderer::LightPoint& l : lights)
        if (l.kind != renderer::LightPointKind::directional) grow(l.position);
    const SurfaceCloud cloud = cloud_of(posed_scene.tracer(), low, high);
    const std::vector<Question> questions =
        questions_of(tiles, lights, wishes.number("lights", 128), 4.0f * cloud.radius);
    compare_ways(scene, wishes, posed_scene.tracer(), cloud, lights, questions, tiles.size());
}

}  // namespace
}  // namespace render2mpeg::bench

int main(int argc, char** argv) try {
    if (argc < 2) {
        std::fputs("bench_shadow_proxies SCENE|MOVERS [frame=] [vpls=] [lights=] [spheres=] [splats=] [side=]\n",
                   stderr);
        return 2;
    }
    render2mpeg::bench::run(argv[1], render2mpeg::bench::Wishes(argc, argv));
    return 0;
} catch (const render2mpeg::core::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
