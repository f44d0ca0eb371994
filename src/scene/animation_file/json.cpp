#include "scene/animation_file/json.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "core/color.h"
#include "core/error.h"
#include "core/plain_file.h"
#include "core/text.h"

namespace render2mpeg::scene {
namespace {

// chosen: films written by hand are a few kilobytes and nest about 10 deep; programs that write films stay below a
// thousand times that.
constexpr std::uintmax_t largest_file = std::uintmax_t{16} << 20;
constexpr int deepest = 32;

std::string shortened(double value) {
    std::ostringstream out;
    out << value;
    return out.str();
}

std::string joined(std::span<const std::string_view> words) {
    std::string all;
    for (const std::string_view w : words) all += (all.empty() ? "" : ", ") + std::string(w);
    return all;
}

/// A name on one line.
std::string shown(std::string_view name) {
    std::string out = "\"";
    for (const char c : name.substr(0, 60)) out += static_cast<unsigned char>(c) < 32 ? '?' : c;
    return out + (name.size() > 60 ? "...\"" : "\"");
}

/// The nearest word; where none is near, all of them.
std::string meant_or_all(std::string_view said, std::span<const std::string_view> words) {
    const std::string near = core::did_you_mean(said, words, "\"", "\"");
    return near.empty() ? "; there are " + joined(words) : near;
}

}  // namespace

JsonValue::JsonValue(std::shared_ptr<const Json> root, const Json* value, std::string file, std::string path)
    : root_(std::move(root)), value_(value), file_(std::move(file)), path_(std::move(path)) {}

JsonValue JsonValue::read(const std::filesystem::path& file) {
    const auto refuse = [&](const std::string& cause) { throw core::Error("reading", file.string(), cause); };
    if (const std::string why = core::why_no_plain_file(file); !why.empty()) refuse(why);
    std::error_code failure;
    const auto size = std::filesystem::file_size(file, failure);
    if (failure) refuse(failure.message());
    if (size > largest_file) refuse("is larger than 16 MiB, which no animation file is");
    std::ifstream in(file, std::ios::binary);
    if (!in) refuse("cannot be opened");

    // The parser does not recurse, but readers of its result do; and it hides repeated keys.
    std::vector<std::set<std::string>> seen;
    const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
        if (depth > deepest) refuse("is nested deeper than " + std::to_string(deepest) + " levels");
        if (event == Json::parse_event_t::object_start) seen.emplace_back();
        if (event == Json::parse_event_t::object_end) seen.pop_back();
        if (event == Json::parse_event_t::key && !seen.back().insert(value.get<std::string>()).second)
            refuse("says the key " + shown(value.get<std::string>()) + " twice in one object");
        return true;
    };
    auto root = std::make_shared<Json>();
    try {
        *root = Json::parse(in, watch, true, true);
    } catch (const Json::exception& e) {
        // "[json.exception.parse_error.101] parse error at line 3, column 5: ..."
        std::string cause = e.what();
        if (const auto bracket = cause.find("] "); bracket != std::string::npos) cause = cause.substr(bracket + 2);
        std::replace_if(
            cause.begin(), cause.end(), [](unsigned char c) { return c < 32; }, ' ');
        refuse(cause);
    }
    const Json* value = root.get();
    return {std::move(root), value, file.string(), ""};
}

JsonValue JsonValue::below(const Json& value, const std::string& step) const {
    std::string path = path_;
    if (!path.empty() && step.front() != '[') path += '.';
    return {root_, &value, file_, path + step};
}

void JsonValue::fail(const std::string& cause) const {
    if (path_.empty()) throw core::Error("reading", file_, cause);
    throw core::Error("reading", file_, path_, cause);
}

void JsonValue::expected(const std::string& what) const {
    std::string found = value_->is_string() ? "the text " + shown(value_->get_ref<const std::string&>())
                                            : std::string(value_->type_name());
    if (value_->is_number()) found = shortened(value_->get<double>());
    if (value_->is_boolean()) found = value_->get<bool>() ? "true" : "false";
    if (value_->is_array()) found = "a list of " + std::to_string(value_->size());
    if (value_->is_object()) found = "an object";
    fail("expected " + what + ", found " + found);
}

bool JsonValue::is_number() const {
    return value_->is_number();
}
bool JsonValue::is_text() const {
    return value_->is_string();
}
bool JsonValue::is_list() const {
    return value_->is_array();
}
bool JsonValue::is_object() const {
    return value_->is_object();
}

double JsonValue::number(double at_least, double at_most) const {
    const std::string wanted = "a number from " + shortened(at_least) + " to " + shortened(at_most);
    if (!value_->is_number()) expected(wanted);
    const double v = value_->get<double>();
    // Bounds are kept in single precision: 0.95 is one that is given as 0.95f.
    const auto single = static_cast<float>(v);
    if (!(single >= static_cast<float>(at_least) && single <= static_cast<float>(at_most))) expected(wanted);
    return std::clamp(v, at_least, at_most);
}

std::int64_t JsonValue::integer(std::int64_t at_least, std::int64_t at_most) const {
    const std::string wanted = "a whole number from " + std::to_string(at_least) + " to " + std::to_string(at_most);
    if (!value_->is_number()) expected(wanted);
    const double v = value_->get<double>();
    if (v != std::floor(v) || !(v >= static_cast<double>(at_least) && v <= static_cast<double>(at_most)))
        expected(wanted);
    return static_cast<std::int64_t>(v);
}

bool JsonValue::boolean() const {
    if (!value_->is_boolean()) expected("true or false");
    return value_->get<bool>();
}

std::string JsonValue::text() const {
    if (!value_->is_string()) expected("a text in quotation marks");
    return value_->get<std::string>();
}

std::size_t JsonValue::word(std::span<const std::string_view> words) const {
    if (!value_->is_string()) expected("one of " + joined(words));
    const auto& said = value_->get_ref<const std::string&>();
    const auto at = std::find(words.begin(), words.end(), said);
    if (at == words.end())
        fail("knows no " + shown(said) + core::did_you_mean(said, words, "\"", "\"") + "; there are " + joined(words));
    return static_cast<std::size_t>(at - words.begin());
}

std::vector<JsonValue> JsonValue::list(std::size_t at_least, std::size_t at_most) const {
    const std::string count =
        at_least == at_most ? std::to_string(at_least) : std::to_string(at_least) + " to " + std::to_string(at_most);
    if (!value_->is_array() || value_->size() < at_least || value_->size() > at_most) expected("a list of " + count);
    std::vector<JsonValue> items;
    for (std::size_t i = 0; i < value_->size(); ++i)
        items.push_back(below((*value_)[i], std::string("[").append(std::to_string(i)).append("]")));
    return items;
}

std::vector<double> JsonValue::numbers(std::size_t count) const {
    if (!value_->is_array() || value_->size() != count) expected("a list of " + std::to_string(count) + " numbers");
    std::vector<double> out;
    for (const JsonValue& item : list(count, count)) out.push_back(item.number(-1e7, 1e7));
    return out;
}

glm::dvec3 JsonValue::position() const {
    const std::vector<double> v = numbers(3);
    return {v[0], v[1], v[2]};
}

glm::vec3 JsonValue::channels(double at_most) const {
    if (value_->is_number()) return glm::vec3(static_cast<float>(number(0, at_most)));
    if (!value_->is_array() || value_->size() != 3) expected("one number, or three of red, green and blue");
    const std::vector<JsonValue> v = list(3, 3);
    return {v[0].number(0, at_most), v[1].number(0, at_most), v[2].number(0, at_most)};
}

glm::vec3 JsonValue::color(double at_most) const {
    if (value_->is_string()) {
        const auto& hex = value_->get_ref<const std::string&>();
        const bool well_formed =
            hex.size() == 7 && hex[0] == '#' && hex.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
        if (!well_formed) expected("a colour like \"#ff8000\" or [1, 0.5, 0]");
        const unsigned long rgb = std::stoul(hex.substr(1), nullptr, 16);
        const auto linear = [&](int shift) {
            return core::srgb_to_linear(static_cast<float>((rgb >> shift) & 255u) / 255.0f);
        };
        return {linear(16), linear(8), linear(0)};
    }
    if (!value_->is_number() && (!value_->is_array() || value_->size() != 3))
        expected("a colour like \"#ff8000\" or [1, 0.5, 0]");
    return channels(at_most);
}

void JsonValue::allow_only(std::span<const std::string_view> keys) const {
    if (!value_->is_object()) expected("an object in braces");
    for (const auto& [key, unused] : value_->items())
        if (std::find(keys.begin(), keys.end(), key) == keys.end())
            fail("knows no key " + shown(key) + meant_or_all(key, keys));
}

std::optional<JsonValue> JsonValue::find(std::string_view key) const {
    if (!value_->is_object()) expected("an object in braces");
    const auto at = value_->find(std::string(key));
    if (at == value_->end()) return std::nullopt;
    return below(*at, std::string(key));
}

JsonValue JsonValue::need(std::string_view key) const {
    if (auto value = find(key)) return *value;
    fail("lacks \"" + std::string(key) + "\"");
}

std::vector<std::pair<std::string, JsonValue>> JsonValue::members() const {
    if (!value_->is_object()) expected("an object in braces");
    std::vector<std::pair<std::string, JsonValue>> out;
    for (const auto& [key, value] : value_->items()) {
        const bool plain = !key.empty() && key.find_first_of(". []\"") == std::string::npos;
        out.emplace_back(key, below(value, plain ? key : std::string("[").append(shown(key)).append("]")));
    }
    return out;
}

}  // namespace render2mpeg::scene
