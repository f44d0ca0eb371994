#pragma once
// Limits of sizes in an animation file.
#include <array>
#include <string_view>

#include "scene/animation_file/json.h"

namespace render2mpeg::scene {

// What has a size at all, and what still fits single precision beside its neighbours.
inline constexpr double smallest_size = 1e-6, largest_size = 1e6;

/// A size by its key.
inline double size_or(const JsonValue& value, std::string_view key, double otherwise) {
    const auto v = value.find(key);
    return v ? v->number(smallest_size, largest_size) : otherwise;
}

/// n sizes by their key, or one number for all of them.
template <std::size_t n>
std::array<double, n> sizes_or(const JsonValue& value, std::string_view key, double otherwise) {
    std::array<double, n> out;
    out.fill(otherwise);
    const auto v = value.find(key);
    if (!v) return out;
    if (v->is_number()) {
        out.fill(v->number(smallest_size, largest_size));
        return out;
    }
    const std::vector<JsonValue> items = v->list(n, n);
    for (std::size_t i = 0; i < n; ++i) out[i] = items[i].number(smallest_size, largest_size);
    return out;
}

}  // namespace render2mpeg::scene
