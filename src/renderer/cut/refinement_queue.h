#pragma once
// A bucket queue of clusters by refinement priority.
#include <bit>
#include <cstdint>
#include <vector>

namespace render2mpeg::renderer {

/// The clusters of a cut that may be refined, the most urgent first, in steps of priority that are a fourth of an
/// octave wide: exact order within a step changes no cut that matters, and a heap's comparisons, which no processor
/// predicts, took as long as bounds. Within a step the oldest comes first, so that where all are as urgent (nothing is
/// lit yet, or nothing tolerated) trees are refined level by level.
class RefinementQueue {
  public:
    void clear() {
        for (; words_ != 0; words_ &= words_ - 1) steps_[std::countr_zero(words_)] = 0;
    }
    bool empty() const { return words_ == 0; }

    /// Puts a slot in that is not there; priority >= 0, not NaN.
    void push(float priority, std::uint32_t slot) {
        if (slot >= entries_.size()) entries_.resize(2 * std::size_t{slot} + 64);
        const std::uint32_t step = std::bit_cast<std::uint32_t>(priority) >> step_bits;
        std::uint64_t& steps = steps_[step / 64];
        const std::uint64_t bit = std::uint64_t{1} << step % 64;
        Ends& ends = ends_[step];
        ((steps & bit) != 0 ? entries_[ends.last].next : ends.first) = slot;
        ends.last = slot;
        entries_[slot].priority = priority;
        steps |= bit;
        words_ |= 1u << step / 64;
    }

    /// The next to come out, and its priority; not when empty.
    std::uint32_t front() const { return ends_[top()].first; }
    float priority() const { return entries_[front()].priority; }

    std::uint32_t pop() {
        const std::uint32_t step = top();
        Ends& ends = ends_[step];
        const std::uint32_t slot = ends.first;
        ends.first = entries_[slot].next;
        if (slot == ends.last) {
            steps_[step / 64] &= ~(std::uint64_t{1} << step % 64);
            if (steps_[step / 64] == 0) words_ &= ~(1u << step / 64);
        }
        return slot;
    }

  private:
    /// Exponent and the two highest digits of a float >= 0 are its step: a rising function.
    static constexpr int step_bits = 21, most_steps = 1024;
    struct Ends {
        std::uint32_t first, last;
    };
    struct Entry {
        float priority;
        std::uint32_t next;
    };

    std::uint32_t top() const {
        const int word = 31 - std::countl_zero(words_);
        return static_cast<std::uint32_t>(64 * word + 63 - std::countl_zero(steps_[word]));
    }

    std::uint32_t words_ = 0;                 ///< bit w: `steps_[w]` is not 0
    std::uint64_t steps_[most_steps / 64]{};  ///< bits of the steps that hold slots
    Ends ends_[most_steps]{};                 ///< of the steps' lists, where there are any
    std::vector<Entry> entries_;              ///< of each slot
};

}  // namespace render2mpeg::renderer
