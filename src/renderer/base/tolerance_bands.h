#pragma once
// Counts work by tolerance.
#include <array>
#include <cstddef>
#include <cstdint>

namespace render2mpeg::renderer {

/// Costs of pixels, binned by the tolerance of their light as a share of their luminance.
struct ToleranceBands {
    /// The bands' ends, not included; the last band has none.
    static constexpr std::array<float, 5> ends{0.01f, 0.02f, 0.04f, 0.08f, 0.16f};
    static constexpr std::size_t count = ends.size() + 1;

    std::array<std::uint64_t, count> points{}, clusters{};  ///< gather points, and clusters they were lit with

    /// A tolerance of just an end, but for its last digits, belongs to the band above.
    static std::size_t band_of(float tolerance) {
        std::size_t band = 0;
        while (band < ends.size() && tolerance >= ends[band] * 0.9999f) ++band;
        return band;
    }
    void add(float tolerance, std::uint64_t more_points, std::uint64_t more_clusters) {
        const std::size_t band = band_of(tolerance);
        points[band] += more_points;
        clusters[band] += more_clusters;
    }
    void add(const ToleranceBands& more) {
        for (std::size_t i = 0; i < count; ++i) {
            points[i] += more.points[i];
            clusters[i] += more.clusters[i];
        }
    }
};

}  // namespace render2mpeg::renderer
