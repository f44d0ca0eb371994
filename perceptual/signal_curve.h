#pragma once
// The tone curve and transfer function by themselves.
#include <array>
#include <bit>
#include <cstdint>

#include "core/isa_clones.h"

/// Tone curve and transfer function, each with its inverse, and tabulated as one.
namespace render2mpeg::perceptual {

/// The display's tone curve by itself: scene-linear, exposed, >= 0, to display-linear in [0, 1]
/// (docs/model/display.md).
double tone_curve(double exposed);
/// Its inverse, for display-linear values in [0, 1).
double inverse_tone_curve(double display_linear);

/// Display-linear light in [0, 1] to the signal R', G' or B' in [0, 1], and back. [BT709, 1.2] with the constants that
/// make value and slope continuous [BT2020, table 4].
double opto_electronic(double display_linear);
double inverse_opto_electronic(double signal);

/// Tone curve and transfer function in one, tabulated: exposed scene-linear light to signal. Right to 1e-4 code values
/// of 219 (test), which is below what float luma resolves twice over, and ten times as fast as the powers. Non-negative
/// input; NaN gives 0.
class SignalCurve {
  public:
    /// Beyond this exposed light the curve stays where it is: 6e-5 code values below white.
    static constexpr float brightest = 262144.0f;

    /// The only one; built at first use.
    static const SignalCurve& instance();

    struct Point {
        float signal;
        float log_slope;  ///< derivative of the signal by the natural logarithm of the light: signal' x light
    };

    float signal(float exposed) const {
        if (!(exposed >= first)) return exposed > 0.0f ? 4.5f * exposed : 0.0f;
        const Place p = place(exposed);
        return p.segment.a + p.t * (p.segment.b + p.t * p.segment.c);
    }

    Point point(float exposed) const {
        if (!(exposed >= first)) return exposed > 0.0f ? Point{4.5f * exposed, 4.5f * exposed} : Point{0.0f, 0.0f};
        if (exposed >= brightest) return {signal(brightest), 0.0f};
        const Place p = place(exposed);
        const float mantissa =
            std::bit_cast<float>((std::bit_cast<std::uint32_t>(exposed) & 0x007fffffu) | 0x3f800000u);
        return {p.segment.a + p.t * (p.segment.b + p.t * p.segment.c),
                (p.segment.b + 2.0f * p.t * p.segment.c) * (mantissa * segments_per_octave)};
    }

    /// point(exposed).log_slope, right to 1e-4 of it and to 1e-6 next to white, without branches: for loops over
    /// pixels. Finite.
    RENDER2MPEG_ALWAYS_INLINED float log_slope(float exposed) const {
        const float within = core::inlined::min(core::inlined::max(exposed, first), brightest);
        const auto bits = __builtin_bit_cast(std::uint32_t, within);
        constexpr std::uint32_t rest = (1u << (23 - segment_bits)) - 1;
        const float t =
            static_cast<float>(static_cast<std::int32_t>(bits & rest)) * (1.0f / static_cast<float>(rest + 1));
        const auto i = static_cast<std::int32_t>((bits >> (23 - segment_bits)) - first_segment);
        const Segment* const segments = segments_.data();
        const float mantissa = __builtin_bit_cast(float, (bits & 0x007fffffu) | 0x3f800000u);
        // On the straight line the slope is in proportion to the light.
        const float share = core::inlined::min(core::inlined::max(exposed, 0.0f) * (1.0f / first), 1.0f);
        return (segments[i].b + 2.0f * t * segments[i].c) * (mantissa * segments_per_octave) * share;
    }

  private:
    /// Below this the curve is the straight line 4.5 x. A power of two, below the end of the line at 0.018.
    static constexpr float first = 0.015625f;
    static constexpr int segment_bits = 7;
    static constexpr float segments_per_octave = 128.0f;
    static constexpr std::uint32_t first_segment = std::bit_cast<std::uint32_t>(first) >> (23 - segment_bits);
    static constexpr std::uint32_t last_segment = std::bit_cast<std::uint32_t>(brightest) >> (23 - segment_bits);

    /// signal = a + t (b + t c), t in [0, 1) over the segment.
    struct Segment {
        float a, b, c;
    };
    struct Place {
        const Segment& segment;
        float t;
    };

    SignalCurve();

    /// A float's bits, read as an integer, are its place on a piecewise linear logarithmic scale.
    Place place(float exposed) const {
        const auto bits = std::bit_cast<std::uint32_t>(exposed < brightest ? exposed : brightest);
        constexpr std::uint32_t rest = (1u << (23 - segment_bits)) - 1;
        return {segments_[(bits >> (23 - segment_bits)) - first_segment],
                static_cast<float>(bits & rest) * (1.0f / static_cast<float>(rest + 1))};
    }

    std::array<Segment, last_segment - first_segment + 1> segments_;
};

}  // namespace render2mpeg::perceptual
