#include "app/farm/farm.h"

#include <fmt/format.h>

#include <unistd.h>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "app/farm/farm_plan.h"
#include "app/files/file_io.h"
#include "app/files/work_folder.h"
#include "app/loop/kept_frames.h"
#include "app/loop/resume.h"
#include "app/options/option_text.h"
#include "app/options/usage_error.h"
#include "app/production/production.h"
#include "app/report/frame_view.h"
#include "app/report/heatmap_film.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "app/system/terminal.h"
#include "core/text.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// chosen: often enough to tell who is alive, and seldom enough for a thousand parts on one file system.
constexpr std::chrono::seconds news_pause(30);

enum class PartState { running, done, failed, interrupted };

/// Contents and age of the status file.
struct PartNews {
    PartState state = PartState::running;
    std::int64_t done = 0, total = 0;  ///< frames
    double seconds = 0;                ///< on the clock, of the try that said so
    std::string machine;
    std::string error;  ///< why it failed
    double age = 0;     ///< seconds since it was written

    /// Whether a part reported as running has stopped reporting: it was killed, or its machine is gone.
    bool is_lost() const {
        // chosen: four times the pause: a busy file server delays what others see.
        return state == PartState::running && age > 4.0 * static_cast<double>(news_pause.count());
    }
};

NLOHMANN_JSON_SERIALIZE_ENUM(PartState, {{PartState::running, "running"},
                                         {PartState::done, "done"},
                                         {PartState::failed, "failed"},
                                         {PartState::interrupted, "interrupted"}})
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PartNews, state, done, total, seconds, machine, error)

using nlohmann::json;

std::filesystem::path news_file(const std::filesystem::path& folder) {
    return folder / "status.json";
}

std::string machine_name() {
    std::array<char, 256> name{};
    return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

/// The last news of the part whose folder this is; none where there is no file that can be read.
std::optional<PartNews> news_in(const std::filesystem::path& folder) {
    const json written = read_json(news_file(folder));
    PartNews news;
    try {
        written.get_to(news);
    } catch (const json::exception&) {
        return {};
    }
    std::error_code error;
    const auto at = std::filesystem::last_write_time(news_file(folder), error);
    if (error) return {};
    news.age = std::chrono::duration<double>(std::filesystem::file_time_type::clock::now() - at).count();
    return news;
}

/// Writes the news of a part that is being made, now and every half minute. That one cannot be written is no failure.
class PartReporter {
  public:
    /// `total` frames.
    PartReporter(std::filesystem::path folder, std::int64_t total) : folder_(std::move(folder)) {
        news_.total = total;
        news_.machine = machine_name();
        write();
        ticker_ = every(news_pause, [this] {
            const std::lock_guard lock(mutex_);
            write();
        });
    }

    /// So many frames are done.
    void advance_to(std::int64_t done) {
        const std::lock_guard lock(mutex_);
        news_.done = done;
    }
    /// How it ended. `error`: why it failed.
    void end(PartState state, const std::string& error = {}) {
        const std::lock_guard lock(mutex_);
        news_.state = state;
        news_.error = error;
        write();
    }

  private:
    void write() {
        news_.seconds = clock_seconds() - start_;
        json written = news_;
        written["process"] = getpid();
        try {
            write_json(news_file(folder_), written);
        } catch (const std::exception&) {
            // A full disk: what is made says so itself.
        }
    }

    std::filesystem::path folder_;
    PartNews news_;
    double start_ = clock_seconds();
    std::mutex mutex_;
    std::jthread ticker_;  ///< last, so that it ends first
};

/// How a part stands, for people.
struct PartStanding {
    std::string word = "waiting", more;
    std::int64_t frames = 0;  ///< done
    double seconds = 0;       ///< that these took, as far as it is known
};

PartStanding standing_of(const FarmPlan& plan, const FilmPart& part) {
    const std::int64_t frames = part.frames.count();
    const std::optional<PartNews> news = news_in(plan.folder_of(part));
    if (plan.is_made(part)) return {"done", news ? news->machine : "", frames, news ? news->seconds : 0};
    if (!news) return {};
    PartStanding standing{"running", news->machine, news->done, news->seconds};
    if (news->is_lost()) {
        standing.word = "lost";
        standing.more += fmt::format(", silent for {}", clock_text(news->age));
    } else if (news->state == PartState::failed) {
        standing.word = "failed";
        standing.more += ": " + news->error;
    } else if (news->state != PartState::running) {
        standing.word = "ended";
        standing.more += ", interrupted";
    }
    return standing;
}

std::string status_text(const FarmPlan& plan) {
    std::string parts, counted;
    std::vector<std::string> words;
    std::int64_t done = 0, total = 0;
    double seconds = 0, timed_frames = 0;
    for (const FilmPart& part : plan.parts) {
        const PartStanding standing = standing_of(plan, part);
        const std::int64_t frames = part.frames.count();
        words.push_back(standing.word);
        done += standing.frames;
        total += frames;
        seconds += standing.seconds;
        if (standing.seconds > 0) timed_frames += static_cast<double>(standing.frames);
        parts += core::printable(fmt::format("part {:<5} {:8} {:>6}/{:<6} {}", part.number, standing.word,
                                             standing.frames, frames, standing.more)) +
                 "\n";
    }
    for (const char* word : {"done", "running", "failed", "lost", "ended", "waiting"})
        if (const auto n = std::ranges::count(words, word); n > 0)
            counted += fmt::format("{}{} {}", counted.empty() ? "" : ", ", n, word);
    const auto running = std::ranges::count(words, std::string("running"));
    const std::string left = running == 0 || timed_frames == 0
                                 ? ""
                                 : ", " +
                                       clock_text(seconds / timed_frames * static_cast<double>(total - done) /
                                                  static_cast<double>(running)) +
                                       " to go";
    return parts + fmt::format("{} parts: {}; {} of {} frames{}\n", plan.parts.size(), counted, done, total, left);
}

/// The parts that are asked for.
std::vector<FilmPart> wanted_of(const FarmPlan& plan, const PartOptions& options) {
    std::vector<FilmPart> wanted;
    if (options.frames) {
        const FrameRange frames = contiguous_from(*options.frames);
        for (const FilmPart& part : plan.parts)
            if (part.frames.first >= frames.first && part.frames.first <= frames.last) wanted.push_back(part);
        return wanted;
    }
    if (!options.number) throw UsageError("I is missing: which part, from 1? Or --frames A-B");
    if (*options.number > static_cast<int>(plan.parts.size()))
        throw UsageError(fmt::format("part {}: the plan has parts 1 to {}", *options.number, plan.parts.size()));
    return {plan.parts[static_cast<std::size_t>(*options.number) - 1]};
}

/// The part's work folder; waits while another process makes the same part. None after an interruption.
std::unique_ptr<WorkFolder> open_part(const FarmPlan& plan, const RenderOptions& options, bool quiet) {
    for (bool told = quiet; !InterruptGuard::requested(); told = true) {
        try {
            return std::make_unique<WorkFolder>(options.output, plan.facts->at("identity"),
                                                WorkFolder::Earlier::resumed);
        } catch (const OutputInUse& in_use) {
            if (!told) print_line(std::string(in_use.what()) + "; waiting for it");
        }
        // chosen: a part takes minutes.
        std::this_thread::sleep_for(std::chrono::seconds(1));
    }
    return nullptr;
}

/// Stores the values settled for the whole film, where the part's folder does not have them yet.
void keep_settled(const FarmPlan& plan, WorkFolder& work) {
    for (const auto& [name, value] : plan.facts->at("settled").items())
        if (work.kept(name).is_null()) work.keep(name, value);
}

int render_part(const FarmPlan& plan, const FilmPart& part, const PartOptions& wish, PartReporter& reporter) {
    const WallClock clock;
    const parallel::ThreadLimit threads(wish.threads);
    const InterruptGuard guard(wish.quiet);
    RenderOptions whole = options_of(plan);
    whole.quiet = whole.quiet || wish.quiet;
    if (wish.memory) whole.memory = wish.memory;
    const RenderOptions options = part_options(plan, part, whole);
    const std::unique_ptr<WorkFolder> work = open_part(plan, options, whole.quiet);
    if (work == nullptr) return InterruptGuard::status();
    if (options.layers) std::filesystem::create_directories(*options.layers);

    RunStatistics statistics;
    RenderJob film = timed(statistics, Stage::load, [&] { return prepare_within_memory(options); });
    timed(statistics, Stage::load, [&] { refuse_other_film(plan, film, whole); });
    open_writers(film, options);
    if (!options.memory) timed(statistics, Stage::load, [&] { return film.images->read_ahead(image_probes(false)); });
    if (InterruptGuard::requested()) return InterruptGuard::status();
    film.part = part.chunks;
    keep_settled(plan, *work);

    HeatmapFilms heatmaps(options, film, *work);
    RenderOptions silent = options;
    silent.quiet = true;
    std::vector<ChunkFile> files = take_up(
        film, silent, *work, [&](const std::vector<ChunkFile>& kept) { heatmaps.take_up(kept); }, statistics);
    settle(film, silent, *work, statistics);
    const std::int64_t there =
        static_cast<std::int64_t>(statistics.frames.size()) + lit_frames_in(options.output, film.chunks());
    if (!options.quiet)
        print_line(fmt::format("part {}: frames {} to {}{}", part.number, part.frames.first, part.frames.last,
                               there == 0 ? "" : fmt::format(", {} are there", there)));
    reporter.advance_to(static_cast<std::int64_t>(statistics.frames.size()));
    SampleFrameObserver sample_frame(film);
    const OpenRender open{film,
                          options,
                          plan.facts->at("identity"),
                          clock,
                          *work,
                          heatmaps,
                          sample_frame,
                          statistics,
                          files,
                          [&](std::int64_t done) { reporter.advance_to(done); }};
    const bool complete = render_chunks(open);
    try {
        heatmaps.rethrow();
    } catch (...) {
        // Nothing goes on from a heatmap that broke off.
        work->remove();
        throw;
    }
    return complete ? 0 : InterruptGuard::status();
}

int make_part(const FarmPlan& plan, const FilmPart& part, const PartOptions& options) {
    std::error_code error;
    std::filesystem::create_directories(plan.folder_of(part), error);
    PartReporter reporter(plan.folder_of(part), part.frames.count());
    try {
        refuse_other_machine(plan);
        const int status = render_part(plan, part, options, reporter);
        reporter.end(status == 0 ? PartState::done : PartState::interrupted);
        return status;
    } catch (const std::bad_alloc&) {
        reporter.end(PartState::failed, "out of memory");
        throw;
    } catch (const std::exception& failure) {
        reporter.end(PartState::failed, failure.what());
        throw;
    }
}

}  // namespace

int make_parts(const PartOptions& options) {
    const FarmPlan plan = read_plan(options.plan);
    const std::vector<FilmPart> wanted = wanted_of(plan, options);
    if (plan.is_joined()) {
        if (!options.quiet) print_line(plan.folder.string() + ": the film is joined already: nothing is to be done");
        return 0;
    }
    if (wanted.empty() && !options.quiet) print_line("no part begins with one of these frames: nothing is to be done");
    for (const FilmPart& part : wanted)
        if (const int status = make_part(plan, part, options); status != 0) return status;
    return 0;
}

int farm_status(const PartOptions& options) {
    const FarmPlan plan = read_plan(options.plan);
    if (options.left) {
        std::vector<int> left;
        for (const FilmPart& part : plan.parts)
            if (!plan.is_joined() && !plan.is_made(part)) left.push_back(part.number);
        if (!left.empty()) print(part_list(left) + "\n");
    } else if (plan.is_joined()) {
        print(fmt::format("{} parts: joined\n", plan.parts.size()));
    } else {
        print(status_text(plan));
    }
    return 0;
}

}  // namespace render2mpeg::app
