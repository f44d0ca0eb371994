#include "renderer/gather/cell_equations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/sampling.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

struct Equations {
    std::vector<EquationBlock> blocks;
    std::vector<std::size_t> ends;
};

/// Random equations of `rows` rows in two phases of four blocks; the weights of a row sum to `reflected`.
Equations random_equations(std::uint32_t rows, float reflected) {
    Equations e{std::vector<EquationBlock>(8), {4, 8}};
    std::uint32_t row = 0;
    for (std::uint32_t b = 0; b < 8; ++b) {
        EquationBlock& block = e.blocks[b];
        block.first_row = row;
        for (; row < rows * (b + 1) / 8; ++row) {
            block.constants.push_back(glm::vec3(core::uniform(1, row, 0), core::uniform(1, row, 1), 1));
            const std::uint32_t terms = row % 4;
            for (std::uint32_t t = 0; t < terms; ++t)
                block.terms.push_back({static_cast<std::uint32_t>(core::uniform(2, row, t) * static_cast<float>(rows)),
                                       glm::vec3(reflected / static_cast<float>(terms))});
            block.ends.push_back(static_cast<std::uint32_t>(block.terms.size()));
        }
    }
    return e;
}

/// By elimination, in double precision.
std::vector<double> eliminated(const Equations& e, std::uint32_t rows, int channel) {
    std::vector<std::vector<double>> a(rows, std::vector<double>(rows + 1, 0.0));
    for (const EquationBlock& block : e.blocks) {
        std::uint32_t term = 0;
        for (std::uint32_t k = 0; k < block.ends.size(); ++k) {
            std::vector<double>& row = a[block.first_row + k];
            row[block.first_row + k] += 1.0;
            row[rows] = static_cast<double>(block.constants[k][channel]);
            for (; term < block.ends[k]; ++term)
                row[block.terms[term].row] -= static_cast<double>(block.terms[term].weight[channel]);
        }
    }
    for (std::uint32_t i = 0; i < rows; ++i)
        for (std::uint32_t k = 0; k < rows; ++k) {
            if (k == i || a[k][i] == 0.0) continue;
            const double share = a[k][i] / a[i][i];
            for (std::uint32_t j = i; j <= rows; ++j) a[k][j] -= share * a[i][j];
        }
    std::vector<double> x;
    for (std::uint32_t i = 0; i < rows; ++i) x.push_back(a[i][rows] / a[i][i]);
    return x;
}

TEST(CellEquations, AreSolvedAsByElimination) {
    constexpr std::uint32_t rows = 200;
    for (const float reflected : {0.3f, 0.8f, 0.99f}) {
        const Equations e = random_equations(rows, reflected);
        const std::vector<glm::vec3> found = solve(e.blocks, e.ends);
        ASSERT_EQ(found.size(), rows);
        for (int channel = 0; channel < 3; ++channel) {
            const std::vector<double> truth = eliminated(e, rows, channel);
            // Rows that reflect 99 % of themselves are as slow as it gets.
            double all = 0, error = 0;
            for (std::uint32_t i = 0; i < rows; ++i) {
                all += truth[i];
                error += std::abs(static_cast<double>(found[i][channel]) - truth[i]);
                EXPECT_NEAR(found[i][channel], truth[i], (reflected < 0.9f ? 0.01 : 0.1) * truth[i]) << reflected;
            }
            EXPECT_LT(error, (reflected < 0.9f ? 3e-4 : 0.05) * all) << reflected;
        }
    }
}

TEST(CellEquations, AreSolvedAlikeByAnyNumberOfThreads) {
    const Equations e = random_equations(5000, 0.9f);
    std::vector<glm::vec3> first;
    for (const int threads : {1, 2, 3, 16}) {
        const parallel::ThreadLimit limit(threads);
        const std::vector<glm::vec3> found = solve(e.blocks, e.ends);
        if (first.empty()) first = found;
        EXPECT_EQ(found, first) << threads;
    }
}

TEST(CellEquations, MayBeNone) {
    const Equations none = random_equations(0, 0.5f);
    EXPECT_TRUE(solve(none.blocks, none.ends).empty());
}

}  // namespace
}  // namespace render2mpeg::renderer
