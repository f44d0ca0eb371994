#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "core/color.h"
#include "parallel/loops.h"
#include "renderer/calibration/audit.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;

/// The furnished room with a shiny ball and a mirror, several surfaces in a pixel.
test::SceneBuilder shiny_room() {
    test::SceneBuilder b = test::furnished_room();
    const int shiny = b.add_material({0.5f, 0.4f, 0.3f});
    b.material(shiny).roughness = 0.4f;
    b.material(shiny).ior = 1.5f;
    b.add_sphere({2.0f, 0.4f, 2.6f}, 0.4f, shiny, 12);
    const int mirror = b.add_material({0.9f, 0.9f, 0.9f});
    b.material(mirror).metallic = 1;
    b.material(mirror).roughness = 0;
    b.add_quad({0.5f, 0.2f, 0.1f}, {1, 0, 0}, {0, 1, 0}, mirror);
    return b;
}

struct AuditedFrame {
    explicit AuditedFrame(int width = 40, int height = 36)
        : stage(shiny_room(), settings(width, height)), world(stage.at(0)) {
        loose = core::ToleranceMap::uniform(width, height, {0.0f, 0.3f});
        cut = stage.renderer().light(world, stage.renderer().look(world), {loose});
    }
    static Settings settings(int width, int height) {
        Settings s = test::lightcuts_frame(width, height);
        s.samples = 2;
        return s;
    }
    std::vector<AuditedPixel> audit(int count) { return stage.renderer().audit(world, cut, loose, count); }
    FilmStage stage;
    scene::Snapshot world;
    core::ToleranceMap loose;
    Lit cut;
};

TEST(Audit, FindsTheDifferenceToTheReferenceFrame) {
    AuditedFrame frame;
    const core::Radiance truth =
        frame.stage.renderer().light(frame.world, frame.cut.frame, {core::ToleranceMap::reference()}).radiance;
    const std::vector<AuditedPixel> pixels = frame.audit(300);
    ASSERT_EQ(pixels.size(), 300u);
    double errors = 0;
    for (const AuditedPixel& p : pixels) {
        const float expected = core::luminance(truth.combined.at(p.x, p.y));
        EXPECT_NEAR(p.luminance, expected, 3e-5f * (expected + 1e-3f));
        EXPECT_NEAR(p.error, std::abs(core::luminance(frame.cut.radiance.combined.at(p.x, p.y)) - expected),
                    3e-5f * expected)
            << "rounding of sums";
        EXPECT_EQ(p.tolerance, 0.3f * p.luminance);
        errors += p.error;
    }
    EXPECT_GT(errors, 0.0);
}

TEST(Audit, DrawsNoPixelTwiceAndAllOfASmallFrame) {
    AuditedFrame frame(16, 16);
    for (const int count : {1, 100, 1000}) {
        std::set<std::pair<int, int>> places;
        const std::vector<AuditedPixel> pixels = frame.audit(count);
        for (const AuditedPixel& p : pixels) {
            EXPECT_TRUE(p.x >= 0 && p.x < 16 && p.y >= 0 && p.y < 16);
            places.insert({p.x, p.y});
        }
        EXPECT_EQ(places.size(), pixels.size());
        EXPECT_EQ(pixels.size(), static_cast<std::size_t>(std::min(count, 256)));
    }
}

TEST(Audit, CostsNothingAndCountsNowhere) {
    AuditedFrame frame;
    const Statistics before = frame.stage.statistics();
    EXPECT_TRUE(frame.audit(0).empty());
    frame.audit(50);
    EXPECT_EQ(frame.stage.statistics().shadow_rays, before.shadow_rays);
    EXPECT_EQ(frame.stage.statistics().gather_points, before.gather_points);
}

TEST(Audit, ChoosesHalfOfItsPixelsAsWholeBlocks) {
    test::SceneBuilder b;
    b.add_quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, b.add_material({0.5f, 0.4f, 0.3f}));
    b.add_camera({0, 0, 2}, {0, 0, 0});
    test::Stage stage(std::move(b), 36, 28);
    const Frame seen = stage.see();
    const std::vector<LitPixel> all = lit_pixels(seen);
    ASSERT_EQ(all.size(), 36u * 28u);
    for (const std::size_t count : {100u, 300u, 2000u}) {
        std::map<std::pair<int, int>, int> of_block;
        std::set<std::pair<int, int>> places;
        for (const LitPixel& p : drawn_with_blocks(all, count, seen)) {
            const glm::ivec2 at = place_of(seen, p);
            places.insert({at.x, at.y});
            ++of_block[{at.x / 8, at.y / 8}];
        }
        EXPECT_EQ(places.size(), std::min<std::size_t>(count, all.size())) << "none twice";
        const auto whole =
            std::count_if(of_block.begin(), of_block.end(), [](const auto& block) { return block.second == 64; });
        EXPECT_EQ(whole, count == 100u ? 0 : count == 300u ? 2 : 12);
    }
}

TEST(Audit, OfAReferenceFrameFindsNothing) {
    AuditedFrame frame;
    frame.loose = core::ToleranceMap::reference();
    frame.cut = frame.stage.renderer().light(frame.world, frame.cut.frame, {frame.loose});
    for (const AuditedPixel& p : frame.audit(200)) EXPECT_FALSE(p.over()) << p.x << ", " << p.y << ": " << p.error;
}

TEST(Audit, IsTheSameForAnyNumberOfThreadsAndAnotherInAnotherFrame) {
    AuditedFrame frame;
    std::vector<AuditedPixel> one, two;
    {
        const parallel::ThreadLimit limit(1);
        one = frame.audit(64);
    }
    {
        const parallel::ThreadLimit limit(2);
        two = frame.audit(64);
    }
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].x, two[i].x);
        EXPECT_EQ(one[i].y, two[i].y);
        EXPECT_EQ(one[i].error, two[i].error);
    }
    const scene::Snapshot later = frame.stage.at(1);
    const Lit cut = frame.stage.renderer().light(later, frame.stage.renderer().look(later), {frame.loose});
    const std::vector<AuditedPixel> other = frame.stage.renderer().audit(later, cut, frame.loose, 64);
    int same = 0;
    for (std::size_t i = 0; i < one.size(); ++i) same += one[i].x == other[i].x && one[i].y == other[i].y ? 1 : 0;
    EXPECT_LT(same, 5);
}

}  // namespace
}  // namespace render2mpeg::renderer
