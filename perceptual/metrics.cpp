#include "perceptual/metrics.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <vector>

#include "core/error.h"

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

}  // namespace

double mean_squared_error(const Plane& a, const Plane& b) {
    EXPECTS(a.width() == b.width() && a.height() == b.height());
    if (a.empty()) return 0.0;
    std::int64_t sum = 0;
    const auto p = a.values(), q = b.values();
    for (std::size_t i = 0; i < p.size(); ++i) {
        const int d = p[i] - q[i];
        sum += d * d;
    }
    return static_cast<double>(sum) / static_cast<double>(a.size());
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

void FilmQuality::add(const core::Picture& picture, const core::Picture& reference) {
    add(mean_squared_error(picture.y, reference.y), ssim(picture.y, reference.y));
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

}  // namespace render2mpeg::perceptual
