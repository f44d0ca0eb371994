#include "app/experiments/trial_page.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/files/file_io.h"
#include "app/report/figures.h"
#include "app/report/frame_view.h"
#include "app/report/heatmap_film.h"
#include "app/report/report.h"

namespace render2mpeg::app {

using nlohmann::json;

json trial_json(const RenderJob& film, const std::string& command, const std::vector<Chunk>& windows, int references,
                double reference_seconds) {
    json frames = json::array();
    for (const Chunk& window : windows) frames.push_back({window.first, window.last});
    return {{"command", command},
            {"version", RENDER2MPEG_VERSION},
            {"isa", core::name_of(film.rendering.isa)},
            {"input", film.animation->source},
            {"width", film.format.width},
            {"height", film.format.height},
            {"fps", film.rate.hertz.value()},
            {"windows", frames},
            {"reference", {{"frames", references}, {"seconds", reference_seconds}}}};
}

json light_json(const RenderJob& film) {
    return {{"samples", film.rendering.samples},
            {"edge_samples", film.rendering.edge_samples},
            {"vpls", film.rendering.vpls},
            {"masking", film.coupling.strategy == perceptual::Strategy::quantised ? "quantised" : "warped"},
            {"cache", cache_word(film.rendering)}};
}

json quality_json(double psnr_y, double ssim_y) {
    return {{"psnr_y", finite_or_null(psnr_y)}, {"ssim_y", ssim_y}};
}

std::string sample_frame_figures(const std::string& name, const Trial& trial, const RenderJob& film) {
    if (!trial.sample_frame) return {};
    const SampleFrame& own = *trial.sample_frame;
    // Both figures share one scale.
    perceptual::HeatScale error = scale_of(HeatSubject::tolerance);
    error.title = "TRUE ERROR / LUMINANCE";
    return slider_figure(fmt::format("Frame {}: {} decoded, beside reference light, not coded", own.frame, name),
                         {name, own.decoded}, {"reference light", own.truth},
                         perceptual::matrix_for(film.format.height)) +
           heat_figure("What each pixel's light may be off by", own.tolerance, scale_of(HeatSubject::tolerance)) +
           heat_figure("What it is off by", own.error, error);
}

std::string decoded_pair(const std::string& title, const std::string& name, const Trial& trial,
                         const std::string& other_name, const Trial& other, const RenderJob& film) {
    if (!trial.sample_frame || !other.sample_frame) return {};
    return slider_figure(title, {name, trial.sample_frame->decoded}, {other_name, other.sample_frame->decoded},
                         perceptual::matrix_for(film.format.height));
}

void write_trial_page(const std::filesystem::path& html, const RenderJob& film, const std::string& title,
                      const std::string& lead, const std::string& body, const std::string& command,
                      const std::string& guide, const json& figures) {
    const std::filesystem::path source = film.animation->source;
    const std::string name = (source.has_filename() ? source : source.parent_path()).filename().string();
    write_whole(html, report_page(name + ": " + title, lead,
                                  body + "<h2>To find it out again</h2>\n<pre>" + escaped(command) +
                                      "</pre>\n<p class=\"soft\">Every figure is in the JSON file beside this page (" +
                                      guide + ").</p>\n"));
    write_json(report_json_of(html), figures);
}

}  // namespace render2mpeg::app
