// Lights the reference frames of a trial by every light point.
#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "app/experiments/trial.h"
#include "app/loop/run_statistics.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "perceptual/flicker.h"
#include "renderer/calibration/audit.h"
#include "scene/pose/motion.h"

/// Trials' references: frames lit by every light point.
namespace render2mpeg::app {
namespace {

constexpr std::uint64_t parting_seed = 0x7a97;

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

}  // namespace

double Trials::reference_seconds() const {
    return core::divide_or(reference_seconds_, static_cast<double>(truths_.size()), 0.0);
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

std::set<std::int64_t> reference_frames(const Chunk& window, int count) {
    std::set<std::int64_t> frames;
    if (count == 1) frames.insert(window.last);
    const int spots = count / 2;
    for (int i = 1; i <= spots; ++i) {
        const std::int64_t last = window.first + window.frames() * i / spots - 1;
        frames.insert({last, std::max(last - 1, window.first)});
    }
    // An odd one, and pairs that would overlap in a short window, have their frames where there are some left.
    std::int64_t next = window.first + window.frames() / 2;
    for (std::int64_t i = 0; static_cast<std::int64_t>(frames.size()) < count && i < window.frames(); ++i) {
        frames.insert(next);
        next = next == window.last ? window.first : next + 1;
    }
    return frames;
}

bool Trials::light_references(const std::function<bool(const ReferenceStanding&)>& part_done) {
    ReferenceStanding standing;
    int left = references_ * static_cast<int>(windows_.size());
    for (const Chunk& window : windows_) {
        measure_start(window);
        renderer_.start_chunk(film_.snapshot(window.first));
        for (const std::int64_t frame : reference_frames(window, references_))
            if (!light_reference(frame, left--, standing, part_done)) return false;
    }
    return true;
}

void Trials::take_references(const Trials& other) {
    for (const Chunk& window : windows_) measure_start(window);
    truths_ = other.truths_;
    reference_seconds_ = other.reference_seconds_;
    references_ = other.references_;
}

bool Trials::light_reference(std::int64_t frame, int left, ReferenceStanding& standing,
                             const std::function<bool(const ReferenceStanding&)>& part_done) {
    const scene::Snapshot world = film_.snapshot(frame);
    renderer::Seen seen = renderer_.see(world);
    Truth truth;
    for (const renderer::LitPixel& pixel : renderer::lit_pixels(seen))
        truth.gathering.push_back(renderer::place_of(seen, pixel));

    const std::uint64_t key = cache_.key_of(film_, renderer_, world, seen);
    std::optional<KeptReference> reference = cache_.find(key, film_.format.width, film_.format.height);
    if (reference) {
        standing.parts = ++standing.done + left - 1;
        if (!part_done(standing)) return false;
    } else {
        reference.emplace();
        if (!light_parts(world, seen, left, standing, part_done, *reference)) return false;
        cache_.keep(key, *reference);
    }
    reference_seconds_ += reference->seconds;
    truth.light = std::move(reference->light);

    core::Radiance whole;
    whole.combined = truth.light;
    truth.picture =
        perceptual::Display(film_.exposure.value_or(0), perceptual::matrix_for(film_.format.height)).develop(whole);
    truth.picture.number = frame;
    if (const auto before = truths_.find(frame - 1); before != truths_.end()) {
        truth.to_previous = scene::motion_between(seen.visible, world, film_.snapshot(frame - 1));
        truth.change = perceptual::change_along(*truth.to_previous, truth.picture.y, before->second.picture.y);
    }
    truths_.insert_or_assign(frame, std::move(truth));
    return true;
}

bool Trials::light_parts(const scene::Snapshot& world, renderer::Seen& seen, int left, ReferenceStanding& standing,
                         const std::function<bool(const ReferenceStanding&)>& part_done, KeptReference& reference) {
    // Without anything to gather first: what it takes to have light at all is no measure of the rest.
    renderer::Seen part{seen.visible, {}, seen.emitted, seen.emitted_specular};
    part.tiles.resize(seen.tiles.size());
    const auto light = [&] {
        return timed(reference.seconds,
                     [&] { return renderer_.sketch(world, part, core::ToleranceMap::reference()).combined; });
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
        part.tiles.assign(seen.tiles.size(), {});
        for (std::size_t i = first; i < last; ++i) part.tiles[tiles[i]].swap(seen.tiles[tiles[i]]);
        const core::Plane<glm::vec3> lit = light();
        for (std::size_t i = first; i < last; ++i) copy_tile(lit, reference.light, tiles[i], seen.tiles_across());
        ++standing.done;
        standing.seconds = before + clock_seconds() - start;
        if (!part_done(standing)) return false;
    }
    return true;
}

}  // namespace render2mpeg::app
