#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/progress.h"
#include "app/statistics.h"
#include "core/error.h"
#include "core/numeric.h"
#include "encoder/cadence.h"

namespace render2mpeg::app {
namespace {

std::string size_text(double bytes) {
    if (bytes < 1e3) return fmt::format("{:.0f} B", bytes);
    if (bytes < 1e6) return fmt::format("{:.1f} kB", bytes / 1e3);
    return bytes < 1e9 ? fmt::format("{:.2f} MB", bytes / 1e6) : fmt::format("{:.2f} GB", bytes / 1e9);
}

std::string count_text(double count) {
    if (count < 1e4) return fmt::format("{:.0f}", count);
    if (count < 1e6) return fmt::format("{:.1f} k", count / 1e3);
    return count < 1e9 ? fmt::format("{:.1f} M", count / 1e6) : fmt::format("{:.2f} G", count / 1e9);
}

std::string percent_text(double share) {
    return fmt::format("{:.1f} %", 100 * share);
}

/// CPU seconds by pass and of the whole, from the statistics of a render.
struct PassCosts {
    nlohmann::json passes;
    double total = 0;
};

PassCosts read_costs(const std::filesystem::path& file) {
    std::ifstream stream(file);
    if (!stream) throw core::Error("reading", file.string(), "the file cannot be opened");
    try {
        const nlohmann::json statistics = nlohmann::json::parse(stream);
        return {statistics.at("passes"), statistics.at("seconds").at("cpu").get<double>()};
    } catch (const nlohmann::json::exception&) {
        throw core::Error("reading", file.string(), "these are not the statistics of a render (docs/stats.md)");
    }
}

/// The shape that the film is shown in, where it is not that of square pixels.
const char* shape_text(const encoder::Settings& coding) {
    static constexpr std::array shapes{"", "", " (4:3)", " (16:9)", " (2.21:1)"};
    return shapes.at(static_cast<std::size_t>(coding.aspect_ratio_code));
}

std::string rate_text(const encoder::Settings& coding) {
    const std::string rate = std::string(coding.rate.name) + " Hz";
    if (coding.cadence != encoder::Cadence::pulldown) return rate;
    return rate + " (" + encoder::declared_rate(coding).name + " with repeated fields)";
}

/// The film and what making it took.
std::string opening_lines(const Film& film, const Ledger& ledger, const RunFacts& facts) {
    const auto frames = static_cast<double>(ledger.frames.size());
    const double duration = frames / film.coding.rate.hertz.value();
    std::string text = fmt::format("{}: {} frame{}, {}x{}{} at {}, {:.2f} s", facts.output, ledger.frames.size(),
                                   ledger.frames.size() == 1 ? "" : "s", film.coding.width, film.coding.height,
                                   shape_text(film.coding), rate_text(film.coding), duration);
    if (facts.bytes > 0)
        text += fmt::format(", {}, {:.0f} kb/s", size_text(static_cast<double>(facts.bytes)),
                            core::divide_or(8e-3 * static_cast<double>(facts.bytes), duration, 0.0));
    text += "\n  CPU time   ";
    for (std::size_t i = 0; i < ledger.seconds.size(); ++i)
        if (ledger.seconds[i] > 0) text += fmt::format("{} {:.2f}  ", stage_names[i], ledger.seconds[i]);
    return text + fmt::format("of {:.2f} s; {} on the clock; peak memory {:.0f} MiB\n", cpu_seconds(),
                              clock_text(ledger.wall), peak_memory_mib());
}

/// How a coded film came out. `made`: what was done to its pictures before they were coded.
std::string closing_lines(const Film& film, const Ledger& ledger, const char* made) {
    std::string text;
    const RateOutcome rate = ledger.rate_outcome();
    const auto share = [](double part, double whole) { return percent_text(core::divide_or(part, whole, 0.0)); };
    if (const std::int64_t wanted = film.coding.rate_control.bit_rate; wanted > 0) {
        const double seconds = static_cast<double>(ledger.frames.size()) / film.coding.rate.hertz.value();
        const double real = core::divide_or(8.0 * static_cast<double>(rate.bytes), seconds, 0.0);
        text += fmt::format("  rate       {:.0f} of {:.0f} kb/s wanted ({:+.1f} %)", 1e-3 * real,
                            1e-3 * static_cast<double>(wanted), 100.0 * (real / static_cast<double>(wanted) - 1.0));
        if (rate.stuffing > 0)
            text += fmt::format(", {} of it stuffing",
                                share(static_cast<double>(rate.stuffing), static_cast<double>(rate.bytes)));
        text += "\n";
    }
    if (rate.off_plan > 0)
        text += fmt::format("  quantiser  {} of {} pictures were coded with another than they were made for\n",
                            rate.off_plan, ledger.frames.size());
    if (rate.requantised > 0)
        text += fmt::format("  buffer     {} pictures were coded again, coarser, to reach the decoder in time\n",
                            rate.requantised);
    if (rate.minimal > 0)
        text += fmt::format("             {} of them show no detail at all: the rate is too low\n", rate.minimal);
    return text + fmt::format("  quality    decoded against {}: PSNR-Y {:.2f} dB, SSIM-Y {:.4f}\n", made,
                              ledger.psnr_y(), ledger.ssim_y());
}

}  // namespace

std::string summary(const Production& film, const Ledger& ledger, const RunFacts& facts) {
    const renderer::Statistics& r = ledger.rendering;
    std::string text = opening_lines(film.film(), ledger, facts);
    text += fmt::format(
        "  light      {} direct and {} indirect light points; mean cut {:.1f} and {:.1f}; {} points to light, {} "
        "shadow rays\n",
        r.direct_points, r.indirect_points, ledger.mean_direct_cut(), ledger.mean_indirect_cut(),
        count_text(static_cast<double>(r.gather_points)), count_text(static_cast<double>(r.shadow_rays)));
    if (r.capped_points > 0)
        text +=
            fmt::format("             {} of the points stopped at the largest cut: their tolerance is not certified\n",
                        percent_text(core::divide_or(static_cast<double>(r.capped_points),
                                                     static_cast<double>(r.gather_points), 0.0)));
    if (r.clamped_energy > 0.0005)
        text +=
            fmt::format("             {} of the light was clamped near light points\n", percent_text(r.clamped_energy));
    if (film.audit > 0)
        text += fmt::format(
            "  audit      {} pixels gathered again from every light point: {:.2f} % beyond their tolerance; error "
            "{:.2f} % "
            "(median), {:.2f} % (95th percentile), {:.2f} % (99th); {:.2f} s\n",
            ledger.audit.errors.size(), 100 * ledger.audit.share_over(), 100 * ledger.audit.error_at(0.5),
            100 * ledger.audit.error_at(0.95), 100 * ledger.audit.error_at(0.99), ledger.audit.seconds);
    if (ledger.brightest_luma <= 16)
        text += "             every pixel is black: no light reaches what the camera sees\n";
    if (r.non_finite > 0)
        text += fmt::format("             {} values were not finite and became 0, the first in {}\n", r.non_finite,
                            r.first_non_finite);
    if (film.kind == OutputKind::film) text += closing_lines(film.film(), ledger, "rendered");
    return text;
}

std::string encode_summary(const Film& film, const Ledger& ledger, const RunFacts& facts) {
    std::string text = opening_lines(film, ledger, facts);
    if (ledger.rendering.non_finite > 0)
        text += fmt::format("  frames     {} values were not finite and became 0\n", ledger.rendering.non_finite);
    return text + closing_lines(film, ledger, "the frames given");
}

std::string plan_table(const renderer::Plan& plan, const std::filesystem::path& statistics) {
    const bool costs_known = !statistics.empty();
    const PassCosts costs = costs_known ? read_costs(statistics) : PassCosts{};
    std::string text;
    for (const renderer::PlanRow& row : plan.rows()) {
        text += fmt::format("{:<3} {:<21}", row.runs ? "yes" : "no", row.name);
        if (costs_known) {
            const auto cost = costs.passes.find(row.name);
            text += cost != costs.passes.end() && cost->is_number()
                        ? fmt::format(" {:>9.2f} s {:>7}", cost->get<double>(),
                                      percent_text(core::divide_or(cost->get<double>(), costs.total, 0.0)))
                        : fmt::format(" {:>11} {:>7}", "", "");
        }
        text += fmt::format("  {}\n", row.reason);
    }
    return text;
}

}  // namespace render2mpeg::app
