// What gathering only light's change would take [Render2MPEG, 6; a "delta cut"]: anchors keep their places from frame
// to frame, so that light at a place changes by the sum over what each anchor changed by, seen through the same walls.
// Gathers that sum by the cut's own rule, from a tree of |dI|, within a share of what the pixel may be off by, and
// counts the rays, against those of gathering indirect light afresh. bench_delta_cuts SCENE [frame=0] [size=192]
// [vpls=9000] [percent=2]. A lower bound: walls that move, and light that is not of anchors, come on top.
//
// Then what things that move take, for points of what is still: the parts of light that they change
// (renderer/cache/light_split.h), each within a share of the tolerance, against gathering all light afresh. Light is
// parted at `frame` and gathered at the next one.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <vector>

#include "app/loop/render_job.h"
#include "bench/wishes.h"
#include "core/color.h"
#include "core/error.h"
#include "renderer/cache/light_split.h"
#include "renderer/cut/gather_groups.h"
#include "renderer/cut/gatherer.h"
#include "renderer/cut/point_light.h"
#include "renderer/cut/shade.h"
#include "renderer/lights/anchors.h"
#include "renderer/surface/posed_scene.h"
#include "renderer/tree/light_trees.h"
#include "renderer/view/see.h"

namespace render2mpeg {
namespace {

/// Luminance that a picture's darkest steps are apart by, at exposure 0.
constexpr float half_code = 0.00015f;

struct Lighting {
    std::uint64_t rays = 0, clusters = 0, points = 0;
    core::Radiance radiance;

    double rays_per_point() const {
        return static_cast<double>(rays) / static_cast<double>(std::max<std::uint64_t>(points, 1));
    }
};

class Trial {
  public:
    Trial(const app::RenderJob& film, int size, int vpls)
        : film_(film),
          posed_scene_(*film.animation, film.rendering.isa, film.plan),
          lights_(posed_scene_, film.plan, film.rendering.direct_points, film.rendering.seed),
          size_(size) {
        pose(film.frames.first);
        anchors_.emplace(posed_scene_, lights_, renderer::AnchorSettings{vpls, film.rendering.bounces});
    }

    void run(std::int64_t frame, float relative);
    void part(std::int64_t frame, float relative);

  private:
    void pose(std::int64_t frame) {
        world_ = film_.snapshot(frame);
        posed_scene_.pose(world_);
    }
    std::vector<renderer::LightPoint> anchors_at(std::int64_t frame);
    Lighting gather(const std::vector<renderer::LightPoint>& lights, const renderer::Seen& seen,
                    const core::ToleranceMap& tolerance) const;

    const app::RenderJob& film_;
    scene::Snapshot world_;
    renderer::PosedScene posed_scene_;
    renderer::LightPoints lights_;
    std::optional<renderer::Anchors> anchors_;
    int size_;
};

/// The still anchors as they shine; the posed scene stays posed so.
std::vector<renderer::LightPoint> Trial::anchors_at(std::int64_t frame) {
    pose(frame);
    return anchors_->at(posed_scene_, lights_.at(posed_scene_)).still;
}

Lighting Trial::gather(const std::vector<renderer::LightPoint>& lights, const renderer::Seen& seen,
                       const core::ToleranceMap& tolerance) const {
    renderer::LightTrees light_trees = renderer::build_light_trees({}, lights, film_.rendering.seed);
    light_trees.indirect_clamp = renderer::GeometryClamp{0.25f};
    light_trees.translucent = true;
    const renderer::ShadeSettings settings{{film_.rendering.min_cut, 1 << 20, 1.0f}, false};
    renderer::ShadeCounts counts;
    Lighting result;
    result.radiance = renderer::shade(light_trees, posed_scene_.tracer(), seen, world_.camera.position(), tolerance,
                                      settings, counts);
    result.rays = counts.shadow_rays;
    result.clusters = counts.indirect_clusters;
    result.points = counts.gather_points;
    return result;
}

void Trial::run(std::int64_t frame, float relative) {
    lights_.place(posed_scene_, film_.snapshot(frame));
    const std::vector<renderer::LightPoint> before = anchors_at(frame), now = anchors_at(frame + 1);
    renderer::SeeCounts counts;
    const renderer::Seen seen = renderer::see(
        posed_scene_, {{size_, size_, 1.0f}, 1, 0, film_.rendering.specular_depth, {}, {}}, film_.plan, counts);

    // The change of each anchor; who was dark and stays so is left out.
    std::vector<renderer::LightPoint> change;
    double changes = 0, all = 0;
    if (before.size() != now.size()) throw core::Error("anchors came or went between frames");
    for (std::size_t i = 0; i < now.size(); ++i) {
        renderer::LightPoint l = now[i];
        if (l.id != before[i].id) throw core::Error("anchors came or went between frames");
        l.intensity = glm::abs(now[i].intensity - before[i].intensity);
        changes += core::luminance(l.intensity);
        all += core::luminance(now[i].intensity);
        if (core::luminance(l.intensity) > 0) change.push_back(l);
    }

    const Lighting fresh = gather(now, seen, core::ToleranceMap::uniform(size_, size_, {half_code, relative}));
    fmt::print("{} anchors, summed |dI| / I {:.1f} %, {} changed; afresh {:.0f} rays and {:.0f} clusters for a point\n",
               now.size(), 100 * changes / std::max(all, 1e-30), change.size(), fresh.rays_per_point(),
               static_cast<double>(fresh.clusters) / static_cast<double>(std::max<std::uint64_t>(fresh.points, 1)));
    for (const float share : {0.1f, 0.2f, 0.3f, 0.5f, 1.0f}) {
        core::ToleranceMap tolerance = core::ToleranceMap::uniform(size_, size_, {});
        for (int y = 0; y < size_; ++y)
            for (int x = 0; x < size_; ++x) {
                const float light = core::luminance(fresh.radiance.combined.at(x, y));
                tolerance.pixels.at(x, y).absolute = share * std::max(half_code, relative * light);
            }
        const Lighting delta = gather(change, seen, tolerance);
        fmt::print("within {:.0f} % of the tolerance: {:.0f} rays, {:.0f} clusters: {:.2f} of afresh\n", 100 * share,
                   delta.rays_per_point(),
                   static_cast<double>(delta.clusters) / static_cast<double>(std::max<std::uint64_t>(delta.points, 1)),
                   static_cast<double>(delta.rays) / static_cast<double>(std::max<std::uint64_t>(fresh.rays, 1)));
    }
}

/// Sixteen points that are gathered together, and what was found of them.
struct Group {
    renderer::GatherLanes lanes;
    float light[renderer::lane_count] = {};  ///< luminance
    std::uint64_t rays = 0;                  ///< of gathering it afresh
};

std::uint64_t gather_within(renderer::Gatherer& gatherer, const Group& group, float share, float relative) {
    renderer::GroupTolerance tolerance;
    for (int i = 0; i < renderer::lane_count; ++i)
        tolerance.set(i, {{share * std::max(half_code, relative * group.light[i]), 0, 0}, group.light[i]});
    renderer::CutLimits limits{1, 1 << 20};
    limits.exact = false;
    renderer::GatheredLight light;
    gatherer.gather(group.lanes, tolerance, limits, light);
    return light.shadow_rays;
}

void Trial::part(std::int64_t frame, float relative) {
    lights_.place(posed_scene_, film_.snapshot(frame));
    renderer::PersistentLightTrees lasting({lights_.average(), anchors_->average_still(), anchors_->average_moving()},
                                           film_.rendering.seed);
    renderer::LightSplit parts;
    renderer::LightTrees light_trees;
    for (const std::int64_t f : {frame, frame + 1}) {
        pose(f);
        const std::vector<renderer::LightPoint> direct = lights_.at(posed_scene_);
        const renderer::Anchors::Lit lit = anchors_->at(posed_scene_, direct);
        light_trees = lasting.at({direct, lit.still, lit.moving});
        light_trees.direct_clamp = light_trees.indirect_clamp = renderer::GeometryClamp{0.25f};
        parts.update(light_trees, lit.still, lasting);
    }
    renderer::SeeCounts counts;
    const renderer::Seen seen = renderer::see(
        posed_scene_, {{size_, size_, 1.0f}, 1, 0, film_.rendering.specular_depth, {}, {}}, film_.plan, counts);
    std::vector<Group> groups;
    std::uint64_t afresh = 0;
    int points = 0;
    renderer::Gatherer whole(light_trees, posed_scene_.tracer());
    for (const renderer::GatherTile& tile : seen.tiles) {
        for (const renderer::GatherGroup& g : renderer::group_points(tile, world_.camera.position(), 4)) {
            const renderer::GatherPoint* pointers[renderer::lane_count] = {};
            bool counts_here = true;
            for (std::size_t i = 0; i < g.points.size(); ++i) {
                pointers[i] = &tile[g.points[i]];
                const std::uint32_t object = pointers[i]->point.address.object;
                counts_here = counts_here && !pointers[i]->point.bsdf.has_glossy() &&
                              film_.animation->objects[object].mobility == scene::Mobility::still;
            }
            if (!counts_here) continue;
            Group& group = groups.emplace_back();
            renderer::fill(group.lanes, std::span<const renderer::GatherPoint* const>(pointers, g.points.size()));
            group.lanes.set = g.set;
            renderer::GatheredLight light;
            const auto add = [&] {
                for (int i = 0; i < renderer::lane_count; ++i) {
                    const int k = std::min(i, group.lanes.count - 1);
                    group.light[i] +=
                        core::luminance(renderer::point_light(light, k, *pointers[k]).scattered(*pointers[k]));
                }
            };
            whole.gather_exact(group.lanes, renderer::Shadow::sharp, nullptr, light);
            add();
            renderer::GroupTolerance tolerance;
            for (int i = 0; i < renderer::lane_count; ++i) tolerance.set(i, {{half_code, relative, 0}, group.light[i]});
            renderer::CutLimits limits;
            limits.exact = false;
            whole.gather(group.lanes, tolerance, limits, light);
            add();
            group.rays = light.shadow_rays;
            afresh += group.rays;
            points += group.lanes.count;
        }
    }
    if (afresh == 0) return;
    fmt::print("{} points of what is still, afresh {} rays each\n", points,
               afresh / static_cast<std::uint64_t>(points));
    const std::pair<const char*, const renderer::LightTrees*> kinds[] = {
        {"hidden", &parts.occluded}, {"moving", &parts.moving}, {"gained", &parts.gained}, {"lost", &parts.lost}};
    for (const float share : {0.1f, 0.3f, 1.0f}) {
        fmt::print("within {:.0f} %:", 100 * share);
        for (const auto& [name, part] : kinds) {
            renderer::Gatherer gatherer(*part, posed_scene_.tracer());
            std::uint64_t rays = 0;
            int without = 0, cheap = 0;
            for (const Group& group : groups) {
                const std::uint64_t taken = gather_within(gatherer, group, share, relative);
                rays += taken;
                without += taken == 0 ? group.lanes.count : 0;
                cheap += 10 * taken <= group.rays ? group.lanes.count : 0;
            }
            fmt::print(" {} {:.3f} of afresh, none {:.0f} %, within a tenth {:.0f} %;", name,
                       static_cast<double>(rays) / static_cast<double>(afresh), 100.0 * without / points,
                       100.0 * cheap / points);
        }
        fmt::print("\n");
    }
}

}  // namespace
}  // namespace render2mpeg

int main(int argc, char** argv) try {
    using namespace render2mpeg;
    if (argc < 2) {
        std::fputs("bench_delta_cuts SCENE [frame=] [size=] [vpls=] [percent=]\n", stderr);
        return 2;
    }
    const bench::Wishes wishes(argc, argv);
    app::RenderOptions options;
    options.input = argv[1];
    options.samples = 1;
    options.exposure = "0";
    const int size = wishes.number("size", 192);
    options.size = fmt::format("{0}x{0}", size);
    const app::RenderJob film = app::prepare(options);
    Trial trial(film, size, wishes.number("vpls", 9000));
    const std::int64_t frame = wishes.number("frame", 0);
    const float relative = 0.01f * static_cast<float>(wishes.number("percent", 2));
    trial.run(frame, relative);
    trial.part(frame, relative);
    return 0;
} catch (const render2mpeg::core::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
