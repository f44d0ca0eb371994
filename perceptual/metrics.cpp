#include "perceptual/metrics.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "core/dct.h"
#include "core/error.h"
#include "core/numeric.h"

// PSNR-HVS-M [Ponomarenko2007] with the sensitivities of PSNR-HVS [Egiazarian2006]. As in the authors' own program,
// blocks do not overlap, variances have n - 1 in the denominator, and the mean coefficient is not masked.

namespace render2mpeg::perceptual {
namespace {

using Plane = core::Plane<std::uint8_t>;

/// Sums over an area of samples a, b: a, b, a^2 + b^2, a b.
struct Sums {
    std::int64_t a = 0, b = 0, squares = 0, products = 0;

    void add(std::int64_t p, std::int64_t q) {
        a += p;
        b += q;
        squares += p * p + q * q;
        products += p * q;
    }
    Sums& operator+=(const Sums& s) {
        a += s.a;
        b += s.b;
        squares += s.squares;
        products += s.products;
        return *this;
    }
};

/// [Wang2004, eq. 13] of n samples in terms of sums: means times n, variances times n (n - 1), which is why the second
/// constant is multiplied so. The first one should be multiplied by n^2; ffmpeg, and x264 before it, multiply it by n,
/// and so count the means of dark windows more strictly. Both are rounded to integers there. We do likewise, so that
/// figures can be compared.
double similarity(const Sums& s, double n) {
    const double c1 = std::floor(0.01 * 0.01 * 255 * 255 * n + 0.5);
    const double c2 = std::floor(0.03 * 0.03 * 255 * 255 * n * (n - 1) + 0.5);
    const double a = static_cast<double>(s.a), b = static_cast<double>(s.b);
    const double variances = static_cast<double>(s.squares) * n - a * a - b * b;
    const double covariance = static_cast<double>(s.products) * n - a * b;
    // Rounding to an integer makes the constants 0 for a single sample: add the smallest that keeps 0 / 0 away.
    const double k1 = c1 > 0 ? c1 : 1, k2 = c2 > 0 ? c2 : 1;
    return (2 * a * b + k1) * (2 * covariance + k2) / ((a * a + b * b + k1) * (variances + k2));
}

/// Sums of the 4x4 blocks of one row of blocks.
void block_sums(const Plane& a, const Plane& b, int block_row, std::vector<Sums>& out) {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = {};
    for (int y = 4 * block_row; y < 4 * block_row + 4; ++y) {
        const std::uint8_t* p = a.row(y);
        const std::uint8_t* q = b.row(y);
        for (std::size_t i = 0; i < out.size(); ++i)
            for (std::size_t x = 4 * i; x < 4 * i + 4; ++x) out[i].add(p[x], q[x]);
    }
}

double mean_of(const std::vector<double>& values, double of_none) {
    if (values.empty()) return of_none;
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Weights of coefficient differences, by vertical frequency. The table of the authors' program, made from JPEG's
/// quantisation table. [Egiazarian2006]
constexpr core::Block8x8 weight{
    1.608443f, 2.339554f, 2.573509f, 1.608443f, 1.072295f, 0.643377f, 0.504610f, 0.421887f,  //
    2.144591f, 2.144591f, 1.838221f, 1.354478f, 0.989811f, 0.443708f, 0.428918f, 0.467911f,  //
    1.838221f, 1.979622f, 1.608443f, 1.072295f, 0.643377f, 0.451493f, 0.372972f, 0.459555f,  //
    1.838221f, 1.513829f, 1.169777f, 0.887417f, 0.504610f, 0.295806f, 0.321689f, 0.415082f,  //
    1.429727f, 1.169777f, 0.695543f, 0.459555f, 0.378457f, 0.236102f, 0.249855f, 0.334222f,  //
    1.072295f, 0.735288f, 0.467911f, 0.402111f, 0.317717f, 0.247453f, 0.227744f, 0.279729f,  //
    0.525206f, 0.402111f, 0.329937f, 0.295806f, 0.249855f, 0.212687f, 0.214459f, 0.254803f,  //
    0.357432f, 0.279729f, 0.270896f, 0.262603f, 0.229778f, 0.257351f, 0.249855f, 0.259950f,
};

/// How much energy in a coefficient masks: (10 / JPEG's step)^2. [Ponomarenko2007, table 1]
constexpr core::Block8x8 masking{
    0.390625f, 0.826446f, 1.000000f, 0.390625f, 0.173611f, 0.062500f, 0.038447f, 0.026874f,  //
    0.694444f, 0.694444f, 0.510204f, 0.277008f, 0.147929f, 0.029727f, 0.027778f, 0.033058f,  //
    0.510204f, 0.591716f, 0.390625f, 0.173611f, 0.062500f, 0.030779f, 0.021004f, 0.031888f,  //
    0.510204f, 0.346021f, 0.206612f, 0.118906f, 0.038447f, 0.013212f, 0.015625f, 0.026015f,  //
    0.308642f, 0.206612f, 0.073046f, 0.031888f, 0.021626f, 0.008417f, 0.009426f, 0.016866f,  //
    0.173611f, 0.081633f, 0.033058f, 0.024414f, 0.015242f, 0.009246f, 0.007831f, 0.011815f,  //
    0.041649f, 0.024414f, 0.016437f, 0.013212f, 0.009426f, 0.006830f, 0.006944f, 0.009803f,  //
    0.019290f, 0.011815f, 0.011080f, 0.010412f, 0.007972f, 0.010000f, 0.009426f, 0.010203f,
};

core::Block8x8 samples_of(const Plane& plane, int column, int row) {
    core::Block8x8 block;
    for (int j = 0; j < 8; ++j)
        for (int i = 0; i < 8; ++i)
            block[static_cast<std::size_t>(8 * j + i)] =
                plane.at(std::min(8 * column + i, plane.width() - 1), std::min(8 * row + j, plane.height() - 1));
    return block;
}

/// n times the sample variance of a square of the block.
double spread(const core::Block8x8& samples, int x, int y, int size) {
    double sum = 0.0, squares = 0.0;
    for (int j = y; j < y + size; ++j)
        for (int i = x; i < x + size; ++i) {
            const double v = static_cast<double>(samples[static_cast<std::size_t>(8 * j + i)]);
            sum += v;
            squares += v * v;
        }
    const double n = static_cast<double>(size * size);
    return std::max(0.0, squares - sum * sum / n) * n / (n - 1.0);
}

/// Masking energy of a block, to be divided by a coefficient's masking: reduced where the energy is in an edge, so that
/// the block's quarters are quieter than the whole. [Ponomarenko2007, eq. 2 and 3]
double masking_of(const core::Block8x8& samples, const core::Block8x8& coefficients) {
    double energy = 0.0;
    for (std::size_t i = 1; i < 64; ++i)
        energy += static_cast<double>(coefficients[i]) * static_cast<double>(coefficients[i]) *
                  static_cast<double>(masking[i]);
    const double quarters =
        spread(samples, 0, 0, 4) + spread(samples, 4, 0, 4) + spread(samples, 0, 4, 4) + spread(samples, 4, 4, 4);
    return core::sqrt_or_zero(energy * core::divide_or(quarters, spread(samples, 0, 0, 8), 0.0)) / 32.0;
}

/// Sum of the weighted squares of one block's differences.
double block_error(const core::Block8x8& a, const core::Block8x8& b) {
    const core::Block8x8 p = core::forward_dct(a), q = core::forward_dct(b);
    const double hidden = std::max(masking_of(a, p), masking_of(b, q));
    double error = 0.0;
    for (std::size_t i = 0; i < 64; ++i) {
        double difference = std::abs(static_cast<double>(p[i]) - static_cast<double>(q[i]));
        if (i > 0) difference = std::max(0.0, difference - hidden / static_cast<double>(masking[i]));
        const double seen = difference * static_cast<double>(weight[i]);
        error += seen * seen;
    }
    return error;
}

}  // namespace

double mean_squared_error(const Plane& a, const Plane& b, std::span<const float> rows) {
    EXPECTS(a.width() == b.width() && a.height() == b.height());
    EXPECTS(rows.empty() || rows.size() == static_cast<std::size_t>(a.height()));
    if (a.empty()) return 0.0;
    double sum = 0, weights = 0;
    for (int y = 0; y < a.height(); ++y) {
        const double weight = rows.empty() ? 1.0 : static_cast<double>(rows[static_cast<std::size_t>(y)]);
        std::int64_t squares = 0;
        for (int x = 0; x < a.width(); ++x) {
            const int d = a.at(x, y) - b.at(x, y);
            squares += d * d;
        }
        sum += weight * static_cast<double>(squares);
        weights += weight * a.width();
    }
    return sum / weights;
}

double psnr(double mean_squared_error) {
    if (!(mean_squared_error > 0.0)) return std::numeric_limits<double>::infinity();
    return 10.0 * std::log10(255.0 * 255.0 / mean_squared_error);
}

double ssim(const Plane& a, const Plane& b) {
    EXPECTS(a.width() == b.width() && a.height() == b.height());
    const int columns = a.width() / 4, rows = a.height() / 4;
    if (a.empty()) return 1.0;
    if (columns < 2 || rows < 2) {
        // Take the whole plane as the only window.
        Sums all;
        for (std::size_t i = 0; i < a.size(); ++i) all.add(a.values()[i], b.values()[i]);
        return similarity(all, static_cast<double>(a.size()));
    }

    std::vector<Sums> upper(static_cast<std::size_t>(columns)), lower(upper.size());
    block_sums(a, b, 0, lower);
    double total = 0.0;
    for (int row = 1; row < rows; ++row) {
        std::swap(upper, lower);
        block_sums(a, b, row, lower);
        for (std::size_t i = 0; i + 1 < upper.size(); ++i) {
            Sums window = upper[i];
            window += upper[i + 1];
            window += lower[i];
            window += lower[i + 1];
            total += similarity(window, 64);
        }
    }
    return total / (static_cast<double>(columns - 1) * (rows - 1));
}

void FilmQuality::add(const core::Picture& picture, const core::Picture& reference, std::span<const float> rows) {
    add(mean_squared_error(picture.y, reference.y, rows), ssim(picture.y, reference.y));
}

void FilmQuality::add(double error, double similarity) {
    errors_.push_back(error);
    similarities_.push_back(similarity);
}

double FilmQuality::psnr_y() const {
    return psnr(mean_of(errors_, 0));
}

double FilmQuality::ssim_y() const {
    return mean_of(similarities_, 1);
}

FilmQuality FilmQuality::worst_tenth() const {
    FilmQuality worst = *this;
    const std::size_t count = (errors_.size() + 9) / 10;
    std::sort(worst.errors_.begin(), worst.errors_.end(), std::greater<>());
    std::sort(worst.similarities_.begin(), worst.similarities_.end());
    worst.errors_.resize(count);
    worst.similarities_.resize(count);
    return worst;
}

double masked_error(const Plane& a, const Plane& b) {
    EXPECTS(a.width() == b.width() && a.height() == b.height());
    if (a.empty()) return 0.0;
    const int columns = std::max(1, a.width() / 8), rows = std::max(1, a.height() / 8);
    double sum = 0.0;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const core::Block8x8 p = samples_of(a, column, row), q = samples_of(b, column, row);
            if (p != q) sum += block_error(p, q);
        }
    return sum / (64.0 * static_cast<double>(columns) * rows);
}

}  // namespace render2mpeg::perceptual
