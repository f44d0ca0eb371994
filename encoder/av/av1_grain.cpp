#include "encoder/av/av1_grain.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/error.h"
#include "core/plane.h"
#include "core/sampling.h"

namespace render2mpeg::av {
namespace {

constexpr int lag = 3, filter_shift = 7;
/// Places in that reach, row by row.
constexpr std::size_t places = 2 * lag * (lag + 1);
using Weights = std::array<double, places>;

constexpr std::pair<int, int> place_of(std::size_t index) {
    const int at = static_cast<int>(index);
    return {at / (2 * lag + 1) - lag, at % (2 * lag + 1) - lag};
}

/// Luma of the table's points, 16..235.
constexpr std::array<int, 14> point_luma{16, 20, 28, 40, 56, 76, 98, 120, 142, 164, 186, 206, 224, 235};

/// Weights that best predict grain of this spot (core::FilmGrain::spot) from its neighbours: the normal equations
/// (Yule-Walker), by elimination.
Weights predictor(double spot) {
    const auto correlation = [&](int down, int across) {
        return std::exp(-(down * down + across * across) / (4 * spot * spot));
    };
    // chosen: 0.1 of 0.02 to 0.3: the filter is stable and shows no lattice (0.02: correlations of 0.1 at six pixels);
    // correlations are up to 0.08 lower than those asked for.
    constexpr double white = 0.1;
    std::array<std::array<double, places + 1>, places> rows{};
    for (std::size_t i = 0; i < places; ++i) {
        const auto [down, across] = place_of(i);
        for (std::size_t k = 0; k < places; ++k)
            rows[i][k] = correlation(down - place_of(k).first, across - place_of(k).second) + (i == k ? white : 0.0);
        rows[i][places] = correlation(down, across);
    }
    // The matrix is positive definite: no row needs another's place.
    for (std::size_t i = 0; i < places; ++i)
        for (std::size_t k = 0; k < places; ++k) {
            if (k == i) continue;
            const double factor = rows[k][i] / rows[i][i];
            for (std::size_t j = i; j <= places; ++j) rows[k][j] -= factor * rows[i][j];
        }
    Weights weights{};
    for (std::size_t i = 0; i < places; ++i) weights[i] = rows[i][places] / rows[i][i];
    return weights;
}

/// How much the filter multiplies the variance of white noise by: the sum of its squared impulse response.
double gain_of(const std::array<int, places>& filter) {
    constexpr int reach = 32;
    core::Plane<double> response(2 * reach + 1, reach, 0.0);
    double sum = 0;
    for (int y = lag; y < reach; ++y)
        for (int x = lag; x < response.width() - lag; ++x) {
            double value = y == lag && x == reach ? 1 : 0;
            for (std::size_t i = 0; i < places; ++i)
                value += filter[i] * response.at(x + place_of(i).second, y + place_of(i).first) / (1 << filter_shift);
            response.at(x, y) = value;
            sum += value * value;
        }
    return sum;
}

void put(std::vector<bool>& bits, int value, int count) {
    for (int i = count - 1; i >= 0; --i) bits.push_back((value >> i & 1) != 0);
}

/// A payload's first bits, these behind them, and in a frame its tiles from the next whole byte on.
std::vector<std::uint8_t> with_bits(const Obu& obu, std::size_t end, const std::vector<bool>& bits, bool has_tiles) {
    std::vector<std::uint8_t> result(obu.payload.begin(), obu.payload.begin() + static_cast<std::ptrdiff_t>(end / 8));
    std::size_t count = end / 8 * 8;
    const auto add = [&](bool bit) {
        if (count % 8 == 0) result.push_back(0);
        if (bit) result.back() = static_cast<std::uint8_t>(result.back() | 0x80 >> count % 8);
        ++count;
    };
    for (std::size_t i = count; i < end; ++i) add((obu.payload[i / 8] >> (7 - i % 8) & 1) != 0);
    // Bits up to the next whole byte are as they must be, where the header was read rightly.
    const std::size_t whole = (end + 7) / 8;
    for (std::size_t i = end; i < 8 * whole || (!has_tiles && i == end); ++i) {
        const bool bit = i / 8 < obu.payload.size() && (obu.payload[i / 8] >> (7 - i % 8) & 1) != 0;
        if (bit != (!has_tiles && i == end)) throw core::Error("AV1: a frame header does not end where it should");
    }
    for (const bool bit : bits) add(bit);
    if (!has_tiles) add(true);
    if (has_tiles)
        result.insert(result.end(), obu.payload.begin() + static_cast<std::ptrdiff_t>(whole), obu.payload.end());
    return result;
}

/// Appends a unit with another payload [AV1, 5.3, 4.10.5].
void append(std::vector<std::uint8_t>& out, const Obu& obu, std::span<const std::uint8_t> payload) {
    out.insert(out.end(), obu.bytes.begin(), obu.bytes.begin() + (obu.has_extension() ? 2 : 1));
    std::size_t size = payload.size();
    for (; size > 127; size >>= 7) out.push_back(static_cast<std::uint8_t>(size | 128));
    out.push_back(static_cast<std::uint8_t>(size));
    out.insert(out.end(), payload.begin(), payload.end());
}

}  // namespace

Av1Grain::Av1Grain(int iso, int height) {
    const core::FilmGrain grain(iso, height);
    set_filter(grain.spot());
    set_scaling(grain);
}

void Av1Grain::set_filter(double spot) {
    const Weights weights = predictor(spot);
    for (std::size_t i = 0; i < places; ++i)
        filter_[i] = std::clamp(static_cast<int>(std::lround(weights[i] * (1 << filter_shift))), -128, 127);
    // Noise before the filter has 512 of 12 bits [AV1, 7.18.3.3]. What is filtered is cut off at 127.
    constexpr double unfiltered = 32, most = 36;
    deviation_ = unfiltered * std::sqrt(gain_of(filter_));
    for (; deviation_ > most && noise_shift_ < 3; deviation_ /= 2) ++noise_shift_;
}

void Av1Grain::set_scaling(const core::FilmGrain& grain) {
    const auto factor = [&](int luma, int shift) {
        return std::lround(grain.deviation(static_cast<float>(luma)) / deviation_ * (1 << shift));
    };
    scaling_shift_ = 11;
    const auto is_too_large = [&](int luma) { return factor(luma, scaling_shift_) > 255; };
    while (scaling_shift_ > 8 && std::ranges::any_of(point_luma, is_too_large)) --scaling_shift_;
    for (std::size_t i = 0; i < scaling_.size(); ++i)
        scaling_[i] = static_cast<int>(std::min(factor(point_luma[i], scaling_shift_), 255L));
}

Av1Grain::BitRow Av1Grain::parameters(const Av1FrameHeader& frame, std::int64_t number) {
    BitRow bits;
    put(bits, 1, 1);  // apply_grain
    put(bits, static_cast<int>(core::mix(static_cast<std::uint64_t>(number)) & 0xffff), 16);
    if (frame.is_inter) {
        const auto has_grain = [&](int reference) { return has_grain_[static_cast<std::size_t>(reference)]; };
        const auto known = std::ranges::find_if(frame.references, has_grain);
        put(bits, known == frame.references.end() ? 1 : 0, 1);  // update_grain
        if (known != frame.references.end()) {
            put(bits, *known, 3);
            return bits;
        }
    }
    put(bits, points, 4);
    for (std::size_t i = 0; i < scaling_.size(); ++i) {
        put(bits, point_luma[i], 8);
        put(bits, scaling_[i], 8);
    }
    put(bits, 0, 1 + 4 + 4);  // chroma_scaling_from_luma, num_cb_points, num_cr_points
    put(bits, scaling_shift_ - 8, 2);
    put(bits, lag, 2);
    for (const int weight : filter_) put(bits, weight + 128, 8);
    put(bits, filter_shift - 6, 2);
    put(bits, noise_shift_, 2);
    put(bits, 3, 2);  // overlap_flag, clip_to_restricted_range
    return bits;
}

void Av1Grain::append_frame(std::vector<std::uint8_t>& out, const Obu& obu, std::int64_t number, bool has_tiles) {
    const Av1FrameHeader frame = headers_.read_frame(obu.payload);
    if (frame.shows_existing) {
        out.insert(out.end(), obu.bytes.begin(), obu.bytes.end());
        return;
    }
    if (frame.is_key) {
        first_number_ = number;
        first_hint_ = frame.order_hint;
    }
    const auto hint_of_shown = static_cast<int>(first_hint_ + number - first_number_);
    const std::int64_t own = number + headers_.distance(frame.order_hint, hint_of_shown);
    append(out, obu, with_bits(obu, frame.end, frame.can_be_shown ? parameters(frame, own) : BitRow(), has_tiles));
    for (std::size_t i = 0; i < has_grain_.size(); ++i)
        if ((frame.refreshed >> i & 1) != 0) has_grain_[i] = frame.can_be_shown;
}

std::vector<std::uint8_t> Av1Grain::with_grain(std::span<const std::uint8_t> unit, std::int64_t number) {
    enum { sequence_header = 1, frame_header = 3, whole_frame = 6, repeated_header = 7 };
    std::vector<std::uint8_t> result;
    for (const Obu& obu : obus_of(unit)) {
        if (obu.type() == repeated_header) throw core::Error("AV1: film grain cannot be told in repeated headers");
        if (obu.type() == sequence_header) {
            const std::size_t place = headers_.read_sequence(obu.payload);
            std::vector<std::uint8_t> header(obu.payload.begin(), obu.payload.end());
            header[place / 8] = static_cast<std::uint8_t>(header[place / 8] | 0x80 >> place % 8);
            append(result, obu, header);
        } else if (obu.type() == frame_header || obu.type() == whole_frame) {
            append_frame(result, obu, number, obu.type() == whole_frame);
        } else {
            result.insert(result.end(), obu.bytes.begin(), obu.bytes.end());
        }
    }
    return result;
}

}  // namespace render2mpeg::av
