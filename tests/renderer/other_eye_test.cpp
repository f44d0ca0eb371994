#include "renderer/cache/other_eye.h"

#include <gtest/gtest.h>

/// What one eye's points tell those of the other.
namespace render2mpeg::renderer {
namespace {

constexpr int side = 16;

scene::Camera camera_at(float x) {
    scene::CameraLens lens;
    lens.vertical_fov = 1.0f;
    glm::mat4 place(1.0f);
    place[3] = glm::vec4(x, 0, 4, 1);
    return scene::Camera(lens, place, side, side, 1.0f);
}

/// The point of the plane z = 0 that a position of a picture shows.
GatherPoint point_of(const scene::Camera& camera, glm::vec2 position, std::uint16_t pixel) {
    const scene::Ray ray = camera.ray_through(position);
    GatherPoint p;
    p.pixel = pixel;
    p.weight = glm::vec3(0.5f);
    p.point.address.object = 7;
    p.point.position = ray.origin - ray.origin.z / ray.direction.z * ray.direction;
    p.point.geometric_normal = p.point.shading_normal = {0, 0, 1};
    p.point.outgoing = -ray.direction;
    return p;
}

/// The left eye before a plane of which a lamp lights the right half alone, and nobody knows of columns 7 and 8.
class OtherEyeTest : public testing::Test {
  protected:
    OtherEyeTest() : left_(camera_at(-0.05f)) {
        seen_.visible = core::Visible(0, side, side);
        seen_.tiles.resize(1);
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                seen_.tiles[0].push_back(
                    point_of(left_, {x + 0.5f, y + 0.5f}, static_cast<std::uint16_t>(y * tile_size + x)));
                PointLight& light = light_[0].emplace_back();
                light.error.value = 0.25f;
                light.direct = glm::vec3(static_cast<float>(x));
                light.indirect = glm::vec3(2.0f * static_cast<float>(x));
                light.glossy = glm::vec3(static_cast<float>(y));
                SharedLight& told = shared_[0].emplace_back();
                told.lit = x > 8 ? 1u : 0u;
                told.dark = x < 7 ? 1u : 0u;
            }
    }
    void take() { eye_.take(seen_, left_, light_, shared_); }
    SharedLight at(const GatherPoint& p) const { return eye_.at(p, right_.pixel_extent(4.0f)).light; }

    scene::Camera left_, right_ = camera_at(0.05f);
    Frame seen_;
    std::vector<std::vector<PointLight>> light_{1};
    std::vector<std::vector<SharedLight>> shared_{1};
    OtherEye eye_;
};

TEST_F(OtherEyeTest, TellsWhatFourPixelsAgreeOn) {
    take();
    const SharedLight lit = at(point_of(right_, {12.3f, 5.7f}, 0)), dark = at(point_of(right_, {3.2f, 5.7f}, 0)),
                      edge = at(point_of(right_, {7.6f, 5.7f}, 0));
    EXPECT_EQ(lit.lit, 1u);
    EXPECT_EQ(lit.dark, 0u);
    EXPECT_FLOAT_EQ(lit.error, 0.5f) << "by unit of weight";
    EXPECT_EQ(dark.lit, 0u);
    EXPECT_EQ(dark.dark, 1u);
    EXPECT_EQ(edge.lit | edge.dark, 0u) << "nobody knows";
}

TEST_F(OtherEyeTest, TellsLightBetweenPixelsAndHowMuchTheyDiffer) {
    take();
    const GatherPoint p = point_of(right_, {9.3f, 5.7f}, 0);
    const ToldLight told = eye_.at(p, right_.pixel_extent(4.0f));
    const glm::vec2 there = left_.project(p.point.position)->position - 0.5f;
    EXPECT_GT(there.x, 9.0f) << "what is near moves to the right for the left eye";
    EXPECT_NEAR(told.light.direct.x, there.x, 1e-3);
    EXPECT_NEAR(told.light.indirect.x, 2 * there.x, 2e-3);
    EXPECT_NEAR(told.light.glossy.x, there.y, 1e-3);
    EXPECT_NEAR(told.spread, 0.5f, 1e-4) << "of gloss alone: the point reflects no diffuse light";
    EXPECT_NEAR(told.turn.x, -0.1f / 4, 2e-3);
}

TEST_F(OtherEyeTest, TellsNothingOfOtherSurfacesNorBeyondThePicture) {
    take();
    const GatherPoint p = point_of(right_, {12.3f, 5.7f}, 0);
    ASSERT_NE(at(p).lit, 0u);
    GatherPoint other = p;
    other.point.address.object = 8;
    EXPECT_EQ(at(other).lit, 0u) << "another object";
    other = p;
    other.point.back_side = true;
    EXPECT_EQ(at(other).lit, 0u) << "another side";
    other = p;
    other.point.position.z += 0.5f;
    EXPECT_EQ(at(other).lit, 0u) << "before the plane";
    other = p;
    other.path = extended_path(direct_path, true);
    EXPECT_EQ(at(other).lit, 0u) << "in a mirror";
    EXPECT_EQ(at(point_of(right_, {15.9f, 5.7f}, 0)).error, 0.0f) << "beside the picture";
    // Beside a silhouette the other pixels tell, unless they are too far.
    for (int y = 0; y < side; ++y)
        seen_.tiles[0][static_cast<std::size_t>(y * tile_size + 12)].point.address.object = 9;
    take();
    const auto about = [&](float x) {
        const glm::vec3 place = left_.ray_through({x + 0.5f, 5.7f}).direction;
        GatherPoint there = point_of(left_, {x + 0.5f, 5.7f}, 0);
        there.point.outgoing = -place;
        return at(there);
    };
    EXPECT_EQ(about(12.5f).lit, 1u);
    EXPECT_FLOAT_EQ(about(12.5f).direct.x, 13.0f) << "of the column beside it";
    EXPECT_GT(about(12.5f).error, 0.0f);
    EXPECT_EQ(about(12.1f).lit, 0u) << "nine tenths of it are something else";
    seen_.tiles[0][static_cast<std::size_t>(6 * tile_size + 13)].point.address.object = 9;
    take();
    EXPECT_EQ(about(12.5f).lit, 1u);
    EXPECT_EQ(about(12.5f).error, 0.0f) << "nobody knows how light varies about one pixel";
    eye_.forget();
    EXPECT_EQ(at(p).lit, 0u);
}

TEST_F(OtherEyeTest, TellsNothingWhereItLooksFromAslant) {
    take();
    const GatherPoint p = point_of(right_, {12.3f, 5.7f}, 0);
    EXPECT_NE(eye_.at(p, right_.pixel_extent(4.0f)).light.lit, 0u);
    EXPECT_EQ(eye_.at(p, 0.02f * right_.pixel_extent(4.0f)).light.lit, 0u) << "pixels that are so much larger";
}

}  // namespace
}  // namespace render2mpeg::renderer
