#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "core/color.h"
#include "core/sampling.h"
#include "renderer/base/lobe.h"
#include "renderer/gather/surface_cache.h"
#include "renderer/geometry/strands.h"
#include "renderer/paths/light_paths.h"
#include "renderer/surface/hair_scattering.h"
#include "scene/model/curves.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/stage.h"
#include "tests/support/statistics.h"

/// Fibres of hair and strands as a shape.
namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;
using test::Stage;

constexpr double two_pi = 2 * std::numbers::pi;

scene::Hair fibre(float roughness, float azimuthal, glm::vec3 absorption = {0.2f, 0.5f, 1.0f}) {
    scene::Hair hair;
    hair.absorption = absorption;
    hair.roughness = roughness;
    hair.azimuthal_roughness = azimuthal;
    return hair;
}

glm::vec3 even_direction(int i, int n) {
    const double z = 1 - 2 * (i + 0.5) / n, turn = two_pi * i * 0.6180339887498949, s = std::sqrt(1 - z * z);
    return glm::vec3(glm::dvec3(s * std::cos(turn), s * std::sin(turn), z));
}

const glm::vec3 along = glm::normalize(glm::vec3(0.3f, 1, 0.2f)),
                hair_seen_from = glm::normalize(glm::vec3(1, 0.4f, 0.5f));

/// Slow and plain: angles by trigonometry, Bessel's function from the library, [Chiang2016]'s own arrangement.
glm::dvec3 reference(const scene::Hair& hair, double h, glm::dvec3 tangent, glm::dvec3 out, glm::dvec3 in) {
    const double theta_o = std::asin(glm::dot(out, tangent)), theta_i = std::asin(glm::dot(in, tangent));
    const glm::dvec3 a = glm::normalize(out - glm::dot(out, tangent) * tangent), b = glm::cross(tangent, a);
    const double phi = std::atan2(glm::dot(in, b), glm::dot(in, a));
    const double eta = static_cast<double>(hair.ior), theta_t = std::asin(std::sin(theta_o) / eta);
    const double eta_across = std::sqrt(eta * eta - std::pow(std::sin(theta_o), 2)) / std::cos(theta_o);
    const double gamma_o = std::asin(h), gamma_t = std::asin(h / eta_across);
    const double ci = std::cos(theta_o) * std::cos(gamma_o), ct = std::sqrt(1 - (1 - ci * ci) / (eta * eta));
    const double f =
        0.5 * (std::pow((eta * ci - ct) / (eta * ci + ct), 2) + std::pow((ci - eta * ct) / (ci + eta * ct), 2));
    const glm::dvec3 t = glm::exp(-glm::dvec3(hair.absorption) * (2 * std::cos(gamma_t) / std::cos(theta_t)));
    const glm::dvec3 ap[4] = {glm::dvec3(f), (1 - f) * (1 - f) * t, (1 - f) * (1 - f) * f * t * t,
                              (1 - f) * (1 - f) * f * f * t * t * t / (1.0 - f * t)};
    const double bm = static_cast<double>(hair.roughness), bn = static_cast<double>(hair.azimuthal_roughness);
    const double v = std::pow(0.726 * bm + 0.812 * bm * bm + 3.7 * std::pow(bm, 20), 2);
    const double s = std::sqrt(std::numbers::pi / 8) * (0.265 * bn + 1.194 * bn * bn + 5.372 * std::pow(bn, 22));
    const double vs[4] = {v, 0.25 * v, 4 * v, 4 * v};
    const double tilt = static_cast<double>(hair.tilt), tilts[4] = {2 * tilt, -tilt, -4 * tilt, 0};
    glm::dvec3 sum(0);
    for (int p = 0; p < 4; ++p) {
        const double th = theta_o + tilts[p];
        const double m = std::exp(-std::sin(theta_i) * std::sin(th) / vs[p]) *
                         std::cyl_bessel_i(0.0, std::abs(std::cos(theta_i) * std::cos(th)) / vs[p]) /
                         (2 * vs[p] * std::sinh(1 / vs[p]));
        double n = 1 / two_pi;
        if (p < 3) {
            const double x = std::remainder(phi - (2 * p * gamma_t - 2 * gamma_o + p * std::numbers::pi), two_pi);
            const auto cdf = [&](double y) { return 1 / (1 + std::exp(-y / s)); };
            n = std::exp(-std::abs(x) / s) / (s * std::pow(1 + std::exp(-std::abs(x) / s), 2)) /
                (cdf(std::numbers::pi) - cdf(-std::numbers::pi));
        }
        sum += m * n * ap[p];
    }
    return sum;
}

TEST(HairScattering, AgreesWithASlowReferenceInDoublePrecision) {
    double worst = 0;
    for (const float roughness : {0.15f, 0.3f, 0.8f})
        for (const float h : {-0.9f, -0.2f, 0.5f}) {
            scene::Hair hair = fibre(roughness, 0.4f);
            hair.tilt = 0.1f;
            const HairScattering fast(hair, {glm::vec3(0), along, 0.01f, -h}, hair_seen_from);
            double most = 0, off = 0;
            for (int i = 0; i < 500; ++i) {
                const glm::vec3 in = even_direction(i, 500);
                const glm::dvec3 slow = reference(hair, static_cast<double>(h), glm::dvec3(along),
                                                  glm::dvec3(hair_seen_from), glm::dvec3(in));
                most = std::max(most, slow.x);
                off = std::max(off, std::abs(slow.x - static_cast<double>(fast.scattered(in).share.x)));
            }
            worst = std::max(worst, off / most);
        }
    EXPECT_LT(worst, 2e-4);
}

TEST(HairScattering, KeepsAllLightThatAFibreDoesNotAbsorb) {
    constexpr int n = 200000;
    for (const float roughness : {0.1f, 0.3f, 0.9f})
        for (const float across : {-0.95f, 0.0f, 0.7f}) {
            const scene::Hair white = fibre(roughness, roughness, glm::vec3(0)), brown = fibre(roughness, roughness);
            const HairScattering w(white, {glm::vec3(0), along, 0.01f, across}, hair_seen_from),
                b(brown, {glm::vec3(0), along, 0.01f, across}, hair_seen_from);
            double kept = 0, tinted = 0, density = 0;
            for (int i = 0; i < n; ++i) {
                const glm::vec3 in = even_direction(i, n);
                kept += static_cast<double>(w.scattered(in).share.y);
                tinted += static_cast<double>(b.scattered(in).share.z);
                density += static_cast<double>(b.scattered(in).density);
            }
            const double angle = 2 * two_pi / n;
            // Tilted scales let some light of steep directions leave the sphere [Chiang2016].
            EXPECT_NEAR(angle * kept, 1.0, 0.01) << roughness << ", " << across;
            EXPECT_NEAR(angle * tinted, static_cast<double>(b.albedo().z), 0.01 * static_cast<double>(b.albedo().z));
            EXPECT_NEAR(angle * density, 1.0, 0.01);
            EXPECT_NEAR(w.albedo().x, 1.0f, 1e-4f);
        }
}

TEST(HairScattering, DrawsDirectionsByItsDensity) {
    constexpr int n = 40000;
    const HairScattering hair(fibre(0.25f, 0.3f), {glm::vec3(0), along, 0.01f, 0.4f}, hair_seen_from);
    // Means of any function agree: of what it scatters, and of the direction itself by density alone.
    glm::dvec3 light(0), drawn(0), meant(0);
    for (int i = 0; i < n; ++i) {
        const auto number = static_cast<std::uint64_t>(i);
        const glm::vec3 d =
            hair.sample(core::uniform(number, 0, 0), {core::uniform(number, 0, 1), core::uniform(number, 0, 2)});
        light += glm::dvec3(hair.scattered(d).share / hair.scattered(d).density) / static_cast<double>(n);
        drawn += glm::dvec3(d) / static_cast<double>(n);
        const glm::vec3 even = even_direction(i, n);
        meant += glm::dvec3(even) * (static_cast<double>(hair.scattered(even).density) * 2 * two_pi / n);
    }
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(light[c], static_cast<double>(hair.albedo()[c]), 0.01);
        EXPECT_NEAR(drawn[c], meant[c], 0.015);
    }
}

TEST(HairScattering, OfAColourIsTheAbsorptionThatGivesIt) {
    for (const float c : {0.05f, 0.4f, 0.95f})
        EXPECT_NEAR(scene::color_of(scene::absorption_of(glm::vec3(c), 0.3f), 0.3f).x, c, 1e-4f);
}

/// One strand from (0, -1, 0) to (0, 1, 0).
int add_strand_object(SceneBuilder& b, float radius, int material) {
    scene::Mesh mesh;
    const glm::vec3 points[] = {{0, -1, 0}, {0, 0, 0}, {0, 1, 0}};
    const float radii[] = {radius, radius, radius};
    scene::add_strand(mesh, points, radii);
    return b.add_object(b.add_mesh(mesh), material);
}

TEST(Strands, AreMetWhereTheyAreSeenAndAsWideAsTheyAre) {
    for (const bool moves : {false, true}) {
        SceneBuilder b;
        const int object = add_strand_object(b, 0.1f, b.add_material());
        if (moves) b.move_object(object, {{0, 0, 0}, {1, 0, 0}});
        const Stage stage(b);
        for (const float x : {-0.09f, -0.03f, 0.05f, 0.08f}) {
            const Hit hit = stage.tracer().nearest({x, 0.4f, 3}, {0, 0, -1}, 10);
            ASSERT_TRUE(hit.found()) << x;
            const SurfacePoint p = stage.posed_scene().surface_at(hit.address, {0, 0, 1});
            EXPECT_NEAR(p.position.x, x, 0.004f);
            EXPECT_NEAR(p.position.y, 0.4f, 0.004f);
            EXPECT_NEAR(p.geometric_normal.x, x / 0.1f, 0.04f);
            EXPECT_GT(p.geometric_normal.z, 0);
            EXPECT_FALSE(p.back_side);
        }
        EXPECT_FALSE(stage.tracer().nearest({0.11f, 0.4f, 3}, {0, 0, -1}, 10).found());
        EXPECT_FALSE(stage.tracer().nearest({0, 1.2f, 3}, {0, 0, -1}, 10).found());
    }
}

TEST(Strands, CarryTheirPointsThroughTime) {
    SceneBuilder b;
    const int object = add_strand_object(b, 0.1f, b.add_material());
    b.move_object(object, {{0, 0, 0}, {1, 0.5f, 0}});
    const Stage stage(b);
    const scene::Snapshot later = test::snapshot(stage.film(), 1, 32, 32);
    const auto here = scene::carry_exact({0, 1, 0.25f, 0.9f}, stage.world()),
               there = scene::carry_exact({0, 1, 0.25f, 0.9f}, later);
    ASSERT_TRUE(here && there);
    EXPECT_NEAR(here->y, 0.25, 0.03);
    EXPECT_NEAR(glm::length(*there - *here - glm::dvec3(1, 0.5, 0)), 0, 1e-6);
}

TEST(Strands, LetLightGoBetweenThemAsFarAsTheyAreThin) {
    for (const float radius : {0.002f, 0.01f}) {
        scene::Mesh mesh;
        for (std::uint64_t i = 0; i < 4000; ++i) {
            const glm::vec3 at(core::uniform(i, 0, 0), core::uniform(i, 0, 1), core::uniform(i, 0, 2));
            const glm::vec3 d = core::sample_sphere({core::uniform(i, 1, 0), core::uniform(i, 1, 1)});
            const glm::vec3 points[] = {at - 0.05f * d, at, at + 0.05f * d};
            const float radii[] = {radius, radius, radius};
            scene::add_strand(mesh, points, radii);
        }
        const double met = 4000 * 0.1 * 2 * static_cast<double>(radius) * std::numbers::pi / 4;
        // The box of all is wider than what they fill.
        EXPECT_NEAR(static_cast<double>(free_path_among(mesh)) * met, 1.1, 0.2) << radius;
    }
}

TEST(Strands, OfGlassAndInMotionAreLitByRaysAndByLightPoints) {
    SceneBuilder b;
    const int glass = b.add_material();
    b.material(glass).transmission = 0.8f;
    add_strand_object(b, 0.2f, glass);
    b.move_object(add_strand_object(b, 0.1f, b.add_material()), {{0.5f, 0, 0}, {0.6f, 0, 0}});
    b.add_quad({-2, -2, -1}, {4, 0, 0}, {0, 4, 0}, b.add_material());
    b.add_point_light({1, 1, 2}, 10.0f);
    b.add_camera({0, 0, 4}, {0, 0, 0});
    for (const Indirect indirect : {Indirect::rays, Indirect::lightcuts}) {
        Settings s = test::small_frame(16, 16);
        s.indirect = indirect;
        s.cache = CacheUse::on;
        FilmStage stage(b, s);
        for (int second = 0; second < 2; ++second) {
            const core::Radiance frame = stage.cut(0.1f, second);
            EXPECT_GT(core::luminance(frame.combined.at(8, 8)), 0.0f);
        }
        EXPECT_EQ(stage.statistics().non_finite, 0u);
    }
}

/// A tuft of fibres that absorb nothing.
SceneBuilder white_tuft(float distance = 3) {
    SceneBuilder b;
    const int hair = b.add_material(glm::vec3(1));
    b.material(hair).hair = fibre(0.3f, 0.3f, glm::vec3(0));
    scene::Mesh mesh;
    for (int i = 0; i < 60; ++i) {
        const float x = 0.05f * static_cast<float>(i % 10) - 0.25f, z = 0.07f * static_cast<float>(i) / 10 - 0.2f;
        const glm::vec3 points[] = {{x, -0.5f, z}, {x + 0.03f, 0, z + 0.02f}, {x, 0.5f, z}};
        const float radii[] = {0.03f, 0.03f, 0.02f};
        scene::add_strand(mesh, points, radii);
    }
    b.add_object(b.add_mesh(mesh), hair);
    b.film().sky.color = glm::vec3(1);
    b.add_camera({0, 0, distance}, {0, 0, 0}, 0.3f);
    return b;
}

TEST(HairLight, OfWhiteFibresInAWhiteSkyIsTheSky) {
    Settings settings = test::small_frame();
    double least = 1e9, most = 0, sum = 0, count = 0;
    // A tuft has a hundred cells, whose light scatters by 0.6 % from view to view.
    for (int view = 0; view < 5; ++view) {
        FilmStage stage(white_tuft(3 + 0.01f * static_cast<float>(view)), settings);
        const core::Radiance r = stage.cut(0.02f);
        for (const glm::vec3& light : r.combined.values()) {
            const auto y = static_cast<double>(core::luminance(light));
            least = std::min(least, y), most = std::max(most, y), sum += y, count += 1;
        }
        EXPECT_GT(stage.statistics().hair.pixels, 100u);
    }
    // Cells are means over directions and places, and keep 0.999 of what fibres scatter. chosen: measured 0.989.
    EXPECT_NEAR(sum / count, 1.0, 0.02);
    EXPECT_GT(least, 0.75);
    EXPECT_LT(most, 1.1);
}

TEST(HairLight, OfPathsInAWhiteSkyIsTheSky) {
    const Stage stage(white_tuft());
    const LightPaths paths(stage.posed_scene(), stage.plan());
    const SurfacePoint p = stage.posed_scene().surface_at({0, 20, 0.5f, 0.3f}, {0, 0, 1});
    ASSERT_TRUE(p.fibre);
    double sum = 0;
    constexpr int n = 4000;
    for (int i = 0; i < n; ++i) {
        PathNumbers numbers(Stream(Purpose::true_paths, {.index = 7}), static_cast<std::uint64_t>(i));
        sum += static_cast<double>(core::luminance(paths.scattered(p, numbers)));
    }
    EXPECT_NEAR(sum / n, 1.0, 0.01);
}

/// White fibres so thin that light goes among them for many cells.
SceneBuilder fine_tuft() {
    SceneBuilder b;
    const int hair = b.add_material(glm::vec3(1));
    b.material(hair).hair = fibre(0.3f, 0.3f, glm::vec3(0));
    scene::Mesh mesh;
    for (std::uint64_t i = 0; i < 3000; ++i) {
        const glm::vec3 at(core::uniform(i, 0, 0) - 0.5f, core::uniform(i, 0, 1) - 0.5f, core::uniform(i, 0, 2) - 0.5f);
        const glm::vec3 d = core::sample_sphere({core::uniform(i, 1, 0), core::uniform(i, 1, 1)});
        const glm::vec3 points[] = {at - 0.1f * d, at, at + 0.1f * d};
        const float radii[] = {0.004f, 0.004f, 0.004f};
        scene::add_strand(mesh, points, radii);
    }
    b.add_object(b.add_mesh(mesh), hair);
    b.film().sky.color = glm::vec3(0.1f);
    b.add_sun({0.3f, -0.5f, -1}, 3.0f);
    return b;
}

TEST(HairLight, OfCellsThatLightEachOtherIsThatOfPathsSlow) {
    const SceneBuilder b = fine_tuft();
    const Stage stage(b);
    const GatherRays rays(stage.posed_scene(), stage.plan());
    const LightPaths paths(stage.posed_scene(), stage.plan());
    SurfaceCache cache(stage.posed_scene(), stage.plan());
    cache.forget({});
    // Cells are asked one by one, so that they have few places.
    std::vector<double> known, truth;
    std::map<std::uint64_t, double> asked;
    for (std::uint64_t i = 0; i < 6000; ++i) {
        const glm::vec3 from(core::uniform(i, 0, 0) - 0.5f, core::uniform(i, 0, 1) - 0.5f, 2);
        const glm::vec3 direction = glm::normalize(glm::vec3(0.3f * core::uniform(i, 1, 0) - 0.15f, 0, -1));
        const Hit hit = stage.tracer().nearest(from, direction, 10);
        if (!hit.found()) continue;
        std::vector<RayTerm> terms;
        std::uint64_t traced = 0;
        rays.follow({from, direction, 10}, hit, {}, Stream(Purpose::rays_of_view, {.index = i}), 0, terms, traced);
        ASSERT_EQ(terms.size(), 1u);
        const std::uint64_t key = terms[0].place.key;
        cache.learn({{terms[0].place}});
        known.push_back(static_cast<double>(core::luminance(cache.radiance(cache.index_of(key)))));
        asked[key] += 1;
        const SurfacePoint p = stage.posed_scene().surface_at(hit.address, -direction);
        for (std::uint64_t k = 0; k < 8; ++k) {
            PathNumbers numbers(Stream(Purpose::true_paths, {.index = i}), k);
            truth.push_back(static_cast<double>(core::luminance(paths.scattered(p, numbers))));
        }
    }
    ASSERT_GT(known.size(), 1500u);
    // One path in a thousand is as bright as sixty, where a fibre reflects the sun. Means without that are known.
    const double bright = 4 * std::accumulate(truth.begin(), truth.end(), 0.0) / static_cast<double>(truth.size());
    support::Draws of_cells, of_paths;
    for (const double light : known) of_cells.add(std::min(light, bright));
    for (const double light : truth) of_paths.add(std::min(light, bright));
    // Rays that ask one cell get one answer, and a cell of one place scatters as paths do.
    double squares = 0;
    for (const auto& [key, times] : asked) squares += times * times;
    const double error = std::sqrt(of_paths.variance() * squares) / of_cells.count();
    EXPECT_LT(error, 0.1 * of_paths.mean());
    // Ten draws of all numbers: 0.94 to 1.11 of it. A quarter more or less is found.
    EXPECT_TRUE(support::same_mean(of_cells.mean(), error, of_paths.mean(), of_paths.standard_error()));
    // A cell that scatters as paths do is brighter than the brightest of 50 times as many in one of 50 films. Two cells
    // that answered each other would be 300, eight times as bright as that one.
    EXPECT_GT(truth.size(), 50 * asked.size());
    EXPECT_LT(*std::max_element(known.begin(), known.end()), 2 * *std::max_element(truth.begin(), truth.end()));
}

/// A fibre that three panels shine upon.
SceneBuilder fibre_and_panels() {
    SceneBuilder b;
    const int hair = b.add_material(), panel = b.add_material(glm::vec3(0)), dim = b.add_material(glm::vec3(0));
    b.material(hair).hair = fibre(0.2f, 0.3f);
    b.material(panel).emission = glm::vec3(5);
    b.material(dim).emission = glm::vec3(1);
    add_strand_object(b, 0.02f, hair);
    b.add_quad({-0.3f, -1, 3}, {0, 0.6f, 0}, {0.6f, 0, 0}, panel);
    b.add_quad({-3, -0.5f, -0.3f}, {0, 0, 0.6f}, {0, 0.6f, 0}, panel);
    b.add_quad({-0.3f, 0.5f, -3}, {0.6f, 0, 0}, {0, 0.6f, 0}, dim);
    return b;
}

TEST(HairLight, ChoosesAmongDirectionsToLightWithoutBias) {
    const Stage stage(fibre_and_panels());
    CellLight light(stage.posed_scene(), stage.plan());
    light.pose({});
    const GatherRays rays(stage.posed_scene(), stage.plan());
    const Scatterer at(stage.posed_scene(), stage.posed_scene().surface_at({0, 1, 0.5f, 0.3f}, {0, 0, 1}));
    ASSERT_TRUE(at.is_fibre());
    double means[2], variances[2];
    for (const bool many : {false, true}) {
        const LightChoices choices = many ? light.light_choices() : LightChoices{};
        double sum = 0, squares = 0;
        constexpr int n = 40000;
        for (std::uint64_t i = 0; i < n; ++i) {
            std::uint64_t traced = 0;
            const Stream numbers(Purpose::strands, {.index = i});
            glm::vec3 direction(0), weight(0), found = light.lamps(at, numbers.at(0), choices, traced);
            const float density =
                at.sample(numbers.uniform(2, 0), {numbers.uniform(2, 1), numbers.uniform(2, 2)}, direction, weight);
            ASSERT_GT(density, 0.0f);
            const AskedLights asked{light.sources(), at.query(), density, choices};
            RayRules rules;
            rules.asked = &asked;
            std::vector<RayTerm> terms;
            const glm::vec3 origin = at.origin_of(direction);
            found += weight * rays.follow({origin, direction, 10}, stage.tracer().nearest(origin, direction, 10), rules,
                                          numbers.at(3), 0, terms, traced);
            const auto y = static_cast<double>(core::luminance(found));
            sum += y;
            squares += y * y;
        }
        means[many] = sum / n;
        variances[many] = squares / n - means[many] * means[many];
    }
    EXPECT_NEAR(means[1] / means[0], 1.0, 0.02);
    EXPECT_NEAR(variances[1] / variances[0], 0.35, 0.15);
}

TEST(HairLight, TakesNoMoreRaysThanWhatItsSamplesShowIsWorth) {
    // However little is tolerated: fibres in the sun differ from sample to sample. Half of the 128 rays of 64 rounds.
    SceneBuilder b = white_tuft();
    b.add_sun({0.3f, -0.5f, -1}, 3.0f);
    Settings settings = test::small_frame();
    settings.samples = 16;
    FilmStage stage(b, settings);
    stage.cut(0.001f);
    const double samples = 16.0 * static_cast<double>(stage.statistics().hair.pixels);
    EXPECT_LT(static_cast<double>(stage.statistics().hair.rays) / samples, 64);
}

TEST(HairLight, HasMoreSamplesWhereStrandsWouldShow) {
    constexpr int side = 24;
    const auto fine_pixels = [](const SceneBuilder& b, float tolerated) {
        Settings settings = test::small_frame(side, side);
        settings.samples = 4;
        settings.most_samples = 64;
        FilmStage stage(b, settings);
        const scene::Snapshot world = stage.at(0);
        const core::ToleranceMap tolerance = core::ToleranceMap::uniform(side, side, {tolerated, 0.001f, 1.0f});
        const Frame frame = stage.renderer().place(world, stage.renderer().look(world), LightOrder{tolerance}).frame;
        int hair = 0;
        for (const FibreTile& tile : frame.fibres) hair += static_cast<int>(tile.size());
        EXPECT_GT(hair, 0);
        return std::ranges::count(frame.samples.values(), 64);
    };
    SceneBuilder sunny = white_tuft();
    sunny.add_sun({0.3f, -0.5f, -1}, 3.0f);
    EXPECT_GT(fine_pixels(sunny, 0.01f), 100);
    EXPECT_LT(fine_pixels(sunny, 2.0f), 10);
    EXPECT_LT(2 * fine_pixels(white_tuft(), 0.05f), fine_pixels(sunny, 0.05f)) << "all fibres are alike";
}

TEST(HairLight, TellsWhatItsPixelsErrSlow) {
    constexpr int side = 24;
    SceneBuilder b = fine_tuft();
    b.film().cameras.clear();
    b.add_camera({0, 0, 3}, {0, 0, 0}, 0.3f);
    const auto look = [&](int samples, float tolerance) {
        Settings settings = test::small_frame(side, side);
        settings.samples = samples;
        return FilmStage(b, settings).cut(tolerance);
    };
    const core::Radiance exact = look(512, 0.05f);
    for (const int samples : {4, 32}) {
        const core::Radiance found = look(samples, 0.3f);
        double off = 0, told = 0;
        for (std::size_t i = 0; i < exact.combined.size(); ++i) {
            off +=
                std::pow(core::luminance(found.combined.values()[i]) - core::luminance(exact.combined.values()[i]), 2);
            told += std::pow(static_cast<double>(found.error.values()[i]), 2);
            EXPECT_NEAR(found.shared_error.values()[i], found.error.values()[i] / 8, 1e-6f);
        }
        EXPECT_GT(off, 0);
        EXPECT_NEAR(std::sqrt(told / off), 1.0, 0.35) << samples;
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
