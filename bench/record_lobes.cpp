// How far what a record knows of a glossy surface carries: pixels of a frame that have a lobe, and neighbours on the
// same surface all around, are lit by every light point as if it were of one roughness after the other; what their
// places kept for another eye, or their neighbours for theirs, is held against that. bench_record_lobes SCENE [frame=0]
// [pixels=200] [vpls=2000] [size=160] [roughness=20,30,40,50,70] [basis=even|stretched]. Prints, for tolerances of 2, 8
// and 26 % of a pixel's light, the per cent of pixels, those with the least of the lobe in them first, of which no more
// than a hundredth is beyond; and the median of their errors. Films to use it on: glossy_films.py.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "app/loop/render_job.h"
#include "bench/lobe_harmonics.h"
#include "bench/record_lobe_stage.h"
#include "bench/record_lobe_trials.h"
#include "bench/wishes.h"
#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/lobe.h"
#include "renderer/cache/glossy_record.h"
#include "renderer/cut/gatherer.h"
#include "renderer/cut/shadow_rays.h"
#include "renderer/lights/anchors.h"
#include "renderer/view/see.h"

namespace render2mpeg {
namespace {

using bench::place_count;
using bench::Places;
using bench::Stage;
using bench::Trials;
using bench::turn_count;
using renderer::GatherPoint;
using renderer::GlossyRecord;

constexpr float turns[bench::turn_count] = {0, 2, 5, 10, 20};  ///< degrees

/// Light of the trees and of lights gathered exactly, as seen by each lane.
struct LaneSums {
    glm::vec3 irradiance[renderer::lane_count]{}, f0[renderer::lane_count]{}, schlick[renderer::lane_count]{};
};

struct Pack {
    renderer::GatherLanes lanes;
    LaneSums trees, exact;
    bool of_places = false;  ///< lanes are places, else eyes of the first
};

glm::vec3 turned(const renderer::SurfacePoint& p, float angle, float azimuth) {
    glm::vec3 t, b;
    core::make_frame(p.outgoing, t, b);
    return std::cos(angle) * p.outgoing + std::sin(angle) * (std::cos(azimuth) * t + std::sin(azimuth) * b);
}

bool faces(const renderer::SurfacePoint& p, glm::vec3 eye) {
    return glm::dot(p.shading_normal, eye) > 0.05f && glm::dot(p.geometric_normal, eye) > 0.05f;
}

/// Adds a light, with its visibility from each place, to all packs and to the places' harmonics.
class Lighting {
  public:
    Lighting(const Stage& stage, const Places& places, bench::Basis basis, std::vector<Pack>& packs)
        : stage_(stage), places_(places), packs_(packs) {
        std::vector<const GatherPoint*> pointers;
        for (const GatherPoint& p : places) {
            pointers.push_back(&p);
            incident_.emplace_back(basis, places[0].point.shading_normal);
        }
        renderer::fill(lanes_, pointers);
    }
    void add_all() {
        for (const renderer::ExactLight& e : stage_.light_trees.exact)
            add(e.type, e.light, &e.spot, stage_.light_trees.point_clamp, true);
        for (int t = 0; t < renderer::LightTrees::tree_count; ++t) {
            const renderer::LightTree& tree = stage_.light_trees.trees[static_cast<std::size_t>(t)];
            for (std::uint32_t i = 0; i < tree.lights.size(); ++i)
                if (core::luminance(tree.lights[i].intensity) > 0.0f)
                    add(tree.type, tree.lights[i], tree.spot(i), stage_.light_trees.clamp(t), false);
        }
    }
    const std::vector<bench::IncidentHarmonics>& incident() const { return incident_; }

  private:
    void add(renderer::LightType type, const renderer::TreeLight& light, const renderer::Spot* spot,
             renderer::GeometryClamp clamp, bool exact) {
        renderer::LightLanes unit;
        renderer::evaluate_light(lanes_, type, light, spot, clamp, unit);
        renderer::ShadowPacket packet;
        renderer::aim(lanes_, type, light, packet);
        packet.active = 0;
        for (int i = 0; i < place_count; ++i) packet.active |= unit.diffuse[i] > 0.0f ? 1u << i : 0u;
        if (packet.active == 0) return;
        const std::uint32_t lit = packet.active & ~stage_.posed_scene.tracer().occluded(packet, nullptr);
        if (lit == 0) return;
        for (int i = 0; i < place_count && !exact; ++i)
            if ((lit >> i & 1u) != 0) add_harmonics(i, type, light, clamp, unit.diffuse[i]);
        for (Pack& pack : packs_) {
            renderer::evaluate_light(pack.lanes, type, light, spot, clamp, unit);
            LaneSums& sums = exact ? pack.exact : pack.trees;
            for (int i = 0; i < pack.lanes.count; ++i) {
                if ((lit >> (pack.of_places ? i : 0) & 1u) == 0) continue;
                sums.irradiance[i] += unit.diffuse[i] * light.intensity;
                sums.f0[i] += unit.f0[i] * light.intensity;
                sums.schlick[i] += unit.schlick[i] * light.intensity;
            }
        }
    }
    void add_harmonics(int i, renderer::LightType type, const renderer::TreeLight& light, renderer::GeometryClamp clamp,
                       float irradiance) {
        const bool far = type == renderer::LightType::directional;
        const glm::vec3 to =
            far ? light.position : light.position - places_[static_cast<std::size_t>(i)].point.position;
        const float spread2 =
            type == renderer::LightType::punctual ? 0.0f : light.disc2 / clamp.scale / (far ? 1.0f : glm::dot(to, to));
        incident_[static_cast<std::size_t>(i)].add(glm::normalize(to), spread2, irradiance * light.intensity);
    }

    const Stage& stage_;
    const Places& places_;
    std::vector<Pack>& packs_;
    renderer::GatherLanes lanes_;
    std::vector<bench::IncidentHarmonics> incident_;
};

/// The lanes of a roughness: all places with their own eyes; and the first with eyes turned, the last of them a little.
constexpr int eye_count = turn_count + 1;

std::array<Pack, 2> packs_of(Places places, float alpha, float azimuth) {
    std::array<Pack, 2> packs;
    for (GatherPoint& p : places) p.point.bsdf.alpha = alpha;
    std::vector<GatherPoint> eyes(eye_count, places[0]);
    for (int t = 0; t < turn_count; ++t)
        eyes[static_cast<std::size_t>(t)].point.outgoing = turned(places[0].point, glm::radians(turns[t]), azimuth);
    eyes[turn_count].point.outgoing = turned(places[0].point, 0.1f * alpha, azimuth);
    for (int k = 0; k < 2; ++k) {
        std::vector<const GatherPoint*> pointers;
        for (const GatherPoint& p : k == 0 ? places : eyes) pointers.push_back(&p);
        renderer::fill(packs[static_cast<std::size_t>(k)].lanes, pointers);
        packs[static_cast<std::size_t>(k)].of_places = k == 0;
    }
    return packs;
}

/// All trials of one pixel at one roughness.
class Judge {
  public:
    Judge(const Places& places, const Pack& own, const Pack& eyes, const std::vector<bench::IncidentHarmonics>& light,
          float alpha, float azimuth, Trials& trials)
        : places_(places), own_(own), eyes_(eyes), light_(light), alpha_(alpha), azimuth_(azimuth), trials_(trials) {}

    void turn() {
        const glm::vec3 there = places_[0].point.outgoing;
        for (int t = 0; t < turn_count; ++t) {
            const glm::vec3 eye = turned(places_[0].point, glm::radians(turns[t]), azimuth_);
            const GlossyRecord lobe = lobe_of(own_, 0, there);
            note(bench::slopes, t, f0() * lobe.f0 + lobe.schlick + slope(t), lobe, t);
            each_guess(0, eye, there, lobe, [&](int means, glm::vec3 guess) { note(means, t, guess, lobe, t); });
        }
    }
    void move() {
        const glm::vec3 eye = places_[0].point.outgoing;
        for (int d = 0; d < bench::distance_count; ++d) {
            glm::vec3 mean[bench::means_count]{};
            for (int k = 0; k < 4; ++k) {
                const int i = 1 + 4 * d + k;
                const glm::vec3 there = places_[static_cast<std::size_t>(i)].point.outgoing;
                const GlossyRecord lobe = lobe_of(own_, i, there);
                each_guess(i, eye, there, lobe, [&](int means, glm::vec3 guess) {
                    mean[means] += 0.25f * guess;
                    if (k == 0) note(means, turn_count + d, guess, lobe, 0);
                });
            }
            const GlossyRecord lobe = lobe_of(own_, 1 + 4 * d, eye);
            for (int m = 0; m < bench::means_count; ++m)
                if (m != bench::slopes)
                    note(static_cast<bench::Means>(m), turn_count + bench::distance_count + d, mean[m], lobe, 0);
        }
    }

  private:
    GlossyRecord lobe_of(const Pack& pack, int lane, glm::vec3 eye) const {
        return {alpha_, eye, pack.trees.f0[lane], pack.trees.schlick[lane]};
    }
    glm::vec3 seen(const GlossyRecord& lobe, glm::vec3 eye) const {
        const renderer::SurfacePoint& p = places_[0].point;
        renderer::Bsdf bsdf = p.bsdf;
        bsdf.alpha = alpha_;
        return renderer::seen_from(lobe, p.shading_normal, eye, bsdf);
    }
    glm::vec3 f0() const { return places_[0].point.bsdf.f0; }
    /// What the lobe's light changes by with the eye, as one nearby tells that turned the same way.
    glm::vec3 slope(int t) const {
        const GlossyRecord here = lobe_of(own_, 0, {}), near = lobe_of(eyes_, turn_count, {});
        const glm::vec3 change = f0() * (near.f0 - here.f0) + near.schlick - here.schlick;
        return change * (std::sin(glm::radians(turns[t])) / std::sin(0.1f * alpha_));
    }
    template <class Note>
    void each_guess(int place, glm::vec3 eye, glm::vec3 there, const GlossyRecord& lobe, Note note) {
        const renderer::SurfacePoint& p = places_[0].point;
        const glm::vec3 still = seen(lobe, eye), f0 = p.bsdf.f0;
        const bench::IncidentHarmonics& light = light_[static_cast<std::size_t>(place)];
        const bench::LobeHarmonics here = bench::project_lobe(light, p.shading_normal, eye, alpha_),
                                   before = bench::project_lobe(light, p.shading_normal, there, alpha_);
        const glm::vec3 kept = f0 * lobe.f0 + lobe.schlick;
        note(bench::lobe_alone, still);
        for (int n = 0; n < bench::tried_orders; ++n) {
            const int functions = bench::functions_of(light.basis(), bench::orders_of(light.basis(), n));
            const glm::vec3 now = bench::scattered(light, here, f0, functions);
            note(bench::harmonics + n, now);
            note(bench::differences + n, kept + now - bench::scattered(light, before, f0, functions));
        }
    }
    void note(int means, int column, glm::vec3 guess, const GlossyRecord& lobe, int eye) {
        const GatherPoint& p = places_[0];
        const auto& bsdf = p.point.bsdf;
        const glm::vec3 diffuse =
            bsdf.diffuse * renderer::lobe::inverse_pi * (eyes_.trees.irradiance[eye] + eyes_.exact.irradiance[eye]);
        const glm::vec3 truth = bsdf.f0 * eyes_.trees.f0[eye] + eyes_.trees.schlick[eye];
        const glm::vec3 exact = bsdf.f0 * eyes_.exact.f0[eye] + eyes_.exact.schlick[eye];
        const float all = core::luminance(diffuse + truth + exact),
                    kept = core::luminance(bsdf.f0 * lobe.f0 + lobe.schlick);
        trials_.of[means][column].push_back(
            {core::divide_or(std::abs(core::luminance(glm::max(guess, glm::vec3(0)) - truth)), all, 0.0f),
             core::divide_or(kept, core::luminance(diffuse + exact) + kept, 0.0f)});
    }

    const Places& places_;
    const Pack &own_, &eyes_;
    const std::vector<bench::IncidentHarmonics>& light_;
    float alpha_, azimuth_;
    Trials& trials_;
};

float azimuth_of(const Places& places, std::uint64_t index) {
    float azimuth = 6.2831853f * core::uniform(9, index);
    for (int k = 0; k < 8; ++k, azimuth += 0.785398f)
        if (faces(places[0].point, turned(places[0].point, glm::radians(turns[turn_count - 1]), azimuth)))
            return azimuth;
    return azimuth;
}

void run(const std::string& scene, const bench::Wishes& wishes) {
    const Stage stage = bench::stage_of(scene, wishes);
    const std::vector<Places> pixels = bench::places_of(stage.seen, wishes.number("pixels", 200));
    const std::vector<int> roughness = wishes.numbers("roughness", "20,30,40,50,70");
    const bench::Basis basis = wishes.text("basis", "even") == "even" ? bench::Basis::even : bench::Basis::stretched;
    std::vector<Trials> trials(roughness.size());
    for (Trials& t : trials) t.basis = basis;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const float azimuth = azimuth_of(pixels[i], i);
        if (!faces(pixels[i][0].point, turned(pixels[i][0].point, glm::radians(turns[turn_count - 1]), azimuth)))
            continue;
        std::vector<Pack> packs;
        const auto alpha = [&](std::size_t r) { return 1e-4f * static_cast<float>(roughness[r] * roughness[r]); };
        for (std::size_t r = 0; r < roughness.size(); ++r)
            for (Pack& pack : packs_of(pixels[i], alpha(r), azimuth)) packs.push_back(pack);
        Lighting lighting(stage, pixels[i], basis, packs);
        lighting.add_all();
        for (std::size_t r = 0; r < roughness.size(); ++r) {
            Judge judge(pixels[i], packs[2 * r], packs[2 * r + 1], lighting.incident(), alpha(r), azimuth, trials[r]);
            judge.turn();
            judge.move();
        }
    }
    fmt::print("{} pixels of {}; per cent of pixels served at 2, 8 and 26 % (median error)\n",
               trials[0].of[0][0].size(), scene);
    for (std::size_t r = 0; r < roughness.size(); ++r) bench::print_tables(trials[r], roughness[r]);
}

}  // namespace
}  // namespace render2mpeg

int main(int argc, char** argv) try {
    if (argc < 2) {
        std::fputs("bench_record_lobes SCENE [frame=] [pixels=] [vpls=] [size=] [roughness=] [basis=]\n", stderr);
        return 2;
    }
    const render2mpeg::parallel::ThreadLimit limit(1);
    render2mpeg::run(argv[1], render2mpeg::bench::Wishes(argc, argv));
    return 0;
} catch (const render2mpeg::core::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
