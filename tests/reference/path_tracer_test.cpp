// The path tracer against itself and against closed forms.
#include "tests/reference/path_tracer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/reference/posed_case.h"

namespace render2mpeg::reference {
namespace {

/// Errors of a mean are normal: one in 10,000 is beyond.
constexpr double most_sigmas = 4;

Estimate whole_picture(const TruthCase& c, const PathSettings& settings, std::uint64_t paths, std::uint64_t seed) {
    const Posed posed(c);
    return mean_of(PathTracer(posed.posed_scene).picture(case_side, case_side, settings, paths, seed));
}

std::vector<NamedCase> all_cases() {
    std::vector<NamedCase> all;
    for (const auto& some : {lamp_cases(), material_cases(), specular_cases(), furnace_cases(), indirect_cases()})
        all.insert(all.end(), some.begin(), some.end());
    return all;
}

TruthCase made(const std::string& name) {
    const auto all = all_cases();
    return std::find_if(all.begin(), all.end(), [&](const NamedCase& n) { return n.name == name; })->make();
}

/// Cases whose lamps paths meet often enough.
class PathTracerEstimatorsSlow : public testing::TestWithParam<const char*> {};

TEST_P(PathTracerEstimatorsSlow, Agree) {
    const TruthCase c = made(GetParam());
    PathSettings settings;
    settings.bounces = c.vpls == 0 ? 0 : PathSettings::endless;
    Estimate found[2];
    for (const Finding finding : {Finding::by_chance, Finding::by_connection}) {
        settings.finding = finding;
        // Small lamps are seldom met.
        const std::uint64_t paths = finding == Finding::by_chance && c.vpls == 0 ? 2048 : 512;
        found[static_cast<int>(finding)] = whole_picture(c, settings, paths, 1 + static_cast<std::uint64_t>(finding));
    }
    for (int k = 0; k < 3; ++k) {
        const double error = std::hypot(found[0].error[k], found[1].error[k]);
        EXPECT_NEAR(found[0].mean[k], found[1].mean[k], most_sigmas * error) << k;
        EXPECT_LT(error, 0.02 * found[0].mean[k]);
    }
}
INSTANTIATE_TEST_SUITE_P(Of, PathTracerEstimatorsSlow,
                         testing::Values("SoftSunBlocked", "PanelBlocked", "PanelWithImage", "SphereBlocked", "Cube",
                                         "EvenSkyBlocked", "SkyImageBlocked", "Dielectric05", "Metal03", "NormalMap",
                                         "MirrorsInMirrors", "PaneOfGlass", "MilkyGlass", "Blended", "CutOut",
                                         "Furnace80", "WhiteRoomInAMirror"));

class PathTracerMeans : public testing::TestWithParam<const char*> {};

TEST_P(PathTracerMeans, AreTheClosedForms) {
    const TruthCase c = made(GetParam());
    PathSettings settings;
    settings.bounces = c.vpls == 0 ? 0 : PathSettings::endless;
    settings.finding = c.finding;
    const Estimate found = whole_picture(c, settings, 1024, 3);
    const Posed posed(c);
    const glm::dvec3 expected = closed_form_mean(c, posed.world.camera);
    for (int k = 0; k < 3; ++k) {
        // chosen: 0.002 for tables of lobes and for spheres of triangles.
        EXPECT_NEAR(found.mean[k], expected[k], 0.002 * expected[k] + most_sigmas * found.error[k]) << k;
        EXPECT_LT(found.error[k], 0.005 * expected[k]);
    }
}
INSTANTIATE_TEST_SUITE_P(Of, PathTracerMeans,
                         testing::Values("Point", "SoftSun", "Panel", "EvenSky", "Metal02InFurnace", "Furnace50"));
INSTANTIATE_TEST_SUITE_P(OfSlow, PathTracerMeans,
                         testing::Values("PointWithRange", "Spot", "Directional", "Sphere", "Metal10InFurnace",
                                         "Furnace80", "Furnace95"));

}  // namespace
}  // namespace render2mpeg::reference
