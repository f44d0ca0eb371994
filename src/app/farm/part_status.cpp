#include "app/farm/part_status.h"

#include <unistd.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "app/files/text_file.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

constexpr std::array<std::pair<PartState, const char*>, 4> state_names{{{PartState::running, "running"},
                                                                        {PartState::done, "done"},
                                                                        {PartState::failed, "failed"},
                                                                        {PartState::interrupted, "interrupted"}}};

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
    std::ifstream stream(news_file(folder));
    const json written = json::parse(stream, nullptr, false);
    PartNews news;
    try {
        const auto state = written.at("state").get<std::string>();
        for (const auto& [known, name] : state_names)
            if (state == name) news.state = known;
        written.at("done").get_to(news.done);
        written.at("total").get_to(news.total);
        written.at("seconds").get_to(news.seconds);
        written.at("machine").get_to(news.machine);
        written.at("error").get_to(news.error);
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
    const char* state = "";
    for (const auto& [known, name] : state_names)
        if (news_.state == known) state = name;
    try {
        write_json(news_file(folder_), {{"state", state},
                                        {"done", news_.done},
                                        {"total", news_.total},
                                        {"seconds", news_.seconds},
                                        {"machine", news_.machine},
                                        {"process", getpid()},
                                        {"error", news_.error}});
    } catch (const std::exception&) {
        // A full disk: what is made says so itself.
    }
}

}  // namespace render2mpeg::app
