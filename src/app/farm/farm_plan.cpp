#include "app/farm/farm_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>
#include <system_error>

#include "app/estimate/chunk_shares.h"
#include "app/files/file_io.h"
#include "app/files/work_folder.h"
#include "app/options/usage_error.h"
#include "app/production/resume.h"
#include "core/error.h"
#include "core/isa.h"

namespace render2mpeg::app {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FrameRange, first, last)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ChunkRange, first, last)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FilmPart, number, chunks, frames)

namespace {

using nlohmann::json;

/// Of the file's form: another number is not read.
constexpr int plan_format = 4;

std::filesystem::path absolute_of(const std::filesystem::path& place) {
    std::error_code error;
    return std::filesystem::absolute(place, error).lexically_normal();
}

/// Whether all of an array's or an object's values are whole numbers: others have no conversion to those.
bool are_whole(const json& values) {
    const json flat = values.flatten();
    return std::all_of(flat.begin(), flat.end(), [](const json& value) { return value.is_number_integer(); });
}

/// Whether the parts follow each other in the film, each with a number of its own.
bool are_sound(const std::vector<FilmPart>& parts) {
    // chosen: ten million chunks, 270 days; a plan that says more is damaged.
    constexpr std::size_t most_chunks = 10'000'000;
    std::size_t chunks = 0;
    std::vector<bool> numbers(parts.size());
    for (const FilmPart& part : parts) {
        const bool follows = part.chunks.first == chunks && part.chunks.last >= chunks &&
                             part.chunks.last < most_chunks && part.frames.first <= part.frames.last;
        const bool is_one = part.number >= 1 && static_cast<std::size_t>(part.number) <= parts.size();
        if (!follows || !is_one || numbers[static_cast<std::size_t>(part.number) - 1]) return false;
        numbers[static_cast<std::size_t>(part.number) - 1] = true;
        chunks = part.chunks.last + 1;
    }
    return chunks > 0;
}

/// Whether parts and shares are sound, and what is looked up is there.
bool is_sound(const FarmPlan& plan) {
    if (!are_sound(plan.parts) || plan.shares.size() != plan.parts.back().chunks.last + 1) return false;
    const auto is_share = [](double share) { return std::isfinite(share) && share > 0; };
    const json& identity = plan.facts->at("identity");
    const std::filesystem::path name(plan.output_name);
    const bool is_named = name == name.filename() && name.has_filename() && name != "." && name != "..";
    return std::ranges::all_of(plan.shares, is_share) && plan.words.size() >= 3 && is_named &&
           identity.at("instruction set").is_string() && identity.at("render2mpeg").is_string() &&
           plan.facts->at("settled").is_object() && plan.facts->at("cost").is_object();
}

}  // namespace

std::filesystem::path FarmPlan::folder_of(const FilmPart& part) const {
    return folder / fmt::format("part_{:05}", part.number);
}

std::int64_t FarmPlan::most_frames() const {
    std::int64_t most = 0;
    for (const FilmPart& part : parts) most = std::max(most, part.frames.count());
    return most;
}

double FarmPlan::share_of(const FilmPart& part) const {
    const auto first = shares.begin() + static_cast<std::ptrdiff_t>(part.chunks.first);
    return std::reduce(first, first + static_cast<std::ptrdiff_t>(part.chunks.count()));
}

std::vector<FilmPart> FarmPlan::longest_first() const {
    std::vector<FilmPart> sorted = parts;
    std::ranges::sort(sorted, {}, &FilmPart::number);
    return sorted;
}

bool FarmPlan::is_joined() const {
    return is_there(joined_mark());
}

bool FarmPlan::is_made(const FilmPart& part) const {
    const std::filesystem::path output = folder_of(part) / output_name;
    std::vector<Chunk> chunks;
    for (std::size_t i = part.chunks.first; i <= part.chunks.last; ++i) chunks.push_back({static_cast<int>(i), 0, 0});
    return WorkFolder::left(output, facts->at("identity"), chunks).size() == chunks.size();
}

std::filesystem::path farm_folder_of(const std::filesystem::path& output) {
    return std::filesystem::path(output) += ".farm";
}

std::vector<FilmPart> parts_of(const std::vector<Chunk>& chunks, const std::vector<double>& shares,
                               std::optional<int> parts, std::optional<std::int64_t> frames_per_part) {
    EXPECTS(!chunks.empty());
    std::size_t count = chunks.size();
    if (parts) {
        count = std::min(count, static_cast<std::size_t>(std::max(1, *parts)));
    } else if (frames_per_part) {
        const std::int64_t length = chunks.front().frames();
        const auto each = static_cast<std::size_t>(std::max<std::int64_t>(1, (*frames_per_part + length / 2) / length));
        count = (chunks.size() + each - 1) / each;
    }
    FarmPlan plan;
    plan.shares = shares;
    for (const ChunkRange& range : balanced(shares, count))
        plan.parts.push_back({0, range, {chunks[range.first].first, chunks[range.last].last}});
    // Of equal ones the earlier comes first.
    std::vector<FilmPart*> order;
    for (FilmPart& part : plan.parts) order.push_back(&part);
    std::ranges::stable_sort(order, std::greater(), [&](const FilmPart* part) { return plan.share_of(*part); });
    for (std::size_t i = 0; i < order.size(); ++i) order[i]->number = static_cast<int>(i) + 1;
    return plan.parts;
}

bool has_plan(const std::filesystem::path& folder) {
    return is_file(folder / plan_name);
}

FarmPlan read_plan(const std::filesystem::path& place) {
    std::error_code error;
    const bool is_folder = std::filesystem::is_directory(place, error);
    const std::filesystem::path file = is_folder ? place / plan_name : place;
    if (!is_there(file)) throw core::Error("reading", file.string(), "there is no plan; `render2mpeg farm` makes one");
    const json written = read_json(file);
    try {
        if (written.at("format") != plan_format)
            throw Refusal("reading", file.string(), "the plan is of another version of render2mpeg");
        FarmPlan plan;
        plan.folder = absolute_of(file).parent_path();
        written.at("render").get_to(plan.words);
        written.at("packed").get_to(plan.packed);
        plan.start = plan.packed ? plan.inputs() : std::filesystem::path(written.at("start").get<std::string>());
        written.at("scheduler").get_to(plan.scheduler);
        written.at("output").get_to(plan.output_name);
        written.at("forecast").get_to(plan.shares);
        plan.facts = std::make_shared<json>();
        for (const char* fact : {"identity", "settled", "cost"}) (*plan.facts)[fact] = written.at(fact);
        if (are_whole(written.at("parts"))) {
            written.at("parts").get_to(plan.parts);
            if (is_sound(plan)) return plan;
        }
    } catch (const json::exception&) {
    }
    throw core::Error("reading", file.string(), "it is no plan that `render2mpeg farm` has written, or is damaged");
}

void write_plan(const FarmPlan& plan) {
    json written = *plan.facts;
    written["format"] = plan_format;
    written["render"] = plan.words;
    written["packed"] = plan.packed;
    written["start"] = plan.start.string();
    written["scheduler"] = plan.scheduler;
    written["output"] = plan.output_name;
    written["parts"] = plan.parts;
    written["forecast"] = plan.shares;
    write_json(plan.folder / plan_name, written);
}

RenderOptions options_of(const FarmPlan& plan) {
    std::error_code error;
    std::filesystem::current_path(plan.start, error);
    if (error)
        throw Refusal("reading", plan.start.string(),
                      error.message() + "; are the film's inputs on this machine? `farm --pack` takes them along");
    try {
        RenderOptions options = parse(plan.words).render;
        options.isa = core::isa_from(plan.facts->at("identity").at("instruction set").get<std::string>());
        return options;
    } catch (const UsageError& error) {
        // Nobody typed it now.
        throw core::Error("reading", (plan.folder / plan_name).string(),
                          std::string("its command is damaged: ") + error.what());
    }
}

RenderOptions part_options(const FarmPlan& plan, const FilmPart& part, const RenderOptions& film) {
    const std::filesystem::path folder = plan.folder_of(part);
    RenderOptions options = film;
    options.output = folder / film.output.filename();
    options.stats.reset();
    if (options.report) options.report = folder / "report.html";
    if (options.layers) options.layers = folder / "layers";
    for (std::size_t i = 0; i < options.side_films.size(); ++i) {
        std::filesystem::path& file = options.side_films[i].file;
        file = folder / fmt::format("beside_{}{}", i + 1, file.extension().string());
    }
    options.resume = true;
    options.overwrite = true;
    return options;
}

json farm_identity(const FarmPlan& plan, const RenderJob& film, RenderOptions options) {
    // Where layers go may differ on the machine that joins.
    options.layers.reset();
    json identity = json::parse(json_text(identity_of(film, options)));
    std::error_code error;
    const std::string here = std::filesystem::weakly_canonical(plan.folder, error).string() + "/";
    json inputs = json::object();
    for (const auto& [file, checksum] : identity["inputs"].items())
        inputs[file.starts_with(here) ? file.substr(here.size()) : file] = checksum;
    identity["inputs"] = inputs;
    return identity;
}

void refuse_other_machine(const FarmPlan& plan) {
    const json& identity = plan.facts->at("identity");
    // A machine that has more can do with less.
    try {
        core::isa_from(identity.at("instruction set").get<std::string>());
    } catch (const core::Error& error) {
        throw Refusal("making", plan.folder.string(),
                      std::string(error.what()) + "; `farm --isa` pins a level that all machines have");
    }
    const std::string difference =
        difference_of({{"render2mpeg", identity.at("render2mpeg")}}, {{"render2mpeg", program_text()}});
    if (!difference.empty()) throw Refusal("making", plan.folder.string(), difference);
}

void refuse_other_film(const FarmPlan& plan, const RenderJob& film, const RenderOptions& options) {
    std::string difference = difference_of(plan.facts->at("identity"), farm_identity(plan, film, options));
    if (difference.empty() && plan.parts.back().chunks.last + 1 != film.chunks().size())
        difference = "the number of chunks has changed";
    if (!difference.empty()) throw Refusal("making", plan.folder.string(), difference + " since `farm` planned it");
}

std::string part_list(std::vector<int> numbers) {
    std::ranges::sort(numbers);
    std::string text;
    for (std::size_t i = 0; i < numbers.size();) {
        std::size_t last = i;
        while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
        text += (text.empty() ? "" : ",") + std::to_string(numbers[i]);
        if (last > i) text += "-" + std::to_string(numbers[last]);
        i = last + 1;
    }
    return text;
}

}  // namespace render2mpeg::app
