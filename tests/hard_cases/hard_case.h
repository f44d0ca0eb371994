#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/picture.h"
#include "core/radiance.h"
#include "renderer/renderer.h"
#include "tests/support/scene_builder.h"

/// Scenes in which careless arithmetic fails, each with the outcome that is right. What every case must fulfil whatever
/// it is about stands in hard_cases_test.cpp; the page hard-cases.md of the build is written from these lists.
namespace render2mpeg::test {

/// How light is gathered: by all light points, or cuts of them; by rays and records to 2 %, or as far as the coding
/// shows, as films are made by default.
enum class Way { reference, lightcuts, records, coupled };
inline constexpr Way all_ways[] = {Way::reference, Way::lightcuts, Way::records, Way::coupled};
const char* name_of(Way way);

template <class T>
bool same_values(const core::Plane<T>& a, const core::Plane<T>& b) {
    return std::ranges::equal(a.values(), b.values());
}

/// A case's film, lit in one way and coded.
struct Lit {
    Way way = Way::reference;
    std::vector<core::Radiance> frames;
    std::vector<core::Picture> decoded;  ///< by libavcodec
    std::size_t bytes = 0;
    renderer::Statistics statistics;
    std::vector<std::string> notes;  ///< of the scene

    glm::vec3 at(int x, int y, std::size_t frame = 0) const { return frames.at(frame).combined.at(x, y); }
    /// Luminance, mean over a frame; largest channel of all frames.
    double mean(std::size_t frame = 0) const;
    float brightest() const;
};

struct HardCase {
    std::string name;
    std::string breaks;   ///< what goes wrong where nobody took care
    std::string outcome;  ///< what is right
    std::function<SceneBuilder()> scene;
    std::function<void(const Lit&)> check = nullptr;           ///< beyond what holds for every case; may be empty
    float brightest = std::numeric_limits<float>::infinity();  ///< radiance that physics allows at most, any channel
    std::string refused = {};  ///< a part of the line with which the scene is refused; empty: it is not
    glm::ivec2 size{32, 32};
    int frames = 3;
    bool default_light = false;  ///< a scene without light is given one, as when it is loaded
};

/// For cases of which no single pixel is asked.
inline HardCase of_side(HardCase hard_case, int side) {
    hard_case.size = glm::ivec2(side);
    return hard_case;
}

std::vector<HardCase> light_cases();
std::vector<HardCase> surface_cases();
std::vector<HardCase> material_cases();
std::vector<HardCase> motion_cases();
std::vector<HardCase> view_cases();
std::vector<HardCase> exposure_cases();
std::vector<HardCase> air_cases();

/// Frames 0 to count - 1, one per second, of `scene` as `hard_case` wants it.
Lit lit(const HardCase& hard_case, const SceneBuilder& scene, Way way);

/// Mean luminance of a case's first frame beside that of another scene lit the same way.
void expect_like(const Lit& film, const SceneBuilder& other, double tolerance);

/// A floor of reflectance `albedo`, seen from straight above from `height` over it.
SceneBuilder floor_from_above(float height = 2, float albedo = 0.5f);

/// A closed white room of 4 x 3 x 4 with a lamp in its ceiling and a block on its floor.
SceneBuilder small_room(float radiance = 10);

}  // namespace render2mpeg::test
