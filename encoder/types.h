#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/frame_packing.h"
#include "core/motion_field.h"
#include "core/picture.h"
#include "core/rational.h"

/// The values that the encoder takes and gives; what is done with them is in encoder.h.
namespace render2mpeg::encoder {

enum class PictureType : std::uint8_t { intra = 1, predicted = 2, bidirectional = 3 };  ///< picture_coding_type

/// How a film is coded: by our own encoders of MPEG-2 and GIF, or by one of libavcodec's (encoder/av/coders.h).
enum class Codec : std::uint8_t {
    mpeg2,
    h264,
    hevc,
    av1,
    vp9,
    prores,
    prores_422,
    prores_lt,
    prores_proxy,
    prores4444,
    prores4444xq,
    dnxhr,
    ffv1,
    h264_lossless,
    gif
};

/// How much is tried: one prediction mode per macroblock in full, or several.
enum class Effort : std::uint8_t { fast, quality };

/// Weighting of errors: uniform, or by the eye's sensitivity to their frequency.
enum class Tune : std::uint8_t { psnr, perceptual };

/// How pictures, all of them progressive, are shown in time.
enum class Cadence : std::uint8_t {
    frames,    ///< each as a whole: progressive_sequence
    fields,    ///< each as two fields, upper lines first, as DVD players expect
    pulldown,  ///< as three and two fields in turn: four pictures last as long as five frames (encoder/cadence.h)
};

/// Rate control mode, which decides the quantisers of a film.
enum class RateMode : std::uint8_t {
    constant_quantiser,  ///< Settings::quantiser, coarser for B pictures
    constant_quality,    ///< RateControl::quality, by PictureFacts::quality_factor
    variable,            ///< RateControl::bit_rate on average, never above max_rate
    constant,            ///< bit_rate throughout, with stuffing where pictures need less
};

/// Rates and buffer. Whatever the mode, a stream never breaks the buffer that its headers declare [H262, annex C].
struct RateControl {
    RateMode mode = RateMode::constant_quantiser;
    double quality = 60;           ///< 0..100: 100 is quantiser 1 where nothing moves, 20 less doubles it
    std::int64_t bit_rate = 0;     ///< bits per second; `variable` and `constant` only
    std::int64_t max_rate = 0;     ///< bits per second; 0: what the level allows, or bit_rate where it is constant
    std::int64_t buffer_bits = 0;  ///< VBV size; 0: the largest that the level and vbv_delay can express
};

/// Part of the sphere about a viewer that equirectangular pictures show: shares of its sides, from 0, that are left
/// off. [SphericalVideo2]
struct SphereBounds {
    double left = 0, top = 0, right = 0, bottom = 0;

    bool operator==(const SphereBounds&) const = default;
};

/// Clock time of a picture (encoder/timecode.h). [SMPTE12]
struct Timecode {
    int hours = 0, minutes = 0, seconds = 0, frames = 0;
    /// At 29.97 and 59.94: each minute but every tenth lacks its first 2 or 4 numbers, so that clocks agree.
    bool drops = false;

    bool operator==(const Timecode&) const = default;
};

/// Part of a film that players can go to.
struct Chapter {
    std::int64_t first = 0, end = 1;  ///< pictures from the film's first one; `end` lies behind it
    std::string title;                ///< UTF-8
};

/// Words that are kept with a film.
struct Labels {
    std::string title;              ///< UTF-8; empty: none
    std::optional<Timecode> start;  ///< of the first picture; none: its number in MPEG-2, midnight in masters' .mov
    std::vector<Chapter> chapters = {};  ///< by `first`
};

/// Coding settings, constant over the film.
struct Settings {
    Codec codec = Codec::mpeg2;
    int width = 0;  ///< any size that a level allows; padded to whole macroblocks inside
    int height = 0;
    core::FrameRate rate;  ///< pictures per second; the header says cadence.h's declared_rate()
    Cadence cadence = Cadence::frames;
    std::int64_t first_number = 0;  ///< display number of the film's first picture, where the cadence begins
    int quantiser = 4;              ///< in the codec's scale (encoder/codec.h): quantiser_scale_code, QP, ...
    int gop = 15;                   ///< pictures from I picture to I picture, 1..100,000
    bool closed_gops = false;  ///< no GOP begins with B pictures that refer to the one before; MPEG-2 alone has any
    int b_pictures = 3;        ///< most B pictures in a row, 0..3
    Effort effort = Effort::quality;
    Tune tune = Tune::psnr;
    RateControl rate_control;
    core::Rational pixel_aspect{1, 1};  ///< width by height of a pixel
    int aspect_ratio_code = 1;  ///< MPEG-2's aspect_ratio_information [H262, table 6-3]; 1: square; 0: it has none such
    int matrix_coefficients = 1;  ///< [H262, table 6-9]; 1: BT.709, 6: BT.601; of libraries' codecs also 9: BT.2020
    int color_primaries = 1;      ///< [H262, table 6-7]; 1: BT.709's; of libraries' codecs also 9: BT.2020's
    /// [H262, table 6-8]; 1: BT.709's curve, 2: none that the table has. Of libraries' codecs also 13: sRGB's, 16: PQ,
    /// 18: HLG.
    int transfer_characteristics = 1;
    float peak = 0;          ///< cd/m^2 of the display that the film is made for, where its signals say so; 0: not said
    core::LightLevel light;  ///< of the whole film, where a container is told it
    std::optional<SphereBounds> sphere;  ///< the pictures are panoramas, which containers can say; none: flat ones
    core::FramePacking packing = core::FramePacking::none;  ///< likewise, and H.264 itself
    Labels labels;                                          ///< for containers; MPEG-2 itself counts by the timecode
    bool alpha = false;                                     ///< pictures have it (core::Picture::alpha)
    int grain = 0;       ///< ISO of film grain, 0 for none; decoders of AV1 add it, other pictures come with it
    int level = 0;       ///< ten times the level of a library's codec: 41 is 4.1; 0: the lowest that holds the pictures
    int references = 0;  ///< pictures that one may be predicted from in H.264; 0: as its level and effort have it
    std::string user_data;  ///< printable ASCII that stands behind every sequence header [H262, 6.2.2.2.2]; empty: none
};

/// Stream parameters declared in headers for these settings.
struct Declaration {
    std::string level;                ///< of Main Profile: "Main", "High-1440" or "High"
    std::int64_t bit_rate = 0;        ///< bits per second: the highest, or the constant one
    std::int64_t buffer_bits = 0;     ///< VBV size
    std::int64_t chunk_fullness = 0;  ///< bits in the VBV before a chunk's first picture is taken out of it
};

/// Allocation to a picture by a first, cheaper pass over the film (encoder/bit_allocation.h).
struct BitAllocation {
    double quantiser = 4;  ///< MPEG-2's 1..31, not rounded; in other codecs its equivalent for P pictures
    double bits = 0;       ///< that the picture should take with it
    double bits_left = 0;  ///< sum of `bits` over this picture and all that follow it in its chunk, in display order
    /// The picture's type in the first pass. If it has another type now, its quantiser is adapted. None: the same type.
    std::optional<PictureType> type = {};
    /// Bits that there are, divided by bits allocated. 1, unless even quantiser 1 needs fewer bits, or 31 more. The
    /// same for all chunks that share their bits.
    double affordable = 1;
    /// FirstPassPicture::ratio. If another number of pictures depends on this one now, its quantiser is adapted.
    std::optional<double> ratio = {};
    /// `bits_left` of I, P and B pictures apart: the real pictures of each type differ from the first pass by a factor
    /// of their own. All 0: not known.
    std::array<double, 3> left_by_type = {};
};

/// Cost of one picture in the first pass.
struct FirstPassPicture {
    std::int64_t number = 0;  ///< display number
    PictureType type = PictureType::intra;
    double quantiser = 1;  ///< in other codecs MPEG-2's equivalent of the film's
    double bits = 0;
    bool starts_chunk = false;
    /// Its quantiser, before rounding, divided by that of a P picture that nothing refers to. None: the usual ratio of
    /// its type.
    std::optional<double> ratio = {};
};

/// The renderer's knowledge of a picture before lighting.
struct PictureFacts {
    bool cut_before = false;  ///< this picture shows nothing of the picture before
    /// Pictures, 0 or more, that follow this one before a cut, a keyframe or the chunk's end. B pictures are planned
    /// only among these, since they refer to a later picture: so many as a run may have must be certain. If the number
    /// is exact, all runs of B pictures have about the same length, and quantisers know how many pictures depend on
    /// one.
    std::int64_t frames_left = 0;
    bool keyframe = false;  ///< a closed GOP begins here, whatever the picture shows
    /// Pictures that follow this one in its chunk, promised with the chunk's first picture; the promise must be kept.
    /// Every chunk then begins with Declaration::chunk_fullness and leaves as much to the next one. None: the VBV goes
    /// on over the chunk's end.
    std::optional<std::int64_t> left_in_chunk = {};
    bool last_chunk = false;  ///< no chunk follows: the fullness at its end is free
    /// Factor of the quantiser, finite and above 0, that brings this picture to the film's quality. Only
    /// `constant_quality` reads it. None: 1.
    std::optional<double> quality_factor = {};
    /// Non-uniformity of the motion from the picture before (encoder/motion_nonuniformity.h). The larger, the fewer B
    /// pictures are planned in a row. None: Settings::b_pictures.
    std::optional<double> motion_nonuniformity = {};
    /// Code values per picture by which the light of places as large as a macroblock changes along motion, mean over
    /// the picture, as the pictures before tell. B pictures show the mean of their references: the larger,
    /// the fewer are planned in a row. None: 0.
    std::optional<double> light_change = {};
    /// B pictures, 0 or more, that should stand between the I or P picture before this one and the next one
    /// (encoder/look_ahead.h); only the first of them needs it. None: as the motion says.
    std::optional<int> b_pictures = {};
    std::optional<BitAllocation> allocation = {};  ///< none: one pass
    /// Pictures of this chunk's beginning, roughly coded: initial values of one pass in place of a guess.
    /// Only those of its first picture are read.
    std::vector<FirstPassPicture> trial = {};
};

/// How a picture will be coded: fixed before it is lit.
struct PicturePlan {
    std::int64_t number = 0;  ///< display number
    PictureType type = PictureType::intra;
    bool starts_gop = true;
    /// Display numbers, in the order of the motion that `push` wants: none, the earlier one, or the earlier and the
    /// later.
    std::vector<std::int64_t> references;
    /// The last picture that depends on this one, directly or not, where motion to it helps `push` (Hints::onward).
    std::optional<std::int64_t> horizon;
    int quantiser = 4;  ///< to render for; the one really used is CodedPicture::quantiser
    /// Of its steps to those of its quantiser, where a codec varies them by itself.
    float step_ratio = 1;

    bool operator==(const PicturePlan&) const = default;
};

/// How a macroblock is to be coded.
enum class Force : std::uint8_t {
    none,   ///< as the encoder finds best
    intra,  ///< predicted from nothing
    skip,   ///< skipped where MPEG-2 allows it: not in I pictures, nor at a row's ends, nor, in B pictures, after an
            ///< intra macroblock or where the vectors of the macroblock before lead out of the picture
};

/// Optional hints for coding a picture, besides its motion. Maps have an entry per macroblock of the displayed picture,
/// (width + 15) / 16 by (height + 15) / 16; they are ignored where the VBV has room for next to nothing.
struct Hints {
    /// Motion to the plan's horizon: macroblocks that are static until then get finer quantisers. Null: not known.
    const core::MotionField* onward = nullptr;
    /// Innovation over the picture before, by macroblock (encoder/innovation.h): the larger it is, the less `onward`
    /// refines the quantiser. Null: not known, taken for 0.
    const core::Plane<float>* innovation = nullptr;
    /// Octaves by which each macroblock's contrast raises the error that stays unseen, finite and 0 or more: 0 where it
    /// hides nothing, 1 where it hides twice as much. Quantisers follow it, in all codecs that have any by macroblock.
    /// Null: they do not.
    const core::Plane<float>* hidden = nullptr;
    /// Factors of each macroblock's quantiser, finite and above 0, before it is rounded into 1..31: below 1 where a
    /// viewer looks, say. Null: 1.
    const core::Plane<float>* quantiser_factors = nullptr;
    const core::Plane<Force>* forced = nullptr;  ///< null: none
};

/// Coding result of one macroblock.
struct MacroblockRecord {
    bool intra = false;
    bool skipped = false;
    std::uint8_t quantiser = 0;               ///< in force, in the codec's scale
    std::int16_t motion_x = 0, motion_y = 0;  ///< forward, half pixels
    std::uint32_t bits = 0;
    bool forward = false, backward = false;       ///< which references it is predicted from
    std::int16_t backward_x = 0, backward_y = 0;  ///< half pixels
};

/// Where a vector comes from: the caller's motion; neighbours, the picture before and zero; a search.
enum class VectorSource : std::uint8_t { exact, predicted, searched };

/// A number for each of these; half-pel neighbours count with their centre.
struct BySource {
    std::uint64_t exact = 0, predicted = 0, searched = 0;

    std::uint64_t& of(VectorSource source) {
        return source == VectorSource::exact ? exact : source == VectorSource::predicted ? predicted : searched;
    }
    std::uint64_t all() const { return exact + predicted + searched; }
    void operator+=(const BySource& other) {
        exact += other.exact;
        predicted += other.predicted;
        searched += other.searched;
    }
};

/// Work of choosing a picture's vectors, over all directions and macroblocks. Effort::fast counts nothing by source.
struct MotionWork {
    BySource evaluations;        ///< 16x16 Hadamard differences of vectors
    BySource chosen;             ///< the cheapest vector of a macroblock and direction, before modes are decided
    std::uint64_t searches = 0;  ///< 16x16 sums of absolute differences of the search

    void operator+=(const MotionWork& other) {
        evaluations += other.evaluations;
        chosen += other.chosen;
        searches += other.searches;
    }
};

struct CodedPicture {
    PicturePlan plan;
    int quantiser = 4;  ///< of the slices' headers; seldom more than one step from the plan's
    std::int64_t coding_order = 0;
    std::vector<std::uint8_t> bytes;  ///< whole access unit: sequence and GOP headers where they stand before it
    core::Picture reconstruction;     ///< decoded picture, cropped to the display size
    core::Plane<MacroblockRecord> macroblocks;
    bool tells_vectors = true;  ///< `macroblocks` say how each was predicted; else only its quantiser and mode
    std::uint64_t block_evaluations = 0;  ///< 16x16 differences computed to choose motion and modes, in all tries
    MotionWork motion;                    ///< part of these, in the last try
    int tries = 1;                        ///< codings until it fitted the buffer
    bool minimal = false;                 ///< not even the coarsest quantiser fitted: nothing but flat blocks, or skips
    std::uint64_t stuffing_bytes = 0;     ///< zeros in `bytes` that keep the buffer from running over
    std::int64_t fullness_before = 0;  ///< bits in the decoder's buffer when the picture is taken out, itself included
    std::int64_t fullness_after = 0;   ///< bits left then
    std::int64_t fullness_next = 0;    ///< bits there when the next picture is taken out
};

}  // namespace render2mpeg::encoder
