#include "renderer/gather/cell_equations.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/color.h"
#include "parallel/loops.h"
#include "renderer/base/flush_denormals.h"

namespace render2mpeg::renderer {
namespace {

/// Luminance that is still to come, as a share of all, at which the equations count as solved; and sweeps at most.
/// chosen: 1e-4.
constexpr double solved = 1e-4;
constexpr unsigned most_sweeps = 256;

/// Rows that are worth a task of their own.
constexpr std::size_t rows_at_once = 256;

/// Sums of luminance over rows: how far a sweep moved them, what they were and are, and their constants.
struct Moved {
    double change = 0, before = 0, all = 0, constant = 0;
};

/// Rows of a phase before `earlier` are read from `now`, others from `before`.
Moved sweep(const EquationBlock& block, std::size_t earlier, const std::vector<glm::vec3>& before,
            std::vector<glm::vec3>& now) {
    Moved moved;
    std::uint32_t term = 0;
    for (std::size_t k = 0; k < block.ends.size(); ++k) {
        glm::vec3 sum = block.constants[k];
        for (; term < block.ends[k]; ++term) {
            const EquationBlock::Term& t = block.terms[term];
            sum += t.weight * (t.row < earlier ? now : before)[t.row];
        }
        const std::size_t row = block.first_row + k;
        moved.change += static_cast<double>(std::abs(core::luminance(sum - before[row])));
        moved.before += static_cast<double>(core::luminance(before[row]));
        moved.all += static_cast<double>(core::luminance(sum));
        moved.constant += static_cast<double>(core::luminance(block.constants[k]));
        now[row] = sum;
    }
    return moved;
}

/// One sweep of all phases, from `before` to `now`.
Moved sweep(std::span<const EquationBlock> blocks, std::span<const std::size_t> ends,
            const std::vector<glm::vec3>& before, std::vector<glm::vec3>& now) {
    std::vector<Moved> moved(blocks.size());
    for (std::size_t phase = 0, first = 0; phase < ends.size(); first = ends[phase++]) {
        const EquationBlock& last = blocks[ends[phase] - 1];
        const std::size_t count = ends[phase] - first, earlier = blocks[first].first_row,
                          rows = last.first_row + last.ends.size() - earlier;
        const std::size_t at_once =
            std::clamp<std::size_t>(rows_at_once * count / std::max<std::size_t>(rows, 1), 1, count);
        parallel::for_ranges(count, at_once, [&](std::size_t begin, std::size_t end) {
            const FlushDenormals flushed;
            for (std::size_t b = first + begin; b < first + end; ++b) moved[b] = sweep(blocks[b], earlier, before, now);
        });
    }
    Moved sum;
    for (const Moved& m : moved) {
        sum.change += m.change;
        sum.before += m.before;
        sum.all += m.all;
        sum.constant += m.constant;
    }
    return sum;
}

}  // namespace

std::vector<glm::vec3> solve(std::span<const EquationBlock> blocks, std::span<const std::size_t> ends) {
    std::vector<glm::vec3> now;
    for (const EquationBlock& b : blocks) now.insert(now.end(), b.constants.begin(), b.constants.end());
    std::vector<glm::vec3> before(now.size());
    double last_change = 0;
    for (unsigned s = 0; s < most_sweeps; ++s) {
        before.swap(now);
        const Moved moved = sweep(blocks, ends, before, now);
        // Changes shrink as a geometric series in the end, whose rest is to come: two of them tell.
        const double factor = last_change > 0.0 ? std::min(moved.change / last_change, 0.999) : 0.999;
        if (!(std::max(factor / (1.0 - factor), 1.0) * moved.change > solved * moved.all)) break;
        last_change = moved.change;
        // Where light stays long it lacks a common factor, which the balance of what comes and goes tells. It is put in
        // at sweeps 4, 8, 16 and so on, so that what it may disturb has time to go.
        const double balance = moved.constant / (moved.before - moved.all + moved.constant);
        if (s < 3 || !std::has_single_bit(s + 1u) || !(balance > 1.0 && balance < 16.0)) continue;
        for (glm::vec3& x : now) x *= static_cast<float>(balance);
        last_change = 0;
    }
    return now;
}

}  // namespace render2mpeg::renderer
