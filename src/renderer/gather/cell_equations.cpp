#include "renderer/gather/cell_equations.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "parallel/loops.h"
#include "renderer/base/flush_denormals.h"

namespace render2mpeg::renderer {
namespace {

/// Change of luminance, as a share, at which the equations count as solved; and sweeps at most, for surfaces that
/// reflect nearly all. chosen: 1e-4; what is left is a hundred times as much where they reflect 99 %.
constexpr double solved = 1e-4;
constexpr int most_sweeps = 256;

/// Rows that are worth a task of their own.
constexpr std::size_t rows_at_once = 256;

/// Luminance of a block and how far a sweep moved it.
struct Moved {
    double change = 0, all = 0;
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
        moved.all += static_cast<double>(core::luminance(sum));
        now[row] = sum;
    }
    return moved;
}

}  // namespace

std::vector<glm::vec3> solve(std::span<const EquationBlock> blocks, std::span<const std::size_t> ends) {
    std::vector<glm::vec3> now;
    for (const EquationBlock& b : blocks) now.insert(now.end(), b.constants.begin(), b.constants.end());
    std::vector<glm::vec3> before(now.size());
    std::vector<Moved> moved(blocks.size());
    for (int s = 0; s < most_sweeps; ++s) {
        before.swap(now);
        for (std::size_t phase = 0, first = 0; phase < ends.size(); first = ends[phase++]) {
            const std::size_t count = ends[phase] - first, earlier = blocks[first].first_row;
            const std::size_t rows = blocks[ends[phase] - 1].first_row + blocks[ends[phase] - 1].ends.size() - earlier;
            const std::size_t at_once =
                std::clamp<std::size_t>(rows_at_once * count / std::max<std::size_t>(rows, 1), 1, count);
            parallel::for_ranges(count, at_once, [&](std::size_t begin, std::size_t end) {
                const FlushDenormals flushed;
                for (std::size_t b = first + begin; b < first + end; ++b)
                    moved[b] = sweep(blocks[b], earlier, before, now);
            });
        }
        double change = 0, all = 0;
        for (const Moved& m : moved) change += m.change, all += m.all;
        if (!(change > solved * all)) break;
    }
    return now;
}

}  // namespace render2mpeg::renderer
