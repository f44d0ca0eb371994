#pragma once
// A curve over light, tabulated by pieces of octaves.
#include <array>
#include <bit>
#include <cstdint>
#include <functional>

namespace render2mpeg::perceptual {

/// A rising curve from exposed light to signal, as 128 parabolas per octave from 2^first_octave to 2^last_octave: ten
/// times as fast as powers. Below it is a straight line through 0, above it stays where it is. Non-negative input; NaN
/// gives 0.
template <int first_octave, int last_octave>
class CurveTable {
  public:
    /// Beyond this exposed light the curve stays where it is.
    static constexpr float brightest = std::bit_cast<float>(static_cast<std::uint32_t>(127 + last_octave) << 23);

    struct Point {
        float signal;
        float log_slope;  ///< derivative of the signal by the natural logarithm of the light: signal' x light
    };

    /// `slope` of the line below the table.
    CurveTable(const std::function<double(double)>& signal_at, float slope) : slope_(slope) {
        for (std::uint32_t i = 0; i < segments_.size(); ++i) {
            const double from = std::bit_cast<float>((first_segment + i) << (23 - segment_bits));
            const double to = std::bit_cast<float>((first_segment + i + 1) << (23 - segment_bits));
            const double begin = signal_at(from), middle = signal_at((from + to) / 2), end = signal_at(to);
            segments_[i] = {static_cast<float>(begin), static_cast<float>(4 * middle - 3 * begin - end),
                            static_cast<float>(2 * begin - 4 * middle + 2 * end)};
        }
    }

    float signal(float exposed) const {
        if (!(exposed >= first)) return exposed > 0.0f ? slope_ * exposed : 0.0f;
        const Place p = place(exposed);
        return p.segment.a + p.t * (p.segment.b + p.t * p.segment.c);
    }

    Point point(float exposed) const {
        if (!(exposed >= first)) return exposed > 0.0f ? Point{slope_ * exposed, slope_ * exposed} : Point{0.0f, 0.0f};
        if (exposed >= brightest) return {signal(brightest), 0.0f};
        const Place p = place(exposed);
        const float mantissa =
            std::bit_cast<float>((std::bit_cast<std::uint32_t>(exposed) & 0x007fffffu) | 0x3f800000u);
        return {p.segment.a + p.t * (p.segment.b + p.t * p.segment.c),
                (p.segment.b + 2.0f * p.t * p.segment.c) * (mantissa * segments_per_octave)};
    }

  private:
    static constexpr float first = std::bit_cast<float>(static_cast<std::uint32_t>(127 + first_octave) << 23);
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

    /// A float's bits, read as an integer, are its place on a piecewise linear logarithmic scale.
    Place place(float exposed) const {
        const auto bits = std::bit_cast<std::uint32_t>(exposed < brightest ? exposed : brightest);
        constexpr std::uint32_t rest = (1u << (23 - segment_bits)) - 1;
        return {segments_[(bits >> (23 - segment_bits)) - first_segment],
                static_cast<float>(bits & rest) * (1.0f / static_cast<float>(rest + 1))};
    }

    float slope_;
    std::array<Segment, last_segment - first_segment + 1> segments_;
};

}  // namespace render2mpeg::perceptual
