#include "app/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "app/files/file_io.h"
#include "app/report/answer.h"
#include "app/report/curve_plot.h"
#include "app/report/figures.h"
#include "app/report/plan_table.h"
#include "app/report/report_style.h"
#include "app/report/summary.h"
#include "app/system/progress.h"
#include "core/error.h"
#include "core/numeric.h"
#include "core/text.h"
#include "encoder/codec.h"
#include "perceptual/metrics.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

std::string kilobits(const json& s) {
    const double seconds = core::divide_or(s.at("frames").get<double>(), s.at("fps").get<double>(), 0.0);
    return fmt::format("{:.0f} kb/s", core::divide_or(8e-3 * s.at("bytes").get<double>(), seconds, 0.0));
}

/// Name of the codec's quantiser scale.
std::string scale_of(const json& s) {
    for (const encoder::CodecFacts& facts : encoder::all_codecs())
        if (s.at("codec") == facts.word) return std::string(facts.scale);
    return "quantiser";
}

std::string capitalised(std::string text) {
    text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
}

double number(const json& s, const char* object, const char* key) {
    return s.at(object).at(key).get<double>();
}

/// The render in one or two sentences, as a reader would be told it.
std::string sentence_of(const json& s) {
    const double cpu = number(s, "seconds", "cpu"), light = number(s, "seconds", "shade");
    std::string text = fmt::format(
        "{} frames of {}x{} took {} on the clock and {:.1f} s of CPU time, {:.0f} % of it gathering light, with {:.0f} "
        "clusters per point of {} light points.",
        s.at("frames").get<std::int64_t>(), s.at("width").get<int>(), s.at("height").get<int>(),
        clock_text(number(s, "seconds", "wall")), cpu, 100 * core::divide_or(light, cpu, 0.0),
        number(s, "mean_cut", "direct") + number(s, "mean_cut", "indirect"),
        s.at("counts").at("direct_points").get<std::int64_t>() +
            s.at("counts").at("indirect_points").get<std::int64_t>());
    if (s.contains("rate")) {
        text += fmt::format(" The film has {} ({})", size_text(s.at("bytes").get<double>()), kilobits(s));
        text += s.at("psnr_y").is_number()
                    ? fmt::format("; decoded, it is {:.2f} dB PSNR-Y and {:.4f} SSIM-Y from what was rendered.",
                                  s.at("psnr_y").get<double>(), s.at("ssim_y").get<double>())
                    : "; decoding it gives exactly what was rendered.";
    }
    if (!s.at("complete").get<bool>()) text = "Interrupted: this is a part of the film. " + text;
    return text;
}

/// Values of frames by `value`, which gives NaN where there is none; of long films means over neighbours.
template <class Value>
Curve curve_of(const json& s, const char* name, const char* color, bool joined, Value&& value) {
    // chosen: marks on a plot 860 wide that can still be told apart.
    constexpr std::size_t most_marks = 400;
    const json& frames = s.at("per_frame");
    const std::size_t each = (frames.size() + most_marks - 1) / most_marks;
    Curve curve{name, color, {}, joined};
    for (std::size_t i = 0; i < frames.size(); i += each) {
        double sum = 0, count = 0;
        for (std::size_t k = i; k < std::min(frames.size(), i + each); ++k)
            if (const double one = value(frames[k]); std::isfinite(one)) {
                sum += one;
                ++count;
            }
        if (count > 0) curve.points.push_back({frames[i].at("frame").get<double>(), sum / count, "", false});
    }
    return curve;
}

/// One curve for each picture type, so that types are told apart by colour.
template <class Value>
std::vector<Curve> by_type(const json& s, Value&& value) {
    std::vector<Curve> curves;
    for (const auto& [type, color] : {std::pair{"I", "i"}, {"P", "p"}, {"B", "b"}})
        curves.push_back(curve_of(s, type, color, false, [&, is = type](const json& frame) {
            return frame.at("type") == is ? value(frame) : std::numeric_limits<double>::quiet_NaN();
        }));
    return curves;
}

std::string plots(const json& s) {
    if (s.at("per_frame").empty()) return {};
    const auto field = [](const char* key) { return [key](const json& f) { return f.at(key).get<double>(); }; };
    const auto plot = [](const std::string& title, const std::string& unit, std::vector<Curve> curves) {
        return figure_of({title, {"frame", false}, {unit, false}, std::move(curves)});
    };
    const auto psnr = [](const json& f) {
        const double error = f.at("mse_y").get<double>();
        return error > 0 ? perceptual::psnr(error) : 100.0;  // chosen: beyond any 8-bit error
    };
    const std::string scale = scale_of(s);
    std::string text = "<h2>Frame by frame</h2>\n";
    if (s.contains("rate"))
        text += plot("Size of the coded pictures", "bytes", by_type(s, field("bytes"))) +
                plot(capitalised(scale) + ", mean over macroblocks", scale, by_type(s, field("mean_quantiser"))) +
                plot("PSNR-Y of the decoded picture", "dB", by_type(s, psnr));
    return text +
           plot("Cut: clusters of lights per point", "clusters",
                {curve_of(s, "direct", "one", true, field("direct_cut")),
                 curve_of(s, "indirect", "two", true, field("indirect_cut"))}) +
           plot("CPU time", "s", {curve_of(s, "CPU", "one", true, field("seconds"))});
}

std::string time_table(const json& s) {
    const double cpu = number(s, "seconds", "cpu");
    std::vector<TableRow> rows;
    double rest = cpu;
    const auto add = [&](const std::string& name, double seconds) {
        const double share = core::divide_or(seconds, cpu, 0.0);
        rows.push_back(
            {{name, fmt::format("{:.2f}", seconds), percent_text(share), fmt::format("{:.1f}", 100 * share)}});
    };
    for (const char* stage : stage_names) {
        std::string name = stage;
        std::replace(name.begin(), name.end(), '_', ' ');
        const double seconds = s.at("seconds").at(stage).get<double>();
        rest -= seconds;
        if (seconds > 0) add(name, seconds);
    }
    if (rest > 0) add("all else", rest);
    return html_table("Where the time went", "tnnb", {"Stage", "CPU, s", "Share", ""}, rows);
}

std::string seconds_text(const json& value) {
    return value.is_number() ? fmt::format("{:.2f}", value.get<double>()) : "";
}

std::string effect_table(const json& s) {
    if (!s.contains("effects")) return {};
    const auto count = [](const json& value) { return value.is_number() ? count_text(value.get<double>()) : ""; };
    std::vector<TableRow> rows;
    for (const json& row : s.at("effects"))
        rows.push_back({{row.at("effect").get<std::string>(), seconds_text(row.at("seconds")), count(row.at("rays")),
                         count(row.at("clusters")), row.at("note").get<std::string>()}});
    return html_table("What the picture consists of", "tnnnt", {"Effect", "CPU, s", "Rays", "Clusters", ""}, rows);
}

std::string plan_rows(const json& plan) {
    std::vector<TableRow> rows;
    for (const json& row : plan) {
        const bool runs = row.at("runs").get<bool>();
        rows.push_back({{row.at("pass").get<std::string>(), runs ? "yes" : "no", seconds_text(row.at("seconds")),
                         row.at("reason").get<std::string>()},
                        false,
                        !runs});
    }
    return html_table("What ran, and why", "ttnt", {"Pass", "Runs", "CPU, s", "Reason"}, rows);
}

constexpr const char* generator = "<meta name=\"generator\" content=\"render2mpeg";

bool is_page_of_ours(const std::filesystem::path& file) {
    std::string start(4096, '\0');
    std::ifstream stream(file, std::ios::binary);
    stream.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<std::size_t>(stream.gcount()));
    return start.starts_with("<!DOCTYPE html>") && start.find(generator) != std::string::npos;
}

bool is_json_of_ours(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    const json value = json::parse(stream, nullptr, false);
    if (!value.is_object() || !value.contains("summary")) return false;
    return (value.contains("per_frame") && value.contains("plan")) ||
           (value.contains("rows") && value.contains("windows"));
}

}  // namespace

std::filesystem::path report_json_of(const std::filesystem::path& html) {
    return std::filesystem::path(html).replace_extension(".report.json");
}

void check_report(const std::filesystem::path& html) {
    if (const std::string ending = core::ending_of(html); ending != ".html" && ending != ".htm")
        throw core::Error("report " + html.string() + ": expected a name that ends in .html");
    for (const auto& [file, ours] : {std::pair{html, &is_page_of_ours}, {report_json_of(html), &is_json_of_ours}}) {
        std::error_code error;
        if (std::filesystem::is_regular_file(file, error) && !std::filesystem::is_empty(file, error) && !ours(file))
            throw core::Error("writing", file.string(), "what has this name is no earlier report, and is left alone");
    }
}

std::string report_page(const std::string& title, const std::string& lead, const std::string& body) {
    std::string page = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>\n";
    page += generator;
    page += " " RENDER2MPEG_VERSION "\"/>\n";
    return page + "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>" +
           escaped(title) + " - render2mpeg</title>\n<style>" + report_style + "</style></head>\n<body><main>\n<h1>" +
           escaped(title) + "</h1>\n<p class=\"lead\">" + escaped(lead) + "</p>\n" + body + "</main></body></html>\n";
}

void write_report(const std::filesystem::path& html, const RenderJob& film, const RunStatistics& statistics,
                  const RunFacts& facts, const std::string& views) {
    json s = statistics_of(film, statistics, facts);
    s["summary"] = sentence_of(s);
    s["plan"] = plan_of(film, statistics);
    const std::string body =
        answer_screen(time_table(s), views, s.at("command").get<std::string>()) + "<h2>What became of it</h2>\n<pre>" +
        escaped(summary(film, statistics, facts)) + "</pre>\n" +
        folded("Frame by frame, effects, passes", plots(s) + effect_table(s) + plan_rows(s.at("plan"))) +
        "<p class=\"soft\">Every figure is in the JSON file beside this page (docs/json.md).</p>\n";
    write_whole(html, report_page(std::filesystem::path(facts.output).filename().string(),
                                  s.at("summary").get<std::string>(), body));
    write_json(report_json_of(html), s);
}

}  // namespace render2mpeg::app
