#include "image/sky_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::image {
namespace {

/// chosen: cells of a quarter of a degree at least, of 0.09 to 0.7 (docs/fits/pictures.md); 64 columns give an image of
/// a few pixels parts that are small enough to be lights.
constexpr int max_columns = 1440, max_rows = 720, min_columns = 64, min_rows = 32;

/// How an axis of `pixels` is cut into cells.
struct Axis {
    int pixels_per_cell = 1, cells_per_pixel = 1;
    int cells = 0;
    std::vector<double> edges;

    Axis(int pixels, int least, int most)
        : pixels_per_cell((pixels + most - 1) / most), cells_per_pixel((least + pixels - 1) / pixels) {
        cells = (pixels * cells_per_pixel + pixels_per_cell - 1) / pixels_per_cell;
        for (int i = 0; i <= cells; ++i)
            edges.push_back(std::min(
                1.0, static_cast<double>(i) * pixels_per_cell / (static_cast<double>(pixels) * cells_per_pixel)));
    }
};

/// Integral of sin from pi a to pi b, without cancellation: cos x - cos y = 2 sin((x + y) / 2) sin((y - x) / 2).
double band(double a, double b) {
    return 2 * std::sin(0.5 * std::numbers::pi * (a + b)) * std::sin(0.5 * std::numbers::pi * (b - a));
}

/// What a column and a row of the map point to.
glm::dvec3 direction_of(double u, double v) {
    const double azimuth = 2 * std::numbers::pi * (u - 0.5), sine = std::sin(std::numbers::pi * v);
    return {sine * std::sin(azimuth), std::cos(std::numbers::pi * v), -sine * std::cos(azimuth)};
}

}  // namespace

SkyGrid::SkyGrid(const core::Plane<glm::vec4>& radiance) {
    const int width = radiance.width(), height = radiance.height();
    EXPECTS(width > 0 && height > 0);
    const Axis across(width, min_columns, max_columns), down(height, min_rows, max_rows);
    light_ = core::Plane<glm::vec3>(across.cells, down.cells, glm::vec3(0));
    center_ = core::Plane<glm::vec3>(across.cells, down.cells, glm::vec3(0));
    column_edges_ = across.edges;
    row_edges_ = down.edges;

    // Walk over the pieces, which are pixels or parts of them. Sums are scaled by the piece, so that no square of a sun
    // overflows.
    const int piece_columns = width * across.cells_per_pixel, piece_rows = height * down.cells_per_pixel;
    std::vector<glm::dvec2> azimuths;
    for (int x = 0; x < piece_columns; ++x) {
        const double azimuth = 2 * std::numbers::pi * ((x + 0.5) / piece_columns - 0.5);
        azimuths.emplace_back(std::sin(azimuth), -std::cos(azimuth));
    }
    glm::dvec3 total{0};
    for (int y = 0; y < piece_rows; ++y) {
        const double v = (y + 0.5) / piece_rows, sine = std::sin(std::numbers::pi * v),
                     cosine = std::cos(std::numbers::pi * v);
        const double solid_angle =
            2 * std::numbers::pi / piece_columns * band(static_cast<double>(y) / piece_rows, (y + 1.0) / piece_rows);
        const glm::vec4* const pixels = radiance.row(y / down.cells_per_pixel);
        for (int x = 0; x < piece_columns; ++x) {
            const glm::dvec3 light = glm::dvec3(glm::vec3(pixels[x / across.cells_per_pixel])) * solid_angle;
            const int column = x / across.pixels_per_cell, row = y / down.pixels_per_cell;
            const auto azimuth = azimuths[static_cast<std::size_t>(x)];
            light_.at(column, row) += glm::vec3(light);
            center_.at(column, row) +=
                core::luminance(glm::vec3(light)) * glm::vec3(sine * azimuth.x, cosine, sine * azimuth.y);
            total += light;
        }
    }
    total_ = glm::vec3(total);
    for (glm::vec3& center : center_.values()) center = core::normalize_or(center, {0, 1, 0});
}

glm::vec3 SkyGrid::irradiance(glm::vec3 normal) const {
    // Cut cells that are large on the sphere into smaller ones, for the cosine varies within them.
    const int pieces = (1023 + columns()) / columns();
    const auto piece = [&](const std::vector<double>& edges, int i, double share) {
        const auto cell = static_cast<std::size_t>(i / pieces);
        return edges[cell] + (edges[cell + 1] - edges[cell]) * (i % pieces + share) / pieces;
    };
    std::vector<glm::dvec2> azimuths;
    for (int x = 0; x < columns() * pieces; ++x) {
        const glm::dvec3 d = direction_of(piece(column_edges_, x, 0.5), 0.5);
        azimuths.emplace_back(d.x, d.z);
    }

    // Weigh each cell by the mean cosine of its pieces.
    const glm::dvec3 n(normal);
    glm::dvec3 sum{0};
    for (int y = 0; y < rows() * pieces; ++y) {
        const int row = y / pieces;
        const double v = piece(row_edges_, y, 0.5), sine = std::sin(std::numbers::pi * v),
                     height = n.y * std::cos(std::numbers::pi * v);
        const double share =
            band(piece(row_edges_, y, 0), piece(row_edges_, y, 1)) /
            (band(row_edges_[static_cast<std::size_t>(row)], row_edges_[static_cast<std::size_t>(row) + 1]) * pieces);
        for (int x = 0; x < columns(); ++x) {
            double cosine = 0;
            for (int p = x * pieces; p < (x + 1) * pieces; ++p) {
                const glm::dvec2 azimuth = azimuths[static_cast<std::size_t>(p)];
                cosine += std::max(0.0, height + sine * (n.x * azimuth.x + n.z * azimuth.y));
            }
            sum += glm::dvec3(light_.at(x, row)) * (share * cosine);
        }
    }
    return glm::vec3(sum);
}

}  // namespace render2mpeg::image
