#include "app/production/production.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "app/estimate/forecast.h"
#include "app/loop/pipeline.h"
#include "app/loop/sink.h"
#include "app/production/resume.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "parallel/lanes.h"

namespace render2mpeg::app {
namespace {

/// Summary of a chunk, for --verbose.
std::string chunk_text(const Chunk& chunk, const RunStatistics& statistics) {
    double seconds = 0, bytes = 0, quantiser = 0;
    for (const FrameEntry& entry : statistics.frames) {
        seconds += entry.cost.seconds;
        bytes += static_cast<double>(entry.bytes);
        quantiser += entry.mean_quantiser / static_cast<double>(chunk.frames());
    }
    return fmt::format("frames {} to {}: {:.2f} s of CPU, {:.0f} bytes, quantiser {:.1f}", chunk.first, chunk.last,
                       seconds, bytes, quantiser);
}

std::vector<Chunk> missing_of(const OpenRender& open) {
    std::vector<Chunk> missing = open.film.chunks();
    std::erase_if(missing, [&](const Chunk& chunk) {
        return std::ranges::find(open.files, chunk.index, index_of) != open.files.end();
    });
    return missing;
}

/// What is known ahead of the frames by their place in the order in which they get done, first those that are there,
/// then chunks in step with each other: which begin light anew, those of chunks and after cuts, and `prices`, by film
/// frame.
Pace pace_of(const RenderJob& film, const std::vector<Chunk>& missing, std::size_t at_once, std::int64_t place,
             const std::vector<double>& prices) {
    const std::vector<std::int64_t> cuts = cuts_of(film);
    std::vector<std::int64_t> starts;
    std::vector<double> in_order(prices.empty() ? 0 : static_cast<std::size_t>(place), 1.0);
    for (std::size_t i = 0; i < missing.size(); i += at_once)
        for (std::int64_t step = 0, more = 1; more > 0; ++step) {
            more = 0;
            for (std::size_t k = i; k < std::min(i + at_once, missing.size()); ++k) {
                if (step >= missing[k].frames()) continue;
                const std::int64_t frame = missing[k].first + step;
                if (step == 0 || std::ranges::binary_search(cuts, frame)) starts.push_back(place);
                if (!prices.empty()) in_order.push_back(prices[static_cast<std::size_t>(frame - film.frames.first)]);
                ++more, ++place;
            }
        }
    return Pace(std::move(starts), in_order);
}

/// Adds a chunk's light to the film's file. False, and told, where that fails: the film goes on without.
bool add_light(LightFile& light, const renderer::Renderer& renderer, const RenderOptions& options) {
    try {
        light.add(renderer.found_light());
        return true;
    } catch (const core::Error& error) {
        if (!options.quiet) print_line(std::string(error.what()) + "; no more light is added");
        return false;
    }
}

/// The missing chunks of a render in the making.
class ChunkProduction {
  public:
    ChunkProduction(const OpenRender& open, std::size_t at_once);
    bool run();

  private:
    struct Made {
        std::optional<ChunkFile> file;  ///< none: not begun, or it failed
        RunStatistics statistics;
        bool whole = false;
        std::exception_ptr failure;
    };

    std::optional<std::size_t> next();
    bool stops() const { return failed_ || InterruptGuard::requested(); }
    void drive(renderer::Renderer& renderer);
    void make(const Chunk& chunk, renderer::Renderer& renderer, Made& made);
    std::optional<KeptFrames> kept_of(const Chunk& chunk) const;
    nlohmann::json record_of(const Chunk& chunk, RunStatistics statistics);
    bool frame_done();
    bool collect();

    const OpenRender& open_;
    const RenderJob& film_;
    const RenderOptions& options_;
    std::vector<Chunk> missing_;
    std::size_t at_once_;
    std::vector<Made> made_;  ///< of each missing chunk
    std::atomic<bool> failed_{false};
    std::mutex mutex_;  ///< of all that follows, and of the render's work folder
    std::size_t next_ = 0;
    std::int64_t done_;  ///< frames
    std::optional<Progress> progress_;
    std::optional<LightFile> light_;
    std::optional<LastFrameWriter> last_frame_;
    RunStatistics written_;  ///< times that records have
};

ChunkProduction::ChunkProduction(const OpenRender& open, std::size_t at_once)
    : open_(open),
      film_(open.film),
      options_(open.options),
      missing_(missing_of(open)),
      at_once_(std::clamp<std::size_t>(at_once, 1, std::max<std::size_t>(1, missing_.size()))),
      made_(missing_.size()),
      done_(static_cast<std::int64_t>(open.statistics.frames.size())) {
    written_.seconds = open.statistics.earlier_seconds;
    written_.earlier_wall = open.statistics.earlier_wall;
    if (options_.last_frame) last_frame_.emplace(*options_.last_frame, film_);
}

bool ChunkProduction::run() {
    if (missing_.empty()) return true;
    tell_activity("building");
    std::int64_t frames = done_;
    for (const Chunk& chunk : missing_) frames += chunk.frames();
    // Those beside the first share with it what never moves.
    light_ = light_file_of(film_, options_);
    std::vector<std::byte> known;
    if (light_) known = light_->known(film_.known_light);
    if (!renderer::Renderer::is_sound(known))
        throw core::Error("reading", options_.light_cache->string(),
                          "it holds light that no run has found: remove it, and let this film find its own");
    renderer::Renderer first =
        renderer_of(film_, light_ ? std::optional<renderer::Renderer::KnownLight>(known) : std::nullopt);
    std::vector<std::byte>().swap(known);  // it may be as large as all else
    std::vector<std::unique_ptr<renderer::Renderer>> others;
    if (at_once_ > 1) {
        const scene::Snapshot instant = film_.snapshot(missing_.front().first);
        while (others.size() + 1 < at_once_) others.push_back(first.beside(instant));
    }
    const bool is_asked = !options_.quiet && open_.prices.empty();
    progress_.emplace(
        frames, options_.quiet, "frame", Counted::frames, open_.clock.seconds(open_.statistics),
        pace_of(film_, missing_, at_once_, done_, is_asked ? prices_of(film_, frames - done_, first) : open_.prices));
    if (done_ > 0) progress_->advance_to(done_, frames);
    parallel::run_lanes(at_once_, [&](std::size_t lane) { drive(lane == 0 ? first : *others[lane - 1]); });
    progress_.reset();
    return collect();
}

std::optional<std::size_t> ChunkProduction::next() {
    const std::lock_guard lock(mutex_);
    if (stops() || next_ == missing_.size()) return {};
    return next_++;
}

void ChunkProduction::drive(renderer::Renderer& renderer) {
    while (const std::optional<std::size_t> i = next()) {
        try {
            make(missing_[*i], renderer, made_[*i]);
        } catch (...) {
            made_[*i].failure = std::current_exception();
            failed_ = true;
        }
    }
}

void ChunkProduction::make(const Chunk& chunk, renderer::Renderer& renderer, Made& made) {
    std::optional<ChunkFile> file;
    {
        const std::lock_guard lock(mutex_);
        file.emplace(open_.work.open(chunk));
    }
    const std::unique_ptr<Sink> sink = make_sink(film_, frames_of(film_, options_, open_.work, chunk));
    ChunkWriter coded(*file);
    std::optional<LayersWriter> layers;
    if (options_.layers) layers.emplace(*options_.layers, film_, made.statistics);
    LoopObservers products;
    if (film_.kind == OutputKind::film) products.add(coded);
    if (sink) products.add(*sink);
    if (layers) products.add(*layers);
    if (last_frame_) products.add(*last_frame_);
    if (!open_.side_films.empty()) products.add(open_.side_films);
    const bool has_sample = options_.report && open_.sample_frame.is_in(chunk);
    if (has_sample) products.add(open_.sample_frame);
    std::optional<KeptFrames> kept = kept_of(chunk);
    try {
        made.whole = render_chunk(
            film_, renderer, chunk, products, made.statistics, [&] { return frame_done(); }, [&] { return stops(); },
            kept ? &*kept : nullptr);
    } catch (...) {
        if (kept && kept->frames() > 0) {
            file->abandon(kept->frames());
            made.file = std::move(file);
        }
        throw;
    }
    if (sink) sink->finish();
    made.statistics = totals_of(made.statistics, renderer);
    renderer.count_anew();
    if (made.whole) {
        nlohmann::json record = record_of(chunk, made.statistics);
        if (has_sample) record[sample_frame_name] = open_.sample_frame.figures();
        file->finish(record);
        if (kept) kept->drop();
        if (light_ && !add_light(*light_, renderer, options_)) light_.reset();
        if (options_.verbose) print_line(chunk_text(chunk, made.statistics));
    } else {
        file->abandon(kept ? kept->frames() : 0);
    }
    made.file = std::move(file);
    if (made.whole && open_.chunk_done) open_.chunk_done(*made.file);
}

/// Lit frames of a chunk in the making. None where what looks on needs more of each frame than its picture, and where
/// frames cost no more than to keep them.
std::optional<KeptFrames> ChunkProduction::kept_of(const Chunk& chunk) const {
    if (!open_.side_films.empty() || film_.audit > 0 || film_.preview || options_.as) return {};
    if (options_.report && open_.sample_frame.is_in(chunk)) return {};
    KeptChunk of{open_.work.stream_of(chunk), chunk, json_text(open_.identity)};
    of.width = film_.format.width;
    of.height = film_.format.height;
    of.needs_pictures = film_.kind == OutputKind::film || film_.kind == OutputKind::y4m;
    const encoder::CodecFacts& codec = encoder::facts_of(film_.coding.codec);
    of.unrounded = film_.kind == OutputKind::film && codec.takes_unrounded();
    if (film_.kind == OutputKind::film) of.chroma = codec.exact_chroma();
    of.alpha = film_.coding.alpha;
    of.products = [this](std::int64_t n) { return images_of(film_, options_, {n, n}); };
    if (at_once_ == 1)
        of.add_times = [this](RunStatistics& own) {
            own.earlier_wall += open_.clock.seconds(open_.statistics) - written_.earlier_wall;
            own.earlier_cpu += cpu_seconds() - written_.earlier_cpu;
        };
    std::optional<KeptFrames> kept(std::in_place, std::move(of));
    if (!kept->complaint().empty() && !options_.quiet)
        print_line(open_.work.stream_of(chunk).replace_extension(".state").string() + " " + kept->complaint() +
                   ": its frames are lit anew");
    return kept;
}

/// Times that no chunk has yet are this one's, so that those of all sum up to what the run took.
nlohmann::json ChunkProduction::record_of(const Chunk& chunk, RunStatistics statistics) {
    {
        const std::lock_guard lock(mutex_);
        const auto take = [](double& own, double& written, double now) { own += now - std::exchange(written, now); };
        for (std::size_t i = 0; i < statistics.seconds.size(); ++i)
            take(statistics.seconds[i], written_.seconds[i], open_.statistics.seconds[i]);
        take(statistics.earlier_wall, written_.earlier_wall, open_.clock.seconds(open_.statistics));
        take(statistics.earlier_cpu, written_.earlier_cpu, cpu_seconds());
    }
    return chunk_record_of(film_, options_, open_.work, chunk, statistics);
}

bool ChunkProduction::frame_done() {
    const std::lock_guard lock(mutex_);
    progress_->advance();
    ++done_;
    if (open_.frames_done) open_.frames_done(done_);
    return !stops();
}

/// Adds what was made to the render.
bool ChunkProduction::collect() {
    RunStatistics& statistics = open_.statistics;
    bool whole = true;
    std::exception_ptr failure;
    for (Made& made : made_) {
        const bool is_next = std::exchange(whole, whole && made.whole);
        if (!failure) failure = made.failure;
        // Drop a chunk that was stopped before its first frame, or behind another.
        if (!made.file || (!made.whole && (!is_next || made.statistics.frames.empty()))) continue;
        statistics = sum_of(statistics, made.statistics);
        open_.files.push_back(std::move(*made.file));
    }
    std::ranges::stable_sort(statistics.frames, {}, &FrameEntry::frame);
    std::ranges::sort(open_.files, {}, index_of);
    if (failure) std::rethrow_exception(failure);
    return whole;
}

}  // namespace

bool make_chunks(const OpenRender& open, std::size_t at_once) {
    return ChunkProduction(open, at_once).run();
}

}  // namespace render2mpeg::app
