#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/motion_field.h"
#include "core/picture.h"
#include "core/rational.h"

namespace render2mpeg::encoder {

enum class PictureType : std::uint8_t { intra = 1, predicted = 2, bidirectional = 3 };  ///< picture_coding_type

/// How much is tried. `fast`: one movement per macroblock in full, levels one by one. `quality`: several movements,
/// levels of a whole block at once.
enum class Effort : std::uint8_t { fast, quality };

/// How pictures, all of them progressive, are shown in time.
enum class Cadence : std::uint8_t {
    frames,    ///< each as a whole: progressive_sequence
    fields,    ///< each as two fields, upper lines first: what a DVD's players expect
    pulldown,  ///< as three and two fields in turn: four pictures last as long as five frames (encoder/cadence.h)
};

/// What a film is coded with; constant over the film.
struct Settings {
    int width = 0;  ///< any size that a level allows; padded to whole macroblocks inside
    int height = 0;
    core::FrameRate rate;  ///< pictures per second; the header says cadence.h's declared_rate()
    Cadence cadence = Cadence::frames;
    std::int64_t first_number = 0;  ///< display number of the film's first picture, where the cadence begins
    int quantiser = 4;              ///< quantiser_scale_code 1..31, q_scale_type 0
    int gop = 15;                   ///< pictures per closed GOP, >= 1
    int b_pictures = 2;             ///< most B pictures in a row, 0..3
    Effort effort = Effort::quality;
    int aspect_ratio_code = 1;    ///< aspect_ratio_information [H262, table 6-3]; 1: square pixels
    int matrix_coefficients = 1;  ///< [H262, table 6-9]; 1: BT.709, 6: BT.601
};

/// Throws core::Error, naming the limit, where no level of Main Profile allows size and rate.
void check(const Settings& settings);

/// What the renderer knows of a picture before anything is lit.
struct PictureFacts {
    bool cut_before = false;  ///< nothing of the picture before is seen in this one
    /// How many pictures certainly follow this one before a cut, a keyframe or the chunk's end; a few are enough
    /// (Settings::b_pictures says how many matter). Only among those are B pictures planned, since they refer to a
    /// later one.
    std::int64_t frames_left = 0;
    bool keyframe = false;  ///< a GOP is to begin here, whatever is seen
};

/// How a picture will be coded: fixed before it is lit.
struct PicturePlan {
    std::int64_t number = 0;  ///< display number
    PictureType type = PictureType::intra;
    bool starts_gop = true;
    /// Display numbers, in the order of the motion that `push` wants: none, the earlier one, or the earlier and the
    /// later.
    std::vector<std::int64_t> references;
    int quantiser = 4;
};

/// What became of one macroblock.
struct MacroblockRecord {
    bool intra = false;
    bool skipped = false;
    std::uint8_t quantiser = 0;               ///< quantiser_scale_code in force
    std::int16_t motion_x = 0, motion_y = 0;  ///< forward, half pixels
    std::uint32_t bits = 0;
    bool forward = false, backward = false;       ///< which references it is predicted from
    std::int16_t backward_x = 0, backward_y = 0;  ///< half pixels
};

struct CodedPicture {
    PicturePlan plan;
    std::int64_t coding_order = 0;
    std::vector<std::uint8_t> bytes;  ///< whole access unit: sequence and GOP headers where they stand before it
    core::Picture reconstruction;     ///< what a decoder shows: cropped to the display size
    core::Plane<MacroblockRecord> macroblocks;
    std::uint64_t block_evaluations = 0;  ///< 16x16 differences computed to choose motion
    bool exceeds_level = false;  ///< a decoder whose buffer has the level's size and fills at its rate starves here
};

/// Pictures in display order to coded pictures in coding order. Neither searches for motion nor looks at other films'
/// pictures: bytes are a function of what was pushed since the last GOP began.
class Encoder {
  public:
    explicit Encoder(const Settings& settings);
    ~Encoder();

    /// Decides type, references and quantiser of the next picture in display order. `first_of_chunk` starts a GOP.
    /// Neither it nor a cut or keyframe may come among the pictures promised by an earlier `frames_left`.
    PicturePlan plan(std::int64_t number, const PictureFacts& facts, bool first_of_chunk);

    /// Codes a picture that was planned. `motion` has one field per reference of the plan, or is empty: then only
    /// predictors and zero are tried. Returns the pictures that became complete.
    std::vector<CodedPicture> push(const core::Picture& picture, const PicturePlan& plan,
                                   std::span<const core::MotionField> motion);

    /// The pictures still held back: none at the end of what was promised to plan(). Where a film ends early, the last
    /// of them becomes a P picture, and its plan says so.
    std::vector<CodedPicture> flush();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// sequence_end_code: ends the last picture of a film; without it libmpeg2 drops pictures.
std::vector<std::uint8_t> sequence_end();

}  // namespace render2mpeg::encoder
