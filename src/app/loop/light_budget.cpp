#include "app/loop/light_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "app/loop/first_pass.h"
#include "app/loop/preview.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "core/dct.h"
#include "core/numeric.h"
#include "perceptual/display.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::app {
namespace {

/// Pixels of all frames of a film from which on measuring pays. chosen: 100,000, three frames of 192x192; measuring
/// takes as long as a few of them.
constexpr std::int64_t least_work = 100'000;

/// Frames that are measured, spread over the film, and the pixels that are shared among them; the frames' longest side.
/// chosen: 3, 768 and 192: few pixels hold most of the error. Short films have one frame for so many pixels of theirs,
/// so that measuring stays a small part of them.
constexpr int most_frames = 3, pixels = 768, longest_side = 192;
constexpr std::int64_t work_per_frame = 1'200'000;

/// Sets of light points, and those of the second over those of the first.
constexpr int sets = 2;
constexpr double finer = 4;

/// Of what a film may lose, the share that light points may take. chosen: two thirds; gathering and eye samples share
/// the rest.
constexpr double light_share = 2.0 / 3.0;

/// The most light points that a film gets, and that it gets where light changes: more take more photons, in every
/// frame. chosen: 262,144 and 16,384; Sponza loses 0.48 dB at quantiser 8 with 262,144 and 1.10 dB with 65,536, for 1.4
/// times the time of a later frame (docs/measurements.md).
constexpr int most_vpls = 1 << 18, most_of_changing_light = 1 << 14, least_vpls = 1 << 10;

/// Errors of light points fall with this power of their number, and those of the second set are this part of what the
/// sets differ by. fit: 0.47 to 0.49 and 0.5 to 0.75 in cornell, colonnade and a figure under a sky
/// (docs/model/budget.md).
constexpr double power = 0.48, part_of_difference = 0.6;

int quantiser_of(const encoder::Settings& coding) {
    return coding.rate_control.bit_rate > 0 ? usual_quantiser(coding) : coding.quantiser;
}

/// Sum of squares over a block's pixels of what quantisation by even steps takes, and how many these are.
struct Squares {
    double sum = 0, count = 0;

    void add(const core::Picture& picture, float step) {
        for (int y = 0; y + 8 <= picture.y.height(); y += 8)
            for (int x = 0; x + 8 <= picture.y.width(); x += 8) {
                core::Block8x8 block;
                for (std::size_t i = 0; i < 64; ++i)
                    block[i] = picture.y.at(x + static_cast<int>(i % 8), y + static_cast<int>(i / 8));
                for (const float c : core::forward_dct(block)) {
                    const double lost = c - step * std::round(c / step);
                    sum += lost * lost;
                }
                count += 64;
            }
    }
    double root_mean() const { return std::sqrt(core::divide_or(sum, count, 0.0)); }
};

/// Pixels of all frames of a film.
std::int64_t work_of(const RenderJob& film) {
    return film.frame_count() * film.format.width * film.format.height;
}

RenderJob small(const RenderJob& film, double factor) {
    RenderJob job = film;
    const float scale = std::min(
        1.0f, static_cast<float>(longest_side) / static_cast<float>(std::max(film.format.width, film.format.height)));
    job.format.width = std::max(8, static_cast<int>(std::lround(static_cast<float>(film.format.width) * scale)));
    job.format.height = std::max(8, static_cast<int>(std::lround(static_cast<float>(film.format.height) * scale)));
    job.rendering.format = job.format;
    job.rendering.samples = 1;
    job.rendering.edge_samples = job.rendering.most_samples = 0;
    job.rendering.cache = renderer::CacheUse::off;
    job.rendering.vpls = static_cast<int>(std::lround(factor * film.rendering.vpls));
    return job;
}

/// A film's small frames as light points light them.
class Measurement {
  public:
    Measurement(const RenderJob& film, bool quiet)
        : film_(film),
          display_(film.display()),
          frames_(static_cast<int>(std::clamp<std::int64_t>(work_of(film) / work_per_frame, 1, most_frames))),
          progress_(sets * frames_, quiet, "light points", Counted::parts_of_step) {}

    /// Luma, in code values, of the same pixels of all frames, by `factor` times as many light points. Ends early where
    /// it is interrupted.
    std::vector<float> luma(double factor) {
        const RenderJob job = small(film_, factor);
        renderer::Renderer renderer = renderer_of(job);
        const auto reference = core::ToleranceMap::reference();
        std::vector<float> luma;
        for (int i = 0; i < frames_ && !InterruptGuard::requested(); ++i) {
            const scene::Snapshot world =
                job.snapshot(film_.frames.first + (film_.frame_count() - 1) * (2 * i + 1) / (2 * frames_));
            if (i == 0) renderer.start_chunk(world);
            renderer::Seen seen = renderer.see(world);
            renderer.add_air(world, nullptr, seen);
            const core::Radiance rough = preview(renderer, world, seen);
            if (factor == 1)
                coding_.add(display_.develop(rough), 2.0f * static_cast<float>(quantiser_of(film_.coding)));
            for (const renderer::AuditedPixel& pixel : renderer.audit(world, seen, reference, rough, pixels / frames_))
                luma.push_back(perceptual::luma_of(display_, pixel.radiance));
            progress_.advance();
        }
        return luma;
    }

    double coding_error() const { return coding_.root_mean(); }

  private:
    const RenderJob& film_;
    perceptual::Display display_;
    int frames_;
    Progress progress_;
    Squares coding_;
};

double distance(std::span<const float> a, std::span<const float> b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(core::divide_or(sum, static_cast<double>(a.size()), 0.0));
}

int power_of_two(double number, int most) {
    return static_cast<int>(std::exp2(std::ceil(std::log2(std::clamp<double>(number, least_vpls, most)) - 0.25)));
}

}  // namespace

bool has_budget(const RenderJob& film) {
    return film.loss && film.rendering.vpls > 0 && film.plan.runs(renderer::Pass::photons) &&
           work_of(film) >= least_work;
}

int most_light_points(const RenderJob& film) {
    if (!has_budget(film)) return film.rendering.vpls;
    return scene::traits_of(*film.animation).changes_light() ? most_of_changing_light : most_vpls;
}

std::optional<LightBudget> measure_light(const RenderJob& film, bool quiet) {
    Measurement measurement(film, quiet);
    const std::vector<float> fewer = measurement.luma(1.0 / finer), few = measurement.luma(1);
    if (InterruptGuard::requested()) return {};
    LightBudget budget;
    budget.coding_error = measurement.coding_error();
    budget.allowed = budget.coding_error * std::sqrt(light_share * (std::pow(10.0, *film.loss / 10.0) - 1.0));
    budget.error = part_of_difference * distance(fewer, few);
    const double over = core::divide_or(budget.error, budget.allowed, 1.0);
    budget.vpls = power_of_two(film.rendering.vpls * std::pow(over, 1.0 / power), most_light_points(film));
    return budget;
}

nlohmann::json json_of(const LightBudget& b) {
    return {{"coding_error", b.coding_error}, {"allowed", b.allowed}, {"error", b.error}, {"vpls", b.vpls}};
}

std::optional<LightBudget> budget_from(const nlohmann::json& written) {
    if (!written.is_object()) return {};
    try {
        return LightBudget{written.at("coding_error"), written.at("allowed"), written.at("error"), written.at("vpls")};
    } catch (const nlohmann::json::exception&) {
        return {};  // damaged: it is found again
    }
}

std::string text_of(const LightBudget& b) {
    return fmt::format("{} carry indirect light: 4,096 err by {:.1f} code values, coding by {:.1f}; {:.1f} are allowed",
                       b.vpls, b.error, b.coding_error, b.allowed);
}

void spend(RenderJob& film, const LightBudget& budget) {
    film.rendering.vpls = budget.vpls;
}

}  // namespace render2mpeg::app
