#include "encoder/av/av1_headers.h"

#include <algorithm>
#include <string>

#include "core/error.h"
#include "encoder/av/bits.h"

namespace render2mpeg::av {
namespace {

void refuse_if(bool refused, const char* what) {
    if (refused) throw core::Error(std::string("AV1: film grain cannot be told in a stream with ") + what);
}

/// tile_log2() [AV1, 5.9.16].
int log2_over(int block, int target) {
    int k = 0;
    while ((block << k) < target) ++k;
    return k;
}

/// color_config() [AV1, 5.5.2] of profile 0. Returns separate_uv_delta_q.
bool read_color(Bits& bits) {
    bits.skip(1);  // high_bitdepth
    refuse_if(bits.flag(), "grey pictures");
    if (bits.flag()) {
        const std::uint32_t color = bits.read(24);
        refuse_if(color == (1u << 16 | 13u << 8), "R, G, B");
    }
    bits.skip(3);  // color_range, chroma_sample_position
    return bits.flag();
}

/// A value of decode_subexp() [AV1, 5.9.28], of which the length alone counts.
void skip_subexp(Bits& bits, int symbols) {
    for (int i = 0, passed = 0;; ++i) {
        const int width = i > 0 ? i + 2 : 3;
        if (symbols <= passed + 3 * (1 << width)) {
            const int n = symbols - passed;
            int w = 0;
            while ((n >> w) > 0) ++w;
            const int value = static_cast<int>(bits.read(w - 1));
            if (value >= (1 << w) - n) bits.skip(1);
            return;
        }
        if (!bits.flag()) {
            bits.skip(static_cast<std::size_t>(width));
            return;
        }
        passed += 1 << width;
    }
}

}  // namespace

std::size_t Av1Headers::read_sequence(std::span<const std::uint8_t> payload) {
    Bits bits(payload);
    Sequence s;
    refuse_if(bits.read(3) != 0, "another profile than the main one");
    bits.skip(1);
    refuse_if(bits.flag(), "a still picture");
    refuse_if(bits.flag(), "a decoder's timing");
    const bool has_delay = bits.flag();
    refuse_if(bits.read(5) != 0, "several operating points");
    bits.skip(12);
    if (bits.read(5) > 7) bits.skip(1);
    if (has_delay && bits.flag()) bits.skip(4);
    const int width_bits = static_cast<int>(bits.read(4)) + 1, height_bits = static_cast<int>(bits.read(4)) + 1;
    s.width = static_cast<int>(bits.read(width_bits)) + 1;
    s.height = static_cast<int>(bits.read(height_bits)) + 1;
    refuse_if(bits.flag(), "frame numbers");
    s.large_blocks = bits.flag();
    bits.skip(4);  // enable_filter_intra .. enable_masked_compound
    s.warped_motion = bits.flag();
    bits.skip(1);
    s.order_hint = bits.flag();
    if (s.order_hint) {
        bits.skip(1);
        s.motion_vectors = bits.flag();
    }
    if (!bits.flag()) s.screen_content = static_cast<int>(bits.read(1));
    if (s.screen_content > 0 && !bits.flag()) s.integer_vectors = static_cast<int>(bits.read(1));
    if (s.order_hint) s.order_hint_bits = static_cast<int>(bits.read(3)) + 1;
    s.superres = bits.flag();
    s.cdef = bits.flag();
    s.restoration = bits.flag();
    s.separate_uv = read_color(bits);
    const std::size_t place = bits.position();
    refuse_if(bits.flag() || bits.overrun(), "film grain already");
    sequence_ = s;
    has_sequence_ = true;
    return place;
}

int Av1Headers::distance(int hint, int from) const {
    if (!sequence_.order_hint) return 0;
    const int half = 1 << (sequence_.order_hint_bits - 1), difference = hint - from;
    return (difference & (half - 1)) - (difference & half);
}

/// Reads uncompressed_header() [AV1, 5.9.2], part by part.
class Av1Headers::FrameReader {
  public:
    FrameReader(const Sequence& sequence, std::array<int, 8>& order_hints, const Av1Headers& headers,
                std::span<const std::uint8_t> payload)
        : s_(sequence), order_hints_(order_hints), headers_(headers), bits_(payload) {}

    Av1FrameHeader read() {
        frame_.shows_existing = bits_.flag();
        if (frame_.shows_existing) return frame_;
        read_kind();
        read_references();
        if (!disable_cdf_update_) bits_.skip(1);
        read_tiles();
        read_quantisers();
        read_segmentation();
        read_delta_quantisers();
        read_filters();
        bits_.skip(1);  // tx_mode_select
        read_modes();
        frame_.end = bits_.position();
        refuse_if(bits_.overrun(), "a damaged frame header");
        for (std::size_t i = 0; i < order_hints_.size(); ++i)
            if ((frame_.refreshed >> i & 1) != 0) order_hints_[i] = frame_.order_hint;
        return frame_;
    }

  private:
    void skip(int count) { bits_.skip(static_cast<std::size_t>(count)); }

    void read_kind() {
        enum : std::uint32_t { key, inter, intra_only, switched };
        const std::uint32_t type = bits_.read(2);
        const bool shown = bits_.flag();
        frame_.is_key = type == key && shown;
        frame_.is_inter = type == inter || type == switched;
        frame_.can_be_shown = shown || bits_.flag();
        resilient_ = type == switched || frame_.is_key || bits_.flag();
        if (frame_.is_key) order_hints_ = {};
        disable_cdf_update_ = bits_.flag();
        const bool screen_content = s_.screen_content == 2 ? bits_.flag() : s_.screen_content == 1;
        if (screen_content) integer_vectors_ = s_.integer_vectors == 2 ? bits_.flag() : s_.integer_vectors == 1;
        refuse_if(type == switched || bits_.flag(), "frames of other sizes");
        frame_.order_hint = static_cast<int>(bits_.read(s_.order_hint_bits));
        has_primary_ = frame_.is_inter && !resilient_ && bits_.read(3) != 7;
        frame_.refreshed = frame_.is_key ? 0xff : static_cast<std::uint8_t>(bits_.read(8));
        if ((frame_.is_inter || frame_.refreshed != 0xff) && resilient_ && s_.order_hint)
            for (int& hint : order_hints_) hint = static_cast<int>(bits_.read(s_.order_hint_bits));
        may_copy_ = screen_content && !frame_.is_inter;
    }

    void read_references() {
        if (frame_.is_inter) {
            refuse_if(s_.order_hint && bits_.flag(), "short lists of references");
            for (int& reference : frame_.references) reference = static_cast<int>(bits_.read(3));
        }
        refuse_if(s_.superres && bits_.flag(), "frames of other sizes");
        if (bits_.flag()) skip(32);  // render_size
        if (!frame_.is_inter) {
            copies_ = may_copy_ && bits_.flag();
            return;
        }
        fine_vectors_ = !integer_vectors_ && bits_.flag();
        if (!bits_.flag()) skip(2);  // interpolation_filter
        skip(1);                     // is_motion_mode_switchable
        if (!resilient_ && s_.motion_vectors) skip(1);
    }

    /// [AV1, 5.9.15]
    void read_tiles() {
        const int shift = s_.large_blocks ? 5 : 4, block = shift + 2;
        const auto blocks = [&](int pixels) { return (2 * ((pixels + 7) >> 3) + (1 << shift) - 1) >> shift; };
        const int columns = blocks(s_.width), rows = blocks(s_.height);
        const int least_columns = log2_over(4096 >> block, columns);
        const int least = std::max(least_columns, log2_over((4096 * 2304) >> (2 * block), rows * columns));
        refuse_if(!bits_.flag(), "tiles of uneven sizes");
        const auto increased = [&](int from, int most) {
            while (from < most && bits_.flag()) ++from;
            return from;
        };
        const int columns_log2 = increased(least_columns, log2_over(1, std::min(columns, 64)));
        const int rows_log2 = increased(std::max(least - columns_log2, 0), log2_over(1, std::min(rows, 64)));
        if (columns_log2 + rows_log2 > 0) skip(columns_log2 + rows_log2 + 2);
    }

    void read_delta_q() {
        if (bits_.flag()) skip(7);
    }

    void read_quantisers() {
        refuse_if(bits_.read(8) == 0, "lossless frames");
        read_delta_q();
        const bool apart = s_.separate_uv && bits_.flag();
        for (int i = 0; i < (apart ? 4 : 2); ++i) read_delta_q();
        if (bits_.flag()) skip(s_.separate_uv ? 12 : 8);  // matrices
    }

    /// [AV1, 5.9.14]
    void read_segmentation() {
        if (!bits_.flag()) return;
        bool updates = true;
        if (has_primary_) {
            if (bits_.flag()) skip(1);
            updates = bits_.flag();
        }
        if (!updates) return;
        constexpr std::array<int, 8> widths{9, 7, 7, 7, 7, 3, 0, 0};
        for (int segment = 0; segment < 8; ++segment)
            for (const int width : widths)
                if (bits_.flag()) skip(width);
    }

    void read_delta_quantisers() {
        if (!bits_.flag()) return;
        skip(2);
        if (!copies_ && bits_.flag()) skip(3);
    }

    /// loop_filter_params(), cdef_params() and lr_params() [AV1, 5.9.11, 5.9.19, 5.9.20].
    void read_filters() {
        if (copies_) return;
        const bool has_levels = bits_.read(12) != 0;
        skip((has_levels ? 12 : 0) + 3);
        if (bits_.flag() && bits_.flag()) {
            for (int i = 0; i < 10; ++i) read_delta_q();
        }
        if (s_.cdef) {
            skip(2);
            skip(12 << bits_.read(2));
        }
        if (!s_.restoration) return;
        const bool of_luma = bits_.read(2) != 0, of_chroma = bits_.read(4) != 0;
        if (!of_luma && !of_chroma) return;
        if (bits_.flag() && !s_.large_blocks) skip(1);
        if (of_chroma) skip(1);
    }

    /// skipModeAllowed [AV1, 5.9.22]
    bool can_skip() const {
        int before = -1, after = -1;
        for (const int reference : frame_.references) {
            const int hint = order_hints_[static_cast<std::size_t>(reference)];
            const int distance = headers_.distance(hint, frame_.order_hint);
            if (distance < 0 && (before < 0 || headers_.distance(hint, before) > 0)) before = hint;
            if (distance > 0 && (after < 0 || headers_.distance(hint, after) < 0)) after = hint;
        }
        if (before < 0 || after >= 0) return before >= 0;
        return std::ranges::any_of(frame_.references, [&](int reference) {
            return headers_.distance(order_hints_[static_cast<std::size_t>(reference)], before) < 0;
        });
    }

    void read_modes() {
        const bool two_references = frame_.is_inter && bits_.flag();
        if (two_references && s_.order_hint && can_skip()) skip(1);
        if (frame_.is_inter && !resilient_ && s_.warped_motion) skip(1);
        skip(1);  // reduced_tx_set
        if (!frame_.is_inter) return;
        for (int reference = 0; reference < 7; ++reference) read_global_motion();
    }

    /// [AV1, 5.9.24, 5.9.25]
    void read_global_motion() {
        if (!bits_.flag()) return;
        const bool rotates = bits_.flag(), translates = !rotates && bits_.flag();
        constexpr int of_alpha = 1 << 12;
        if (!translates) {
            for (int i = 0; i < (rotates ? 2 : 4); ++i) skip_subexp(bits_, 2 * of_alpha + 1);
        }
        const int of_translation = 1 << (translates ? (fine_vectors_ ? 9 : 8) : 12);
        for (int i = 0; i < 2; ++i) skip_subexp(bits_, 2 * of_translation + 1);
    }

    const Sequence& s_;
    std::array<int, 8>& order_hints_;
    const Av1Headers& headers_;
    Bits bits_;
    Av1FrameHeader frame_;
    bool resilient_ = false, disable_cdf_update_ = false, integer_vectors_ = false, fine_vectors_ = false;
    bool has_primary_ = false;                ///< primary_ref_frame is one
    bool may_copy_ = false, copies_ = false;  ///< intra block copy
};

Av1FrameHeader Av1Headers::read_frame(std::span<const std::uint8_t> payload) {
    refuse_if(!has_sequence_, "no sequence header");
    return FrameReader(sequence_, order_hints_, *this, payload).read();
}

}  // namespace render2mpeg::av
