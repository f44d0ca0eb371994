#include "encoder_rd/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "bd_rate.h"
#include "core/numeric.h"

namespace render2mpeg::bench {
namespace {

constexpr std::array<const char*, 3> measures = {"PSNR-Y", "SSIM", "PSNR-HVS-M"};

double quality(const Measured& m, std::size_t measure) {
    return measure == 0 ? m.psnr_y : measure == 1 ? in_db(m.ssim_y) : m.psnr_hvs_m;
}

const Curve* find(const std::vector<Curve>& curves, const std::string& clip, const std::string& codec) {
    for (const Curve& curve : curves)
        if (curve.clip == clip && curve.codec == codec) return &curve;
    return nullptr;
}

std::vector<std::string> clips_of(const std::vector<Curve>& curves) {
    std::vector<std::string> clips;
    for (const Curve& curve : curves)
        if (std::find(clips.begin(), clips.end(), curve.clip) == clips.end()) clips.push_back(curve.clip);
    return clips;
}

double difference(const Curve& test, const Curve& anchor, std::size_t measure) {
    const auto points = [&](const Curve& curve) {
        std::vector<RatePoint> list;
        for (const Measured& m : curve.points) list.push_back({m.bits, quality(m, measure)});
        return list;
    };
    return bd_rate(points(anchor), points(test));
}

/// Pictures per CPU second over all points of a curve.
double speed(const Curve& curve) {
    double pictures = 0, seconds = 0;
    for (const Measured& m : curve.points) {
        pictures += static_cast<double>(m.pictures);
        seconds += m.seconds;
    }
    return core::divide_or(pictures, seconds, 0.0);
}

double evaluations(const Curve& curve) {
    double sum = 0;
    for (const Measured& m : curve.points) sum += m.evaluations;
    return core::divide_or(sum, static_cast<double>(curve.points.size()), 0.0);
}

/// One row of the table.
struct Row {
    std::string clip;
    std::array<double, 3> difference{};
    double test_speed = 0, anchor_speed = 0, test_evaluations = 0, anchor_evaluations = 0;
};

std::vector<Row> rows_of(const std::vector<Curve>& curves, const Comparison& c) {
    std::vector<Row> rows;
    Row mean{"mean", {}, 0, 0, 0, 0};
    for (const std::string& clip : clips_of(curves)) {
        const Curve *test = find(curves, clip, c.test), *anchor = find(curves, clip, c.anchor);
        if (!test || !anchor) continue;
        Row row{clip, {}, speed(*test), speed(*anchor), evaluations(*test), evaluations(*anchor)};
        for (std::size_t m = 0; m < measures.size(); ++m) row.difference[m] = difference(*test, *anchor, m);
        rows.push_back(row);
    }
    const auto n = static_cast<double>(rows.size());
    for (const Row& row : rows) {
        for (std::size_t m = 0; m < measures.size(); ++m) mean.difference[m] += row.difference[m] / n;
        mean.test_speed += row.test_speed / n;
        mean.anchor_speed += row.anchor_speed / n;
        mean.test_evaluations += row.test_evaluations / n;
        mean.anchor_evaluations += row.anchor_evaluations / n;
    }
    if (rows.size() > 1) rows.push_back(mean);
    return rows;
}

}  // namespace

std::vector<Comparison> comparisons_among(const std::vector<Curve>& curves) {
    const std::vector<Comparison> wanted = {
        {"quality", "A"},       {"fast", "A"},         {"fast", "B"},     {"quality", "B"}, {"lit", "B"},
        {"eye", "B"},           {"eye", "B-eye"},      {"free", "C"},     {"unaided", "B"}, {"unaided-fast", "A"},
        {"quality", "unaided"}, {"quality", "search"}, {"quality", "lit"}};
    std::vector<Comparison> there;
    for (const Comparison& c : wanted)
        if (!rows_of(curves, c).empty()) there.push_back(c);
    return there;
}

std::string points_text(const std::vector<Curve>& curves) {
    std::string text;
    for (const Curve& curve : curves)
        for (const Measured& m : curve.points) {
            text += fmt::format(
                "{:8} {:8} q {:2}  {:8.0f} bits/picture  Y {:.3f} dB  SSIM {:.3f} dB  HVS-M {:.3f} dB  {:6.1f} "
                "pictures/s",
                curve.clip, curve.codec, m.quantiser, m.bits / static_cast<double>(m.pictures), m.psnr_y,
                in_db(m.ssim_y), m.psnr_hvs_m, m.pictures_per_second());
            for (std::size_t t = 0; t < 3; ++t)
                if (m.types[t].pictures > 0)
                    text += fmt::format("  {}: {} x {:.0f} at {:.2f} dB", "IPB"[t], m.types[t].pictures,
                                        m.types[t].bits / static_cast<double>(m.types[t].pictures),
                                        10 * std::log10(255.0 * 255.0 * static_cast<double>(m.types[t].pictures) /
                                                        std::max(1e-9, m.types[t].error)));
            if (m.evaluations > 0)
                text += fmt::format("  {:.1f} evaluations, {:.1f} % intra, {:.1f} % skipped", m.evaluations,
                                    100 * m.intra, 100 * m.skipped);
            text += '\n';
        }
    return text;
}

std::string table(const std::vector<Curve>& curves) {
    std::string text =
        "| test | against | clip | PSNR-Y | SSIM | PSNR-HVS-M | pictures per CPU second | evaluations |\n"
        "|---|---|---|---|---|---|---|---|\n";
    for (const Comparison& c : comparisons_among(curves))
        for (const Row& row : rows_of(curves, c)) {
            text += fmt::format("| {} | {} | {} |", c.test, c.anchor, row.clip);
            for (const double d : row.difference) text += fmt::format(" {:+.1f} % |", d);
            text += fmt::format(" {:.0f} : {:.0f} |", row.test_speed, row.anchor_speed);
            text += row.anchor_evaluations > 0
                        ? fmt::format(" {:.1f} : {:.1f} |\n", row.test_evaluations, row.anchor_evaluations)
                        : fmt::format(" {:.1f} |\n", row.test_evaluations);
        }
    return text;
}

std::string deviations(const std::vector<Curve>& curves) {
    std::map<std::pair<std::string, int>, std::vector<double>> qualities;
    for (const Curve& curve : curves)
        for (const Measured& m : curve.points) qualities[{curve.codec, m.quantiser}].push_back(m.psnr_hvs_m);
    std::string text =
        "| codec | quantiser, or its quality | clips | PSNR-HVS-M | deviation |\n|---|---|---|---|---|\n";
    for (const auto& [of, values] : qualities) {
        const auto n = static_cast<double>(values.size());
        double sum = 0, squares = 0;
        for (const double v : values) sum += v, squares += v * v;
        text += fmt::format("| {} | {} | {} | {:.2f} dB | {:.2f} dB |\n", of.first, of.second, values.size(), sum / n,
                            std::sqrt(std::max(0.0, squares / n - sum / n * sum / n)));
    }
    return text;
}

void write_json(const std::filesystem::path& file, const std::vector<Curve>& curves) {
    using nlohmann::json;
    json points = json::array(), differences = json::array();
    for (const Curve& curve : curves)
        for (const Measured& m : curve.points)
            points.push_back({{"clip", curve.clip},
                              {"codec", curve.codec},
                              {"quantiser", m.quantiser},
                              {"pictures", m.pictures},
                              {"bits", m.bits},
                              {"psnr_y", m.psnr_y},
                              {"ssim_y", m.ssim_y},
                              {"psnr_hvs_m", m.psnr_hvs_m},
                              {"cpu_seconds", m.seconds},
                              {"evaluations_per_macroblock", m.evaluations}});
    for (const Comparison& c : comparisons_among(curves))
        for (const Row& row : rows_of(curves, c))
            differences.push_back({{"test", c.test},
                                   {"anchor", c.anchor},
                                   {"clip", row.clip},
                                   {"psnr_y_percent", row.difference[0]},
                                   {"ssim_percent", row.difference[1]},
                                   {"psnr_hvs_m_percent", row.difference[2]},
                                   {"speed_ratio", core::divide_or(row.test_speed, row.anchor_speed, 0.0)}});
    std::ofstream(file) << json{{"points", points}, {"bd_rate", differences}}.dump(1) << '\n';
}

}  // namespace render2mpeg::bench
