#include "app/experiments/trial_table.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/files/file_io.h"
#include "app/report/figures.h"

namespace render2mpeg::app {
namespace {

std::string four_digits(double value) {
    return fmt::format("{:.4f}", value);
}
std::string percent_of(double share) {
    return short_figure(100 * share);
}

}  // namespace

namespace columns {
const TrialColumn light{"light_seconds", "light, s", 8, short_figure, [](const Trial&t) { return t.seconds; }},
    code{"code_seconds", "code, s", 8, short_figure, [](const Trial&t) { return t.code_seconds; }},
    rays{"rays_per_point", "rays", 6, count_text, [](const Trial&t) { return t.rays; }},
    cut{"cut", "cut", 5, count_text, [](const Trial&t) { return t.cut; }},
    median{"error_p50", "50 %", 5, percent_of, [](const Trial&t) { return t.errors.quantile(0.5); }},
    p95{"error_p95", "95 %", 5, percent_of, [](const Trial&t) { return t.errors.quantile(0.95); }},
    over{"over_tolerance", "over", 5, percent_of, [](const Trial&t) { return t.share_over(); }},
    twice{"over_twice", "", 0, nullptr, [](const Trial&t) { return t.share_over_twice(); }},
    psnr_y{"psnr_y", "PSNR-Y", 6, psnr_text, [](const Trial&t) { return t.film_quality().psnr_y; }},
    ssim_y{"ssim_y", "SSIM", 6, four_digits, [](const Trial&t) { return t.film_quality().ssim_y; }},
    psnr_hvs_m{"psnr_hvs_m", "HVS-M", 6, psnr_text, [](const Trial&t) { return t.film_quality().psnr_hvs_m; }},
    bytes{"bytes", "size", 8, size_text, [](const Trial&t) { return t.bytes; }},
    kilobits{"kilobits", "kb/s", 9, [](double kilobits) { return fmt::format("{:.1f}", kilobits); },
             [](const Trial&t) { return 1e-3 * t.bit_rate; }};

namespace {
const TrialColumn capped{"capped", "", 0, nullptr, [](const Trial&t) { return t.capped; }},
    points{"points", "", 0, nullptr, [](const Trial&t) { return static_cast<double>(t.points); }},
    p99{"error_p99", "", 0, nullptr, [](const Trial&t) { return t.errors.quantile(0.99); }},
    pixels{"error_pixels", "", 0, nullptr, [](const Trial&t) { return static_cast<double>(t.errors.count()); }},
    lit_psnr_y{"lit_psnr_y", "", 0, nullptr, [](const Trial&t) { return t.lit.psnr_y(); }},
    lit_ssim_y{"lit_ssim_y", "", 0, nullptr, [](const Trial&t) { return t.lit.ssim_y(); }},
    film_bytes{"film_bytes", "", 0, nullptr, [](const Trial&t) { return t.film_bytes; }},
    requantised{"requantised", "", 0, nullptr, [](const Trial&t) { return static_cast<double>(t.requantised); }},
    cpu{"cpu", "", 0, nullptr, [](const Trial&t) { return t.cpu; }},
    clock{"clock", "", 0, nullptr, [](const Trial&t) { return t.clock; }};
const TrialColumns all{&light,      &code,   &rays,       &cut,      &capped,      &points, &median,     &p95,
                       &p99,        &pixels, &over,       &twice,    &psnr_y,      &ssim_y, &psnr_hvs_m, &lit_psnr_y,
                       &lit_ssim_y, &bytes,  &film_bytes, &kilobits, &requantised, &cpu,    &clock};
}  // namespace
}  // namespace columns

std::string heads_text(const TrialColumns& columns, const std::string& name, int width) {
    std::string text = fmt::format("{:<{}}", name, width);
    for (const TrialColumn* c : columns)
        if (c->width > 0) text += fmt::format(" {:>{}}", c->head, c->width);
    return text + "\n";
}

std::string row_text(const TrialColumns& columns, const std::string& name, int width, const Trial& trial) {
    std::string text = fmt::format("{:<{}}", name, width);
    for (const TrialColumn* c : columns)
        if (c->width > 0) text += fmt::format(" {:>{}}", c->text(c->value(trial)), c->width);
    if (trial.requantised == 0) return text + "\n";
    // The quantiser of a rate-controlled film says little.
    return text + fmt::format("\n{:<{}} {} of {} pictures coded coarser than that, to fit the buffer\n", "", width,
                              trial.requantised, trial.frames);
}

nlohmann::json figures_json(const Trial& trial) {
    nlohmann::json figures{{"quantiser", trial.quantiser}};
    for (const TrialColumn* c : columns::all) figures[c->key] = finite_or_null(c->value(trial));
    return figures;
}

}  // namespace render2mpeg::app
