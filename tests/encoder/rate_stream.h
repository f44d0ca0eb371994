#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "encoder/mpeg2/bitstream/codes.h"

/// Reads streams back for the rate tests: headers, sizes and every macroblock's bits. Of the encoder it shares the
/// tables of code words only, which foreign decoders have confirmed (codes_test.cpp).
namespace render2mpeg::encoder::testing {

/// What one picture says of itself, and how large it and its macroblocks are.
struct ReadPicture {
    std::size_t first_byte = 0;        ///< of the access unit, its sequence and GOP headers included
    std::size_t after_start_code = 0;  ///< of the picture
    std::size_t end = 0;               ///< first byte of the next access unit, or of the end code
    int type = 0;
    int temporal_reference = 0;
    int vbv_delay = 0;
    int f_code[4] = {};
    bool repeat_first_field = false;
    int largest_macroblock = 0;  ///< bits
    int macroblocks = 0;         ///< coded or skipped
    bool has_sequence_header = false;
};

struct ReadStream {
    int level = 0;
    int width = 0, height = 0;
    int frame_rate_code = 0;
    std::int64_t bit_rate = 0, buffer_bits = 0;
    bool progressive = false;
    std::vector<ReadPicture> pictures;  ///< in coding order
};

/// Bits from the front of a byte array.
class Bits {
  public:
    Bits(std::span<const std::uint8_t> bytes, std::size_t at_byte) : bytes_(bytes), at_(8 * at_byte) {}
    std::uint32_t peek(int count) const {
        std::uint32_t value = 0;
        for (int i = 0; i < count; ++i) {
            const std::size_t bit = at_ + static_cast<std::size_t>(i);
            const bool set = bit / 8 < bytes_.size() && (bytes_[bit / 8] >> (7 - bit % 8) & 1) != 0;
            value = value << 1 | (set ? 1u : 0u);
        }
        return value;
    }
    std::uint32_t take(int count) {
        const std::uint32_t value = peek(count);
        at_ += static_cast<std::size_t>(count);
        if (at_ > 8 * bytes_.size()) throw std::runtime_error("the stream ends within a code");
        return value;
    }
    bool accept(mpeg2::Code code) {
        if (code.length == 0 || peek(code.length) != code.bits) return false;
        at_ += code.length;
        return true;
    }
    std::size_t position() const { return at_; }

  private:
    std::span<const std::uint8_t> bytes_;
    std::size_t at_;
};

/// The macroblock layer of one slice. [H262, 6.2.4 to 6.2.6]
class SliceReader {
  public:
    SliceReader(Bits& in, ReadPicture& picture, bool table_one, int columns)
        : in_(in), picture_(picture), table_one_(table_one), columns_(columns) {}

    void read() {
        in_.take(5);  // quantiser_scale_code
        if (in_.take(1) != 0) throw std::runtime_error("a slice has extra information");
        int column = -1;
        // Slices end where a start code's zeros begin.
        while (in_.peek(23) != 0) {
            const std::size_t before = in_.position();
            column += increment();
            if (column >= columns_) throw std::runtime_error("a slice is longer than a row");
            macroblock();
            picture_.largest_macroblock =
                std::max(picture_.largest_macroblock, static_cast<int>(in_.position() - before));
        }
        if (column != columns_ - 1) throw std::runtime_error("a slice ends within a row");
        picture_.macroblocks += columns_;
    }

  private:
    int increment() {
        int sum = 0;
        while (in_.accept(mpeg2::address_increment_codes[0])) sum += 33;
        for (std::size_t i = 1; i <= 33; ++i)
            if (in_.accept(mpeg2::address_increment_codes[i])) return sum + static_cast<int>(i);
        throw std::runtime_error("no macroblock_address_increment");
    }

    mpeg2::MacroblockType type() {
        for (int bits = 0; bits < 32; ++bits) {
            mpeg2::MacroblockType t;
            t.intra = (bits & 1) != 0;
            t.motion_forward = (bits & 2) != 0;
            t.pattern = (bits & 4) != 0;
            t.quant = (bits & 8) != 0;
            t.motion_backward = (bits & 16) != 0;
            if (in_.accept(mpeg2::macroblock_type_code(static_cast<PictureType>(picture_.type), t))) return t;
        }
        throw std::runtime_error("no macroblock_type");
    }

    void component(int f_code) {
        for (std::size_t i = 0; i < mpeg2::motion_codes.size(); ++i) {
            if (!in_.accept(mpeg2::motion_codes[i])) continue;
            if (i > 0) in_.take(1 + f_code - 1);
            return;
        }
        throw std::runtime_error("no motion_code");
    }

    void macroblock() {
        const mpeg2::MacroblockType t = type();
        if (t.quant && in_.take(5) == 0) throw std::runtime_error("quantiser_scale_code 0");
        for (int d = 0; d < 2; ++d)
            if (t.motion(d)) component(picture_.f_code[2 * d]), component(picture_.f_code[2 * d + 1]);
        int pattern = t.intra ? 63 : 0;
        if (t.pattern) pattern = coded_pattern();
        for (int i = 0; i < 6; ++i)
            if ((pattern & 32 >> i) != 0) block(t.intra, i < 4);
    }

    int coded_pattern() {
        for (std::size_t i = 1; i < 64; ++i)
            if (in_.accept(mpeg2::pattern_codes[i])) return static_cast<int>(i);
        throw std::runtime_error("no coded_block_pattern");
    }

    void block(bool intra, bool luma) {
        int count = 0;
        if (intra) {
            const auto& sizes = luma ? mpeg2::luma_dc_size_codes : mpeg2::chroma_dc_size_codes;
            std::size_t size = 0;
            while (size < sizes.size() && !in_.accept(sizes[size])) ++size;
            if (size == sizes.size()) throw std::runtime_error("no dct_dc_size");
            in_.take(static_cast<int>(size));
            count = 1;
        }
        const mpeg2::CoefficientCodes& codes =
            intra && table_one_ ? mpeg2::coefficient_codes_one() : mpeg2::coefficient_codes_zero();
        if (!intra && in_.peek(1) == 1) in_.take(2), count = 1;  // the first coefficient's short code and sign
        while (!in_.accept(codes.end_of_block)) {
            count += coefficient(codes) + 1;
            if (count > 64) throw std::runtime_error("a block has more than 64 coefficients");
        }
    }

    /// Gives the run.
    int coefficient(const mpeg2::CoefficientCodes& codes) {
        if (in_.peek(6) == 1) {  // escape [H262, table B-16]
            in_.take(6);
            const auto run = static_cast<int>(in_.take(6));
            in_.take(12);
            return run;
        }
        static const RunTable zero(mpeg2::coefficient_codes_zero()), one(mpeg2::coefficient_codes_one());
        const RunTable& table = &codes == &mpeg2::coefficient_codes_zero() ? zero : one;
        const auto [run, length] = table.entries[in_.peek(16)];
        if (length == 0) throw std::runtime_error("no coefficient");
        in_.take(length + 1);
        return run;
    }

    /// Run and code length by the next 16 bits.
    struct RunTable {
        explicit RunTable(const mpeg2::CoefficientCodes& codes) : entries(1 << 16) {
            for (int run = 0; run < mpeg2::CoefficientCodes::runs; ++run)
                for (const mpeg2::Code& code : codes.code[run]) {
                    const std::size_t first = code.length == 0 ? 0 : code.bits << (16 - code.length);
                    const std::size_t count = code.length == 0 ? 0 : std::size_t{1} << (16 - code.length);
                    std::fill_n(entries.begin() + static_cast<std::ptrdiff_t>(first), count,
                                std::pair<int, int>(run, code.length));
                }
        }
        std::vector<std::pair<int, int>> entries;
    };

    Bits& in_;
    ReadPicture& picture_;
    bool table_one_;
    int columns_;
};

/// Walks from start code to start code.
class StreamReader {
  public:
    explicit StreamReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    ReadStream read() {
        for (std::size_t at = next_start_code(0); at < bytes_.size(); at = next_start_code(at + 4)) take(at);
        if (open_) stream_.pictures.back().end = bytes_.size();
        return stream_;
    }

  private:
    std::size_t next_start_code(std::size_t from) const {
        for (; from + 3 < bytes_.size(); ++from)
            if (bytes_[from] == 0 && bytes_[from + 1] == 0 && bytes_[from + 2] == 1) return from;
        return bytes_.size();
    }
    void close(std::size_t at) {
        if (open_) stream_.pictures.back().end = at;
        open_ = false;
    }
    /// An access unit begins with its first header.
    void begin(std::size_t at) {
        if (begun_) return;
        close(at);
        begun_ = true;
        first_ = at;
    }

    void take(std::size_t at) {
        const int code = bytes_[at + 3];
        Bits in(bytes_, at + 4);
        if (code == 0xb3) {
            begin(at);
            sequence(in);
        } else if (code == 0xb8) {
            begin(at);
        } else if (code == 0x00) {
            begin(at);
            picture(in, at);
        } else if (code == 0xb5) {
            extension(in);
        } else if (code == 0xb7) {
            close(at);
        } else if (code >= 0x01 && code <= 0xaf) {
            SliceReader(in, stream_.pictures.back(), table_one_, (stream_.width + 15) / 16).read();
        }
    }
    void sequence(Bits& in) {
        stream_.width = static_cast<int>(in.take(12));
        stream_.height = static_cast<int>(in.take(12));
        in.take(4);
        stream_.frame_rate_code = static_cast<int>(in.take(4));
        low_rate_ = in.take(18);
        in.take(1);
        low_buffer_ = in.take(10);
        has_sequence_ = true;
    }
    void picture(Bits& in, std::size_t at) {
        ReadPicture p;
        p.first_byte = first_;
        p.after_start_code = at + 4;
        p.temporal_reference = static_cast<int>(in.take(10));
        p.type = static_cast<int>(in.take(3));
        p.vbv_delay = static_cast<int>(in.take(16));
        p.has_sequence_header = has_sequence_;
        stream_.pictures.push_back(p);
        open_ = true;
        begun_ = has_sequence_ = false;
    }
    void extension(Bits& in) {
        const std::uint32_t kind = in.take(4);
        if (kind == 1) {
            stream_.level = static_cast<int>(in.take(8) & 15);
            stream_.progressive = in.take(1) != 0;
            in.take(2 + 4);
            stream_.bit_rate = (static_cast<std::int64_t>(in.take(12)) << 18 | low_rate_) * 400;
            in.take(1);
            stream_.buffer_bits = (static_cast<std::int64_t>(in.take(8)) << 10 | low_buffer_) * 16384;
        } else if (kind == 8) {
            ReadPicture& p = stream_.pictures.back();
            for (int& f_code : p.f_code) f_code = static_cast<int>(in.take(4));
            in.take(2 + 2 + 1 + 1 + 1 + 1);
            table_one_ = in.take(1) != 0;
            in.take(1);
            p.repeat_first_field = in.take(1) != 0;
        }
    }

    std::span<const std::uint8_t> bytes_;
    ReadStream stream_;
    bool open_ = false, begun_ = false, has_sequence_ = false, table_one_ = false;
    std::size_t first_ = 0;
    std::int64_t low_rate_ = 0, low_buffer_ = 0;
};

inline ReadStream read_stream(std::span<const std::uint8_t> bytes) {
    return StreamReader(bytes).read();
}

}  // namespace render2mpeg::encoder::testing
