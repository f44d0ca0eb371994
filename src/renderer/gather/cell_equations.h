#pragma once
// Linear equations of cells that light each other, solved by any number of threads alike.
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace render2mpeg::renderer {

/// Rows x = constant + sum of weight * x of other rows, componentwise; the sum of a row's weights is below 1.
struct EquationBlock {
    struct Term {
        std::uint32_t row = 0;
        glm::vec3 weight{0};
    };
    std::uint32_t first_row = 0;       ///< number of its first row
    std::vector<glm::vec3> constants;  ///< by row
    std::vector<std::uint32_t> ends;   ///< by row: end of its terms
    std::vector<Term> terms;
};

/// Solves equations whose blocks lie in phases: `ends` has the end of each. Gauss-Seidel between phases: rows of later
/// phases read what this sweep found in earlier ones. Jacobi within a phase: its blocks read each other's rows as of
/// the sweep before, so that the result is the same for any number of threads. Put first what most others ask. Returns
/// x by row, to about a ten-thousandth of all luminance; to some hundredths where cells keep 99 % to themselves.
std::vector<glm::vec3> solve(std::span<const EquationBlock> blocks, std::span<const std::size_t> ends);

}  // namespace render2mpeg::renderer
