#include "encoder/mpeg2/motion/candidates.h"

#include <algorithm>
#include <cmath>

#include "encoder/mpeg2/bitstream/levels.h"
#include "parallel/loops.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// Every fourth pixel of every eighth row.
/// chosen: every eighth row of 4 and 8: time against bits (docs/measurements.md#encoder).
constexpr int sample_step = 4, row_step = 8, first_row = 2;

/// Vectors of the macroblock's valid pixels.
struct Samples {
    std::array<glm::vec2, 16 / sample_step*(16 / row_step)> vector;
    int count = 0;
    glm::vec2 low{0.0f}, high{0.0f}, sum{0.0f};
};

/// Longest vector: longer ones lead out of every picture (1920 columns at most), and NaN counts as longer.
constexpr float longest = 4096.0f;

bool is_valid(core::PixelClass kind, glm::vec2 v) {
    return kind != core::PixelClass::none && std::abs(v.x) <= longest && std::abs(v.y) <= longest;
}

Samples gather(const core::MotionField& motion, int column, int row) {
    Samples samples;
    const int end_x = std::min(column * 16 + 16, motion.vector.width());
    const int end_y = std::min(row * 16 + 16, motion.vector.height());
    for (int y = std::min(row * 16 + first_row, end_y - 1); y >= row * 16 && y < end_y; y += row_step) {
        const glm::vec2* vectors = motion.vector.row(y);
        const core::PixelClass* kinds = motion.kind.row(y);
        for (int x = column * 16; x < end_x; x += sample_step)
            if (is_valid(kinds[x], vectors[x])) samples.vector[static_cast<std::size_t>(samples.count++)] = vectors[x];
    }
    if (samples.count == 0) return samples;
    samples.low = samples.high = samples.vector[0];
    for (int i = 0; i < samples.count; ++i) {
        const glm::vec2 v = samples.vector[static_cast<std::size_t>(i)];
        samples.low = glm::min(samples.low, v);
        samples.high = glm::max(samples.high, v);
        samples.sum += v;
    }
    return samples;
}

Vector to_half_pixels(glm::vec2 v, const VectorRange& range) {
    return range.clamp(static_cast<int>(std::floor(2.0f * v.x + 0.5f)),
                       static_cast<int>(std::floor(2.0f * v.y + 0.5f)));
}

/// Centres of two clusters, begun at the two ends along the axis of the larger spread.
std::array<glm::vec2, 2> two_means(const Samples& samples) {
    const glm::vec2 spread = samples.high - samples.low;
    const int axis = spread.x >= spread.y ? 0 : 1;
    const auto end = samples.vector.begin() + samples.count;
    const auto [first, last] = std::minmax_element(samples.vector.begin(), end,
                                                   [axis](glm::vec2 a, glm::vec2 b) { return a[axis] < b[axis]; });
    std::array<glm::vec2, 2> centre = {*first, *last};
    // chosen: three rounds; clusters of two rigid motions are stable after two.
    for (int round = 0; round < 3; ++round) {
        std::array<glm::vec2, 2> sum = {glm::vec2{0.0f}, glm::vec2{0.0f}};
        std::array<float, 2> weight = {0.0f, 0.0f};
        for (auto v = samples.vector.begin(); v != end; ++v) {
            const glm::vec2 a = *v - centre[0], b = *v - centre[1];
            const std::size_t nearer = glm::dot(b, b) < glm::dot(a, a) ? 1 : 0;
            sum[nearer] += *v;
            weight[nearer] += 1.0f;
        }
        for (std::size_t k = 0; k < 2; ++k)
            if (weight[k] > 0.0f) centre[k] = sum[k] / weight[k];
    }
    return centre;
}

}  // namespace

Candidates exact_candidates(const core::MotionField& motion, int column, int row, const VectorRange& range) {
    Candidates candidates;
    const Samples samples = gather(motion, column, row);
    if (samples.count == 0) return candidates;

    // Take the middle where all pixels move alike to a quarter pixel.
    const glm::vec2 spread = samples.high - samples.low;
    if (std::max(spread.x, spread.y) <= 0.25f) {
        candidates.add(to_half_pixels((samples.low + samples.high) * 0.5f, range));
        return candidates;
    }
    // chosen: modes of less than a pixel's distance are within reach of the refinement by half pixels.
    if (std::max(spread.x, spread.y) > 1.0f) {
        for (const glm::vec2 mode : two_means(samples)) candidates.add(to_half_pixels(mode, range));
    } else {
        candidates.add(to_half_pixels(samples.sum / static_cast<float>(samples.count), range));
    }
    const int x = std::min(column * 16 + 8, motion.vector.width() - 1);
    const int y = std::min(row * 16 + 8, motion.vector.height() - 1);
    if (is_valid(motion.kind.at(x, y), motion.vector.at(x, y)))
        candidates.add(to_half_pixels(motion.vector.at(x, y), range));
    return candidates;
}

core::Plane<Candidates> exact_candidates(const core::MotionField& motion, int columns, int rows,
                                         int horizontal_f_code_limit) {
    core::Plane<Candidates> all(columns, rows);
    parallel::for_each(static_cast<std::size_t>(rows), [&](std::size_t r) {
        const int row = static_cast<int>(r);
        for (int column = 0; column < columns; ++column)
            all.at(column, row) = exact_candidates(
                motion, column, row,
                vector_range(column, row, columns, rows, horizontal_f_code_limit, vertical_f_code_limit));
    });
    return all;
}

}  // namespace render2mpeg::encoder::mpeg2
