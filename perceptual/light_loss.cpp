#include "perceptual/light_loss.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/error.h"
#include "core/numeric.h"
#include "core/picture.h"
#include "core/sampling.h"
#include "perceptual/masking.h"

namespace render2mpeg::perceptual {
namespace {

constexpr int side = 8;

/// Of noise that neighbours share, a coefficient's energy falls with exp(-(u^2 + v^2) / shared_reach). chosen: 2.3, by
/// which a mean has 0.29 of it, as of the widest planes of records
/// (docs/model/irradiance-cache.md#blocks-have-a-price).
constexpr double shared_reach = 2.3;

/// Shares of coefficients in that energy; their sum is 1.
core::Block8x8 shares_of_shared() {
    core::Block8x8 shares{};
    float sum = 0;
    for (std::size_t i = 0; i < shares.size(); ++i) {
        const auto u = static_cast<double>(i % side), v = static_cast<double>(i / side);
        shares[i] = static_cast<float>(std::exp(-(u * u + v * v) / shared_reach));
        sum += shares[i];
    }
    for (float& share : shares) share /= sum;
    return shares;
}

/// Blocks that are coded with noise; of smaller pictures each more than once. chosen: 2048, some 3 ms; by 240 losses of
/// one picture differ by a third.
constexpr std::size_t asked = 2048;

/// Squared error of a block's pixels by rounding to whole code values, which the decoder does whatever the steps.
constexpr double by_rounding = 64.0 / 12;

/// A coefficient as it is decoded.
float decoded(float c, float step, float dead_zone) {
    const float levels = std::floor(std::abs(c) / step + 1.0f - dead_zone);
    return levels > 0.0f ? std::copysign(levels * step, c) : 0.0f;
}

/// Power that light is of luma above black.
constexpr float power = 2.2f;

/// Mean squared change of luma, relative to it, where light has a standard error relative to it.
float shown(float change) {
    // Gauss and Hermite's rule of four points.
    struct Node {
        float place, weight;
    };
    float square = 0;
    for (const Node node : {Node{0.74196378f, 0.45412415f}, Node{2.3344142f, 0.04587585f}})
        for (const float sign : {-1.0f, 1.0f}) {
            const float off = std::pow(std::max(1.0f + sign * node.place * change, 0.0f), 1.0f / power) - 1.0f;
            square += node.weight * off * off;
        }
    return square;
}

/// The same by a table of 64 entries for each doubling of the error.
class ShownErrors {
  public:
    ShownErrors() {
        for (std::size_t i = 0; i < changes_.size(); ++i) changes_[i] = shown(error_of(static_cast<float>(i)));
    }
    float operator()(float error) const {
        // Below a thousandth light and luma change alike.
        if (!(error > least)) return error * error / (power * power);
        const float place = by_doubling * std::log2(error / least);
        const auto below = static_cast<std::size_t>(place);
        if (below + 1 >= changes_.size()) return shown(error);
        return std::lerp(changes_[below], changes_[below + 1], place - static_cast<float>(below));
    }

  private:
    static constexpr float least = 1e-3f, by_doubling = 64;
    static float error_of(float place) { return least * std::exp2(place / by_doubling); }
    std::array<float, std::size_t{64} * 17> changes_{};  ///< up to 131
};

/// Variance of luma by a variance of light, both squared code values there: nothing is darker than black, and next to
/// it the curve is straight.
float shown(float variance, float luma) {
    static const ShownErrors errors;
    constexpr float black = 16.0f, straight = 9.0f;
    const float above = std::max(luma - black, straight);
    return above * above * errors(power * std::sqrt(variance) / above);
}

/// Step and dead zone of a coefficient.
struct Levels {
    float step, dead_zone;
    Levels(const Quantisation& q, float scale, bool predicted, std::size_t i)
        : step(scale * (predicted ? q.inter[i] : q.intra[i])),
          dead_zone(predicted ? q.inter_dead_zone : q.intra_dead_zone) {
        if (!predicted && i == 0) step = q.dc_step, dead_zone = 0.5f;
    }
    float decode(float coefficient) const { return decoded(coefficient, step, dead_zone); }
};

/// A number of about the standard normal distribution: the sum of eight bytes of a hash, less its mean, over its
/// standard deviation.
float normal(std::uint64_t draw, std::uint64_t coefficient) {
    constexpr float mean = 8 * 127.5f, deviation = 209.02f;
    const std::uint64_t bits = core::mix(draw << 6 | coefficient);
    std::uint64_t pairs = (bits & 0x00ff00ff00ff00ff) + (bits >> 8 & 0x00ff00ff00ff00ff);
    pairs = (pairs * 0x0001000100010001) >> 48;
    return (static_cast<float>(pairs) - mean) / deviation;
}

}  // namespace

core::Plane<PixelNoise> noise_of(const PixelLight& light, const InverseLuma& display, const core::Plane<float>& error,
                                 const core::Plane<float>& shared_error) {
    EXPECTS(error.width() == light.width() && error.height() == light.height() && shared_error.size() == error.size());
    core::Plane<PixelNoise> noise(light.width(), light.height());
    for (std::size_t i = 0; i < noise.size(); ++i) {
        const float of_one_code = display.difference(light.luma.values()[i], light.luminance.values()[i],
                                                     light.exponent.values()[i], 1.0f),
                    alone = core::divide_or(error.values()[i], of_one_code, 0.0f),
                    of_block = core::divide_or(shared_error.values()[i], of_one_code, 0.0f);
        noise.values()[i] = {alone * alone, of_block * of_block};
    }
    return noise;
}

core::Plane<BlockNoise> noise_of_blocks(const core::Plane<PixelNoise>& pixels, const core::Plane<float>& luma) {
    EXPECTS(pixels.size() == luma.size());
    static const core::Block8x8 shares = shares_of_shared();
    core::Plane<BlockNoise> noise((pixels.width() + side - 1) / side, (pixels.height() + side - 1) / side);
    for (int row = 0; row < noise.height(); ++row)
        for (int column = 0; column < noise.width(); ++column) {
            float alone = 0, of_block = 0, count = 0;
            for (int y = row * side; y < std::min((row + 1) * side, pixels.height()); ++y)
                for (int x = column * side; x < std::min((column + 1) * side, pixels.width()); ++x) {
                    const PixelNoise& light = pixels.at(x, y);
                    const float seen = shown(light.alone, luma.at(x, y));
                    alone += seen;
                    of_block += light.of_block * core::divide_or(seen, light.alone, 1.0f);
                    ++count;
                }
            alone /= count;
            of_block /= count;
            // The mean has a 64th of white noise, and its share of the rest.
            constexpr float of_white = 1.0f / 64;
            const float smooth = std::clamp((of_block - alone * of_white) / (shares[0] - of_white), 0.0f, alone);
            for (std::size_t i = 0; i < shares.size(); ++i)
                noise.at(column, row)[i] = alone - smooth + 64 * smooth * shares[i];
        }
    return noise;
}

CodedBlocks::CodedBlocks(const core::Plane<core::Block8x8>& picture, const core::Plane<float>& luma,
                         const core::Plane<float>& prediction)
    : coefficients(picture) {
    if (prediction.empty()) return;
    EXPECTS(prediction.width() == luma.width() && prediction.height() == luma.height());
    core::Picture left;
    left.y = core::Plane<std::uint8_t>(luma.width(), luma.height());
    left.luma = luma;
    predicted = core::Plane<std::uint8_t>(picture.width(), picture.height(), 1);
    for (int y = 0; y < luma.height(); ++y)
        for (int x = 0; x < luma.width(); ++x) {
            left.luma.at(x, y) -= prediction.at(x, y);
            if (!(prediction.at(x, y) > 0)) predicted.at(x / side, y / side) = 0;
        }
    const core::Plane<core::Block8x8> residual = transform(left);
    EXPECTS(residual.size() == predicted.size());
    for (std::size_t i = 0; i < predicted.size(); ++i)
        if (predicted.values()[i] != 0) coefficients.values()[i] = residual.values()[i];
}

core::Plane<std::uint8_t> decode(const CodedBlocks& blocks, const core::Plane<float>& luma,
                                 const core::Plane<float>& prediction, const Quantisation& quantisation, float scale) {
    EXPECTS(prediction.empty() == blocks.predicted.empty());
    core::Plane<std::uint8_t> picture(luma.width(), luma.height());
    for (int row = 0; row < blocks.coefficients.height(); ++row)
        for (int column = 0; column < blocks.coefficients.width(); ++column) {
            const bool inter = !blocks.predicted.empty() && blocks.predicted.at(column, row) != 0;
            core::Block8x8 block = blocks.coefficients.at(column, row);
            for (std::size_t i = 0; i < block.size(); ++i)
                block[i] = Levels(quantisation, scale, inter, i).decode(block[i]);
            block = core::inverse_dct(block);
            for (int y = row * side; y < std::min((row + 1) * side, luma.height()); ++y)
                for (int x = column * side; x < std::min((column + 1) * side, luma.width()); ++x) {
                    const float told = inter ? prediction.at(x, y) : 0.0f,
                                decoded = told + block[static_cast<std::size_t>(y % side * side + x % side)];
                    picture.at(x, y) = static_cast<std::uint8_t>(std::lround(std::clamp(decoded, 0.0f, 255.0f)));
                }
        }
    return picture;
}

CodedBlocks left_by_intra(const core::Plane<core::Block8x8>& picture, const Quantisation& quantisation, float scale) {
    CodedBlocks left(picture, {}, {});
    left.predicted = core::Plane<std::uint8_t>(picture.width(), picture.height(), 1);
    for (std::size_t i = 0; i < 64; ++i) {
        const Levels levels(quantisation, scale, false, i);
        for (core::Block8x8& block : left.coefficients.values()) block[i] -= levels.decode(block[i]);
    }
    return left;
}

double NoisyPicture::loss(double times) const {
    const std::size_t count = blocks.coefficients.size();
    EXPECTS(noise.size() == count && count > 0);
    const double step = std::max(static_cast<double>(count) / asked, 1.0);
    double by_coding = by_rounding * asked, with_noise = by_coding;
    for (std::size_t draw = 0; draw < asked; ++draw) {
        const std::size_t block = static_cast<std::size_t>(step * static_cast<double>(draw)) % count;
        const bool inter = !blocks.predicted.empty() && blocks.predicted.values()[block] != 0;
        for (std::size_t i = 0; i < 64; ++i) {
            const float c = blocks.coefficients.values()[block][i], variance = noise.values()[block][i];
            const Levels levels(quantisation, scale, inter, i);
            const float lost = levels.decode(c) - c;
            by_coding += static_cast<double>(lost) * static_cast<double>(lost);
            const float more = static_cast<float>(times) * std::sqrt(variance) * normal(draw, i);
            const double now = static_cast<double>(levels.decode(c + more) - c);
            with_noise += now * now;
        }
    }
    return with_noise > by_coding ? 10 * std::log10(with_noise / by_coding) : 0.0;
}

}  // namespace render2mpeg::perceptual
