#include "app/farm/part_status.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <system_error>
#include <vector>

#include "app/farm/farm.h"
#include "app/farm/farm_plan.h"
#include "app/files/file_io.h"
#include "app/system/progress.h"
#include "core/text.h"

namespace render2mpeg::app {
namespace {

/// How a part stands, for people.
struct PartStanding {
    std::string word = "waiting", more;
    std::int64_t frames = 0;  ///< done
    double seconds = 0;       ///< that these took, as far as it is known
};

PartStanding standing_of(const FarmPlan& plan, const FilmPart& part) {
    const std::int64_t frames = part.frames.last + 1 - part.frames.first;
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
        const std::int64_t frames = part.frames.last + 1 - part.frames.first;
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
        if (const auto n = std::count(words.begin(), words.end(), word); n > 0)
            counted += fmt::format("{}{} {}", counted.empty() ? "" : ", ", n, word);
    const auto running = std::count(words.begin(), words.end(), "running");
    const std::string left = running == 0 || timed_frames == 0
                                 ? ""
                                 : ", " +
                                       clock_text(seconds / timed_frames * static_cast<double>(total - done) /
                                                  static_cast<double>(running)) +
                                       " to go";
    return parts + fmt::format("{} parts: {}; {} of {} frames{}\n", plan.parts.size(), counted, done, total, left);
}

}  // namespace

NLOHMANN_JSON_SERIALIZE_ENUM(PartState, {{PartState::running, "running"},
                                         {PartState::done, "done"},
                                         {PartState::failed, "failed"},
                                         {PartState::interrupted, "interrupted"}})
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PartNews, state, done, total, seconds, machine, error)

namespace {

using nlohmann::json;

/// chosen: often enough to tell who is alive, and seldom enough for a thousand parts on one file system.
constexpr std::chrono::seconds news_pause(30);

std::filesystem::path news_file(const std::filesystem::path& folder) {
    return folder / "status.json";
}

std::string machine_name() {
    std::array<char, 256> name{};
    return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

}  // namespace

bool PartNews::is_lost() const {
    // chosen: four times the pause: a busy file server delays what others see.
    return state == PartState::running && age > 4.0 * static_cast<double>(news_pause.count());
}

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

PartReporter::PartReporter(std::filesystem::path folder, std::int64_t total)
    : folder_(std::move(folder)), start_(std::chrono::steady_clock::now()) {
    news_.total = total;
    news_.machine = machine_name();
    write();
    ticker_ = std::thread([this] {
        std::unique_lock lock(mutex_);
        while (!ends_.wait_for(lock, news_pause, [this] { return ended_; })) write();
    });
}

PartReporter::~PartReporter() {
    {
        const std::lock_guard lock(mutex_);
        ended_ = true;
    }
    ends_.notify_all();
    ticker_.join();
}

void PartReporter::advance_to(std::int64_t done) {
    const std::lock_guard lock(mutex_);
    news_.done = done;
}

void PartReporter::end(PartState state, const std::string& error) {
    const std::lock_guard lock(mutex_);
    news_.state = state;
    news_.error = error;
    write();
}

void PartReporter::write() {
    news_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    json written = news_;
    written["process"] = getpid();
    try {
        write_json(news_file(folder_), written);
    } catch (const std::exception&) {
        // A full disk: what is made says so itself.
    }
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
