#include "app/experiments/cost_table.h"

#include <fmt/format.h>

#include <cmath>

#include "app/experiments/reference_cache.h"
#include "app/report/figures.h"

namespace render2mpeg::app {
namespace {

std::string percent(double share) {
    return short_figure(100 * share);
}

/// As the columns below.
std::string columns(const std::string& name, const char* first) {
    return fmt::format("{:<9}{}\n{:<9}{:>7} {:>6} {:>6} {:>6} {:>6} {:>5} {:>5} {:>6} {:>6} {:>8}\n", "",
                       "  light           cut  error, %     pixels over, %", name, first, "rays", "size", "median",
                       "95 %", "it", "twice", "PSNR-Y", "SSIM", "size");
}

std::string row(const std::string& name, const Trial& t) {
    // Its quantiser says less than it seems to.
    const std::string note = t.requantised == 0
                                 ? ""
                                 : fmt::format("{:<9}{} of {} pictures coded coarser than that, to fit the buffer\n",
                                               "", t.requantised, t.frames);
    return fmt::format("{:<9}{:>7} {:>6} {:>6} {:>6} {:>6} {:>5} {:>5} {:>6} {:.4f} {:>8}\n", name,
                       short_figure(t.seconds), count_text(t.rays), count_text(t.cut), percent(t.errors.quantile(0.5)),
                       percent(t.errors.quantile(0.95)), percent(t.share_over()), percent(t.share_over_twice()),
                       psnr_text(t.decoded.psnr_y()), t.decoded.ssim_y(), size_text(t.bytes)) +
           note;
}

}  // namespace

std::string cost_heading(const RenderJob& film, const Sweep& sweep) {
    std::string frames;
    int count = 0;
    for (const Chunk& window : sweep.windows) {
        count += static_cast<int>(window.frames());
        // Where there are many, the first ones tell how they lie.
        if (&window - sweep.windows.data() < 4)
            frames += (frames.empty() ? "" : ", ") + (window.first == window.last
                                                          ? fmt::format("{}", window.first)
                                                          : fmt::format("{} to {}", window.first, window.last));
        else if (&window - sweep.windows.data() == 4)
            frames += ", ...";
    }
    return fmt::format("{}: {} frame{} of {}x{} ({}); {} by {} as reference\n", film.animation->source, count,
                       count == 1 ? "" : "s", film.format.width, film.format.height, frames, sweep.references,
                       reference_light(film, sweep.direct_points + sweep.indirect_points)) +
           fmt::format("reference light: {} s of CPU per frame\n", short_figure(sweep.reference_seconds));
}

std::string fixed_heading(int quantiser) {
    return fmt::format("\nFixed tolerances, coded with quantiser {}. Light: CPU seconds per frame, rays per\n",
                       quantiser) +
           "point; PSNR-Y and SSIM: decoded, against reference light before coding.\n" + columns("fixed", "s");
}

std::string fixed_row(const Trial& trial) {
    return row(tolerance_text(trial.tolerance.relative), trial);
}

std::string pair_heading() {
    return "\nCoupled to the quantiser, and a fixed 2 % coded with it.\n" + columns("quantiser", "s");
}

std::string pair_rows(const CoupledPair& pair) {
    std::string text =
        row(fmt::format("{:>2} coup.", pair.coupled.quantiser), pair.coupled) + row("    2 %", pair.fixed);
    const std::optional<double> ratio = pair.time_ratio(), loss = pair.psnr_loss();
    if (!ratio) return text;
    text += fmt::format("{:<9}{:.2f} times the time", "", *ratio);
    if (loss) text += fmt::format(", {:+.2f} dB PSNR-Y, {:+.4f} SSIM", -*loss, -pair.ssim_loss());
    return text + "\n";
}

}  // namespace render2mpeg::app
