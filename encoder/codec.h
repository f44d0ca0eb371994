#pragma once
// Differences between codecs: a row each.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "encoder/types.h"

namespace render2mpeg::encoder {

/// Quantisers of B pictures less those of P pictures that nothing refers to, in libavcodec's encoders. `middle`: of the
/// B picture that the others of its run refer to (is_middle).
struct LibraryOffsets {
    int bidirectional = 0, middle = 0;
};

/// Names that FFmpeg has for what a codec is made with.
struct LibraryNames {
    std::string_view stream;         ///< kind of stream: "h264"
    std::string_view encoder;        ///< "libx264"
    std::string_view quality, fast;  ///< value of the encoder's option `choice`, by Effort
    std::string_view choice;         ///< "preset"
    std::string_view pixels;         ///< pixel format; "yuv420p" where the encoder lacks it
    std::string_view package;        ///< where it comes from, for builds that lack it
    std::string_view tag;            ///< name in .mp4 and .mov; empty: libavformat's choice
};

/// All that differs between codecs: one row each.
struct CodecFacts {
    Codec codec;
    std::string_view word;                    ///< on the command line: "h264"
    std::string_view name;                    ///< "H.264"
    std::string_view scale;                   ///< name of its quantisers: "QP"
    int finest = 1, coarsest = 1;             ///< quantisers; one alone where it has none to choose
    int most_b_pictures = 0;                  ///< in a row
    int least_width = 16, least_height = 16;  ///< of its pictures, in pixels
    /// Its quantisers beside MPEG-2's q: at_1 + by_doubling * log2(q). fit: docs/measurements.md#codecs
    double at_1 = 1, by_doubling = 1;
    LibraryOffsets offsets{};  ///< chosen: docs/measurements.md#codecs; SVT-AV1 has its own by layers
    LibraryNames ffmpeg{};
    std::string_view endings{};  ///< of files in which players look for it, the usual one first
    std::string_view not_on{};   ///< devices that do not play it
    bool master = false;         ///< no quantisers to choose: for editors, and GIF
    bool has_srgb = true;        ///< its table of transfer functions has sRGB's
    bool takes_blocks = false;   ///< it is told a quantiser for each macroblock
    bool tells_blocks = false;   ///< libavcodec tells how its macroblocks are predicted
    bool adds_grain = false;     ///< its decoders add film grain that its headers tell

    constexpr bool has_ending(std::string_view ending) const {
        for (std::size_t at = endings.find(ending); at != std::string_view::npos; at = endings.find(ending, at + 1))
            if (at + ending.size() == endings.size() || endings[at + ending.size()] == ' ') return !ending.empty();
        return false;
    }
    constexpr bool has_more_than_8_bits() const {
        return ffmpeg.pixels.ends_with("10") || ffmpeg.pixels.ends_with("12");
    }
    /// Its coder takes luma before rounding: of more than 8 bits, and all of 4:4:4, GIF among them.
    constexpr bool takes_unrounded() const { return has_more_than_8_bits() || has_chroma_of_all_pixels(); }
    constexpr bool has_chroma_of_all_pixels() const { return ffmpeg.pixels.find("444") != std::string_view::npos; }
    /// Chroma that its coder takes before rounding.
    constexpr core::ExactChroma exact_chroma() const {
        const bool more = has_chroma_of_all_pixels() || ffmpeg.pixels.find("422") != std::string_view::npos;
        return more                     ? core::ExactChroma::full
               : has_more_than_8_bits() ? core::ExactChroma::halved
                                        : core::ExactChroma::none;
    }
    /// Width and height of its pictures must be even. MPEG-2's, padded to whole macroblocks, need not.
    constexpr bool even_sides() const { return codec != Codec::mpeg2 && !has_chroma_of_all_pixels(); }
    /// Its films can have alpha.
    constexpr bool has_alpha() const { return ffmpeg.pixels.starts_with("yuva"); }
    constexpr std::string_view usual_ending() const { return endings.substr(0, endings.find(' ')); }
};

constexpr CodecFacts master_facts(Codec codec, std::string_view word, std::string_view name, std::string_view ending,
                                  bool has_srgb, const LibraryNames& ffmpeg, int least_width = 16,
                                  int least_height = 16) {
    return {.codec = codec,
            .word = word,
            .name = name,
            .scale = "quantiser",
            .least_width = least_width,
            .least_height = least_height,
            .ffmpeg = ffmpeg,
            .endings = ending,
            .not_on = "browsers, phones, televisions",
            .master = true,
            .has_srgb = has_srgb};
}

/// In the order of their enumeration.
inline constexpr std::array all_codecs{
    CodecFacts{.codec = Codec::mpeg2,
               .word = "mpeg2",
               .name = "MPEG-2",
               .scale = "quantiser",
               .coarsest = 31,
               .most_b_pictures = 3,
               .at_1 = 0,
               .ffmpeg = {"mpeg2video", "mpeg2video", "", "", "", "yuv420p", "FFmpeg", ""},
               .endings = ".mpg .mpeg .vob .ts .m2v .mkv .mp4 .mov",
               .not_on = "browsers, phones",
               .has_srgb = false,
               .takes_blocks = true,
               .tells_blocks = true},
    CodecFacts{.codec = Codec::h264,
               .word = "h264",
               .name = "H.264",
               .scale = "QP",
               .coarsest = 51,
               .most_b_pictures = 3,
               .at_1 = 14.9,
               .by_doubling = 5.7,
               .offsets = {2, 1},
               .ffmpeg = {"h264", "libx264", "slow", "veryfast", "preset", "yuv420p", "FFmpeg with libx264", ""},
               .endings = ".mp4 .mkv .mov .ts",
               .takes_blocks = true,
               .tells_blocks = true},
    CodecFacts{.codec = Codec::hevc,
               .word = "hevc",
               .name = "HEVC",
               .scale = "QP",
               .coarsest = 51,
               .most_b_pictures = 3,
               .at_1 = 15.6,
               .by_doubling = 5.4,
               .offsets = {2, 1},
               .ffmpeg = {"hevc", "libx265", "slow", "veryfast", "preset", "yuv420p10", "FFmpeg with libx265", "hvc1"},
               .endings = ".mp4 .mkv .mov .ts",
               .not_on = "most browsers, devices from before 2016",
               .takes_blocks = true},
    CodecFacts{.codec = Codec::av1,
               .word = "av1",
               .name = "AV1",
               .scale = "QP",
               .coarsest = 63,
               .least_width = 64,
               .least_height = 64,
               .at_1 = 9.6,
               .by_doubling = 11,
               .ffmpeg = {"av1", "libsvtav1", "6", "10", "preset", "yuv420p10", "FFmpeg with libsvtav1", ""},
               .endings = ".mp4 .mkv .webm",
               .not_on = "phones and televisions from before 2021, most editors",
               .adds_grain = true},
    CodecFacts{.codec = Codec::vp9,
               .word = "vp9",
               .name = "VP9",
               .scale = "QP",
               .coarsest = 63,
               .at_1 = 0,
               .by_doubling = 11.3,
               .ffmpeg = {"vp9", "libvpx-vp9", "2", "5", "cpu-used", "yuva420p", "FFmpeg with libvpx", ""},
               .endings = ".webm .mkv",
               .not_on = "most editors, televisions; its alpha: Safari"},
    master_facts(Codec::prores, "prores", "ProRes", ".mov", false,
                 {"prores", "prores_ks", "hq", "hq", "profile", "yuv422p10", "FFmpeg", "apch"}),
    master_facts(Codec::prores_422, "prores_422", "ProRes 422", ".mov", false,
                 {"prores", "prores_ks", "standard", "standard", "profile", "yuv422p10", "FFmpeg", "apcn"}),
    master_facts(Codec::prores_lt, "prores_lt", "ProRes 422 LT", ".mov", false,
                 {"prores", "prores_ks", "lt", "lt", "profile", "yuv422p10", "FFmpeg", "apcs"}),
    master_facts(Codec::prores_proxy, "prores_proxy", "ProRes 422 Proxy", ".mov", false,
                 {"prores", "prores_ks", "proxy", "proxy", "profile", "yuv422p10", "FFmpeg", "apco"}),
    master_facts(Codec::prores4444, "prores4444", "ProRes 4444", ".mov", false,
                 {"prores", "prores_ks", "4444", "4444", "profile", "yuva444p10", "FFmpeg", "ap4h"}),
    master_facts(Codec::prores4444xq, "prores4444xq", "ProRes 4444 XQ", ".mov", false,
                 {"prores", "prores_ks", "4444xq", "4444xq", "profile", "yuva444p10", "FFmpeg", "ap4x"}),
    master_facts(Codec::dnxhr, "dnxhr", "DNxHR", ".mov", true,
                 {"dnxhd", "dnxhd", "dnxhr_hqx", "dnxhr_hqx", "profile", "yuv422p10", "FFmpeg", "AVdh"}, 256, 120),
    master_facts(Codec::ffv1, "ffv1", "FFV1", ".mkv", true,
                 {"ffv1", "ffv1", "3", "3", "level", "yuv444p12", "FFmpeg", ""}),
    master_facts(Codec::h264_lossless, "h264_lossless", "H.264 lossless", ".mp4 .mov .mkv", true,
                 {"h264", "libx264", "medium", "veryfast", "preset", "yuv444p", "FFmpeg with libx264", ""}),
    CodecFacts{.codec = Codec::gif,
               .word = "gif",
               .name = "GIF",
               .scale = "quantiser",
               .least_width = 1,
               .least_height = 1,
               .ffmpeg = {"gif", "gif", "", "", "", "yuva444p", "FFmpeg", ""},
               .endings = ".gif",
               .not_on = "televisions, editors",
               .master = true}};

constexpr const CodecFacts& facts_of(Codec codec) {
    return all_codecs[static_cast<std::size_t>(codec)];
}

/// ISO of the grain that pictures have before they are coded.
constexpr int grain_of_pictures(const Settings& settings) {
    return facts_of(settings.codec).adds_grain ? 0 : settings.grain;
}

/// Whether B picture `index`, from 0, of a run of `length` is the one in the middle.
constexpr bool is_middle(std::int64_t index, std::int64_t length) {
    return length > 1 && index == length / 2;
}

/// The distance of two levels of a predicted macroblock's coefficient in an orthonormal transform, code values, with
/// the least weight of a matrix.
double step_of(Codec codec, double quantiser);
/// The base_q_idx of AV1 and VP9, not rounded, that has this step.
double av1_index_of(double step);

/// The quantiser of a codec, not rounded, for about the PSNR of MPEG-2's `quantiser`, > 0.
double quantiser_like(Codec codec, double mpeg2_quantiser);
/// The inverse: MPEG-2's equivalent of a codec's quantiser, not rounded; below 1 where MPEG-2 has none as fine.
double mpeg2_quantiser_like(Codec codec, double quantiser);

/// The number of sRGB's curve in a codec's table; where that lacks it BT.709's, shown alike or by a television's curve.
constexpr int transfer_number(Codec codec) {
    return facts_of(codec).has_srgb ? 13 : 1;
}

/// End code after the last picture of a film; empty where a codec has none.
std::vector<std::uint8_t> end_of_stream(Codec codec);

}  // namespace render2mpeg::encoder
