#include "app/experiments/trial.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "app/job/scene_settings.h"
#include "app/loop/picture_coder.h"
#include "app/loop/pipeline.h"
#include "app/report/frame_view.h"
#include "app/system/interrupt.h"
#include "core/color.h"
#include "core/numeric.h"
#include "encoder/encoder.h"
#include "encoder/latitude.h"
#include "parallel/loops.h"
#include "renderer/calibration/audit.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::app {
namespace {

RenderJob plainly_coded(RenderJob film, int references) {
    film.coding.rate_control.mode = encoder::RateMode::constant_quantiser;
    film.two_passes = false;
    film.audit = 0;
    // References have no tolerance, and so no supersampled edges: light alone is compared.
    if (references > 0) film.rendering.most_samples = 0;
    return film;
}

/// Whether one renderer serves both.
bool is_same_light(const RenderJob& a, const RenderJob& b) {
    const renderer::Settings &r = a.rendering, &s = b.rendering;
    return a.preview == b.preview && r.indirect == s.indirect && r.samples == s.samples &&
           r.edge_samples == s.edge_samples && r.most_samples == s.most_samples && r.vpls == s.vpls &&
           r.cache == s.cache;
}

void set_coding(Trial& trial, const encoder::Settings& coding) {
    trial.quantiser = coding.quantiser;
    trial.quality.reset();
    if (coding.rate_control.mode == encoder::RateMode::constant_quality) trial.quality = coding.rate_control.quality;
}

void set_film_bytes(Trial& trial, double bytes, const RenderJob& film) {
    trial.film_bytes = bytes;
    trial.bit_rate = 8 * bytes * film.rate.hertz.value();
}

/// Sets counts per gather point from the renderer's growth.
void set_counts(Trial& trial, const renderer::Statistics& before, const renderer::Statistics& after) {
    trial.points = after.gather_points - before.gather_points;
    const auto per_point = [&](std::uint64_t count) { return ratio_of(count, trial.points); };
    trial.rays = per_point(after.shadow_rays + after.gather_rays - before.shadow_rays - before.gather_rays);
    trial.cut =
        per_point(after.direct_clusters + after.indirect_clusters - before.direct_clusters - before.indirect_clusters);
    trial.capped = per_point(after.capped_points - before.capped_points);
}

/// Mean squared errors add up, as far as coding and light err independently.
double sum_of(double shown, double there, double decoded) {
    const auto error = [](double psnr) { return std::isfinite(psnr) ? std::pow(10.0, -0.1 * psnr) : 0.0; };
    const double sum = std::max(0.0, error(shown) + error(decoded) - error(there));
    return sum > 0 ? -10 * std::log10(sum) : std::numeric_limits<double>::infinity();
}

}  // namespace

double ReferenceFrame::mean_squared_error(const core::Plane<std::uint8_t>& luma) const {
    // A pixel's squared error is the product of those against both halves.
    const float all_rows = std::accumulate(rows.begin(), rows.end(), 0.0f) / static_cast<float>(luma.height());
    double change = 0;
    for (const TruePixel& p : truth) {
        const double error = 1.0 * luma.at(p.place.x, p.place.y) - picture.y.at(p.place.x, p.place.y),
                     weight = rows.empty() ? 1.0 : rows[static_cast<std::size_t>(p.place.y)] / all_rows;
        change += weight * ((error - p.beyond[0]) * (error - p.beyond[1]) - error * error);
    }
    const double share = static_cast<double>(gathering.size()) / static_cast<double>(luma.size());
    const double all = perceptual::mean_squared_error(luma, picture.y, rows) +
                       share * core::divide_or(change, static_cast<double>(truth.size()), 0.0);
    return std::max(all, 0.0);
}

std::vector<Chunk> windows_by_shot(const RenderJob& film, const SampleExtent& sample) {
    const std::size_t cuts = cuts_of(film).size();
    // chosen: eight shots are sampled one by one (4 to 16); of more the parts tell enough.
    if (cuts == 0 || cuts >= 8) return middle_windows(film, sample.windows, sample.frames);
    return windows_of_shots(film, sample.frames);
}

RenderJob at_quantiser(RenderJob film, int quantiser) {
    film.coding.quantiser = quantiser;
    film.coding.rate_control.mode = encoder::RateMode::constant_quantiser;
    return film;
}

RenderJob at_quality(RenderJob film, double quality) {
    film.coding.rate_control.mode = encoder::RateMode::constant_quality;
    film.coding.rate_control.quality = quality;
    return film;
}

Quality Trial::film_quality(const Quality& shown_all) const {
    const auto of = [](const perceptual::FilmQuality& q, double masked) {
        return Quality{q.psnr_y(), q.ssim_y(), perceptual::psnr(masked)};
    };
    return has_references ? with_light(shown_all, of(shown_there, shown_masked_there), of(decoded, masked_error))
                          : shown_all;
}
Quality Trial::film_quality() const {
    return film_quality({shown.psnr_y(), shown.ssim_y(), perceptual::psnr(shown_masked)});
}

/// Compares lit and coded pictures with references, where there are any.
class Trials::Judge : public LoopObserver {
  public:
    Judge(const Trials& trials, Trial& trial, LitWindows* keep) : trials_(trials), trial_(trial), keep_(keep) {}

    void lit(const LitFrame& frame) override {
        waiting_.insert_or_assign(frame.world.frame, frame.picture);
        if (keep_ != nullptr)
            keep_->frames.insert_or_assign(frame.world.frame,
                                           LitWindows::Shown{frame.picture, frame.lit.frame.visible});
        const auto known = trials_.references_.find(frame.world.frame);
        if (known == trials_.references_.end()) return;
        const ReferenceFrame& truth = known->second;
        for (const glm::ivec2 place : truth.gathering) {
            const renderer::AuditedPixel p =
                renderer::compare(place, truth.light.at(place.x, place.y), frame.tolerance, frame.lit.radiance);
            trial_.errors.add(core::divide_or(p.error, std::max(p.luminance, trials_.half_code_), 0.0f));
            trial_.over += p.over() ? 1 : 0;
            trial_.over_twice += p.noticed() > 2 * p.tolerance ? 1 : 0;
        }
        trial_.lit.add(truth.mean_squared_error(frame.picture.y), perceptual::ssim(frame.picture.y, truth.picture.y));
        if (known == std::prev(trials_.references_.end())) keep_sample_frame(frame, truth);
    }

    void coded(const encoder::CodedPicture& picture) override {
        trial_.bytes += static_cast<double>(picture.bytes.size());
        trial_.requantised += picture.tries > 1 ? 1 : 0;
        const auto lit = waiting_.find(picture.plan.number);
        decoded(picture.plan.number, picture.reconstruction, lit->second);
        waiting_.erase(lit);
    }

    void decoded(std::int64_t number, const core::Picture& picture, const core::Picture& lit) {
        trial_.shown.add(picture, lit, trials_.rows_);
        const double masked = trials_.masks_all_ ? perceptual::masked_error(picture.y, lit.y) : 0.0;
        trial_.shown_masked += masked / trials_.frames();
        const auto known = trials_.references_.find(number);
        if (known == trials_.references_.end()) return;
        const ReferenceFrame& truth = known->second;
        trial_.decoded.add(truth.mean_squared_error(picture.y), perceptual::ssim(picture.y, truth.picture.y));
        if (trials_.installed_) judged_.push_back({truth.picture, picture});
        if (trial_.sample_frame && trial_.sample_frame->frame == number) {
            auto sample_frame = std::make_shared<SampleFrame>(*trial_.sample_frame);
            sample_frame->decoded = part_of(picture, view_of(picture.width(), picture.height()));
            trial_.sample_frame = std::move(sample_frame);
        }
        trial_.shown_there.add(picture, lit, trials_.rows_);
        trial_.shown_masked_there += masked / trials_.references();
        trial_.masked_error += perceptual::masked_error(picture.y, known->second.picture.y) / trials_.references();
    }

    /// Ends a trial.
    void finish() const {
        if (trials_.installed_) trial_.installed = trials_.installed_->of(judged_, trials_.film_.colors());
        if (trials_.worst_tenth_) trial_.shown = trial_.shown.worst_tenth();
    }

  private:
    void keep_sample_frame(const LitFrame& frame, const ReferenceFrame& truth) {
        const ViewBox box = view_of(frame.picture.width(), frame.picture.height());
        const core::Plane<glm::vec3>& light = frame.lit.radiance.combined;
        core::Plane<float> error(light.width(), light.height()), tolerance(light.width(), light.height());
        for (std::size_t i = 0; i < light.size(); ++i) {
            const float right = core::luminance(truth.light.values()[i]);
            const float whole = std::max(right, trials_.half_code_);
            error.values()[i] = core::divide_or(std::abs(core::luminance(light.values()[i]) - right), whole, 0.0f);
            if (frame.tolerance.is_reference()) continue;
            const core::Tolerance& t = frame.tolerance.pixels.values()[i];
            tolerance.values()[i] = core::divide_or(t.allows(right), whole, 0.0f);
        }
        trial_.sample_frame = std::make_shared<SampleFrame>(SampleFrame{truth.picture.number,
                                                                        part_of(truth.picture, box),
                                                                        part_of(frame.picture, box),
                                                                        {},
                                                                        part_of(error, box),
                                                                        part_of(tolerance, box)});
    }

    const Trials& trials_;
    Trial& trial_;
    LitWindows* keep_;
    std::map<std::int64_t, core::Picture> waiting_;  ///< lit, and not coded yet
    std::vector<JudgedPicture> judged_;
};

Trials::Trials(const RenderJob& film, std::vector<Chunk> windows, int references)
    : film_(plainly_coded(film, references)),
      windows_(std::move(windows)),
      renderer_(renderer_of(film_)),
      references_of_window_(std::clamp(references, 0, static_cast<int>(windows_.front().frames()))) {
    RenderJob fixed = film_;
    fixed.tolerance = {};
    half_code_ = fixed.tolerance_map().pixels.values()[0].absolute;
}

int Trials::frames() const {
    return std::accumulate(windows_.begin(), windows_.end(), 0,
                           [](int sum, const Chunk& window) { return sum + static_cast<int>(window.frames()); });
}

double Trials::bytes_held(bool keeps_frames) const {
    const double pixels = static_cast<double>(film_.format.width) * film_.format.height;
    constexpr double picture = 1.5 + sizeof(float);
    constexpr double visible = sizeof(core::SurfaceAddress) + sizeof(float) + 2 * sizeof(core::PackedNormal) +
                               sizeof(std::uint32_t) + sizeof(core::PixelClass);
    constexpr double truth = sizeof(glm::vec3) + picture + sizeof(glm::ivec2);
    return pixels * (truth * references_of_window_ * static_cast<double>(windows_.size()) +
                     (keeps_frames ? (picture + visible) * frames() : 0.0));
}

std::optional<Trial> Trials::run(const RenderJob& film, const std::function<bool()>& frame_done, LitWindows* keep) {
    Trial trial;
    set_coding(trial, film.coding);
    trial.frames = frames();
    trial.has_references = references() > 0;
    Judge judge(*this, trial, keep);
    std::optional<renderer::Renderer> own;
    if (!is_same_light(film, film_)) own.emplace(renderer_of(film));
    renderer::Renderer& renderer = own ? *own : renderer_;
    const renderer::Statistics before = renderer.statistics();
    const std::optional<FrameSample> sample = light_sample({film, {windows_, {}}}, renderer, judge, frame_done);
    if (!sample) return std::nullopt;
    const RunStatistics& statistics = sample->statistics;
    set_counts(trial, before, renderer.statistics());
    trial.seconds = statistics.of(Stage::shade) + statistics.of(Stage::preview);
    if (film.tolerance.coupled) trial.seconds += statistics.of(Stage::tolerate);
    trial.seconds /= trial.frames;
    trial.code_seconds = (statistics.of(Stage::encode) + statistics.of(renderer::Pass::motion)) / trial.frames;
    trial.bytes /= trial.frames;
    const FrameCost whole = film_by(film_, *sample);
    set_film_bytes(trial, whole.bytes / static_cast<double>(film_.frame_count()), film_);
    trial.cpu = whole.seconds / static_cast<double>(film_.frame_count());
    trial.clock = trial.cpu * core::divide_or(sample->clock, sample->cpu, 0.0);
    if (keep != nullptr) keep->light = trial;
    judge.finish();
    return trial;
}

Trial Trials::coded_again(const LitWindows& lit, RenderJob film) const {
    return coded_by(
        [&film, &lit](const Chunk& window, const std::vector<const core::Picture*>& pictures,
                      const std::function<void(const core::Picture&)>& decoded) {
            film.frames = {window.first, window.last};
            Coded sum;
            const auto take = [&](const std::vector<encoder::CodedPicture>& coded) {
                for (const encoder::CodedPicture& picture : coded) {
                    sum.bytes += static_cast<double>(picture.bytes.size());
                    sum.requantised += picture.tries > 1 ? 1 : 0;
                    core::Picture shown = picture.reconstruction;
                    shown.number = picture.plan.number - window.first;
                    decoded(shown);
                }
            };
            RunStatistics statistics;
            PosedFrames posed(film);
            PictureCoder coder(film.film(), window, film.allocations, shots_of(*film.animation), statistics,
                               scene::traits_of(*film.animation).lights_change);
            for (std::int64_t n = window.first; n <= window.last; ++n) {
                const EyeSnapshots worlds = posed.at(n);
                RenderedMotion motion(film, posed, {{lit.frames.at(n).visible}}, worlds, statistics);
                take(timed(sum.seconds, [&] {
                    const encoder::PicturePlan plan = coder.plan(n, worlds.front()->cut_before, motion);
                    return coder.code(*pictures[static_cast<std::size_t>(n - window.first)], plan, motion);
                }));
            }
            take(timed(sum.seconds, [&] { return coder.flush(); }));
            return sum;
        },
        lit, film);
}

Trial Trials::coded_by(const Codec& codec, const LitWindows& lit, const RenderJob& film) const {
    Trial trial = lit.light;
    set_coding(trial, film.coding);
    trial.decoded = trial.shown = trial.shown_there = {};
    trial.shown_masked = trial.shown_masked_there = 0;
    trial.masked_error = trial.bytes = trial.code_seconds = 0;
    trial.requantised = 0;
    Judge judge(*this, trial, nullptr);
    for (const Chunk& window : windows_) {
        std::vector<const core::Picture*> pictures;
        for (std::int64_t n = window.first; n <= window.last; ++n) pictures.push_back(&lit.frames.at(n).picture);
        const Coded coded = codec(window, pictures, [&](const core::Picture& picture) {
            judge.decoded(window.first + picture.number, picture, *pictures[static_cast<std::size_t>(picture.number)]);
        });
        trial.bytes += coded.bytes;
        trial.requantised += coded.requantised;
        trial.code_seconds += coded.seconds;
    }
    trial.bytes /= trial.frames;
    set_film_bytes(trial, trial.bytes * core::divide_or(lit.light.film_bytes, lit.light.bytes, 1.0), film_);
    trial.code_seconds /= trial.frames;
    judge.finish();
    return trial;
}

double Trials::reference_seconds() const {
    return ratio_of(reference_seconds_, references_.size());
}

bool Trials::light_references(const std::function<void(double)>& expected, const std::function<bool()>& one_done) {
    const parallel::StopWhen stop(&InterruptGuard::requested);
    try {
        for (const Chunk& window : windows_) {
            renderer_.start_chunk(film_.snapshot(window.first));
            for (int i = 1; i <= references_of_window_; ++i) {
                light_reference(window.first + window.frames() * i / references_of_window_ - 1, expected);
                if (!one_done()) return false;
            }
        }
    } catch (const parallel::Stopped&) {
        return false;
    }
    return true;
}

renderer::PlacedFrame Trials::reference_frame(const scene::Snapshot& world) {
    // Twice the samples of the finest pictures halve errors at least.
    renderer::ExposureSamples samples = exposure_samples(film_, 1, film_.display());
    samples.fewest = samples.most = 2 * samples.most;
    const core::ToleranceMap none = core::ToleranceMap::reference();
    return renderer_.place(world, renderer_.look(world), {none, renderer::LightingMode::film, samples});
}

core::Plane<glm::vec3> Trials::gathered(const scene::Snapshot& world, const renderer::PlacedFrame& placed) {
    const core::ToleranceMap none = core::ToleranceMap::reference();
    return timed(reference_seconds_, [&] {
        return renderer_.gather(world, placed, {none, renderer::LightingMode::rough}).radiance.combined;
    });
}

double Trials::expected_seconds(const scene::Snapshot& world, const renderer::PlacedFrame& placed) {
    const renderer::Frame& seen = placed.frame;
    renderer::PlacedFrame part{{seen.visible, {}, seen.emitted, seen.emitted_specular}, placed.ungathered};
    part.frame.tiles.resize(seen.tiles.size());
    // Make the lights first: their time is no measure of the rest.
    gathered(world, part);
    // chosen: a tile of 32 tells the time of all for 3 % more of it (16 to 64).
    constexpr std::size_t each = 32;
    std::size_t lit = 0;
    for (std::size_t t = 0; t < seen.tiles.size(); t += each, ++lit) part.frame.tiles[t] = seen.tiles[t];
    const double start = clock_seconds();
    gathered(world, part);
    return (clock_seconds() - start) * static_cast<double>(seen.tiles.size()) / static_cast<double>(lit);
}

void Trials::weigh_by_solid_angle() {
    rows_ = encoder::weights_of_rows(film_.coding);
}

void Trials::light_reference(std::int64_t frame, const std::function<void(double)>& expected) {
    const scene::Snapshot world = film_.snapshot(frame);
    const renderer::PlacedFrame placed = reference_frame(world);
    // Points of exposed frames light pixels of other tiles.
    if (references_.empty() && !placed.frame.exposure) expected(wanted_references() * expected_seconds(world, placed));
    ReferenceFrame reference;
    for (const renderer::LitPixel& pixel : renderer::lit_pixels(placed.frame))
        reference.gathering.push_back(renderer::place_of(placed.frame, pixel));
    reference.light = gathered(world, placed);
    core::Radiance whole;
    whole.frame = frame;
    whole.combined = reference.light;
    if (!shown_) shown_ = std::make_unique<GlareFilter>(film_, shown_statistics_);
    reference.picture = film_.display().develop(shown_->of(whole, world.time));
    reference.picture.number = frame;
    reference.rows = rows_;
    references_.insert_or_assign(frame, std::move(reference));
}

void Trials::find_truth(std::size_t most) {
    PathTruth found;
    renderer::ErrorSplit split;
    const perceptual::Display display = film_.display();
    const auto luma = [&](glm::vec3 light) { return static_cast<double>(perceptual::luma_of(display, light)); };
    const core::ToleranceMap none = core::ToleranceMap::reference();
    double pixels = 0;
    for (auto& [frame, reference] : references_) {
        const scene::Snapshot world = film_.snapshot(frame);
        renderer_.start_chunk(world);
        renderer::Lit lit{reference_frame(world), {}};
        if (lit.frame.exposure) return;
        core::Radiance& shown = lit.radiance;
        shown.frame = frame;
        shown.combined = reference.light;
        shown.capped = core::Plane<std::uint8_t>(shown.combined.width(), shown.combined.height(), 0);
        const std::vector<renderer::LitPixel> all = renderer::lit_pixels(lit.frame);
        std::vector<renderer::AuditedPixel> audited;
        for (const renderer::LitPixel& p :
             renderer::drawn(all, std::min((all.size() + 15) / 16, most / references_.size()), frame)) {
            const glm::ivec2 place = renderer::place_of(lit.frame, p);
            audited.push_back(renderer::compare(place, reference.light.at(place.x, place.y), none, shown));
        }
        const auto validated = timed(found.seconds, [&] {
            return renderer_.validate(world, lit, none, audited, {.relative_error = 0.01f * PathTruth::percent});
        });
        split.add(validated, luma);
        reference.truth.clear();
        for (const renderer::ValidatedPixel& p : validated) {
            ReferenceFrame::TruePixel& pixel = reference.truth.emplace_back();
            pixel.place = p.place;
            for (std::size_t half = 0; half < 2; ++half)
                pixel.beyond[half] = luma(glm::vec3(p.truth.at_points.halves[half])) - luma(p.shown);
        }
        found.of += all.size();
        pixels += static_cast<double>(shown.combined.size());
    }
    found.pixels = split.pixels();
    if (found.pixels == 0) return;
    found.seconds /= static_cast<double>(found.pixels);
    found.share = static_cast<double>(found.of) / pixels;
    // Chance may hide the error: its standard error bounds it.
    const renderer::MeanError square =
        split.mean_square(renderer::ErrorCause::light_points, renderer::ErrorMeasure::code_value);
    found.psnr_y = perceptual::psnr(std::max(square.value, 0.0) + square.error);
    truth_ = found;
}

Quality with_light(const Quality& shown, const Quality& there, const Quality& decoded) {
    return {sum_of(shown.psnr_y, there.psnr_y, decoded.psnr_y),
            std::clamp(shown.ssim_y + decoded.ssim_y - there.ssim_y, -1.0, 1.0),
            sum_of(shown.psnr_hvs_m, there.psnr_hvs_m, decoded.psnr_hvs_m)};
}

}  // namespace render2mpeg::app
