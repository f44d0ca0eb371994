#include "encoder/mpeg2/motion/motion_search.h"

#include <array>
#include <bit>

#include "core/error.h"
#include "encoder/mpeg2/kernels/kernels.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

constexpr int grid = 4, most_reach = 24;
/// Steps of 2 and 1 may lead as much beyond the area.
constexpr int margin = 3;

/// One macroblock's search.
class Search {
  public:
    Search(const Frame& picture, const Frame& reference, const SearchArea& area)
        : area_(area),
          here_(picture.y.row(area.row * 16) + area.column * 16),
          there_(reference.y.row(area.row * 16) + area.column * 16),
          stride_(static_cast<std::ptrdiff_t>(picture.y.width())),
          x_(area.centre.x >> 1),
          y_(area.centre.y >> 1) {
        EXPECTS(area.reach % grid == 0 && area.reach > 0 && area.reach <= most_reach);
    }

    SearchResult run() {
        for (int y = -area_.reach; y <= area_.reach; y += grid)
            for (int x = -area_.reach; x <= area_.reach; x += grid) consider(x, y);
        for (int step = grid / 2; step > 0; step /= 2) {
            const auto best = result_.vectors;
            for (const Vector& v : best) {
                const int x = (v.x >> 1) - x_, y = (v.y >> 1) - y_;
                for (int dy = -step; dy <= step; dy += step)
                    for (int dx = -step; dx <= step; dx += step) consider(x + dx, y + dy);
            }
        }
        return result_;
    }

  private:
    /// Considers a vector so many pixels from the centre, once.
    void consider(int x, int y) {
        std::uint64_t& row = seen_[static_cast<std::size_t>(y + most_reach + margin)];
        const std::uint64_t bit = std::uint64_t{1} << (x + most_reach + margin);
        if ((row & bit) != 0) return;
        row |= bit;
        const int dx = x_ + x, dy = y_ + y;
        if (2 * dx < area_.allowed.low_x || 2 * dx > area_.allowed.high_x || 2 * dy < area_.allowed.low_y ||
            2 * dy > area_.allowed.high_y)
            return;
        ++result_.evaluations;
        const auto difference =
            static_cast<float>(kernels().sad_16x16(here_, stride_, there_ + dy * stride_ + dx, stride_));
        if (result_.vectors.size() == SearchResult::most && difference >= result_.vectors.key(SearchResult::most - 1))
            return;  // whatever its bits are
        const Vector v{static_cast<std::int16_t>(2 * dx), static_cast<std::int16_t>(2 * dy)};
        result_.vectors.add(v, difference + area_.cost_per_bit * static_cast<float>(bits(v)));
    }

    /// Approximate bits of the vector: for each component 1 for no difference, else 3 and 2 more for each doubling.
    int bits(Vector v) const { return bits_of(v.x - area_.prediction.x) + bits_of(v.y - area_.prediction.y); }
    static int bits_of(int difference) {
        const auto magnitude = static_cast<unsigned>(difference < 0 ? -difference : difference);
        return 1 + 2 * static_cast<int>(std::bit_width(magnitude));
    }

    const SearchArea& area_;
    const std::uint8_t *here_, *there_;
    std::ptrdiff_t stride_;
    int x_, y_;  ///< the centre, pixels
    std::array<std::uint64_t, 2 * (most_reach + margin) + 1> seen_{};
    SearchResult result_;
};

}  // namespace

SearchResult search_whole_pixels(const Frame& picture, const Frame& reference, const SearchArea& area) {
    return Search(picture, reference, area).run();
}

}  // namespace render2mpeg::encoder::mpeg2
