#include "app/trial.h"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <utility>

#include "app/pipeline.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "perceptual/hvs.h"
#include "renderer/audit.h"

namespace render2mpeg::app {
namespace {

constexpr std::uint64_t parting_seed = 0x7a97;

Production plainly_coded(Production film) {
    film.coding.rate_control.mode = encoder::RateMode::constant_quantiser;
    film.two_passes = false;
    film.audit = 0;
    return film;
}

/// Tiles that have anything to gather, in random order: any stretch of them is like all others.
std::vector<std::size_t> lit_tiles(const renderer::Seen& seen) {
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

double clock_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

std::vector<Chunk> windows_of(FrameRange film, const Sample& sample) {
    const std::int64_t all = film.last - film.first + 1, length = std::min<std::int64_t>(sample.frames, all);
    const std::int64_t count = std::min<std::int64_t>(sample.windows, all / length);
    std::vector<Chunk> windows;
    for (std::int64_t i = 0; i < count; ++i) {
        const std::int64_t begin = i * all / count, end = (i + 1) * all / count;
        const std::int64_t first = film.first + begin + (end - begin - length) / 2;
        windows.push_back({static_cast<int>(i), first, first + length - 1});
    }
    return windows;
}

double Trial::share_over() const {
    return core::divide_or(static_cast<double>(over), static_cast<double>(errors.count()), 0.0);
}
double Trial::share_over_twice() const {
    return core::divide_or(static_cast<double>(over_twice), static_cast<double>(errors.count()), 0.0);
}

/// Holds what is lit and coded against the truth, where that is known.
class Trials::Judge : public Watcher {
  public:
    Judge(const Trials& trials, Trial& trial, LitWindows* keep) : trials_(trials), trial_(trial), keep_(keep) {}

    void lit(const LitFrame& frame) override {
        if (keep_ != nullptr)
            keep_->frames.insert_or_assign(frame.world.frame, LitWindows::Frame{frame.picture, frame.visible});
        const auto known = trials_.truths_.find(frame.world.frame);
        if (known == trials_.truths_.end()) return;
        const Truth& truth = known->second;
        for (const glm::ivec2 place : truth.gathering) {
            const renderer::AuditedPixel p =
                renderer::compare(place, truth.light.at(place.x, place.y), frame.tolerance, frame.radiance);
            trial_.errors.add(core::divide_or(p.error, std::max(p.luminance, trials_.half_code_), 0.0f));
            trial_.over += p.over() ? 1 : 0;
            trial_.over_twice += p.noticed() > 2 * p.tolerance ? 1 : 0;
        }
        trial_.lit.add(frame.picture, truth.picture);
    }

    void coded(const encoder::CodedPicture& picture) override {
        trial_.bytes += static_cast<double>(picture.bytes.size());
        trial_.requantised += picture.tries > 1 ? 1 : 0;
        decoded(picture.plan.number, picture.reconstruction);
    }

    void decoded(std::int64_t number, const core::Picture& picture) {
        const auto known = trials_.truths_.find(number);
        if (known == trials_.truths_.end()) return;
        trial_.decoded.add(picture, known->second.picture);
        trial_.masked_error += perceptual::masked_error(picture.y, known->second.picture.y) / trials_.references();
    }

  private:
    const Trials& trials_;
    Trial& trial_;
    LitWindows* keep_;
};

Trials::Trials(const Production& film, std::vector<Chunk> windows, int references)
    : film_(plainly_coded(film)),
      windows_(std::move(windows)),
      renderer_(*film_.animation, film_.rendering, film_.plan),
      references_(std::clamp(references, 1, static_cast<int>(windows_.front().frames()))) {
    Production fixed = film_;
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
    return pixels * (truth * references_ * static_cast<double>(windows_.size()) +
                     (keeps_frames ? (picture + visible) * frames() : 0.0));
}

double Trials::reference_seconds() const {
    return core::divide_or(reference_seconds_, static_cast<double>(truths_.size()), 0.0);
}

double Trials::share_of_chunk() const {
    return static_cast<double>(windows_.front().frames()) /
           static_cast<double>(chunks_of(film_.frames, film_.coding.gop).front().frames());
}

void Trials::measure_start(const Chunk& window) {
    renderer_.start_chunk(film_.snapshot(window.first));
    const auto light = [&](std::int64_t frame, double& seconds) {
        const scene::Snapshot world = film_.snapshot(frame);
        renderer::Seen nothing = renderer_.see(world);
        for (renderer::GatherTile& tile : nothing.tiles) tile.clear();
        timed(seconds, [&] { return renderer_.sketch(world, nothing, core::ToleranceMap::reference()).combined; });
    };
    light(window.first, first_light_seconds_);
    const std::int64_t beside = window.first < film_.frames.last ? window.first + 1 : window.first - 1;
    light(std::max(beside, film_.frames.first), next_light_seconds_);
}

bool Trials::light_references(const std::function<bool(const ReferenceStanding&)>& part_done) {
    ReferenceStanding standing;
    int left = references_ * static_cast<int>(windows_.size());
    for (const Chunk& window : windows_) {
        measure_start(window);
        renderer_.start_chunk(film_.snapshot(window.first));
        for (int i = 1; i <= references_; ++i, --left)
            if (!light_reference(window.first + window.frames() * i / references_ - 1, left, standing, part_done))
                return false;
    }
    return true;
}

bool Trials::light_reference(std::int64_t frame, int left, ReferenceStanding& standing,
                             const std::function<bool(const ReferenceStanding&)>& part_done) {
    const scene::Snapshot world = film_.snapshot(frame);
    renderer::Seen seen = renderer_.see(world);
    Truth truth;
    for (const renderer::LitPixel& pixel : renderer::lit_pixels(seen))
        truth.gathering.push_back(renderer::place_of(seen, pixel));

    // Without anything to gather first: what it takes to have light at all is no measure of the rest.
    renderer::Seen part{seen.visible, {}, seen.unscattered, seen.unscattered_specular};
    part.tiles.resize(seen.tiles.size());
    const auto light = [&] {
        return timed(reference_seconds_,
                     [&] { return renderer_.sketch(world, part, core::ToleranceMap::reference()).combined; });
    };
    truth.light = light();

    // Light some tiles at a time: a frame can take an hour.
    const std::vector<std::size_t> tiles = lit_tiles(seen);
    const int parts = parts_of(tiles.size());
    standing.parts = standing.done + parts * left;
    const double before = standing.seconds, start = clock_seconds();
    for (int p = 0; p < parts; ++p) {
        const std::size_t first = tiles.size() * static_cast<std::size_t>(p) / static_cast<std::size_t>(parts);
        const std::size_t last = tiles.size() * static_cast<std::size_t>(p + 1) / static_cast<std::size_t>(parts);
        part.tiles.assign(seen.tiles.size(), {});
        for (std::size_t t = first; t < last; ++t) part.tiles[tiles[t]].swap(seen.tiles[tiles[t]]);
        const core::Plane<glm::vec3> lit = light();
        for (std::size_t t = first; t < last; ++t) copy_tile(lit, truth.light, tiles[t], seen.tiles_across());
        ++standing.done;
        standing.seconds = before + clock_seconds() - start;
        if (!part_done(standing)) return false;
    }

    core::Radiance whole;
    whole.combined = truth.light;
    truth.picture =
        perceptual::Display(film_.exposure.value_or(0), perceptual::matrix_for(film_.format.height)).develop(whole);
    truth.picture.number = frame;
    truths_.insert_or_assign(frame, std::move(truth));
    return true;
}

std::optional<Trial> Trials::run(const ToleranceRequest& tolerance, int quantiser,
                                 const std::function<bool()>& frame_done, LitWindows* keep) {
    Trial trial;
    trial.tolerance = tolerance;
    trial.quantiser = quantiser;
    trial.frames = frames();
    Judge judge(*this, trial, keep);
    Production film = film_;
    film.tolerance = tolerance;
    film.coding.quantiser = quantiser;
    Ledger ledger;
    const renderer::Statistics before = renderer_.statistics();
    double once = 0;  // CPU for what a chunk takes once
    for (const Chunk& window : windows_) {
        // Each is a film of its own: it owes the next one nothing of the decoder's buffer.
        film.frames = {window.first, window.last};
        bool goes_on = true, first = true;
        const auto started = [&] {
            return renderer_.statistics().calibration_seconds + ledger.stage_seconds(Stage::preview);
        };
        const double earlier = started();
        render_chunk(film, renderer_, window, {nullptr, nullptr, nullptr, &judge}, ledger, [&] {
            if (std::exchange(first, false)) once += started() - earlier;
            return goes_on = frame_done();
        });
        if (!goes_on) return std::nullopt;
    }

    const renderer::Statistics& after = renderer_.statistics();
    trial.points = after.gather_points - before.gather_points;
    const auto points = static_cast<double>(trial.points);
    const auto per_point = [&](std::uint64_t count) {
        return core::divide_or(static_cast<double>(count), points, 0.0);
    };
    trial.rays = per_point(after.shadow_rays - before.shadow_rays);
    trial.cut =
        per_point(after.direct_clusters + after.indirect_clusters - before.direct_clusters - before.indirect_clusters);
    trial.capped = per_point(after.capped_points - before.capped_points);
    trial.seconds = ledger.stage_seconds(Stage::shade) + ledger.stage_seconds(Stage::preview);
    if (tolerance.coupled) trial.seconds += ledger.stage_seconds(Stage::tolerate);
    // The rough first look makes the first frame's lights; what frame after frame has to make is no start.
    once += (tolerance.coupled ? 0.0 : first_light_seconds_) - next_light_seconds_;
    once = std::clamp(once, 0.0, trial.seconds);
    trial.bytes /= trial.frames;
    trial.window_seconds = trial.seconds / trial.frames;
    trial.seconds = (trial.seconds - once + once * share_of_chunk()) / trial.frames;
    trial.code_seconds =
        (ledger.stage_seconds(Stage::encode) + ledger.pass_seconds[static_cast<std::size_t>(renderer::Pass::motion)]) /
        trial.frames;
    if (keep != nullptr) keep->light = trial;
    return trial;
}

Trial Trials::coded_again(const LitWindows& lit, int quantiser) const {
    Production film = film_;
    film.coding.quantiser = quantiser;
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
            encoder::Encoder encoder(film.coding);
            for (std::int64_t n = window.first; n <= window.last; ++n) {
                const core::Visible& visible = lit.frames.at(n).visible;
                const scene::Snapshot world = film.snapshot(n);
                take(timed(sum.seconds, [&] {
                    encoder::PictureFacts facts = facts_of(film, world, window);
                    tell_motion(film, window, visible, world, facts);
                    const encoder::PicturePlan plan = encoder.plan(n, facts, n == window.first);
                    const auto onward = onward_motion(film, plan, visible, world);
                    return encoder.push(*pictures[static_cast<std::size_t>(n - window.first)], plan,
                                        motion_of(film, plan, visible, world), {onward ? &*onward : nullptr});
                }));
            }
            take(timed(sum.seconds, [&] { return encoder.flush(); }));
            return sum;
        },
        lit, quantiser);
}

Trial Trials::coded_by(const Codec& codec, const LitWindows& lit, int quantiser) const {
    Trial trial = lit.light;
    trial.quantiser = quantiser;
    trial.decoded = {};
    trial.masked_error = trial.bytes = trial.code_seconds = 0;
    trial.requantised = 0;
    Judge judge(*this, trial, nullptr);
    for (const Chunk& window : windows_) {
        std::vector<const core::Picture*> pictures;
        for (std::int64_t n = window.first; n <= window.last; ++n) pictures.push_back(&lit.frames.at(n).picture);
        const Coded coded = codec(window, pictures, [&](const core::Picture& picture) {
            judge.decoded(window.first + picture.number, picture);
        });
        trial.bytes += coded.bytes;
        trial.requantised += coded.requantised;
        trial.code_seconds += coded.seconds;
    }
    trial.bytes /= trial.frames;
    trial.code_seconds /= trial.frames;
    return trial;
}

}  // namespace render2mpeg::app
