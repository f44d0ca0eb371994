#include "app/experiments/trial.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "app/loop/picture_coder.h"
#include "app/loop/pipeline.h"
#include "app/loop/scene_settings.h"
#include "app/report/frame_view.h"
#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "encoder/encoder.h"
#include "parallel/loops.h"
#include "perceptual/pumping.h"
#include "renderer/calibration/audit.h"
#include "scene/pose/motion.h"
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

void set_coarseness(Trial& trial, const Coarseness& coarseness) {
    trial.quantiser = coarseness.quantiser;
    trial.quality = coarseness.quality;
}

/// Sets counts per gather point from the renderer's growth.
void set_counts(Trial& trial, const renderer::Statistics& before, const renderer::Statistics& after) {
    trial.points = after.gather_points - before.gather_points;
    const auto points = static_cast<double>(trial.points);
    const auto per_point = [&](std::uint64_t count) {
        return core::divide_or(static_cast<double>(count), points, 0.0);
    };
    trial.rays = per_point(after.shadow_rays + after.gather_rays - before.shadow_rays - before.gather_rays);
    trial.cut =
        per_point(after.direct_clusters + after.indirect_clusters - before.direct_clusters - before.indirect_clusters);
    trial.capped = per_point(after.capped_points - before.capped_points);
}

constexpr std::uint64_t parting_seed = 0x7a97;

/// Non-empty tiles in random order, so that any stretch of them is like all others.
std::vector<std::size_t> lit_tiles(const renderer::Frame& seen) {
    std::vector<std::pair<float, std::size_t>> dice;
    for (std::size_t t = 0; t < seen.tiles.size(); ++t)
        if (!seen.tiles[t].empty())
            dice.emplace_back(core::uniform(parting_seed, static_cast<std::uint64_t>(seen.visible.frame), t), t);
    std::sort(dice.begin(), dice.end());
    std::vector<std::size_t> tiles;
    for (const auto& [die, tile] : dice) tiles.push_back(tile);
    return tiles;
}

/// chosen: parts of a frame's references: enough for a first estimate within seconds where a frame takes minutes
/// (1/64), but never so small that threads run out of tiles (16..4096 tiles, of 256 pixels).
int parts_of(std::size_t tiles) {
    const auto least = static_cast<std::size_t>(std::max(16, 4 * parallel::thread_count()));
    return static_cast<int>(std::clamp<std::size_t>(tiles / least, 1, 64));
}

void copy_tile(const core::Plane<glm::vec3>& from, core::Plane<glm::vec3>& to, std::size_t tile, int across) {
    const int left = static_cast<int>(tile) % across * renderer::tile_size;
    const int top = static_cast<int>(tile) / across * renderer::tile_size;
    const int width = std::min(renderer::tile_size, to.width() - left);
    for (int y = top; y < std::min(top + renderer::tile_size, to.height()); ++y)
        std::copy_n(from.row(y) + left, width, to.row(y) + left);
}

/// Mean squared errors add up, as far as coding and light err independently.
double sum_of(double shown, double there, double decoded) {
    const auto error = [](double psnr) { return std::isfinite(psnr) ? std::pow(10.0, -0.1 * psnr) : 0.0; };
    const double sum = std::max(0.0, error(shown) + error(decoded) - error(there));
    return sum > 0 ? -10 * std::log10(sum) : std::numeric_limits<double>::infinity();
}

}  // namespace

void Coarseness::apply_to(encoder::Settings& coding) const {
    coding.quantiser = quantiser;
    coding.rate_control.mode = quality ? encoder::RateMode::constant_quality : encoder::RateMode::constant_quantiser;
    if (quality) coding.rate_control.quality = *quality;
    if (gop) coding.gop = *gop;
}

double Trial::share_over() const {
    return core::divide_or(static_cast<double>(over), static_cast<double>(errors.count()), 0.0);
}
double Trial::share_over_twice() const {
    return core::divide_or(static_cast<double>(over_twice), static_cast<double>(errors.count()), 0.0);
}

/// Compares lit and coded pictures with the truth, where that is known.
class Trials::Judge : public LoopObserver {
  public:
    Judge(const Trials& trials, Trial& trial, LitWindows* keep) : trials_(trials), trial_(trial), keep_(keep) {}

    void lit(const LitFrame& frame) override {
        waiting_.insert_or_assign(frame.world.frame, frame.picture);
        if (keep_ != nullptr)
            keep_->frames.insert_or_assign(frame.world.frame,
                                           LitWindows::Shown{frame.picture, frame.lit.frame.visible});
        const auto known = trials_.truths_.find(frame.world.frame);
        if (known == trials_.truths_.end()) return;
        const Truth& truth = known->second;
        for (const glm::ivec2 place : truth.gathering) {
            const renderer::AuditedPixel p =
                renderer::compare(place, truth.light.at(place.x, place.y), frame.tolerance, frame.lit.radiance);
            trial_.errors.add(core::divide_or(p.error, std::max(p.luminance, trials_.half_code_), 0.0f));
            trial_.over += p.over() ? 1 : 0;
            trial_.over_twice += p.noticed() > 2 * p.tolerance ? 1 : 0;
        }
        trial_.lit.add(frame.picture, truth.picture);
        if (known == std::prev(trials_.truths_.end())) keep_sample_frame(frame, truth);
    }

    void coded(const encoder::CodedPicture& picture) override {
        trial_.bytes += static_cast<double>(picture.bytes.size());
        starts_.add(picture);
        trial_.requantised += picture.tries > 1 ? 1 : 0;
        const auto lit = waiting_.find(picture.plan.number);
        decoded(picture.plan.number, picture.reconstruction, lit->second);
        waiting_.erase(lit);
    }

    void decoded(std::int64_t number, const core::Picture& picture, const core::Picture& lit) {
        trial_.shown.add(picture, lit);
        const double masked = trials_.masks_all_ ? perceptual::masked_error(picture.y, lit.y) : 0.0;
        trial_.shown_masked += masked / trials_.frames();
        const auto known = trials_.truths_.find(number);
        if (known == trials_.truths_.end()) return;
        trial_.decoded.add(picture, known->second.picture);
        if (trial_.sample_frame && trial_.sample_frame->frame == number) {
            auto sample_frame = std::make_shared<SampleFrame>(*trial_.sample_frame);
            sample_frame->decoded = part_of(picture, view_of(picture.width(), picture.height()));
            trial_.sample_frame = std::move(sample_frame);
        }
        trial_.shown_there.add(picture, lit);
        trial_.shown_masked_there += masked / trials_.references();
        watch_change(number, picture.y);
        trial_.masked_error += perceptual::masked_error(picture.y, known->second.picture.y) / trials_.references();
    }

    const GopStarts& starts() const { return starts_; }

  private:
    void keep_sample_frame(const LitFrame& frame, const Truth& truth) {
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

    /// Adds the change along motion of a pair once both are decoded.
    void watch_change(std::int64_t number, const core::Plane<std::uint8_t>& luma) {
        decoded_.insert_or_assign(number, luma);
        for (const std::int64_t later : {number, number + 1}) {
            const auto now = decoded_.find(later), before = decoded_.find(later - 1);
            const auto truth = trials_.truths_.find(later);
            if (now == decoded_.end() || before == decoded_.end() || !truth->second.to_previous) continue;
            change_ += perceptual::change_along(*truth->second.to_previous, now->second, before->second) -
                       truth->second.change;
            trial_.flicker = change_ / ++pairs_;
        }
    }

    const Trials& trials_;
    Trial& trial_;
    LitWindows* keep_;
    GopStarts starts_;
    std::map<std::int64_t, core::Picture> waiting_;              ///< lit, and not coded yet
    std::map<std::int64_t, core::Plane<std::uint8_t>> decoded_;  ///< luma of references
    double change_ = 0;
    int pairs_ = 0;
};

Trials::Trials(const RenderJob& film, std::vector<Chunk> windows, int references)
    : film_(plainly_coded(film, references)),
      windows_(std::move(windows)),
      renderer_(*film_.animation, film_.rendering, film_.plan),
      references_(std::clamp(references, 0, static_cast<int>(windows_.front().frames()))) {
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
    constexpr double truth = sizeof(glm::vec3) + picture + sizeof(glm::ivec2) + sizeof(glm::vec2) + sizeof(float);
    return pixels * (truth * references_ * static_cast<double>(windows_.size()) +
                     (keeps_frames ? (picture + visible) * frames() : 0.0));
}

void Trials::set_times(Trial& trial, const FrameSample& sample) const {
    trial.cpu = film_by(film_, sample).seconds / static_cast<double>(film_.frame_count());
    trial.clock = trial.cpu * core::divide_or(sample.clock, sample.cpu, 0.0);
}

std::optional<Trial> Trials::run(const ToleranceRequest& tolerance, const Coarseness& coarseness,
                                 const std::function<bool()>& frame_done, LitWindows* keep) {
    Trial trial;
    trial.tolerance = tolerance;
    set_coarseness(trial, coarseness);
    trial.frames = frames();
    Judge judge(*this, trial, keep);
    RenderJob film = film_;
    film.tolerance = tolerance;
    film.coupling.fraction = tolerance.fraction;
    coarseness.apply_to(film.coding);
    RunStatistics statistics;
    const renderer::Statistics before = renderer_.statistics();
    const std::optional<FrameSample> sample = light_windows(film, renderer_, windows_, judge, statistics, frame_done);
    if (!sample) return std::nullopt;
    set_counts(trial, before, renderer_.statistics());
    trial.seconds = statistics.stage_seconds(Stage::shade) + statistics.stage_seconds(Stage::preview);
    if (tolerance.coupled) trial.seconds += statistics.stage_seconds(Stage::tolerate);
    trial.seconds /= trial.frames;
    trial.bytes /= trial.frames;
    trial.surplus = judge.starts().surplus(film_, windows_, trial.bytes);
    set_times(trial, *sample);
    trial.code_seconds = (statistics.stage_seconds(Stage::encode) +
                          statistics.pass_seconds[static_cast<std::size_t>(renderer::Pass::motion)]) /
                         trial.frames;
    if (keep != nullptr) keep->light = trial;
    return pooled(std::move(trial));
}

std::optional<Trial> Trials::run_other(const RenderJob& film, const std::function<bool()>& frame_done) const {
    Trial trial;
    trial.tolerance = film.tolerance;
    set_coarseness(trial, film.coding.quantiser);
    trial.frames = frames();
    Judge judge(*this, trial, nullptr);
    RunStatistics statistics;
    renderer::Renderer renderer(*film.animation, film.rendering, film.plan);
    const std::optional<FrameSample> sample = light_windows(film, renderer, windows_, judge, statistics, frame_done);
    if (!sample) return std::nullopt;
    trial.bytes /= trial.frames;
    trial.surplus = judge.starts().surplus(film_, windows_, trial.bytes);
    set_times(trial, *sample);
    return trial;
}

Trial Trials::coded_again(const LitWindows& lit, const Coarseness& coarseness) const {
    RenderJob film = film_;
    coarseness.apply_to(film.coding);
    return coded_by(
        [&film, &lit](const Chunk& window, const std::vector<const core::Picture*>& pictures,
                      const std::function<void(const core::Picture&)>& decoded) {
            film.frames = {window.first, window.last};
            Coded sum;
            const auto take = [&](const std::vector<encoder::CodedPicture>& coded) {
                for (const encoder::CodedPicture& picture : coded) {
                    sum.bytes += static_cast<double>(picture.bytes.size());
                    sum.starts.add(picture);
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
                const std::shared_ptr<const scene::Snapshot> world = posed.at(n);
                RenderedMotion motion(film, posed, lit.frames.at(n).visible, *world, statistics);
                take(timed(sum.seconds, [&] {
                    const encoder::PicturePlan plan = coder.plan(n, world->cut_before, motion);
                    return coder.code(*pictures[static_cast<std::size_t>(n - window.first)], plan, motion);
                }));
            }
            take(timed(sum.seconds, [&] { return coder.flush(); }));
            return sum;
        },
        lit, coarseness);
}

Trial Trials::coded_by(const Codec& codec, const LitWindows& lit, const Coarseness& coarseness) const {
    Trial trial = lit.light;
    set_coarseness(trial, coarseness);
    trial.decoded = trial.shown = trial.shown_there = {};
    trial.shown_masked = trial.shown_masked_there = 0;
    trial.masked_error = trial.bytes = trial.code_seconds = trial.flicker = 0;
    trial.requantised = 0;
    Judge judge(*this, trial, nullptr);
    GopStarts starts;
    for (const Chunk& window : windows_) {
        std::vector<const core::Picture*> pictures;
        for (std::int64_t n = window.first; n <= window.last; ++n) pictures.push_back(&lit.frames.at(n).picture);
        const Coded coded = codec(window, pictures, [&](const core::Picture& picture) {
            judge.decoded(window.first + picture.number, picture, *pictures[static_cast<std::size_t>(picture.number)]);
        });
        trial.bytes += coded.bytes;
        starts.add(coded.starts);
        trial.requantised += coded.requantised;
        trial.code_seconds += coded.seconds;
    }
    trial.bytes /= trial.frames;
    trial.surplus = starts.surplus(film_, windows_, trial.bytes);
    trial.code_seconds /= trial.frames;
    return pooled(std::move(trial));
}

double Trials::reference_seconds() const {
    return core::divide_or(reference_seconds_, static_cast<double>(truths_.size()), 0.0);
}

bool Trials::light_references(const std::function<bool(const ReferenceStanding&)>& part_done) {
    ReferenceStanding standing;
    int left = references_ * static_cast<int>(windows_.size());
    for (const Chunk& window : windows_) {
        renderer_.start_chunk(film_.snapshot(window.first));
        for (const std::int64_t frame : reference_frames(window, references_))
            if (!light_reference(frame, left--, standing, part_done)) return false;
    }
    return true;
}

void Trials::take_references(const Trials& other) {
    truths_ = other.truths_;
    reference_seconds_ = other.reference_seconds_;
    references_ = other.references_;
}

bool Trials::light_reference(std::int64_t frame, int left, ReferenceStanding& standing,
                             const std::function<bool(const ReferenceStanding&)>& part_done) {
    const scene::Snapshot world = film_.snapshot(frame);
    // Twice the samples of the finest pictures halve errors at least.
    renderer::ExposureSamples samples = exposure_samples(film_, 1, film_.display());
    samples.fewest = samples.most = 2 * samples.most;
    const core::ToleranceMap none = core::ToleranceMap::reference();
    const renderer::PlacedFrame placed =
        renderer_.place(world, renderer_.look(world), {none, renderer::Manner::film, samples});
    const renderer::Frame& seen = placed.frame;
    Truth truth;
    for (const renderer::LitPixel& pixel : renderer::lit_pixels(seen))
        truth.gathering.push_back(renderer::place_of(seen, pixel));

    const std::uint64_t key = cache_.key_of(film_, renderer_, world, placed);
    std::optional<KeptReference> reference = cache_.find(key, film_.format.width, film_.format.height);
    if (reference) {
        standing.parts = ++standing.done + left - 1;
        if (!part_done(standing)) return false;
    } else {
        reference.emplace();
        if (!light_parts(world, placed, left, standing, part_done, *reference)) return false;
        cache_.keep(key, *reference);
    }
    reference_seconds_ += reference->seconds;
    truth.light = std::move(reference->light);

    core::Radiance whole;
    whole.combined = truth.light;
    if (!shown_) shown_ = std::make_unique<GlareFilter>(film_, shown_statistics_);
    truth.picture = film_.display().develop(shown_->of(whole, world.time));
    truth.picture.number = frame;
    if (const auto before = truths_.find(frame - 1); before != truths_.end()) {
        truth.to_previous = scene::motion_between(seen.visible, world, film_.snapshot(frame - 1));
        truth.change = perceptual::change_along(*truth.to_previous, truth.picture.y, before->second.picture.y);
    }
    truths_.insert_or_assign(frame, std::move(truth));
    return true;
}

bool Trials::light_parts(const scene::Snapshot& world, const renderer::PlacedFrame& placed, int left,
                         ReferenceStanding& standing, const std::function<bool(const ReferenceStanding&)>& part_done,
                         KeptReference& reference) {
    // Make the lights first: their time is no measure of the rest.
    const renderer::Frame& seen = placed.frame;
    const core::ToleranceMap none = core::ToleranceMap::reference();
    const renderer::LightOrder order{none, renderer::Manner::rough};
    renderer::PlacedFrame part{{seen.visible, {}, seen.emitted, seen.emitted_specular}, placed.ungathered};
    part.frame.tiles.resize(seen.tiles.size());
    if (seen.exposure) {
        // Its points light pixels of other tiles.
        reference.light =
            timed(reference.seconds, [&] { return renderer_.gather(world, placed, order).radiance.combined; });
        standing.parts = ++standing.done + left - 1;
        return part_done(standing);
    }
    const auto light = [&] {
        return timed(reference.seconds, [&] { return renderer_.gather(world, part, order).radiance.combined; });
    };
    reference.light = light();

    // Light some tiles at a time: a frame can take an hour.
    const std::vector<std::size_t> tiles = lit_tiles(seen);
    const int parts = parts_of(tiles.size());
    standing.parts = standing.done + parts * left;
    const double before = standing.seconds, start = clock_seconds();
    for (int p = 0; p < parts; ++p) {
        const std::size_t first = tiles.size() * static_cast<std::size_t>(p) / static_cast<std::size_t>(parts);
        const std::size_t last = tiles.size() * static_cast<std::size_t>(p + 1) / static_cast<std::size_t>(parts);
        part.frame.tiles.assign(seen.tiles.size(), {});
        for (std::size_t i = first; i < last; ++i) part.frame.tiles[tiles[i]] = seen.tiles[tiles[i]];
        const core::Plane<glm::vec3> lit = light();
        for (std::size_t i = first; i < last; ++i) copy_tile(lit, reference.light, tiles[i], seen.tiles_across());
        ++standing.done;
        standing.seconds = before + clock_seconds() - start;
        if (!part_done(standing)) return false;
    }
    return true;
}

Quality with_light(const Quality& shown, const Quality& there, const Quality& decoded) {
    return {sum_of(shown.psnr_y, there.psnr_y, decoded.psnr_y),
            std::clamp(shown.ssim_y + decoded.ssim_y - there.ssim_y, -1.0, 1.0),
            sum_of(shown.psnr_hvs_m, there.psnr_hvs_m, decoded.psnr_hvs_m)};
}

Quality quality_of(const Trial& trial, bool against_references) {
    const auto of = [](const perceptual::FilmQuality& q, double masked) {
        return Quality{q.psnr_y(), q.ssim_y(), perceptual::psnr(masked)};
    };
    const Quality shown = of(trial.shown, trial.shown_masked);
    if (!against_references) return shown;
    return with_light(shown, of(trial.shown_there, trial.shown_masked_there), of(trial.decoded, trial.masked_error));
}

}  // namespace render2mpeg::app
