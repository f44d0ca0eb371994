#pragma once
// JSON values that know their place, so that errors name it.
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace render2mpeg::scene {

/// A JSON value with its place (`camera.keys[3].position`) for messages. Wrong types and ranges throw core::Error.
class JsonValue {
  public:
    /// Reads JSON with comments. Refuses files over 16 MiB, nested deeper than 32, or with repeated keys.
    static JsonValue read(const std::filesystem::path& file);

    /// `file: camera.keys[3].position: <cause>`
    [[noreturn]] void fail(const std::string& cause) const;

    /// Place in the file; empty for the whole.
    const std::string& place() const { return path_; }

    bool is_number() const;
    bool is_text() const;
    bool is_list() const;
    bool is_object() const;

    double number(double at_least, double at_most) const;
    /// The number of a key, or `otherwise`.
    double number_or(std::string_view key, double at_least, double at_most, double otherwise) const {
        const auto value = find(key);
        return value ? value->number(at_least, at_most) : otherwise;
    }
    /// Replaces a value where the key is there.
    void set(std::string_view key, float& into, double at_least, double at_most) const {
        into = static_cast<float>(number_or(key, at_least, at_most, static_cast<double>(into)));
    }
    std::int64_t integer(std::int64_t at_least, std::int64_t at_most) const;
    bool boolean() const;
    std::string text() const;
    /// Index of one of these words; errors name the nearest.
    std::size_t word(std::span<const std::string_view> words) const;

    std::vector<JsonValue> list(std::size_t at_least, std::size_t at_most) const;
    std::vector<double> numbers(std::size_t count) const;
    glm::dvec3 position() const;  ///< [x, y, z], each within 1e7
    /// One number for all channels or [r, g, b], each 0..`at_most`.
    glm::vec3 channels(double at_most) const;
    /// Linear colour: "#rrggbb" (sRGB), or `channels`.
    glm::vec3 color(double at_most) const;

    /// Throws for another key and names the nearest.
    void allow_only(std::span<const std::string_view> keys) const;
    std::optional<JsonValue> find(std::string_view key) const;
    JsonValue need(std::string_view key) const;
    bool has(std::string_view key) const { return find(key).has_value(); }
    /// In the order of the file.
    std::vector<std::pair<std::string, JsonValue>> members() const;

  private:
    using Json = nlohmann::ordered_json;
    JsonValue(std::shared_ptr<const Json> root, const Json* value, std::string file, std::string path);
    JsonValue below(const Json& value, const std::string& step) const;
    [[noreturn]] void expected(const std::string& what) const;

    std::shared_ptr<const Json> root_;
    const Json* value_;
    std::string file_, path_;
};

inline constexpr double smallest_size = 1e-6, largest_size = 1e6;

/// A size, or `otherwise`.
inline double size_or(const JsonValue& value, std::string_view key, double otherwise) {
    return value.number_or(key, smallest_size, largest_size, otherwise);
}

/// n sizes, or one number for all of them.
template <int n>
glm::vec<n, double> sizes_or(const JsonValue& value, std::string_view key, double otherwise) {
    const auto v = value.find(key);
    if (!v || v->is_number()) return glm::vec<n, double>(size_or(value, key, otherwise));
    const std::vector<JsonValue> items = v->list(n, n);
    glm::vec<n, double> out;
    for (int i = 0; i < n; ++i) out[i] = items[static_cast<std::size_t>(i)].number(smallest_size, largest_size);
    return out;
}

}  // namespace render2mpeg::scene
