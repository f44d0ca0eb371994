// What irradiance gradients say of light between records, against the plane through them, on equal rays: records on a
// lattice of pixels, lit by every light point and by cuts, keep the gradients of the very lights that lit them; at
// pixels between, lit exactly, what each method says is held against the truth. bench_record_gradients SCENE
// [frames=0,12] [size=192] [pixels=2000] [vpls=9000] [lattices=2,4,8] [cuts=2,8] (per cent, lattice of 4; 0: none)
// [least=3] (records that gradients need). Diffuse light of the light trees alone; 1 thread.
//
// Columns: root mean square, 95th and 99th percentile of errors over luminance (at least half a code value) and the
// share beyond 2 and 8 %, of pixels where a plane fits; root mean square where all records around see the same lights
// as the pixel, but for 2 % of its light, and elsewhere; Spearman's correlation of what records disagree by with the
// error; then, of all pixels, the share that is served at 2 and at 8 % when disagreement is trusted just so much that 1
// % of the served are beyond their tolerance (that factor in brackets).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "record_gradients_frame.h"
#include "record_gradients_report.h"
#include "renderer/cache/record_fit.h"
#include "renderer/cache/record_gather.h"
#include "renderer/cache/record_groups.h"
#include "tests/bench/wishes.h"

namespace render2mpeg {
namespace {

using bench::Judged;
using bench::LatticeFrame;
using bench::Sample;
using bench::SlopedLight;
using bench::trust_of;

/// Radii of the search, in steps of the lattice: the product's 4 and 6 pixels on its first lattice of 4.
constexpr float radii[bench::radius_count] = {1.0f, 1.5f};
/// What is lost or won of a pixel's light where it counts as one visibility. chosen: 10 %; at 2 % no pixel is smooth.
constexpr float alike_share = 0.1f;

/// record_fit.cpp, doubt.
float doubt(float relative) {
    constexpr float coarse = 0.62f, fine = 2.1f, turn2 = 0.1f * 0.1f;
    return coarse + (fine - coarse) * turn2 / (turn2 + relative * relative);
}

Judged judge(const bench::Guess& g, const Sample& s, float base, float truth) {
    Judged j;
    j.found = g.found && core::is_finite(g.value);
    if (!j.found) return j;
    j.instead = g.instead;
    const float luminance = core::luminance(g.value);
    j.error = luminance - truth;
    j.off = g.off;
    for (int t = 0; t < bench::tolerance_count; ++t) {
        const float whole = base + std::max(luminance, 0.0f);
        const float allowed = core::Tolerance{s.floor, bench::relative_tolerances[t]}.allows(whole);
        const float doubts = doubt(core::divide_or(allowed, whole, 1.0f));
        j.over[t] = core::divide_or(g.off * doubts * (g.level ? doubts : 1.0f), allowed, 1e30f);
    }
    return j;
}

/// Where samples lie, and what light they get exactly.
struct Truth {
    renderer::PointRef ref;
    float base = 0;  ///< luminance of lights that are not clustered
    glm::vec3 light{0};
    std::vector<std::uint64_t> lit;
    bench::Unshadowed unshadowed;
};

bool sees_the_same(const Truth& t, const SlopedLight& record) {
    float all = 0, other = 0;
    for (std::size_t i = 0; i < t.unshadowed.size(); ++i) {
        const bool here = (t.lit[i / 64] >> i % 64 & 1) != 0, there = (record.lit[i / 64] >> i % 64 & 1) != 0;
        all += here ? t.unshadowed[i] : 0.0f;
        other += here != there ? t.unshadowed[i] : 0.0f;
    }
    return other <= alike_share * all;
}

Truth light_exactly(const LatticeFrame& frame, const renderer::PointRef& ref) {
    Truth t{ref, 0, {}, {}, {}};
    const renderer::GatherPoint& p = frame.point(ref);
    SlopedLight light = bench::gather_sloped(frame.forest, *frame.tracer, p, &t.unshadowed);
    t.light = light.light;
    t.lit = std::move(light.lit);
    renderer::GatherLanes lanes;
    const renderer::GatherPoint* const points[] = {&p};
    renderer::fill(lanes, points);
    renderer::GatheredLight exact;
    renderer::Gatherer(frame.forest, *frame.tracer).gather_exact(lanes, exact);
    t.base = std::max(core::luminance(point_light(exact, 0, p).scattered(p)), 0.0f);
    return t;
}

/// What light changes by up to the nearest record, and what is left of that when its gradients are followed.
void measure_nearest(const bench::Place& place, const std::vector<bench::Near>& near, float truth, Sample& s) {
    const auto nearest = std::min_element(near.begin(), near.end(), [](const bench::Near& a, const bench::Near& b) {
        return glm::dot(a.offset, a.offset) < glm::dot(b.offset, b.offset);
    });
    if (nearest == near.end()) return;
    s.has_nearest = true;
    s.change = truth - core::luminance(told(*nearest, place, 0, 0));
    s.left = truth - core::luminance(told(*nearest, place, 1, 1));
}

Sample sample_of(const LatticeFrame& frame, const Truth& t, const std::vector<SlopedLight>& exact,
                 const std::vector<SlopedLight>& light, int step, int least) {
    const renderer::GatherPoint& p = frame.point(t.ref);
    const bench::LatticeSearch search(frame, p);
    const bench::Place place{p.point.position, p.point.shading_normal, p.weight * p.point.bsdf.diffuse,
                             static_cast<float>(step) * search.extent};
    const float truth = core::luminance(place.reflects * t.light);
    Sample s;
    s.luminance = t.base + truth;
    s.floor = frame.floor;
    s.smooth = true;
    for (int r = 0; r < bench::radius_count; ++r) {
        const float quarter = 0.25f * static_cast<float>(step), reach = radii[r] * 4.0f + 0.5f;
        std::vector<bench::Near> near;
        search.each(step, reach * quarter, [&](std::uint32_t i, const renderer::RecordMark& m, float apart) {
            const float d2 = apart * apart / (quarter * quarter), falloff = 1.0f - d2 / (reach * reach * 1.1f);
            near.push_back({&light[i], (m.at - search.at) / quarter, falloff * falloff / (0.25f + d2), m.position,
                            m.shading_normal});
            if (r + 1 == bench::radius_count) s.smooth = s.smooth && sees_the_same(t, exact[i]);
        });
        if (r == 0) measure_nearest(place, near, truth, s);
        for (int m = 0; m < bench::method_count; ++m)
            s.judged[m][r] = judge(guess(static_cast<bench::Method>(m), place, near, least), s, t.base, truth);
    }
    return s;
}

/// What the product itself says, at each trust.
void ask_product(const LatticeFrame& frame, const std::vector<Truth>& truths, const std::vector<SlopedLight>& light,
                 int step, std::vector<Sample>& samples, std::size_t first) {
    renderer::Records records;
    for (std::size_t i = 0; i < frame.places.size(); ++i) {
        if (frame.places[i].x % step != 0 || frame.places[i].y % step != 0) continue;
        renderer::PointLight l;
        l.indirect = light[i].light;
        if (const auto r = renderer::record_of(frame.point(frame.places[i].ref), l, {}, 1, 0,
                                               {light[i].by_place, light[i].by_normal}))
            records.add(*r);
    }
    renderer::RecordMap map(frame.width(), frame.height());
    map.build(records.all(), frame.world.camera);
    for (std::size_t i = 0; i < truths.size(); ++i) {
        const renderer::GatherPoint& p = frame.point(truths[i].ref);
        const bench::LatticeSearch search(frame, p);
        Sample& s = samples[first + i];
        const float truth = s.luminance - truths[i].base;
        for (int t = 0; t < bench::tolerance_count; ++t)
            for (int k = bench::least_trust; k <= bench::most_trust; ++k) {
                const renderer::PointTolerance tolerance{{frame.floor, bench::relative_tolerances[t]}, truths[i].base};
                const renderer::RecordEstimate e =
                    estimate({p, tolerance, search.at, search.extent, renderer::receives(p)}, map, records,
                             {trust_of(k), 0.5f, 0.0f}, 0);
                s.served[t].push_back(e.holds ? (core::luminance(e.light.scattered(p)) - truth) / s.allowed(t)
                                              : std::numeric_limits<float>::quiet_NaN());
            }
    }
}

/// Light of the records of a lattice by cuts at a relative tolerance; the others' stays empty.
std::vector<SlopedLight> light_by_cuts(const LatticeFrame& frame, int step, float relative) {
    std::vector<std::vector<renderer::PointRef>> areas;
    std::vector<std::vector<std::uint32_t>> index(frame.seen.tiles.size());
    for (std::size_t t = 0; t < index.size(); ++t) index[t].assign(frame.seen.tiles[t].size(), 0);
    constexpr int area = renderer::area_tiles * renderer::tile_size;
    const int across = (frame.width() + area - 1) / area, down = (frame.height() + area - 1) / area;
    areas.resize(static_cast<std::size_t>(across * down));
    for (std::uint32_t i = 0; i < frame.places.size(); ++i) {
        const LatticeFrame::At& at = frame.places[i];
        if (at.x % step != 0 || at.y % step != 0) continue;
        areas[static_cast<std::size_t>(at.y / area * across + at.x / area)].push_back(at.ref);
        index[at.ref.tile][at.ref.index] = i;
    }
    std::vector<SlopedLight> light(frame.places.size());
    renderer::CutLimits limits;
    limits.exact = false;
    for (const auto& requests : areas)
        for (const renderer::RequestGroup& group :
             renderer::group_requests(frame.seen, requests, frame.world.camera.position())) {
            const renderer::GatherPoint* points[renderer::lane_count];
            renderer::GroupTolerance tolerance;
            for (int i = 0; i < renderer::lane_count; ++i) tolerance.set(i, {{frame.floor, relative}, 0});
            for (std::size_t i = 0; i < group.points.size(); ++i) points[i] = &frame.point(group.points[i]);
            const auto gathered =
                bench::gather_sloped(frame.forest, *frame.tracer, std::span(points).first(group.points.size()),
                                     group.set, tolerance, limits);
            for (std::size_t i = 0; i < group.points.size(); ++i)
                light[index[group.points[i].tile][group.points[i].index]] = gathered[i];
        }
    return light;
}

std::vector<Truth> truths_of(const LatticeFrame& frame, int count) {
    std::vector<LatticeFrame::At> all;
    for (const LatticeFrame::At& at : points_of(frame))
        if (at.x % 2 != 0 || at.y % 2 != 0) all.push_back(at);
    std::vector<Truth> truths(std::min(all.size(), static_cast<std::size_t>(count)));
    parallel::for_each(truths.size(), [&](std::size_t i) {
        const double place = (static_cast<double>(i) + core::uniform(7, i)) / static_cast<double>(truths.size());
        const auto which = static_cast<std::size_t>(place * static_cast<double>(all.size()));
        truths[i] = light_exactly(frame, all[std::min(which, all.size() - 1)].ref);
    });
    return truths;
}

void run(const std::string& scene, const bench::Wishes& wishes) {
    const std::vector<int> lattices = wishes.numbers("lattices", "2,4,8"), cuts = wishes.numbers("cuts", "2,8");
    std::vector<std::vector<Sample>> exactly(lattices.size()), by_cuts(cuts.size());
    const int least = wishes.number("least", 3);
    const int finest = *std::min_element(lattices.begin(), lattices.end());
    bench::GradientFilm film(scene, wishes);
    for (const int number : wishes.numbers("frames", "0,12")) {
        const LatticeFrame frame = film.frame(number);
        const std::vector<Truth> truths = truths_of(frame, wishes.number("pixels", 2000));
        std::vector<SlopedLight> exact(frame.places.size());
        parallel::for_each(exact.size(), [&](std::size_t i) {
            const LatticeFrame::At& at = frame.places[i];
            if (at.x % finest == 0 && at.y % finest == 0)
                exact[i] = bench::gather_sloped(frame.forest, *frame.tracer, frame.point(at.ref));
        });
        const auto take = [&](const std::vector<SlopedLight>& light, int step, std::vector<Sample>& samples) {
            const std::size_t first = samples.size();
            for (const Truth& t : truths) samples.push_back(sample_of(frame, t, exact, light, step, least));
            if (step <= 4) ask_product(frame, truths, light, step, samples, first);
        };
        for (std::size_t l = 0; l < lattices.size(); ++l) take(exact, lattices[l], exactly[l]);
        for (std::size_t c = 0; c < cuts.size(); ++c)
            if (cuts[c] > 0) take(light_by_cuts(frame, 4, 0.01f * static_cast<float>(cuts[c])), 4, by_cuts[c]);
    }
    for (std::size_t l = 0; l < lattices.size(); ++l)
        report(fmt::format("{}, lattice of {}, lit exactly", scene, lattices[l]), exactly[l]);
    for (std::size_t c = 0; c < cuts.size(); ++c)
        if (cuts[c] > 0) report(fmt::format("{}, lattice of 4, cuts at {} %", scene, cuts[c]), by_cuts[c]);
}

}  // namespace
}  // namespace render2mpeg

int main(int argc, char** argv) try {
    using namespace render2mpeg;
    if (argc < 2) {
        std::fputs("bench_record_gradients SCENE [frames=] [size=] [pixels=] [vpls=] [lattices=] [cuts=] [least=]\n",
                   stderr);
        return 2;
    }
    const parallel::ThreadLimit limit(1);
    run(argv[1], bench::Wishes(argc, argv));
    return 0;
} catch (const render2mpeg::core::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
