#include "renderer/gather/ray_guide.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// Least density, so that light that no ray has found yet is not missed. chosen: 0.2 of 0.1 to 0.5.
constexpr double least_density = 0.2;

/// Rays that a cell counts as those of the larger cell about it, beside its own. chosen: 1.
constexpr double larger_rays = 2;

}  // namespace

std::uint32_t RayGuide::cell_of(glm::vec2 u) {
    const auto index = [](float x) { return std::min(static_cast<std::uint32_t>(x * float{side}), side - 1); };
    return index(u.y) * side + index(u.x);
}

std::uint32_t RayGuide::place_of(glm::vec2 u) {
    const std::uint32_t cell = cell_of(u), x = cell % side, y = cell / side;
    std::uint32_t bits = 0;
    for (unsigned b = 0; b < 4; ++b) bits |= (x >> b & 1u) << (2 * b) | (y >> b & 1u) << (2 * b + 1);
    return bits;
}

void RayGuide::learn() {
    // Mean squares of ever smaller cells, those of few rays drawn towards those of the larger one about them.
    std::array<double, cells> squares{};
    double mean = 0, roots = 0;
    for (std::uint32_t across = 1; across <= side; across *= 2) {
        std::array<double, cells> larger = squares;
        const std::uint32_t width = side / across;
        for (std::uint32_t y = 0; y < across; ++y)
            for (std::uint32_t x = 0; x < across; ++x) {
                double sum = 0, rays = 0;
                for (std::uint32_t j = y * width; j < (y + 1) * width; ++j)
                    for (std::uint32_t i = x * width; i < (x + 1) * width; ++i)
                        sum += squares_[j * side + i], rays += rays_[j * side + i];
                const double about = across == 1 ? 0.0 : larger[(y / 2) * (across / 2) + x / 2];
                const double drawn = across == 1 ? 1e-9 : larger_rays;
                squares[y * across + x] = (sum + drawn * about) / (rays + drawn);
            }
    }
    // A cell beside a bright one may be as bright where no ray has met it yet.
    const std::array<double, cells> sharp = squares;
    for (std::uint32_t y = 0; y < side; ++y)
        for (std::uint32_t x = 0; x < side; ++x) {
            double sum = 0, weights = 0;
            for (std::uint32_t j = y - (y > 0); j <= std::min(y + 1, side - 1); ++j)
                for (std::uint32_t i = x - (x > 0); i <= std::min(x + 1, side - 1); ++i) {
                    const double weight = (i == x ? 2.0 : 1.0) * (j == y ? 2.0 : 1.0);
                    sum += weight * sharp[j * side + i];
                    weights += weight;
                }
            squares[y * side + x] = sum / weights;
        }
    for (std::uint32_t c = 0; c < cells; ++c) {
        mean += core::divide_or(sums_[c], 1.0 * rays_[c], 0.0) / cells;
        roots += std::sqrt(squares[c]) / cells;
    }
    variance_share_ = 1;
    rows_ = {};
    if (!(roots > 0.0) || !(roots < std::numeric_limits<double>::infinity())) return;
    double even = 0, guided = 0, sum = 0;
    for (std::uint32_t c = 0; c < cells; ++c) {
        const double density = least_density + (1.0 - least_density) * std::sqrt(squares[c]) / roots;
        density_[c] = static_cast<float>(density);
        even += squares[c] / cells;
        guided += squares[c] / density / cells;
        sum += density;
        if ((c + 1) % side == 0) rows_[(c + 1) / side] = static_cast<float>(sum / cells);
    }
    rows_[side] = 1.0f;
    variance_share_ = core::divide_or(guided - mean * mean, even - mean * mean, 1.0);
    if (!(variance_share_ > 0.0)) variance_share_ = 1;
}

RayGuide::Drawn RayGuide::draw(glm::vec2 u) const {
    const auto after = std::upper_bound(rows_.begin() + 1, rows_.end() - 1, u.y);
    const auto row = static_cast<std::uint32_t>(after - rows_.begin()) - 1;
    const float width = rows_[row + 1] - rows_[row];
    const float y = std::min((u.y - rows_[row]) / width, 0x1.fffffep-1f);
    float left = u.x * width * cells;
    std::uint32_t column = 0;
    while (column + 1 < side && left >= density_[row * side + column]) left -= density_[row * side + column++];
    const float density = density_[row * side + column];
    const float x = std::clamp(left / density, 0.0f, 0x1.fffffep-1f);
    const glm::vec2 corner(column, row);
    return {(corner + glm::vec2(x, y)) / float{side}, density};
}

}  // namespace render2mpeg::renderer
