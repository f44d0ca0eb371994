#include "image/channel_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace render2mpeg::image {
namespace {

/// Texels that a coordinate may be off.
constexpr double slack = 0.01;

/// Boxes of coordinates beyond this are not asked. chosen: 1024 repetitions; texels of an image are counted in 31 bits.
constexpr double farthest = 0x1p10;

/// chosen: 2^20 finest cells, 11 MB while a pyramid lives; larger textures have cells of several texels.
constexpr double most_cells = 0x1p20;

/// A rectangle is looked at in cells so large that it has at most so many along a side. chosen: of 2 to 8; fewer are
/// less exact.
constexpr int most_across = 4;

constexpr Bounds nothing{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};

Bounds joined(Bounds a, Bounds b) {
    return {std::min(a.low, b.low), std::max(a.high, b.high)};
}

}  // namespace

ChannelBounds::ChannelBounds(const Texture& texture, int channel)
    : size_(texture.width(), texture.height()), wrap_u_(texture.wrap_u()), wrap_v_(texture.wrap_v()) {
    EXPECTS(size_.x > 0 && size_.y > 0 && std::max(size_.x, size_.y) < 1 << 20);
    while (static_cast<double>(size_.x) * size_.y > most_cells * block_ * block_) block_ *= 2;
    core::Plane<Bounds> finest((size_.x + block_ - 1) / block_, (size_.y + block_ - 1) / block_, nothing);
    for (int y = 0; y < size_.y; ++y)
        for (int x = 0; x < size_.x; ++x) {
            const float value = texture.texel(x, y, channel);
            Bounds& cell = finest.at(x / block_, y / block_);
            cell = joined(cell, {value, value});
        }
    levels_.push_back(std::move(finest));
    while (levels_.back().size() > 1) {
        const core::Plane<Bounds>& below = levels_.back();
        core::Plane<Bounds> level((below.width() + 1) / 2, (below.height() + 1) / 2, nothing);
        for (int y = 0; y < below.height(); ++y)
            for (int x = 0; x < below.width(); ++x)
                level.at(x / 2, y / 2) = joined(level.at(x / 2, y / 2), below.at(x, y));
        levels_.push_back(std::move(level));
    }
}

std::optional<Bounds> ChannelBounds::within(glm::dvec2 low, glm::dvec2 high) const {
    struct Parts {
        Texels part[2];
        int count = 1;
    };
    // Texels on one axis that lie about a range of coordinates: one row of them, or two where the image begins anew.
    const auto taken = [](double from, double to, int n, core::Wrap wrap) -> Parts {
        const int first = static_cast<int>(std::floor(from * n - 0.5 - slack)),
                  last = static_cast<int>(std::floor(to * n - 0.5 + slack)) + 1;
        if (wrap != core::Wrap::clamp_to_edge && last - first >= n - 1) return {{{0, n - 1}, {}}};
        const int a = wrapped(first, n, wrap), b = wrapped(last, n, wrap);
        switch (wrap) {
            case core::Wrap::repeat:
                if (a > b) return {{{0, b}, {a, n - 1}}, 2};
                break;
            case core::Wrap::mirrored_repeat: {
                // Where the range turns at an edge it holds that.
                const auto period = [n](int i) { return i >= 0 ? i / n : -((n - 1 - i) / n); };
                const bool up = period(first) % 2 == 0, turns = period(first) != period(last);
                const auto [least, most] = std::minmax(a, b);
                return {{{turns && !up ? 0 : least, turns && up ? n - 1 : most}, {}}};
            }
            case core::Wrap::clamp_to_edge:
                break;
        }
        return {{{a, b}, {}}};
    };

    if (!(low.x > -farthest && low.y > -farthest && high.x < farthest && high.y < farthest)) return {};
    const Parts columns = taken(low.x, high.x, size_.x, wrap_u_), rows = taken(low.y, high.y, size_.y, wrap_v_);
    Bounds bounds = nothing;
    for (int j = 0; j < rows.count; ++j)
        for (int i = 0; i < columns.count; ++i) bounds = joined(bounds, over(columns.part[i], rows.part[j]));
    return bounds;
}

/// Of a rectangle of texels.
Bounds ChannelBounds::over(Texels columns, Texels rows) const {
    int x0 = columns.first / block_, x1 = columns.last / block_, y0 = rows.first / block_, y1 = rows.last / block_;
    std::size_t level = 0;
    for (; std::max(x1 - x0, y1 - y0) >= most_across; ++level) x0 /= 2, x1 /= 2, y0 /= 2, y1 /= 2;
    Bounds bounds = nothing;
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) bounds = joined(bounds, levels_[level].at(x, y));
    return bounds;
}

}  // namespace render2mpeg::image
