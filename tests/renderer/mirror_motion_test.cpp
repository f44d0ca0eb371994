#include <gtest/gtest.h>

#include "core/motion_field.h"
#include "scene/pose/motion.h"
#include "stage.h"

namespace render2mpeg::test {
namespace {

/// A block that moves before a mirror at z = 0, or behind an opening in its place where its image would be.
SceneBuilder block_and_mirror(bool mirrored) {
    SceneBuilder b;
    const float side = mirrored ? 1.0f : -1.0f;
    if (mirrored) {
        const int silver = b.add_material({1, 1, 1});
        b.material(silver).metallic = 1;
        b.material(silver).roughness = 0;
        b.add_quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, silver);
    }
    const int block = b.add_object(b.add_mesh(SceneBuilder::box({-1.5f, -1, -0.5f}, {1.5f, 1, 0.5f}, false)),
                                   b.add_material({0.6f, 0.3f, 0.2f}), {0, 0, 0});
    b.move_object(block, {{-0.5f, 0.1f, 2 * side}, {0.4f, 0, 2.6f * side}});
    b.add_quad({-20, -20, 9 * side}, {0, side * 40, 0}, {40, 0, 0}, b.add_material({0.3f, 0.3f, 0.3f}));
    b.add_point_light({0, 3, 4 * side}, 10);
    // From above the block, so that it does not hide its image.
    b.add_camera({0.3f, 6, 5}, {0, 0, -1.2f}, 0.4f);
    return b;
}

TEST(MirrorMotion, IsThatOfTheImage) {
    Stage mirror(block_and_mirror(true)), image(block_and_mirror(false));
    const renderer::Frame a = mirror.see(1), b = image.see(1);
    const scene::Snapshot later_a = snapshot(mirror.film(), 1, 32, 32), later_b = snapshot(image.film(), 1, 32, 32);
    const core::MotionField in_mirror = scene::motion_between(a.visible, mirror.world(), later_a, &a.imaged),
                            in_world = scene::motion_between(b.visible, image.world(), later_b);
    int compared = 0;
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
            if (a.visible.kind.at(x, y) != core::PixelClass::reflected) continue;
            ASSERT_TRUE(a.imaged.at(x, y).is_surface());
            const glm::vec2 off = in_mirror.vector.at(x, y) - in_world.vector.at(x, y);
            EXPECT_LT(glm::length(off), 1e-3f) << x << " " << y;
            compared += glm::length(in_world.vector.at(x, y)) > 1 ? 1 : 0;
        }
    EXPECT_GT(compared, 50);
}

TEST(MirrorMotion, OfBentMirrorsIsTheSurfaces) {
    SceneBuilder b = block_and_mirror(true);
    b.film().objects.erase(b.film().objects.begin());
    b.add_sphere({0, 0, -1}, 1.5f, 0);
    Stage stage(b);
    const renderer::Frame seen = stage.see(1);
    for (const core::SurfaceAddress& imaged : seen.imaged.values()) EXPECT_FALSE(imaged.is_surface());
}

}  // namespace
}  // namespace render2mpeg::test
