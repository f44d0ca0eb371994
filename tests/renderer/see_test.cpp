#include "renderer/view/see.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "stage.h"

namespace render2mpeg::test {
namespace {

using core::PixelClass;
using renderer::Frame;
using renderer::GatherPoint;
using renderer::tile_size;

/// A gather point with the pixel of the picture that it belongs to.
struct Placed {
    int x, y;
    const GatherPoint* point;
};

std::vector<Placed> points_of(const Frame& seen) {
    std::vector<Placed> all;
    for (std::size_t t = 0; t < seen.tiles.size(); ++t) {
        const int x0 = static_cast<int>(t) % seen.tiles_across() * tile_size;
        const int y0 = static_cast<int>(t) / seen.tiles_across() * tile_size;
        for (const GatherPoint& g : seen.tiles[t])
            all.push_back({x0 + g.pixel % tile_size, y0 + g.pixel / tile_size, &g});
    }
    return all;
}

TEST(SamplePattern, BeginsAtTheCentreAndBalancesAboutIt) {
    for (const int n : {1, 2, 3, 4, 5, 8, 16, 64}) {
        const auto pattern = renderer::sample_pattern(n);
        ASSERT_EQ(pattern.size(), static_cast<std::size_t>(n));
        EXPECT_EQ(pattern[0], (glm::vec2{0.5f, 0.5f}));
        glm::dvec2 sum{0, 0};
        for (const glm::vec2 p : pattern) {
            sum += p;
            EXPECT_GT(std::min(p.x, p.y), -0.2f);
            EXPECT_LT(std::max(p.x, p.y), 1.2f);
        }
        if (n > 2) {
            EXPECT_NEAR(sum.x / n, 0.5, 1e-6);
            EXPECT_NEAR(sum.y / n, 0.5, 1e-6);
        }
        for (std::size_t i = 0; i < pattern.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                EXPECT_GT(glm::distance(pattern[i], pattern[j]), 0.35f / std::sqrt(static_cast<float>(n)));
    }
}

TEST(Seeing, APlaneGivesItsDepthAndNormalInClosedForm) {
    // An oblique plane through (0, 0, -6).
    const glm::vec3 normal = glm::normalize(glm::vec3{0.3f, 0.5f, 1.0f});
    glm::vec3 u, v;
    core::make_frame(normal, u, v);
    SceneBuilder builder;
    const glm::vec3 middle{0, 0, -6};
    builder.add_quad(middle - 40.0f * u - 40.0f * v, 80.0f * u, 80.0f * v, builder.add_material());
    builder.add_camera({0, 0, 0}, {0, 0, -1}, 0.8f);
    Stage stage(builder, 37, 21);
    const Frame seen = stage.see(4);
    for (int y = 0; y < 21; ++y) {
        for (int x = 0; x < 37; ++x) {
            const scene::Ray ray =
                stage.world().camera.ray_through({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
            const glm::vec3 hit =
                ray.origin + glm::dot(middle - ray.origin, normal) / glm::dot(ray.direction, normal) * ray.direction;
            ASSERT_EQ(seen.visible.kind.at(x, y), PixelClass::surface);
            EXPECT_NEAR(seen.visible.depth.at(x, y), -hit.z, 2e-5f * -hit.z);
            EXPECT_LT(glm::distance(seen.visible.geometric_normal.at(x, y).unpack(), normal), 1e-4f);
            EXPECT_LT(glm::distance(seen.visible.shading_normal.at(x, y).unpack(), normal), 1e-4f);
            const auto carried = scene::carry(seen.visible.address.at(x, y), stage.world());
            ASSERT_TRUE(carried);
            EXPECT_LT(glm::distance(*carried, hit), 1e-4f);
        }
    }
    // A wall that fills a pixel is one gather point of weight 1 in it.
    const auto points = points_of(seen);
    ASSERT_EQ(points.size(), 37u * 21u);
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(points[i].point->weight.x, 1.0f, 1e-6f);
}

TEST(Seeing, ASphereGivesItsDepthAndNormalInClosedForm) {
    SceneBuilder builder;
    builder.add_sphere({0.2f, -0.1f, -5}, 1.5f, builder.add_material(), 200);
    builder.add_camera({0, 0, 0}, {0, 0, -1}, 0.8f);
    Stage stage(builder, 48, 48);
    const Frame seen = stage.see(1);
    int inside = 0;
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 48; ++x) {
            const glm::vec3 d = stage.world()
                                    .camera.ray_through({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f})
                                    .direction;
            const glm::vec3 c{0.2f, -0.1f, -5};
            const float b = glm::dot(d, c), root = b * b - glm::dot(c, c) + 1.5f * 1.5f;
            if (std::abs(root) < 0.02f) continue;  // the silhouette of a polyhedron
            ASSERT_EQ(seen.visible.kind.at(x, y) == PixelClass::surface, root > 0);
            if (root <= 0) {
                EXPECT_EQ(seen.visible.depth.at(x, y), std::numeric_limits<float>::infinity());
                continue;
            }
            ++inside;
            const glm::vec3 hit = (b - std::sqrt(root)) * d;
            EXPECT_NEAR(seen.visible.depth.at(x, y), -hit.z, 2e-3f);
            EXPECT_LT(glm::distance(seen.visible.shading_normal.at(x, y).unpack(), (hit - c) / 1.5f), 3e-3f);
        }
    }
    EXPECT_GT(inside, 600);
}

TEST(Edges, WeighTheirSurfacesByCoveredArea) {
    // A sheet with an oblique edge before a wall; the edge crosses the picture, its covered area per pixel is known by
    // counting.
    for (const int samples : {4, 16}) {
        SceneBuilder builder;
        const int white = builder.add_material();
        builder.add_quad({-20, -20, -10}, {40, 0, 0}, {0, 40, 0}, white);
        const int sheet = builder.add_quad({0, -8, -5}, {8, 0, 0}, {2.4f, 16, 0}, white);
        builder.add_camera({0, 0, 0}, {0, 0, -1}, 0.8f);
        Stage stage(builder, 48, 48);
        const Frame seen = stage.see(samples);

        std::map<std::pair<int, int>, float> sums, covered;
        for (const Placed& p : points_of(seen)) {
            sums[{p.x, p.y}] += p.point->weight.x;
            if (p.point->point.address.object == static_cast<std::uint32_t>(sheet))
                covered[{p.x, p.y}] += p.point->weight.x;
        }
        double squares = 0, difference = 0;
        int edge_pixels = 0;
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 48; ++x) {
                EXPECT_NEAR((sums[{x, y}]), 1.0f, 1e-5f);
                int within = 0;
                constexpr int fine = 32;
                for (int i = 0; i < fine * fine; ++i) {
                    const glm::vec2 at{static_cast<float>(x) + (static_cast<float>(i % fine) + 0.5f) / fine,
                                       static_cast<float>(y) + (static_cast<float>(i / fine) + 0.5f) / fine};
                    const glm::vec3 d = stage.world().camera.ray_through(at).direction;
                    const glm::vec3 p = 5.0f / -d.z * d;
                    within += p.x > 0.15f * (p.y + 8);
                }
                const double area = static_cast<double>(within) / (fine * fine);
                if (within == 0 || within == fine * fine) {
                    EXPECT_NEAR((covered[{x, y}]), area, 1e-5) << x << " " << y;
                    continue;
                }
                ++edge_pixels;
                const double error = covered[{x, y}] - area;
                squares += error * error;
                difference += error;
            }
        }
        ASSERT_GT(edge_pixels, 40);
        // A straight edge cuts one cell of samples in a row of sqrt(n): the error per pixel is about half a sample.
        EXPECT_LT(std::sqrt(squares / edge_pixels), 0.6 / samples * std::sqrt(static_cast<double>(samples)) / 1.5);
        EXPECT_NEAR(difference / edge_pixels, 0.0, 0.03);
    }
}

/// Share of each pixel that an object covers, and how many primary rays that took.
std::vector<float> coverage(Stage& stage, std::uint32_t object, int samples, int edge_samples, int width, int height,
                            std::uint64_t& rays) {
    const std::uint64_t before = stage.counts().primary_rays;
    const Frame seen = stage.see(samples, 6, edge_samples);
    rays = stage.counts().primary_rays - before;
    std::vector<float> covered(static_cast<std::size_t>(width * height), 0.0f);
    for (const Placed& p : points_of(seen))
        if (p.point->point.address.object == object)
            covered[static_cast<std::size_t>(p.y * width + p.x)] += p.point->weight.x;
    return covered;
}

TEST(Seeing, PixelsAtEdgesGetMoreSamples) {
    // A slanted half plane before a wall, in an orthogonal view of 48 x 48 pixels: what it covers is known.
    constexpr int size = 48;
    SceneBuilder builder;
    const float half = std::tan(0.4f) * 10.0f;
    builder.add_quad({-30, -30, -20}, {60, 0, 0}, {0, 60, 0}, builder.add_material());
    builder.add_quad({-30.0f, -30.0f, -10.0f}, {30, 0, 0}, {9.0f, 60, 0}, builder.add_material());
    builder.add_camera({0, 0, 0}, {0, 0, -1}, 0.8f);
    Stage stage(builder, size, size);
    const auto truth = [&](int x, int y) {
        // x of the edge: 0.15 y + 4.5 - 0 at y = 0, in scene units at the quad's depth.
        double inside = 0;
        constexpr int fine = 64;
        for (int i = 0; i < fine; ++i)
            for (int j = 0; j < fine; ++j) {
                const double px = ((x + (i + 0.5) / fine) / size * 2 - 1) * half,
                             py = (1 - (y + (j + 0.5) / fine) / size * 2) * half;
                inside += px < (py + 30) * 0.15 ? 1 : 0;
            }
        return inside / (fine * fine);
    };
    std::uint64_t rays[3];
    double worst[3];
    const int more[3] = {0, 16, 64};
    for (int k = 0; k < 3; ++k) {
        const std::vector<float> covered = coverage(stage, 1, 4, more[k], size, size, rays[k]);
        worst[k] = 0;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                worst[k] = std::max(
                    worst[k],
                    std::abs(static_cast<double>(covered[static_cast<std::size_t>(y * size + x)]) - truth(x, y)));
    }
    EXPECT_EQ(rays[0], 4u * size * size);
    EXPECT_GT(worst[0], 0.2);
    EXPECT_LT(worst[1], 0.1);
    EXPECT_LT(worst[2], 0.04);
    // At most two pixels of a row and one more where the edge steps.
    EXPECT_LE(rays[2], rays[0] + 3u * 64u * size);
}

TEST(Seeing, TheBorderOfASurfaceIsAnEdge) {
    SceneBuilder builder;
    builder.add_quad({-30, -30, -10}, {30, 0, 0}, {0, 60, 0}, builder.add_material());
    builder.add_camera({0, 0, 0}, {0, 0, -1}, 0.8f);
    Stage flat(builder, 32, 32);
    const std::uint64_t before = flat.counts().primary_rays;
    flat.see(4, 6, 64);
    const std::uint64_t rays = flat.counts().primary_rays - before;
    // Its edge against nothing lies between two columns: no more than two of them.
    EXPECT_GT(rays, 4u * 32 * 32);
    EXPECT_LE(rays, 4u * 32 * 32 + 2u * 64u * 32);
}

TEST(Seeing, AFlatWallSeenAtAGrazingAngleHasNoEdges) {
    SceneBuilder builder;
    builder.add_quad({-500, -1, 10}, {1000, 0, 0}, {0, 0, -3000}, builder.add_material());
    builder.add_quad({-500, -1, -2990}, {1000, 0, 0}, {0, 3000, 0}, builder.add_material());
    builder.add_camera({0, 0, 0}, {0.0f, -0.3f, -1}, 0.5f);
    Stage stage(builder, 64, 64);
    const std::uint64_t before = stage.counts().primary_rays;
    stage.see(4, 6, 64);
    EXPECT_EQ(stage.counts().primary_rays - before, 4u * 64 * 64);
}

TEST(Seeing, IsTheSameForAnyNumberOfThreadsAndForStillFrames) {
    SceneBuilder builder;
    const int mirror = builder.add_material({0.9f, 0.9f, 0.9f});
    builder.material(mirror).metallic = 1;
    builder.material(mirror).roughness = 0;
    const int veil = builder.add_material();
    builder.material(veil).alpha_mode = scene::AlphaMode::blend;
    builder.material(veil).base_color.a = 0.3f;
    builder.add_sphere({-1, 0, -6}, 1, mirror);
    builder.add_sphere({1, 0, -5}, 1, veil);
    builder.add_quad({-9, -1, 2}, {18, 0, 0}, {0, 0, -18}, builder.add_material());
    builder.film().sky.color = {0.2f, 0.3f, 0.5f};
    builder.add_camera({0, 0.4f, 0}, {0, 0, -5});
    Stage stage(builder, 70, 50);
    const auto look = [&](int threads, int second) {
        const parallel::ThreadLimit limit(threads);
        stage.pose(second);
        return stage.see(4);
    };
    const Frame one = look(1, 0), two = look(2, 0), later = look(2, 3);
    EXPECT_GT(stage.counts().specular_rays, 100u);
    for (const Frame* other : {&two, &later}) {
        EXPECT_EQ(one.emitted, other->emitted);
        EXPECT_EQ(one.emitted_specular, other->emitted_specular);
        EXPECT_EQ(one.visible.address, other->visible.address);
        EXPECT_EQ(one.visible.depth, other->visible.depth);
        EXPECT_EQ(one.visible.shading_normal, other->visible.shading_normal);
        const auto a = points_of(one), b = points_of(*other);
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t i = 0; i < a.size(); ++i) {
            EXPECT_EQ(a[i].point->weight, b[i].point->weight);
            EXPECT_EQ(a[i].point->point.position, b[i].point->point.position);
            EXPECT_EQ(a[i].point->point.bsdf.diffuse, b[i].point->point.bsdf.diffuse);
        }
    }
}

TEST(Seeing, WorksForPicturesOfAnySize) {
    SceneBuilder builder;
    builder.add_quad({-50, -50, -5}, {100, 0, 0}, {0, 100, 0}, builder.add_material());
    builder.add_camera({0, 0, 0}, {0, 0, -1});
    for (const auto& [width, height] : {std::pair{1, 1}, {16, 16}, {17, 1}, {3, 33}}) {
        Stage stage(builder, width, height);
        const Frame seen = stage.see(2);
        EXPECT_EQ(seen.tiles.size(), static_cast<std::size_t>((width + 15) / 16 * ((height + 15) / 16)));
        std::map<std::pair<int, int>, int> points;
        for (const Placed& p : points_of(seen)) ++points[{p.x, p.y}];
        EXPECT_EQ(points.size(), static_cast<std::size_t>(width * height));
        EXPECT_EQ(points.rbegin()->first, (std::pair{width - 1, height - 1}));
    }
}

TEST(Seeing, NothingAtAllIsSky) {
    SceneBuilder builder;
    builder.film().sky.color = {1, 2, 3};
    builder.add_camera({0, 0, 0}, {0, 0, -1});
    Stage stage(builder, 20, 20);
    const Frame seen = stage.see(4);
    EXPECT_TRUE(points_of(seen).empty());
    for (const PixelClass kind : seen.visible.kind.values()) EXPECT_EQ(kind, PixelClass::sky);
    for (const glm::vec3 light : seen.emitted.values()) EXPECT_EQ(light, (glm::vec3{1, 2, 3}));
}

TEST(Seeing, FromInsideAnObjectShowsItsInsideFaces) {
    SceneBuilder builder;
    builder.add_box({-1, -1, -1}, {1, 1, 1}, builder.add_material());  // faces point outwards
    builder.add_camera({0.2f, 0.1f, 0}, {0, 0, -1});
    Stage stage(builder, 16, 16);
    const Frame seen = stage.see(1);
    const auto points = points_of(seen);
    ASSERT_EQ(points.size(), 256u);
    for (const Placed& p : points) {
        EXPECT_TRUE(p.point->point.back_side);
        EXPECT_GT(glm::dot(p.point->point.shading_normal, p.point->point.outgoing), 0.0f);
    }
}

TEST(Seeing, BeginsAtTheNearPlaneAndEndsAtTheFarOne) {
    SceneBuilder builder;
    const int white = builder.add_material();
    for (const float z : {-1.0f, -3.0f, -9.0f}) builder.add_quad({-50, -50, z}, {100, 0, 0}, {0, 100, 0}, white);
    scene::CameraLens lens;
    lens.near = 2.0f;
    builder.add_camera(lens, {0, 0, 0}, {0, 0, -1});
    Stage stage(builder, 16, 16);
    const Frame seen = stage.see(1);
    for (const float depth : seen.visible.depth.values()) EXPECT_NEAR(depth, 3.0f, 1e-5f);

    builder.film().cameras[0].near = 4.0f;
    builder.film().cameras[0].far = 8.0f;
    Stage beyond(builder, 16, 16);
    const Frame nothing = beyond.see(1);
    for (const PixelClass kind : nothing.visible.kind.values()) EXPECT_EQ(kind, PixelClass::sky);
}

}  // namespace
}  // namespace render2mpeg::test
