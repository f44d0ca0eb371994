#include "app/farm/part_news.h"

#include <unistd.h>

#include <array>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "app/files/file_io.h"
#include "app/system/progress.h"

namespace render2mpeg::app {

NLOHMANN_JSON_SERIALIZE_ENUM(PartState, {{PartState::running, "running"},
                                         {PartState::done, "done"},
                                         {PartState::failed, "failed"},
                                         {PartState::interrupted, "interrupted"}})
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PartNews, state, done, total, seconds, machine, error)

namespace {

std::filesystem::path news_file(const std::filesystem::path& folder) {
    return folder / "status.json";
}

std::string machine_name() {
    std::array<char, 256> name{};
    return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

}  // namespace

std::optional<PartNews> news_in(const std::filesystem::path& folder) {
    const nlohmann::json written = read_json(news_file(folder));
    PartNews news;
    try {
        written.get_to(news);
    } catch (const nlohmann::json::exception&) {
        return {};
    }
    std::error_code error;
    const auto at = std::filesystem::last_write_time(news_file(folder), error);
    if (error) return {};
    news.age = std::chrono::duration<double>(std::filesystem::file_time_type::clock::now() - at).count();
    return news;
}

PartReporter::PartReporter(std::filesystem::path folder, std::int64_t total) : folder_(std::move(folder)) {
    news_.total = total;
    news_.machine = machine_name();
    write();
    ticker_ = every(news_pause, [this] {
        const std::lock_guard lock(mutex_);
        write();
    });
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
    news_.seconds = clock_seconds() - start_;
    nlohmann::json written = news_;
    written["process"] = getpid();
    try {
        write_json(news_file(folder_), written);
    } catch (const std::exception&) {
        // A full disk: what is made says so itself.
    }
}

}  // namespace render2mpeg::app
