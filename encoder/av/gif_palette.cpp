#include "encoder/av/gif_palette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "core/error.h"

namespace render2mpeg::av {
namespace {

constexpr std::size_t most_colors = 255;

/// Weights of squared differences, about what each channel adds to luma. chosen: 2, 4, 3, as other makers of palettes.
constexpr Rgb weights{2, 4, 3};

/// Pixels of about one colour.
struct Bin {
    std::array<double, 3> sum{};  ///< float would lose what millions of pixels add
    double count = 0;

    Rgb mean() const {
        const auto of = [&](std::size_t c) { return static_cast<float>(sum[c] / count); };
        return {of(0), of(1), of(2)};
    }
};

/// One for each code that pixels have; where those are too many, for each cell of 2 codes a side, then of 4.
std::vector<Bin> bins_of(std::span<const Rgb> pixels) {
    constexpr std::size_t most_bins = 1 << 16;  // chosen: a second for each round of a large picture's
    std::vector<Bin> bins;
    for (int bits = 8; bins.empty() || (bins.size() > most_bins && bits >= 6); --bits) {
        std::vector<std::pair<std::uint32_t, std::size_t>> cells;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            std::uint32_t cell = 0;
            for (const float value : pixels[i])
                cell =
                    cell << 8 | static_cast<std::uint32_t>(std::lround(std::clamp(value, 0.0f, 255.0f))) >> (8 - bits);
            cells.emplace_back(cell, i);
        }
        std::ranges::sort(cells);
        bins.clear();
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (i == 0 || cells[i].first != cells[i - 1].first) bins.emplace_back();
            for (std::size_t c = 0; c < 3; ++c) bins.back().sum[c] += static_cast<double>(pixels[cells[i].second][c]);
            bins.back().count += 1;
        }
    }
    return bins;
}

/// Bins `first` to `end`, their mean, and the channel in which they differ most.
struct Box {
    std::size_t first = 0, end = 0;
    Rgb mean{};
    std::size_t channel = 0;
    double error = 0;  ///< weighted squared differences from the mean in this channel
};

Box box_of(const std::vector<Bin>& bins, std::size_t first, std::size_t end) {
    Box box{first, end};
    std::array<double, 3> sum{}, squares{};
    double count = 0;
    for (std::size_t i = first; i < end; ++i) {
        const Rgb mean = bins[i].mean();
        count += bins[i].count;
        for (std::size_t c = 0; c < 3; ++c) {
            sum[c] += bins[i].count * static_cast<double>(mean[c]);
            squares[c] += bins[i].count * static_cast<double>(mean[c]) * static_cast<double>(mean[c]);
        }
    }
    for (std::size_t c = 0; c < 3; ++c) {
        box.mean[c] = static_cast<float>(sum[c] / count);
        const double error = static_cast<double>(weights[c]) * (squares[c] - sum[c] * sum[c] / count);
        if (end - first > 1 && error > box.error) box.error = error, box.channel = c;
    }
    return box;
}

/// Halves the box that errs most at its mean, until there are enough.
std::vector<Rgb> means_of_boxes(std::vector<Bin>& bins) {
    std::vector<Box> boxes{box_of(bins, 0, bins.size())};
    while (boxes.size() < most_colors) {
        Box& worst = *std::ranges::max_element(boxes, {}, &Box::error);
        const auto begin = bins.begin() + static_cast<std::ptrdiff_t>(worst.first),
                   end = bins.begin() + static_cast<std::ptrdiff_t>(worst.end);
        const auto middle = std::partition(
            begin, end, [&](const Bin& bin) { return bin.mean()[worst.channel] < worst.mean[worst.channel]; });
        if (worst.error <= 0 || middle == begin || middle == end) break;
        const auto at = static_cast<std::size_t>(middle - bins.begin());
        const Box upper = box_of(bins, at, worst.end);
        worst = box_of(bins, worst.first, at);
        boxes.push_back(upper);
    }
    std::vector<Rgb> means;
    for (const Box& box : boxes) means.push_back(box.mean);
    return means;
}

float difference(const Rgb& a, const Rgb& b) {
    float sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += weights[c] * (a[c] - b[c]) * (a[c] - b[c]);
    return sum;
}

/// `colors` are ascending in green: looks from the place of the wanted green on to both sides.
std::size_t nearest_of(const std::vector<Rgb>& colors, const Rgb& wanted) {
    const auto place = std::ranges::lower_bound(colors, wanted[1], {}, [](const Rgb& color) { return color[1]; });
    std::ptrdiff_t above = place - colors.begin(), below = above - 1;
    const auto count = static_cast<std::ptrdiff_t>(colors.size());
    std::size_t best = 0;
    float least = std::numeric_limits<float>::infinity();
    const auto looks = [&](std::ptrdiff_t& at, std::ptrdiff_t step) {
        if (at < 0 || at >= count) return false;
        const Rgb& color = colors[static_cast<std::size_t>(at)];
        if (weights[1] * (color[1] - wanted[1]) * (color[1] - wanted[1]) >= least) return false;
        const float found = difference(color, wanted);
        if (found < least) least = found, best = static_cast<std::size_t>(at);
        at += step;
        return true;
    };
    for (bool goes_on = true; goes_on;) {
        const bool went_up = looks(above, 1), went_down = looks(below, -1);
        goes_on = went_up || went_down;
    }
    return best;
}

void sort_by_green(std::vector<Rgb>& colors) {
    std::ranges::sort(colors, [](const Rgb& a, const Rgb& b) {
        return a[1] != b[1] ? a[1] < b[1] : a[0] != b[0] ? a[0] < b[0] : a[2] < b[2];
    });
}

/// Moves colours to the mean of the bins that they are nearest to.
void refine(std::vector<Rgb>& colors, const std::vector<Bin>& bins) {
    sort_by_green(colors);
    std::vector<Bin> taken(colors.size());
    for (const Bin& bin : bins) {
        Bin& of = taken[nearest_of(colors, bin.mean())];
        for (std::size_t c = 0; c < 3; ++c) of.sum[c] += bin.sum[c];
        of.count += bin.count;
    }
    for (std::size_t i = 0; i < colors.size(); ++i)
        if (taken[i].count > 0) colors[i] = taken[i].mean();
}

}  // namespace

GifPalette::GifPalette(std::span<const Rgb> pixels) {
    EXPECTS(!pixels.empty());
    std::vector<Bin> bins = bins_of(pixels);
    std::vector<Rgb> means = means_of_boxes(bins);
    // chosen: 4 rounds; further ones change less than a hundredth of the error.
    for (int round = 0; round < 4; ++round) refine(means, bins);
    for (Rgb& mean : means)
        for (float& value : mean) value = std::round(std::clamp(value, 0.0f, 255.0f));
    sort_by_green(means);
    means.erase(std::unique(means.begin(), means.end()), means.end());
    colors_ = means;
    for (const Rgb& color : colors_)
        codes_.push_back({static_cast<std::uint8_t>(color[0]), static_cast<std::uint8_t>(color[1]),
                          static_cast<std::uint8_t>(color[2])});
}

std::size_t GifPalette::nearest(const Rgb& color) const {
    return nearest_of(colors_, color);
}

}  // namespace render2mpeg::av
