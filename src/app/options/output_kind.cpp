#include "app/options/output_kind.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>

#include "app/options/mistakes.h"
#include "app/options/usage_error.h"
#include "core/error.h"
#include "core/text.h"
#include "encoder/av/av.h"

namespace render2mpeg::app {
namespace {

struct NumberField {
    std::size_t begin = 0, length = 0;
    int digits = 0;
};

std::optional<NumberField> number_field(const std::string& name) {
    const std::size_t begin = name.find('%');
    if (begin == std::string::npos || name.find('%', begin + 1) != std::string::npos) return {};
    std::size_t end = begin + 1;
    int digits = 0;
    while (end < name.size() && name[end] >= '0' && name[end] <= '9' && digits < 10)
        digits = digits * 10 + (name[end++] - '0');
    if (end >= name.size() || name[end] != 'd' || digits > 9) return {};
    return NumberField{begin, end + 1 - begin, digits};
}

}  // namespace

OutputKind kind_of(const std::filesystem::path& output) {
    if (av::is_film(output)) return OutputKind::film;
    const std::string ending = core::ending_of(output);
    if (ending == ".y4m") return OutputKind::y4m;
    if (ending == ".exr" || ending == ".png") {
        if (!is_numbered(output))
            throw UsageError("writing", output.string(),
                             "an image sequence needs one frame number in its name, e.g. frames.%04d" + ending);
        return ending == ".exr" ? OutputKind::exr : OutputKind::png;
    }
    if (const std::string instead = instead_of(output); !instead.empty())
        throw UsageError("writing", output.string(), instead);
    throw UsageError("writing", output.string(),
                     "the ending chooses what is written: .mpg, .vob, .ts, .m2v, .mkv, .webm, .gif, .mp4, .mov, .y4m, "
                     "or images such as "
                     "frames.%04d.exr or .png");
}

void settle_stream(std::filesystem::path& output, std::optional<std::string>& as) {
    if (output != "-") {
        if (as) throw UsageError("--as " + *as + ": it says what goes to standard output; write -o -");
        return;
    }
    if (!as) as = "ts";
    output = "-." + *as;
}

void check_pipe(int descriptor) {
    if (isatty(descriptor) != 0)
        throw UsageError("-o -: standard output is a terminal; write into a pipe, e.g. | ffplay -");
}

bool is_numbered(const std::filesystem::path& pattern) {
    return number_field(pattern.filename().string()).has_value();
}

std::vector<std::int64_t> numbers_on_disk(const std::filesystem::path& pattern) {
    const std::filesystem::path folder = pattern.has_parent_path() ? pattern.parent_path() : ".";
    std::vector<std::int64_t> numbers;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
        if (const auto number = number_in(pattern, entry.path())) numbers.push_back(*number);
    std::ranges::sort(numbers);
    return numbers;
}

std::optional<std::int64_t> number_in(const std::filesystem::path& pattern, const std::filesystem::path& file) {
    const std::string name = pattern.filename().string(), found = file.filename().string();
    const auto field = number_field(name);
    EXPECTS(field.has_value());
    const std::string before = name.substr(0, field->begin), after = name.substr(field->begin + field->length);
    if (found.size() <= before.size() + after.size() || !found.starts_with(before) || !found.ends_with(after))
        return {};
    // Only names of numbered(): "7" is none of %04d.
    const char* end = found.data() + found.size() - after.size();
    std::int64_t number = -1;
    const auto [stop, failure] = std::from_chars(found.data() + before.size(), end, number);
    if (failure != std::errc{} || stop != end || number < 0 || numbered(pattern, number).filename() != found) return {};
    return number;
}

std::filesystem::path layers_in(const std::filesystem::path& folder) {
    return folder / "frame_%04d.exr";
}

std::filesystem::path motion_in(const std::filesystem::path& folder) {
    return folder / "frame_%04d.motion";
}

std::filesystem::path numbered(const std::filesystem::path& pattern, std::int64_t frame) {
    std::string name = pattern.filename().string();
    const auto field = number_field(name);
    EXPECTS(field.has_value());
    name.replace(field->begin, field->length, fmt::format("{:0{}d}", frame, field->digits));
    return pattern.parent_path() / name;
}

std::filesystem::path work_folder_of(const std::filesystem::path& output) {
    return std::filesystem::path(output) += ".partial";
}

}  // namespace render2mpeg::app
