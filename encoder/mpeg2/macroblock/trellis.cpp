#include "encoder/mpeg2/macroblock/trellis.h"

#include <bit>
#include <cstdlib>

#include "encoder/mpeg2/kernels/quantiser.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// The cheapest way of coding a block up to a coefficient that is not 0; all after it are left out.
struct Path {
    float cost;          ///< lambda * bits + distortion beyond that of a block of zeros
    std::int8_t scan;    ///< of the coefficient
    std::int8_t before;  ///< path that it goes on from
    std::int16_t level;  ///< magnitude
    std::int16_t value;  ///< dequantised magnitude
};

class Trellis {
  public:
    Trellis(const Block& block, const QuantTable& table, const CoefficientLengths& lengths, bool intra, float lambda)
        : block_(block), table_(table), lengths_(lengths), intra_(intra), lambda_(lambda) {
        // The empty path ends before the first coefficient, or at an intra block's DC.
        paths_[0] = {0.0f, static_cast<std::int8_t>(intra ? 0 : -1), -1, 0, 0};
        open_[0] = 0;
    }

    /// Extends the open paths to the coefficient at `scan`, by its level and the one below.
    void extend(int scan) {
        const std::size_t place = place_of_scan[static_cast<std::size_t>(scan)];
        const float target = std::abs(block_.coefficients[place]);
        const int highest = std::abs(block_.levels[place]);
        Path& best = paths_[count_];
        best.before = -1;
        for (int level = highest; level > 0 && level >= highest - 1; --level) {
            const int value = dequantised_magnitude(table_, static_cast<int>(place), level);
            const float error = target - static_cast<float>(value),
                        gain = loss_of(block_, place, error) - loss_of(block_, place, target);
            for (int i = 0; i < open_count_; ++i) {
                const Path& from = paths_[open_[i]];
                const float cost = from.cost + gain +
                                   lambda_ * static_cast<float>(lengths_.bits_after(from.scan, scan, level, intra_));
                if (best.before >= 0 && cost >= best.cost) continue;
                best = {cost, static_cast<std::int8_t>(scan), open_[i], static_cast<std::int16_t>(level),
                        static_cast<std::int16_t>(value)};
            }
        }

        // A path that ends earlier and costs as much can never win: longer runs have no shorter codes (test).
        while (open_count_ > 0 && paths_[open_[open_count_ - 1]].cost >= best.cost) --open_count_;
        open_[open_count_++] = static_cast<std::int8_t>(count_++);
    }

    /// The cheapest path of all.
    const Path& best() const { return paths_[open_[0]]; }
    const Path& before(const Path& path) const { return paths_[path.before]; }

  private:
    const Block& block_;
    const QuantTable& table_;
    const CoefficientLengths& lengths_;
    bool intra_;
    float lambda_;
    Path paths_[65];
    int count_ = 1;
    std::int8_t open_[65];  ///< by rising scan and rising cost
    int open_count_ = 1;
};

}  // namespace

void trellis_rdoq(Block& block, const QuantTable& table, const CoefficientLengths& lengths, bool intra, float lambda) {
    Trellis trellis(block, table, lengths, intra, lambda);
    for (std::uint64_t left = block.scan_mask; left != 0; left &= left - 1) trellis.extend(std::countr_zero(left));

    // Trace back; coefficients not on the path become 0.
    const Path* path = &trellis.best();
    for (std::uint64_t left = block.scan_mask; left != 0;) {
        const int scan = 63 - std::countl_zero(left);
        left &= ~(std::uint64_t{1} << scan);
        const bool stays = path->level > 0 && path->scan == scan;
        const int level = stays ? path->level : 0, value = stays ? path->value : 0;
        if (stays) path = &trellis.before(*path);
        const std::size_t place = place_of_scan[static_cast<std::size_t>(scan)];
        if (level == std::abs(block.levels[place])) continue;

        const float target = std::abs(block.coefficients[place]);
        const float error = target - static_cast<float>(std::abs(block.dequantised[place])),
                    new_error = target - static_cast<float>(value);
        block.distortion += loss_of(block, place, new_error) - loss_of(block, place, error);
        const int sign = block.levels[place] < 0 ? -1 : 1;
        block.levels[place] = static_cast<std::int16_t>(sign * level);
        block.dequantised[place] = static_cast<std::int16_t>(sign * value);
        if (!stays) block.scan_mask &= ~(std::uint64_t{1} << scan);
    }
}

}  // namespace render2mpeg::encoder::mpeg2
