#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/job/render_job.h"
#include "app/loop/run_statistics.h"
#include "core/binomial.h"
#include "core/color.h"
#include "perceptual/display.h"
#include "support/program.h"

/// What `--audit` says of a render.
namespace render2mpeg::app {
namespace {

nlohmann::json statistics_of(const std::string& options) {
    const support::Folder folder;
    const std::string stats = (folder / "s.json").string();
    const support::Outcome outcome = support::run(support::program() + " render -y --hold " + support::panel_film() +
                                                  " --frames 0:1 --size 32x32 --samples 1 -o " +
                                                  (folder / "a.mpg").string() + " --stats " + stats + " " + options);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return nlohmann::json::parse(support::contents(stats));
}

TEST(Audit, SaysHowWellTolerancesWereKeptSlow) {
    const nlohmann::json audited = statistics_of("--tolerance fixed=4% --audit 40");
    const nlohmann::json& audit = audited.at("audit");
    EXPECT_EQ(audit.at("pixels"), 80);
    // Rays keep a tolerance by 1.3 standard errors, which 19 % exceed if all are normal; here of all pixels 26 %.
    EXPECT_LE(audit.at("over_tolerance").get<double>(), 0.32);
    const auto over = static_cast<std::uint64_t>(std::lround(80 * audit.at("over_tolerance").get<double>()));
    EXPECT_DOUBLE_EQ(audit.at("over_tolerance_at_most").get<double>(), core::most_share(over, 80, 0.95));
    EXPECT_GT(audit.at("error_p50").get<double>(), 0.0);
    EXPECT_LE(audit.at("error_p50").get<double>(), audit.at("error_p95").get<double>());
    EXPECT_LE(audit.at("error_p95").get<double>(), audit.at("error_p99").get<double>());
    EXPECT_LE(audit.at("error_p95").get<double>(),
              0.04 / 1.3 * 3);  // 2 standard errors, if they were all normal; here 2.4
    EXPECT_GT(audit.at("seconds").get<double>(), 0.0);

    // An audit changes nothing, and nobody who does not ask for one pays.
    const nlohmann::json plain = statistics_of("--tolerance fixed=4%");
    EXPECT_TRUE(plain.at("audit").is_null());
    EXPECT_EQ(plain.at("bytes"), audited.at("bytes"));
    EXPECT_EQ(plain.at("counts").at("shadow_rays"), audited.at("counts").at("shadow_rays"));

    // All that was spent was spent on pixels that may be off by 4 %, or more where they are dark.
    const nlohmann::json& points = plain.at("counts").at("band_points");
    ASSERT_EQ(points.size(), 6u);
    double all = 0;
    for (const nlohmann::json& band : points) all += band.get<double>();
    EXPECT_EQ(all, plain.at("counts").at("gather_points").get<double>());
    EXPECT_GT(points[3].get<double>(), 0.9 * all);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(points[i], 0);
}

TEST(Audit, SplitsTheErrorByCauseSlow) {
    const nlohmann::json audit = statistics_of("--tolerance fixed=4% --audit 100").at("audit"),
                         truth = audit.at("truth");
    EXPECT_EQ(audit.at("pixels"), 200);
    EXPECT_GE(truth.at("paths").get<double>(), 512.0);
    double bias = 0, dark = 0;
    const auto value = [&](const char* cause, const char* key) {
        return truth.at(cause).at(key).at("value").get<double>();
    };
    for (const char* cause : {"gathering", "light_points", "eye_samples"}) {
        bias += value(cause, "bias");
        dark += value(cause, "dark_bias");
        EXPECT_GE(truth.at(cause).at("rms").get<double>(), 0.0);
    }
    EXPECT_NEAR(value("total", "bias"), bias, 1e-9);
    EXPECT_NEAR(value("total", "dark_bias"), dark, 1e-9);
    // What was audited against light points is the first cause.
    EXPECT_LE(truth.at("gathering").at("relative_rms").get<double>(), 0.065);  // 0.031 of rays alone; here 0.054
    EXPECT_GT(truth.at("total").at("rms").get<double>(), 0.0);
    EXPECT_LT(std::abs(value("total", "bias")), 0.2);
}

TEST(Audit, AddsUpOverRuns) {
    renderer::ValidatedPixel p;
    p.shown = glm::vec3(3);
    p.at_points = glm::vec3(2);
    for (const std::size_t half : {0u, 1u}) {
        p.truth.at_points.halves[half] = glm::dvec3(1.75);
        p.truth.whole.halves[half] = glm::dvec3(1);
    }
    p.truth.paths = 700;
    const std::vector<renderer::ValidatedPixel> frame(4, p);
    const auto luma = [](glm::vec3 light) { return 20.0 * static_cast<double>(light.y); };
    RunStatistics earlier, later, whole;
    earlier.audit.split.add(frame, luma);
    earlier.audit.errors.add(1);
    whole.audit.split.add(frame, luma);
    whole.audit.split.add(frame, luma);
    restore(later, json_of(earlier));
    later.audit.split.add(frame, luma);
    EXPECT_EQ(later.audit.split.pixels(), 8u);
    EXPECT_EQ(later.audit.split.sums().paths, 5600u);
    for (std::size_t c = 0; c < renderer::cause_count; ++c) {
        const auto cause = static_cast<renderer::ErrorCause>(c);
        for (std::size_t m = 0; m < renderer::measure_count; ++m) {
            const auto measure = static_cast<renderer::ErrorMeasure>(m);
            EXPECT_EQ(later.audit.split.mean_square(cause, measure).value,
                      whole.audit.split.mean_square(cause, measure).value);
            EXPECT_GT(later.audit.split.rms(cause, measure), 0.0);
        }
        EXPECT_EQ(later.audit.split.bias(cause).value, whole.audit.split.bias(cause).value);
    }
    // Statistics of runs without an audit hold none.
    restore(later, json_of(RunStatistics()));
    EXPECT_FALSE(json_of(RunStatistics()).contains("audit_split"));
}

TEST(Audit, OfWholeBlocksTellsTheErrorOfTheirMeans) {
    // Errors of 3 and -1 code values by turns, whose mean is 1; the halves of the truth are 0.5 off it, up and down.
    std::vector<renderer::ValidatedPixel> pixels;
    const auto luma = [](glm::vec3 light) { return 20.0 * static_cast<double>(light.y); };
    for (int i = 0; i < 64 + 63; ++i) {
        renderer::ValidatedPixel& p = pixels.emplace_back();
        p.place = {16 + i % 8, 8 + i / 8};
        p.shown = p.at_points = glm::vec3(i % 2 == 0 ? 1.15f : 0.95f);
        p.truth.at_points.halves = p.truth.whole.halves = {glm::dvec3(1.025), glm::dvec3(0.975)};
    }
    renderer::ErrorSplit split;
    split.add(pixels, luma);
    EXPECT_EQ(split.sums().blocks, 1u) << "one pixel of the second is missing";
    const auto total = renderer::ErrorCause::total;
    EXPECT_NEAR(split.block_mean_square(total).value, 0.5 * 1.5, 1e-5);
    EXPECT_NEAR(split.block_rms(total), std::sqrt(0.75), 1e-5);
    EXPECT_NEAR(split.mean_square(total, renderer::ErrorMeasure::code_value).value,
                (64 * (2.5 * 3.5) + 63 * (1.5 * 0.5)) / 127, 1e-4);
    renderer::ErrorSplit twice;
    twice.add(split);
    twice.add(split);
    EXPECT_EQ(twice.sums().blocks, 2u);
    EXPECT_EQ(twice.block_rms(total), split.block_rms(total));
    RunStatistics written, read;
    written.audit.split = split;
    written.audit.errors.add(1);
    restore(read, json_of(written));
    EXPECT_EQ(read.audit.split.block_rms(total), split.block_rms(total));
}

TEST(Audit, TellsHowErrorsOfPointsChangeFromFrameToFrame) {
    const auto luma = [](glm::vec3 light) { return 20.0 * static_cast<double>(light.y); };
    // Errors of 2 and 5 code values against a truth whose halves are 0.5 off it, up and down; light points have none.
    const auto errors = [&](float shown) {
        renderer::ValidatedPixel p;
        p.shown = glm::vec3(shown);
        p.at_points = glm::vec3(1);
        p.truth.at_points.halves = p.truth.whole.halves = {glm::dvec3(1.025), glm::dvec3(0.975)};
        return renderer::code_errors(p, luma);
    };
    RunStatistics written, read;
    renderer::ErrorSplit& split = written.audit.split;
    split.add_change(errors(1.1f), errors(1.25f));
    split.add_change(errors(1.1f), errors(1.1f));
    const auto total = renderer::ErrorCause::total;
    EXPECT_NEAR(split.flicker(total), std::sqrt(9.0 / 2), 1e-5);
    EXPECT_NEAR(split.flicker(renderer::ErrorCause::gathering), std::sqrt(9.0 / 2), 1e-5);
    EXPECT_EQ(split.flicker(renderer::ErrorCause::light_points), 0.0);
    written.audit.errors.add(1);
    restore(read, json_of(written));
    read.audit.split.add(split);
    EXPECT_EQ(read.audit.split.sums().followed, 4u);
    EXPECT_NEAR(read.audit.split.flicker(total), std::sqrt(9.0 / 2), 1e-5);
}

/// A room whose camera moves by these metres a frame, seven pixels to each; three frames.
nlohmann::json truth_of_pan(double step) {
    const support::Folder folder;
    std::ofstream(folder / "pan.json") << R"({ "frames": 3, "frame_rate": 25, "size": [48, 32], "exposure": 0,
        "camera": { "keys": [{ "at": 0, "position": [0, 1, 4], "look_at": [0, 1, 0] },
                             { "at": 0.08, "position": [)"
                                       << 2 * step << R"(, 1, 4], "look_at": [)" << 2 * step <<
        R"(, 1, 0] }], "interpolation": "linear" },
        "objects": [{ "shape": "quad", "size": [20, 20], "position": [0, 1, 0] },
                    { "shape": "box", "size": [1, 0.5, 0.5], "position": [0, 0.5, 0.5] }],
        "lights": [{ "kind": "panel", "size": 1, "position": [1, 3, 3], "look_at": [0, 1, 0], "intensity": 20 }] })";
    const std::string stats = (folder / "s.json").string();
    const support::Outcome outcome =
        support::run(support::program() + " render -y --hold " + (folder / "pan.json").string() +
                     " --tolerance fixed=4% --audit 128 -o " + (folder / "a.mpg").string() + " --stats " + stats);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("flicker"), std::string::npos) << outcome.output;
    return nlohmann::json::parse(support::contents(stats)).at("audit").at("truth");
}

TEST(Audit, FollowsPointsAlongMotionSlow) {
    // A quarter of the pixels of two frames; some leave the picture, or lie between two places.
    for (const double step : {0.0, 0.1}) {
        const nlohmann::json truth = truth_of_pan(step);
        EXPECT_LE(truth.at("followed"), 64);
        EXPECT_GE(truth.at("followed"), step > 0 ? 40 : 60);
        const double flicker = truth.at("total").at("flicker_rms");
        EXPECT_LE(flicker, 1.5 * truth.at("total").at("code_value_rms").get<double>() + 0.5);
    }
}

TEST(Audit, OfNoPixelsIsOfNoError) {
    Audit audit;
    EXPECT_EQ(audit.share_over(), 0.0);
    EXPECT_EQ(audit.errors.quantile(0.99), 0.0);
    for (int i = 100; i > 0; --i) audit.errors.add(static_cast<float>(i));
    audit.over = 3;
    EXPECT_EQ(audit.share_over(), 0.03);
}

TEST(ErrorHistogram, KnowsQuantilesToOnePercentOnTheSafeSide) {
    core::ErrorHistogram errors;
    for (int i = 100000; i > 0; --i) errors.add(1e-6f * static_cast<float>(i));
    EXPECT_EQ(errors.count(), 100000u);
    for (const double q : {0.01, 0.5, 0.95, 0.99, 1.0}) {
        EXPECT_GE(errors.quantile(q), 0.1 * q * (1 - 1e-5));
        EXPECT_LE(errors.quantile(q), 0.1 * q * 1.011);
    }
}

TEST(ErrorHistogram, TakesNothingAtAllAndWhatIsBeyondAllMeasure) {
    core::ErrorHistogram errors;
    errors.add(0.0f);
    EXPECT_EQ(errors.quantile(1.0), 0.0);
    errors.add(1e-30f);
    EXPECT_EQ(errors.quantile(1.0), 0.0);
    for (const float large : {1e30f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()})
        errors.add(large);
    EXPECT_EQ(errors.quantile(0.4), 0.0);
    EXPECT_EQ(errors.quantile(0.41), std::numeric_limits<double>::infinity());
    EXPECT_EQ(errors.count(), 5u);
}

TEST(ErrorHistogram, TellsTheLargestItKnowsFromWhatIsLarger) {
    core::ErrorHistogram errors;
    errors.add(255.9f);
    errors.add(256.0f);
    EXPECT_EQ(errors.quantile(1.0), 256.0);
    errors.add(256.1f);
    EXPECT_EQ(errors.quantile(0.6), 256.0);
    EXPECT_EQ(errors.quantile(1.0), std::numeric_limits<double>::infinity());
}

TEST(FixedTolerance, LetsBlackBeOffByHalfACodeValue) {
    RenderJob film;
    film.format = {4, 2, 1.0f};
    film.tolerance.relative = 0.02f;
    EXPECT_EQ(film.tolerance_map().pixels.at(3, 1).absolute, 0.0f);  // no code values without an exposure
    film.exposure = 1.5f;
    const core::Tolerance t = film.tolerance_map().pixels.at(3, 1);
    EXPECT_EQ(t.relative, 0.02f);
    const perceptual::Display display(1.5f, perceptual::matrix_for(2));
    EXPECT_NEAR(perceptual::luma_of(display, glm::vec3(t.absolute)) - perceptual::luma_of(display, glm::vec3(0)), 0.5f,
                1e-3f);
    film.tolerance.relative = 0;
    EXPECT_EQ(film.tolerance_map().pixels.at(0, 0).absolute, 0.0f);
}

}  // namespace
}  // namespace render2mpeg::app
