#include "app/files/whole_mark.h"

#include <fmt/format.h>
#include <sys/xattr.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <system_error>

#include "app/files/checksum.h"
#include "app/files/identity_difference.h"
#include "app/files/text_file.h"
#include "core/error.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

constexpr const char* attribute = "user.render2mpeg.film";

/// chosen: all attributes of a file of ext4's share a block of 4 KiB.
constexpr std::size_t most_bytes = 3500;

std::string dump(const json& value) {
    return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::uint64_t checksum_of_text(const std::string& text) {
    Checksum sum;
    sum.add(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
    return sum.value();
}

/// The files as they are: names, sizes and times of writing.
std::string state_of(const std::vector<std::filesystem::path>& files) {
    std::string text;
    for (const std::filesystem::path& file : files) {
        std::error_code error;
        const auto bytes = std::filesystem::file_size(file, error);
        const auto written = std::filesystem::last_write_time(file, error).time_since_epoch().count();
        if (error) return {};
        text += fmt::format("{}\n{}\n{}\n", file.filename().string(), bytes, static_cast<std::int64_t>(written));
    }
    return text_of(checksum_of_text(text));
}

/// The identity with its inputs as one, for films of many: which of them changed is not told then.
json with_inputs_as_one(json identity) {
    json& inputs = identity["inputs"];
    if (!inputs.is_array() || inputs.size() < 2) return identity;
    const std::string name = inputs.front().value("file", std::string()) + " or one of the files that it refers to";
    inputs = json::array({{{"file", name}, {"checksum", text_of(checksum_of_text(dump(inputs)))}}});
    return identity;
}

std::string full_name_of(const std::filesystem::path& file) {
    std::error_code error;
    return std::filesystem::weakly_canonical(std::filesystem::absolute(file, error), error).string();
}

/// The mark of a file; none where there is none.
std::optional<json> mark_of(const std::filesystem::path& file) {
    const ssize_t size = getxattr(file.c_str(), attribute, nullptr, 0);
    if (size <= 0) return std::nullopt;
    std::string text(static_cast<std::size_t>(size), '\0');
    if (getxattr(file.c_str(), attribute, text.data(), text.size()) != size) return std::nullopt;
    json mark = json::parse(text, nullptr, false);
    if (!mark.is_object() || !mark.contains("identity") || !mark.value("beside", json()).is_array())
        return std::nullopt;
    return mark;
}

}  // namespace

void mark_as_whole(const Products& products, const json& identity) {
    EXPECTS(!products.frames.empty());
    json mark{{"identity", identity}, {"files", state_of(products.frames)}, {"beside", json::array()}};
    for (const std::filesystem::path& file : products.beside) mark["beside"].push_back(full_name_of(file));
    std::string text = dump(mark);
    if (text.size() > most_bytes) {
        mark["identity"] = with_inputs_as_one(identity);
        mark["as_one"] = true;
        text = dump(mark);
    }
    const int failure = setxattr(products.frames.front().c_str(), attribute, text.data(), text.size(), 0);
    static_cast<void>(failure);  // then nobody will know it
}

Wholeness wholeness_of(const Products& products, const json& identity) {
    EXPECTS(!products.frames.empty());
    const std::optional<json> mark = mark_of(products.frames.front());
    if (!mark) return {};
    // As it was written: what is no UTF-8 was replaced.
    const json now = json::parse(dump(mark->contains("as_one") ? with_inputs_as_one(identity) : identity));
    if (std::string text = difference_of((*mark)["identity"], now); !text.empty())
        return {Wholeness::State::other, std::move(text)};
    if (mark->value("files", json()) != state_of(products.frames))
        return {Wholeness::State::other, "what was written has changed since"};
    const json& there = (*mark)["beside"];
    for (const std::filesystem::path& file : products.beside) {
        std::error_code error;
        if (std::find(there.begin(), there.end(), json(as_json_keeps(full_name_of(file)))) == there.end() ||
            !std::filesystem::exists(file, error))
            return {Wholeness::State::lacking, file.string()};
    }
    return {Wholeness::State::whole, {}};
}

}  // namespace render2mpeg::app
