#pragma once
// Headers of AV1's frames, read to where film grain stands.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace render2mpeg::av {

/// What is known of a frame behind its header.
struct Av1FrameHeader {
    bool shows_existing = false;  ///< a frame decoded before is shown, and nothing else is said
    bool is_key = false;          ///< a key frame that is shown
    bool is_inter = false;
    bool can_be_shown = false;   ///< now or later: it has film grain
    int order_hint = 0;          ///< display order, modulo
    std::uint8_t refreshed = 0;  ///< places of references that it is stored in, a bit each
    std::array<int, 7> references{};
    std::size_t end = 0;  ///< of the header in bits: film_grain_params() would begin there
};

/// Reads headers of a stream that has no film grain yet, in coding order [AV1, 5.5, 5.9]. All that it reads throws
/// core::Error where it is damaged or has what encoders of films do not use: scalability, layers, frame sizes that
/// change, frame numbers, decoder models, lossless frames, tiles of uneven sizes.
class Av1Headers {
  public:
    /// Reads a sequence header's payload. Returns the place of film_grain_params_present, bits.
    std::size_t read_sequence(std::span<const std::uint8_t> payload);
    /// Reads a frame header's payload, or a frame's.
    Av1FrameHeader read_frame(std::span<const std::uint8_t> payload);

    /// How many frames one order hint lies behind another.
    int distance(int hint, int from) const;

  private:
    class FrameReader;

    /// The sequence header's values that decide what frame headers have.
    struct Sequence {
        int width = 0, height = 0;
        bool large_blocks = false, warped_motion = false, order_hint = false, motion_vectors = false;
        bool superres = false, cdef = false, restoration = false, separate_uv = false;
        int screen_content = 2, integer_vectors = 2;  ///< 2: each frame says
        int order_hint_bits = 0;
    };

    Sequence sequence_;
    bool has_sequence_ = false;
    std::array<int, 8> order_hints_{};  ///< of references
};

}  // namespace render2mpeg::av
