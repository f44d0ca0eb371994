#include "app/experiments/sample_frame_view.h"

#include <fmt/format.h>

#include "app/report/frame_view.h"
#include "app/report/heatmap_film.h"

namespace render2mpeg::app {

std::string sample_frame_figures(const std::string& name, const Trial& trial, perceptual::ColorMatrix matrix) {
    if (!trial.sample_frame) return {};
    const SampleFrame& own = *trial.sample_frame;
    // One scale for both: they are to be compared.
    perceptual::HeatScale error = scale_of(HeatSubject::tolerance);
    error.title = "TRUE ERROR / LUMINANCE";
    return slider_figure(fmt::format("Frame {}: {} decoded, beside reference light, not coded", own.frame, name),
                         {name, own.decoded}, {"reference light", own.truth}, matrix) +
           heat_figure("What each pixel's light may be off by", own.tolerance, scale_of(HeatSubject::tolerance)) +
           heat_figure("What it is off by", own.error, error);
}

std::string decoded_pair(const std::string& title, const std::string& name, const Trial& trial,
                         const std::string& other_name, const Trial& other, perceptual::ColorMatrix matrix) {
    if (!trial.sample_frame || !other.sample_frame) return {};
    return slider_figure(title, {name, trial.sample_frame->decoded}, {other_name, other.sample_frame->decoded}, matrix);
}

}  // namespace render2mpeg::app
