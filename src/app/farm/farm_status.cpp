#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "app/estimate/hire.h"
#include "app/farm/farm.h"
#include "app/farm/farm_plan.h"
#include "app/farm/part_news.h"
#include "app/farm/pieces.h"
#include "app/files/file_io.h"
#include "app/files/work_folder.h"
#include "app/options/usage_error.h"
#include "app/system/progress.h"
#include "app/system/terminal.h"
#include "core/numeric.h"
#include "core/text.h"

namespace render2mpeg::app {
namespace {

/// How a part stands, for people.
struct PartStanding {
    std::string word = "waiting", more;
    std::int64_t frames = 0;  ///< done
    double seconds = 0;       ///< that these took, as far as it is known
};

/// What the records of a part's finished chunks count.
struct Spent {
    std::int64_t frames = 0;
    double cpu = 0;    ///< seconds
    double share = 0;  ///< of the film by forecast
};

Spent spent_of(const FarmPlan& plan, const FilmPart& part) {
    Spent counted;
    const std::filesystem::path output = plan.folder_of(part) / plan.output_name;
    if (!WorkFolder::is_of(output, plan.facts->at("identity"))) return counted;
    for (std::size_t i = part.chunks.first; i <= part.chunks.last; ++i) {
        const nlohmann::json record = read_json(WorkFolder::record_of(output, {static_cast<int>(i), 0, 0}));
        try {
            const auto first = record.at("first").get<std::int64_t>(), last = record.at("last").get<std::int64_t>();
            counted.cpu += record.at("facts").at("statistics").at("cpu").get<double>();
            counted.frames += last - first + 1;
            counted.share += plan.shares[i];
        } catch (const nlohmann::json::exception&) {
            // Not made yet, or damaged: the join tells.
        }
    }
    return counted;
}

PartStanding standing_of(const FarmPlan& plan, const FilmPart& part, const Spent& counted) {
    const std::int64_t frames = part.frames.count();
    const std::optional<PartNews> news = news_in(plan.folder_of(part));
    if (plan.is_made(part)) return {"done", news ? news->machine : "", frames, news ? news->seconds : 0};
    if (!news && counted.frames > 0) return {"begun", "", counted.frames, 0};
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

/// CPU spent on what is finished, that of the plan too, and what the forecast says of what is left, at that pace.
std::string money_text(const FarmPlan& plan, const Spent& counted, const std::optional<Price>& price) {
    if (counted.frames == 0) return {};
    const double planned = plan.facts->at("cost").at("cpu").get<double>(),
                 all = std::reduce(plan.shares.begin(), plan.shares.end()),
                 left = core::divide_or(counted.cpu, counted.share, 0) * std::max(0.0, all - counted.share);
    return fmt::format("spent {}; left about {}\n", cost_text(price, 1, (planned + counted.cpu) / 3600),
                       cost_text(price, 1, left / 3600));
}

std::string status_text(const FarmPlan& plan, const std::optional<Price>& price) {
    std::string parts, counted;
    std::vector<std::string> words;
    std::int64_t done = 0, total = 0;
    double seconds = 0, timed = 0;
    std::vector<double> to_go;  // of the parts by forecast
    Spent all;
    for (const FilmPart& part : plan.longest_first()) {
        const Spent made = spent_of(plan, part);
        const PartStanding standing = standing_of(plan, part, made);
        all = {all.frames + made.frames, all.cpu + made.cpu, all.share + made.share};
        const std::int64_t frames = part.frames.count();
        const double done_of = static_cast<double>(standing.frames) / static_cast<double>(frames);
        words.push_back(standing.word);
        done += standing.frames;
        total += frames;
        seconds += standing.seconds;
        if (standing.seconds > 0) timed += done_of * plan.share_of(part);
        to_go.push_back((1 - done_of) * plan.share_of(part));
        parts += core::printable(fmt::format("part {:<5} {:8} {:>6}/{:<6} {}", part.number, standing.word,
                                             standing.frames, frames, standing.more)) +
                 "\n";
    }
    for (const char* word : {"done", "running", "failed", "lost", "ended", "begun", "waiting"})
        if (const auto n = std::ranges::count(words, word); n > 0)
            counted += fmt::format("{}{} {}", counted.empty() ? "" : ", ", n, word);
    const auto running = std::ranges::count(words, std::string("running"));
    const std::string left =
        running == 0 || timed <= 0
            ? ""
            : ", " + clock_text(seconds / timed * farm_seconds(to_go, static_cast<int>(running))) + " to go";
    return parts + fmt::format("{} parts: {}; {} of {} frames{}\n", plan.parts.size(), counted, done, total, left) +
           money_text(plan, all, price);
}

}  // namespace

int farm_status(const PartOptions& options) {
    const FarmPlan plan = read_plan(options.plan);
    if (options.price && !options.price->of_core) throw UsageError("--price: what was spent is counted in core-hours");
    if (options.pieces && !plan.is_joined())
        for (const std::string& line : take_pieces(plan, plan.parts, *options.pieces)) print_line(line);
    if (options.left) {
        std::vector<int> left;
        for (const FilmPart& part : plan.parts)
            if (!plan.is_joined() && !plan.is_made(part)) left.push_back(part.number);
        if (!left.empty()) print(part_list(left) + "\n");
    } else if (plan.is_joined()) {
        print(fmt::format("{} parts: joined\n", plan.parts.size()));
    } else {
        print(status_text(plan, options.price));
    }
    return 0;
}

}  // namespace render2mpeg::app
