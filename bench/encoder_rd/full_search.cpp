#include "encoder_rd/full_search.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace render2mpeg::bench {
namespace {

/// A macroblock's part of the picture.
struct Area {
    int x, y, width, height;
};

std::int64_t difference(const core::Picture& picture, const core::Picture& reference, const Area& area, int dx,
                        int dy) {
    std::int64_t sum = 0;
    for (int y = area.y; y < area.y + area.height; ++y) {
        const std::uint8_t* here = picture.y.row(y) + area.x;
        const std::uint8_t* there = reference.y.row(y + dy) + area.x + dx;
        int row = 0;
        for (int x = 0; x < area.width; ++x) row += std::abs(here[x] - there[x]);
        sum += row;
    }
    return sum;
}

}  // namespace

core::MotionField full_search(const core::Picture& picture, const core::Picture& reference, int quantiser, int range,
                              std::uint64_t& evaluations) {
    const int width = picture.width(), height = picture.height();
    core::MotionField field;
    field.picture = picture.number;
    field.reference = reference.number;
    field.vector = core::Plane<glm::vec2>(width, height);
    field.kind = core::Plane<core::PixelClass>(width, height, core::PixelClass::surface);
    for (int top = 0; top < height; top += 16) {
        int centre_x = 0, centre_y = 0;
        for (int left = 0; left < width; left += 16) {
            const Area area{left, top, std::min(16, width - left), std::min(16, height - top)};
            const int low_x = std::max(centre_x - range, -left), low_y = std::max(centre_y - range, -top);
            const int high_x = std::min(centre_x + range, width - left - area.width);
            const int high_y = std::min(centre_y + range, height - top - area.height);
            int best_x = 0, best_y = 0;
            std::int64_t best = std::numeric_limits<std::int64_t>::max();
            for (int y = low_y; y <= high_y; ++y)
                for (int x = low_x; x <= high_x; ++x) {
                    // About a bit per doubling; absolute differences weigh a third of the quantiser per bit.
                    const int length = std::abs(x - centre_x) + std::abs(y - centre_y);
                    std::int64_t cost = difference(picture, reference, area, x, y);
                    for (int l = length; l > 0; l /= 2) cost += quantiser / 3;
                    ++evaluations;
                    if (cost >= best) continue;
                    best = cost;
                    best_x = x;
                    best_y = y;
                }
            for (int y = top; y < top + area.height; ++y)
                std::fill_n(field.vector.row(y) + left, area.width, glm::vec2(best_x, best_y));
            centre_x = best_x;
            centre_y = best_y;
        }
    }
    return field;
}

}  // namespace render2mpeg::bench
