#pragma once
// Two-dimensional arrays.
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include "core/error.h"

namespace render2mpeg::core {

/// A dense two-dimensional array, row by row without padding; (0, 0) is the upper left, y points down.
template <class T>
class Plane {
    static_assert(!std::is_same_v<T, bool>, "std::vector<bool> has no rows; use std::uint8_t");

  public:
    Plane() = default;
    Plane(int width, int height, T fill = T{}) : width_(width), height_(height) {
        EXPECTS(width >= 0 && height >= 0);
        values_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill);
    }

    int width() const { return width_; }
    int height() const { return height_; }
    std::size_t size() const { return values_.size(); }
    bool empty() const { return values_.empty(); }

    T& at(int x, int y) { return values_[index(x, y)]; }
    const T& at(int x, int y) const { return values_[index(x, y)]; }
    T* row(int y) { return values_.data() + index(0, y); }
    const T* row(int y) const { return values_.data() + index(0, y); }
    std::span<T> values() { return values_; }
    std::span<const T> values() const { return values_; }

    bool operator==(const Plane&) const = default;

  private:
    std::size_t index(int x, int y) const {
        EXPECTS_DEBUG(x >= 0 && x < width_ && y >= 0 && y < height_);
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }

    int width_ = 0;
    int height_ = 0;
    std::vector<T> values_;
};

}  // namespace render2mpeg::core
