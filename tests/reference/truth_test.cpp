// The renderer without tolerance (every light point, no cut), and its own paths, against the path tracer and against
// closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ostream>

#include "core/color.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "tests/reference/posed_case.h"
#include "tests/renderer/film_stage.h"

namespace render2mpeg::reference {

void PrintTo(const NamedCase& named, std::ostream* to) {
    *to << named.name;
}

namespace {

constexpr int side = case_side, patch_side = 4, patches_across = side / patch_side;

/// Errors of a mean are normal, and a picture has 16 patches of three channels: one in 500 pictures has one beyond.
constexpr double sigmas = 4.5;

/// Multiplies the paths and prints rows of docs/measurements.md#closed-forms-and-paths, where RENDER2MPEG_TRUTH_PATHS
/// says so; 0: no.
int wanted_paths() {
    const char* text = std::getenv("RENDER2MPEG_TRUTH_PATHS");
    return text == nullptr ? 0 : std::max(1, std::atoi(text));
}

renderer::Settings settings_of(const TruthCase& c, renderer::Indirect indirect) {
    renderer::Settings s;
    s.format = {side, side, 1.0f};
    s.samples = 1;
    s.direct_points = c.direct_points;
    s.indirect = indirect;
    s.vpls = c.vpls;
    s.specular_depth = c.specular_depth;
    s.isa = core::detect_isa();
    return s;
}

PathSettings paths_of(const TruthCase& c, bool all_bounces) {
    PathSettings s;
    s.finding = c.finding;
    if (c.vpls == 0 && !all_bounces) s.bounces = 0;
    s.caustics = c.caustics;
    return s;
}

/// Of size x size pixels.
template <class Pixel>
Estimate mean_of_patch(const Pixel& pixel, int x0, int y0, int size) {
    std::vector<Estimate> pixels;
    for (int y = y0; y < y0 + size; ++y)
        for (int x = x0; x < x0 + size; ++x) pixels.push_back(pixel(x, y));
    return mean_of(pixels);
}

/// Errors as shares of the picture's brightness there, as luminance.
struct Found {
    double whole = 0, whole_error = 0;  ///< of the picture's mean; its standard error
    double patch = 0, patch_error = 0;  ///< of the patch that is off most
    double closed_whole = 0, closed_pixel = 0;
};

double luminance(glm::dvec3 v) {
    return core::luminance(glm::vec3(v));
}

/// Holds a picture's mean and its patches against the path tracer's.
void compare_patches(const core::Radiance& ours, const std::vector<Estimate>& truth, Allowed allowed, Found& found) {
    const auto our_pixel = [&](int x, int y) { return Estimate{glm::dvec3(ours.combined.at(x, y)), {}}; };
    const auto true_pixel = [&](int x, int y) { return truth[static_cast<std::size_t>(y * side + x)]; };
    const Estimate whole = mean_of_patch(true_pixel, 0, 0, side), our_whole = mean_of_patch(our_pixel, 0, 0, side);
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(our_whole.mean[k], whole.mean[k], allowed.whole * whole.mean[k] + sigmas * whole.error[k]) << k;
    found.whole = luminance(our_whole.mean) / luminance(whole.mean) - 1;
    found.whole_error = luminance(whole.error) / luminance(whole.mean);
    for (int j = 0; j < patches_across; ++j)
        for (int i = 0; i < patches_across; ++i) {
            const int x = i * patch_side, y = j * patch_side;
            const Estimate t = mean_of_patch(true_pixel, x, y, patch_side),
                           o = mean_of_patch(our_pixel, x, y, patch_side);
            for (int k = 0; k < 3; ++k) {
                // In shadow a hundredth of the picture's light counts as nothing.
                const double off = allowed.patch * (t.mean[k] + 0.05 * whole.mean[k]) + sigmas * t.error[k];
                EXPECT_NEAR(o.mean[k], t.mean[k], off) << "patch at " << x << " " << y << ", channel " << k;
            }
            const double base = luminance(t.mean) + 0.05 * luminance(whole.mean);
            const double error = luminance(o.mean - t.mean) / base;
            if (std::abs(error) <= std::abs(found.patch)) continue;
            found.patch = error;
            found.patch_error = luminance(t.error) / base;
        }
}

void compare_closed_form(const core::Radiance& ours, const scene::Camera& camera, const TruthCase& c, Found& found) {
    double sum = 0, truths = 0;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const glm::dvec3 truth = closed_form_of(c, camera, x, y);
            const glm::dvec3 our = ours.combined.at(x, y);
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(our[k], truth[k], c.closed_form_pixel * truth[k] + 1e-6) << x << " " << y << " " << k;
            sum += luminance(our);
            truths += luminance(truth);
            const double error = luminance(our - truth) / luminance(truth);
            if (std::abs(error) > std::abs(found.closed_pixel)) found.closed_pixel = error;
        }
    found.closed_whole = sum / truths - 1;
}

void print_row(const NamedCase& named, const TruthCase& c, const Found& f, std::uint64_t paths) {
    const auto percent = [](double share) { return 100 * share; };
    std::printf("| %s | ", named.name);
    if (c.closed_form)
        std::printf("%+.3f | %+.3f | ", percent(f.closed_whole), percent(f.closed_pixel));
    else
        std::printf("| | ");
    std::printf("%+.2f +- %.2f | %+.2f +- %.2f | %llu |\n", percent(f.whole), percent(f.whole_error), percent(f.patch),
                percent(f.patch_error), static_cast<unsigned long long>(paths));
}

/// So that no two cases share their random numbers.
std::uint64_t seed_of(const std::string& name) {
    std::uint64_t seed = 0;
    for (const char c : name) seed = core::mix(seed ^ static_cast<unsigned char>(c));
    return seed;
}

void judge(const NamedCase& named) {
    const TruthCase c = named.make();
    const std::uint64_t paths = c.paths * static_cast<std::uint64_t>(std::max(1, wanted_paths()));
    const Posed posed(c);
    const std::vector<Estimate> truth =
        PathTracer(posed.posed_scene).picture(side, side, paths_of(c, false), paths, seed_of(named.name));
    for (const renderer::Indirect indirect : {renderer::Indirect::rays, renderer::Indirect::lightcuts}) {
        if (indirect == renderer::Indirect::lightcuts && c.vpls == 0) continue;
        SCOPED_TRACE(indirect == renderer::Indirect::rays ? "by rays" : "by light points");
        test::FilmStage stage(c.scene, settings_of(c, indirect), c.caustics);
        const core::Radiance ours = stage.reference();
        Found found;
        compare_patches(ours, truth, c.allowed, found);
        if (c.closed_form) compare_closed_form(ours, posed.world.camera, c, found);
        if (wanted_paths() > 0) print_row(named, c, found, paths * side * side);
    }
}

/// The path tracer's picture of pixels, not of their centres: four times by rays through a place in each of 4 x 4 parts
/// of a pixel. What they differ by tells the error, that of an edge as well.
std::vector<Estimate> whole_pixels(const Posed& posed, const TruthCase& c, std::uint64_t seed) {
    constexpr int across = 4, parts = across * across, pictures = 4;
    const std::uint64_t paths = std::max<std::uint64_t>(c.paths / (parts * pictures), 4);
    const PathTracer tracer(posed.posed_scene);
    std::vector<Estimate> pixels(std::size_t{side} * side);
    parallel::for_each(pixels.size(), [&](std::size_t i) {
        const int x = static_cast<int>(i) % side, y = static_cast<int>(i) / side;
        glm::dvec3 sum(0), squares(0);
        for (std::uint64_t picture = 0; picture < pictures; ++picture) {
            glm::dvec3 mean(0);
            for (int k = 0; k < parts; ++k) {
                const std::uint64_t number = core::mix(seed) + (i * pictures + picture) * parts + std::uint64_t(k);
                const glm::vec2 place(
                    static_cast<float>(x) + (static_cast<float>(k % across) + core::uniform(number, 0, 0)) / across,
                    static_cast<float>(y) + (static_cast<float>(k / across) + core::uniform(number, 0, 1)) / across);
                const scene::Ray ray = posed.world.camera.ray_through(place);
                mean +=
                    tracer.radiance(ray.origin, ray.direction, paths_of(c, true), paths, number).mean / (1.0 * parts);
            }
            sum += mean;
            squares += mean * mean;
        }
        const glm::dvec3 mean = sum / (1.0 * pictures);
        const glm::dvec3 variance = glm::max(squares / (1.0 * pictures) - mean * mean, 0.0) / (pictures - 1.0);
        pixels[i] = {mean, glm::sqrt(variance)};
    });
    return pixels;
}

/// The picture by paths alone.
void judge_paths(const NamedCase& named) {
    const TruthCase c = named.make();
    const Posed posed(c);
    test::FilmStage stage(c.scene, settings_of(c, renderer::Indirect::rays), c.caustics);
    const scene::Snapshot world = stage.at(0);
    const core::ToleranceMap none = core::ToleranceMap::reference();
    const renderer::LightOrder by_paths{none, renderer::LightingMode::truth, {}, nullptr, {0.03f, 1u << 14}};
    const core::Radiance ours = stage.renderer().light(world, stage.renderer().look(world), by_paths).radiance;
    Found found;
    const Allowed allowed{std::max(c.allowed.whole, 0.01), std::max(c.allowed.patch, 0.03)};
    compare_patches(ours, whole_pixels(posed, c, seed_of(named.name)), allowed, found);
}

std::string name_of(const testing::TestParamInfo<NamedCase>& info) {
    return info.param.name;
}

class LampsTruthSlow : public testing::TestWithParam<NamedCase> {};
TEST_P(LampsTruthSlow, IsThePathTracers) {
    judge(GetParam());
}
INSTANTIATE_TEST_SUITE_P(All, LampsTruthSlow, testing::ValuesIn(lamp_cases()), name_of);

class MaterialsTruthSlow : public testing::TestWithParam<NamedCase> {};
TEST_P(MaterialsTruthSlow, IsThePathTracers) {
    judge(GetParam());
}
INSTANTIATE_TEST_SUITE_P(All, MaterialsTruthSlow, testing::ValuesIn(material_cases()), name_of);

class MirrorsAndGlassTruthSlow : public testing::TestWithParam<NamedCase> {};
TEST_P(MirrorsAndGlassTruthSlow, IsThePathTracers) {
    judge(GetParam());
}
INSTANTIATE_TEST_SUITE_P(All, MirrorsAndGlassTruthSlow, testing::ValuesIn(specular_cases()), name_of);

class FurnacesTruthSlow : public testing::TestWithParam<NamedCase> {};
TEST_P(FurnacesTruthSlow, IsThePathTracers) {
    judge(GetParam());
}
INSTANTIATE_TEST_SUITE_P(All, FurnacesTruthSlow, testing::ValuesIn(furnace_cases()), name_of);

class IndirectTruthSlow : public testing::TestWithParam<NamedCase> {};
TEST_P(IndirectTruthSlow, IsThePathTracers) {
    judge(GetParam());
}
INSTANTIATE_TEST_SUITE_P(All, IndirectTruthSlow, testing::ValuesIn(indirect_cases()), name_of);

class OwnPathsTruthSlow : public testing::TestWithParam<NamedCase> {};
TEST_P(OwnPathsTruthSlow, IsThePathTracers) {
    judge_paths(GetParam());
}
INSTANTIATE_TEST_SUITE_P(Lamps, OwnPathsTruthSlow, testing::ValuesIn(lamp_cases()), name_of);
INSTANTIATE_TEST_SUITE_P(Materials, OwnPathsTruthSlow, testing::ValuesIn(material_cases()), name_of);
INSTANTIATE_TEST_SUITE_P(Furnaces, OwnPathsTruthSlow, testing::ValuesIn(furnace_cases()), name_of);
INSTANTIATE_TEST_SUITE_P(Indirect, OwnPathsTruthSlow, testing::ValuesIn(indirect_cases()), name_of);

}  // namespace
}  // namespace render2mpeg::reference
