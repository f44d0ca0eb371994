// How true indirect light is: what a path tracer finds at pixels of a frame against the sum over all anchors, without
// clustering. bench_light_truth SCENE|nook|MOVERS [frame=0] [vpls=4096] [photons=0] [pixels=256] [paths=1024]
// [clamp=0.25,0] (0: none). Prints, for each clamp, the light on the whole over the path tracer's, median and root mean
// square error (the path tracer's own variance taken off), of all pixels and by how near the nearest other surface is,
// in radii of the nearest anchor's disc. `nook` is a box in a corner of a room, 20 cm off its walls; MOVERS one of the
// films of mover_scenes.h.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "bench/subject.h"
#include "bench/wishes.h"
#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/lobe.h"
#include "renderer/cut/gatherer.h"
#include "renderer/lights/anchors.h"
#include "renderer/view/see.h"
#include "tests/reference/path_tracer.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg {
namespace {

constexpr int picture_size = 192;

bench::Subject nook() {
    test::SceneBuilder b;
    const int white = b.add_material(glm::vec3(0.8f));
    b.add_box({0, 0, 0}, {4, 3, 4}, white, true);
    b.add_box({0.2f, 0, 0.2f}, {0.9f, 0.8f, 0.9f}, b.add_material({0.7f, 0.5f, 0.4f}));
    b.add_point_light({2.8f, 2.2f, 2.8f}, 20.0f);
    b.add_camera({1.7f, 1.5f, 1.5f}, {0.3f, 0.2f, 0.3f}, 0.9f);
    return bench::subject(b.build(), 0, picture_size, picture_size);
}

/// One pixel's surface: what a path tracer says of it, and how near others are.
struct Place {
    renderer::GatherPoint point;
    double truth = 0, variance = 0;  ///< luminance of indirect light, and the variance of that mean
    double nearness = 0;             ///< distance of the nearest other surface over the anchors' radius here
    double found = 0;                ///< luminance by anchors
};

std::vector<Place> places_of(const bench::Subject& s, const renderer::PosedScene& posed_scene, int count) {
    renderer::SeeCounts counts;
    const renderer::Seen seen = renderer::see(
        posed_scene, {{picture_size, picture_size, 1.0f}, 1, 0, s.settings.specular_depth, {}, {}}, s.plan, counts);
    std::vector<const renderer::GatherPoint*> all;
    for (const renderer::GatherTile& tile : seen.tiles)
        for (const renderer::GatherPoint& p : tile)
            if (!p.reached_by_specular()) all.push_back(&p);
    std::vector<Place> places(std::min(all.size(), static_cast<std::size_t>(count)));
    for (std::size_t i = 0; i < places.size(); ++i) {
        const double at = (static_cast<double>(i) + core::uniform(7, i)) / static_cast<double>(places.size());
        places[i].point =
            *all[std::min(all.size() - 1, static_cast<std::size_t>(at * static_cast<double>(all.size())))];
    }
    return places;
}

/// How far the nearest of 256 directions gets.
double nearest_surface(const renderer::PosedScene& posed_scene, const renderer::SurfacePoint& p, std::uint64_t index) {
    double least = std::numeric_limits<double>::infinity();
    for (std::uint64_t k = 0; k < 256; ++k) {
        const glm::vec3 d = core::sample_cosine_hemisphere(
            p.geometric_normal, {core::uniform(11, index, 2 * k), core::uniform(11, index, 2 * k + 1)});
        const renderer::Hit hit =
            posed_scene.tracer().nearest(renderer::offset_origin(p, d), d, std::numeric_limits<float>::infinity());
        if (hit.found()) least = std::min(least, static_cast<double>(hit.distance));
    }
    return least;
}

double radius_about(const std::vector<renderer::LightPoint>& anchors, const renderer::SurfacePoint& p) {
    float best = std::numeric_limits<float>::infinity(), radius = 1;
    for (const renderer::LightPoint& l : anchors) {
        const glm::vec3 d = l.position - p.position;
        if (glm::dot(l.normal, p.geometric_normal) < 0.5f || glm::dot(d, d) >= best) continue;
        best = glm::dot(d, d);
        radius = std::sqrt(l.disc2);
    }
    return radius;
}

/// What all anchors together make each place scatter.
void gather(std::vector<Place>& places, const renderer::PosedScene& posed_scene, const renderer::Anchors::Lit& lit,
            float clamp) {
    renderer::LightTrees light_trees = renderer::build_light_trees({}, lit.still, 1);
    light_trees.trees[renderer::LightTrees::dynamic_tree] =
        renderer::build_light_tree(renderer::LightType::oriented, lit.moving, 1);
    light_trees.point_clamp = clamp > 0 ? renderer::GeometryClamp{clamp} : renderer::GeometryClamp::none();
    light_trees.translucent = true;
    parallel::for_each(places.size(), [&](std::size_t i) {
        renderer::Gatherer gatherer(light_trees, posed_scene.tracer());
        renderer::GatherLanes lanes;
        const renderer::GatherPoint* const points[] = {&places[i].point};
        renderer::fill(lanes, points);
        renderer::GatheredLight light;
        gatherer.gather_all(lanes, light);
        const renderer::PointLight l = renderer::point_light(light, 0, places[i].point);
        places[i].found = core::luminance(places[i].point.point.bsdf.diffuse * l.indirect + l.glossy);
    });
}

std::string judged(const std::vector<Place>& places, double least, double most) {
    double found = 0, truth = 0, squares = 0, count = 0;
    std::vector<double> errors;
    for (const Place& p : places) {
        if (p.nearness < least || p.nearness >= most || !(p.truth > 0)) continue;
        found += p.found;
        truth += p.truth;
        const double error = p.found / p.truth - 1;
        squares += error * error - p.variance / (p.truth * p.truth);
        errors.push_back(std::abs(error));
        count += 1;
    }
    if (errors.empty()) return "0 |";
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
    return fmt::format("{}: {:.3f}, {:.1f} %, {:.1f} % |", count, found / truth, 100 * errors[errors.size() / 2],
                       100 * std::sqrt(std::max(0.0, squares / count)));
}

void run(const std::string& scene, const bench::Wishes& wishes) {
    const int frame = wishes.number("frame", 0);
    bench::Subject s = scene == "nook" ? nook() : bench::subject(scene, frame, picture_size, picture_size);
    renderer::PosedScene posed_scene(*s.animation, s.settings.isa, s.plan);
    posed_scene.pose(s.world);
    renderer::LightPoints lights(posed_scene, s.plan, s.settings.direct_points, s.settings.seed);
    renderer::AnchorSettings settings{wishes.number("vpls", 4096), s.settings.bounces};
    settings.photons = static_cast<std::uint64_t>(wishes.number("photons", 0));
    const renderer::Anchors anchors(posed_scene, lights, settings);
    lights.place(posed_scene, s.world);
    const renderer::Anchors::Lit lit = anchors.at(posed_scene, lights.at(posed_scene));

    std::vector<Place> places = places_of(s, posed_scene, wishes.number("pixels", 256));
    const auto paths = static_cast<std::uint64_t>(wishes.number("paths", 1024));
    constexpr int all_bounces = 64;
    parallel::for_each(places.size(), [&](std::size_t i) {
        Place& p = places[i];
        const reference::Estimate e =
            reference::scattered_light(posed_scene, p.point.point, all_bounces, paths, 100 + i, 1);
        p.truth = core::luminance(glm::vec3(e.mean));
        const double error = core::luminance(glm::vec3(e.error));
        p.variance = error * error;
        p.nearness = nearest_surface(posed_scene, p.point.point, i) / radius_about(lit.still, p.point.point);
    });
    std::string clamps = wishes.text("clamp", "0.25,0");
    fmt::print(
        "| {}, {} anchors, {} photon paths; clamp | all | within 1 radius | 1 to 2 | 2 to 4 | farther |\n"
        "|---|---|---|---|---|---|\n",
        scene, lit.still.size() + lit.moving.size(), anchors.paths());
    const double infinity = std::numeric_limits<double>::infinity();
    for (std::size_t start = 0; start <= clamps.size();) {
        const std::size_t comma = std::min(clamps.find(',', start), clamps.size());
        const std::string clamp = clamps.substr(start, comma - start);
        start = comma + 1;
        gather(places, posed_scene, lit, std::strtof(clamp.c_str(), nullptr));
        fmt::print("| {} | {} {} {} {} {}\n", clamp, judged(places, 0, infinity), judged(places, 0, 1),
                   judged(places, 1, 2), judged(places, 2, 4), judged(places, 4, infinity));
    }
}

}  // namespace
}  // namespace render2mpeg

int main(int argc, char** argv) try {
    if (argc < 2) {
        std::fputs("bench_light_truth SCENE|nook|MOVERS [frame=] [vpls=] [photons=] [pixels=] [paths=] [clamp=]\n",
                   stderr);
        return 2;
    }
    render2mpeg::run(argv[1], render2mpeg::bench::Wishes(argc, argv));
    return 0;
} catch (const render2mpeg::core::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
