#pragma once
// A queue of clusters by refinement priority.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace render2mpeg::renderer {

/// The clusters of a cut that may be refined, the most urgent first, in steps of priority that are a fourth of an
/// octave wide: exact order within a step changes no cut that matters. Within a step the oldest comes first, so that
/// where all are as urgent (nothing is lit yet, or nothing tolerated) trees are refined level by level.
class RefinementQueue {
  public:
    void clear() {
        heap_.clear();
        next_ = 0;
    }
    bool empty() const { return heap_.empty(); }

    /// Puts a slot in that is not there; priority >= 0, not NaN.
    void push(float priority, std::uint32_t slot) {
        // Exponent and the two highest digits of a float >= 0: a rising function.
        const std::uint64_t step = std::bit_cast<std::uint32_t>(priority) >> 21;
        heap_.push_back({step << 32 | ~next_++, priority, slot});
        std::push_heap(heap_.begin(), heap_.end());
    }

    /// The next to come out, and its priority; not when empty.
    std::uint32_t front() const { return heap_.front().slot; }
    float priority() const { return heap_.front().priority; }

    std::uint32_t pop() {
        std::pop_heap(heap_.begin(), heap_.end());
        const std::uint32_t slot = heap_.back().slot;
        heap_.pop_back();
        return slot;
    }

  private:
    struct Entry {
        std::uint64_t order;  ///< larger ones first
        float priority;
        std::uint32_t slot;
        bool operator<(const Entry& other) const { return order < other.order; }
    };
    std::vector<Entry> heap_;
    std::uint32_t next_ = 0;  ///< since `clear`
};

}  // namespace render2mpeg::renderer
