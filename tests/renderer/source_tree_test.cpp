#include "renderer/paths/source_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/sampling.h"
#include "renderer/paths/light_paths.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

/// Sources all about a surface, some behind it, a few distant.
std::vector<SourceExtent> some_sources(std::size_t count) {
    std::vector<SourceExtent> sources;
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto number = [&](std::uint64_t k) { return core::uniform(3, i, k); };
        sources.push_back({{8 * number(0) - 4, 4 * number(1) - 1, 8 * number(2) - 4},
                           0.2f * number(3),
                           0.1 + static_cast<double>(number(4)),
                           i % 50 == 7});
    }
    return sources;
}

/// A source that knows of its own whether it is behind the surface.
class PlainLight final : public Light {
  public:
    explicit PlainLight(const SourceExtent& extent) : extent_(extent) {}
    SourceExtent extent() const override { return extent_; }
    double weight(const LightQuery&) const override {
        return extent_.distant || extent_.centre.y > 0 ? extent_.power : 0.0;
    }
    LightSample sample(const LightQuery&, double, glm::vec2) const override { return {}; }

  private:
    SourceExtent extent_;
};

TEST(SourceTree, ChoosesByTheChancesThatItTells) {
    const LightQuery query{{0, 0, 0}, {0, 0, 0}, {0, 1, 0}};
    for (const std::size_t count : {1u, 32u, 33u, 500u}) {
        Lights lights;
        for (const SourceExtent& source : some_sources(count)) lights.push_back(std::make_unique<PlainLight>(source));
        const SourceTree tree(std::move(lights));
        std::vector<double> taken(count, 0.0), chances;
        double sum = 0;
        for (std::size_t i = 0; i < count; ++i) {
            chances.push_back(tree.chance_of(query, i));
            sum += chances.back();
        }
        // A group all of whose sources are behind takes its share of the numbers, and chooses none.
        EXPECT_LE(sum, 1.0 + 1e-9);
        EXPECT_GT(sum, 0.7);
        constexpr int numbers = 200000;
        for (int k = 0; k < numbers; ++k) {
            const SourceTree::Choice c = tree.choose(query, (k + 0.5) / numbers);
            if (!(c.chance > 0.0)) continue;
            ASSERT_NEAR(c.chance, chances[c.source], 1e-9);
            ASSERT_TRUE(c.left >= 0.0 && c.left < 1.0);
            taken[c.source] += 1.0 / numbers;
        }
        for (std::size_t i = 0; i < count; ++i) EXPECT_NEAR(taken[i], chances[i], 2.0 / numbers + 1e-6) << i;
    }
}

TEST(SourceTree, BringsAllLightOfManyLamps) {
    test::SceneBuilder b;
    b.add_quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, b.add_material(glm::vec3(0.5f)));
    double expected = 0;
    for (const SourceExtent& s : some_sources(200)) {
        const auto strength = static_cast<float>(10 * s.power);
        if (s.distant) {
            b.add_sun({0, -1, 0}, strength);
            expected += static_cast<double>(strength);
            continue;
        }
        b.add_point_light(s.centre, strength);
        if (s.centre.y > 0) {
            const double d2 = glm::dot(s.centre, s.centre);
            expected += static_cast<double>(strength * s.centre.y) / (d2 * std::sqrt(d2));
        }
    }
    const test::Stage stage(b);
    const LightPaths paths(stage.posed_scene(), stage.plan());
    const SurfacePoint p = stage.posed_scene().surface_at({0, 0, 0, 0.5f}, {0, 1, 0});
    double sum = 0;
    constexpr std::uint64_t count = 1u << 16;
    for (std::uint64_t i = 0; i < count; ++i) {
        PathNumbers numbers(Stream(Purpose::true_paths, {.index = 5}), i);
        sum += static_cast<double>(paths.scattered(p, numbers).x);
    }
    EXPECT_NEAR(sum / count / (0.5 / 3.14159265 * expected), 1.0, 0.01);
}

}  // namespace
}  // namespace render2mpeg::renderer
