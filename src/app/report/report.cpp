#include "app/report/report.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "app/files/file_io.h"
#include "app/report/figures.h"
#include "app/report/summary.h"
#include "app/system/progress.h"
#include "core/error.h"
#include "core/numeric.h"
#include "core/text.h"
#include "encoder/codec.h"

namespace render2mpeg::app {

/// page.html, with REPORT_DATA in place of a page's data.
extern const char* const page_html;
/// Part of a page on which a panorama is looked around in, with AROUND_DATA in place of what it is.
extern const char* const around_html;

namespace {

using nlohmann::json;

std::string kilobits(const json& s) {
    const double seconds = core::divide_or(s.at("frames").get<double>(), s.at("fps").get<double>(), 0.0);
    return fmt::format("{:.0f} kb/s", core::divide_or(8e-3 * s.at("bytes").get<double>(), seconds, 0.0));
}

std::string scale_of(const json& s) {
    for (const encoder::CodecFacts& facts : encoder::all_codecs)
        if (s.at("codec") == facts.word) return std::string(facts.scale);
    return "quantiser";
}

double number(const json& s, const char* object, const char* key) {
    return s.at(object).at(key).get<double>();
}

/// The render in one or two sentences, as a reader would be told it.
std::string sentence_of(const json& s) {
    const double cpu = number(s, "seconds", "cpu"), light = number(s, "seconds", "shade");
    const double clusters = number(s, "mean_cut", "direct") + number(s, "mean_cut", "indirect");
    std::string text = fmt::format(
        "{} of {}x{} took {} on the clock and {:.1f} s of CPU time, {:.0f} % of it gathering light, with {} per point "
        "of {}.",
        core::counted(s.at("frames").get<std::size_t>(), "frame"), s.at("width").get<int>(), s.at("height").get<int>(),
        clock_text(number(s, "seconds", "wall")), cpu, 100 * core::divide_or(light, cpu, 0.0),
        core::counted(static_cast<std::size_t>(std::llround(clusters)), "cluster"),
        core::counted(s.at("counts").at("direct_points").get<std::size_t>() +
                          s.at("counts").at("indirect_points").get<std::size_t>(),
                      "light point"));
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

/// What the page plots of frames, by key; the JSON file has all.
json frames_of(const json& s) {
    json frames = json::object();
    for (const char* key :
         {"frame", "type", "bytes", "mean_quantiser", "mse_y", "direct_cut", "indirect_cut", "gather_rays",
          "shadow_rays", "records_created", "records_served", "seconds", "seconds_by_stage"}) {
        json& values = frames[key] = json::array();
        for (const json& frame : s.at("per_frame")) values.push_back(frame.at(key));
    }
    return frames;
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
    const json value = read_json(file);
    if (!value.is_object() || !value.contains("summary")) return false;
    return (value.contains("per_frame") && value.contains("plan")) ||
           (value.contains("rows") && value.contains("windows"));
}

}  // namespace

namespace {

/// JSON as a script within a page.
std::string script_of(const json& value) {
    std::string data = value.dump(-1, ' ', false, json::error_handler_t::replace);
    // No text may end the script that holds it.
    for (std::size_t at = 0; (at = data.find('<', at)) != std::string::npos; at += 6) data.replace(at, 1, "\\u003c");
    return data;
}

std::string filled(std::string text, std::string_view place, const json& value) {
    return text.replace(text.find(place), place.size(), script_of(value));
}

/// A file's name as links have it: percent signs and numbers for what they reserve.
std::string escaped(const std::string& name) {
    std::string address;
    for (const char c : name)
        if (std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("-._~/").find(c) != std::string::npos)
            address += c;
        else
            address += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    return address;
}

/// The part that shows a panorama, which is looked for beside the page as it lies now; else nothing.
std::string around(const std::filesystem::path& html, const RenderJob& film, const std::filesystem::path& output) {
    if (!film.coding.sphere || output.empty()) return {};
    const encoder::SphereBounds& b = *film.coding.sphere;
    const bool has_eyes = film.coding.packing != core::FramePacking::none;
    return filled(
        around_html, "AROUND_DATA",
        {{"name", escaped(std::filesystem::proximate(output, html.parent_path().empty() ? "." : html.parent_path())
                              .generic_string())},
         {"bounds", {b.left, b.top, b.right, b.bottom}},
         {"stereo", has_eyes ? json(core::name_of(film.coding.packing)) : json()}});
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

void write_page(const std::filesystem::path& html, const json& page, const std::string& part) {
    std::string text = filled(page_html, "REPORT_DATA", page);
    text.insert(text.rfind("</body>"), part.empty() ? part : "<main>" + part + "</main>\n");
    write_whole(html, text);
}

void write_report(const std::filesystem::path& html, const RenderJob& film, const RunStatistics& statistics,
                  const RunFacts& facts, const json& pictures) {
    json s = statistics_of(film, statistics, facts);
    s["summary"] = sentence_of(s);
    s["plan"] = plan_of(film, statistics);
    json shown = s;
    shown.erase("per_frame");
    write_page(html,
               {{"kind", "render"},
                {"title", std::filesystem::path(facts.output).filename().string()},
                {"lead", s.at("summary")},
                {"figures", shown},
                {"frames", frames_of(s)},
                {"scale", scale_of(s)},
                {"text", summary(film, statistics, facts)},
                {"pictures", pictures}},
               around(html, film, facts.output));
    write_json(report_json_of(html), s);
}

}  // namespace render2mpeg::app
