#pragma once
// Reads how the pictures of a film are coded.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/frame_packing.h"
#include "core/rational.h"
#include "encoder/types.h"

/// Tells how a film is coded: its stream and each picture, whoever made it.
namespace render2mpeg::av {

/// Facts about the video stream of a film file.
struct StreamFacts {
    encoder::Codec codec = encoder::Codec::mpeg2;
    std::string container;              ///< libavformat's long name
    int streams = 0;                    ///< in the container, this one included
    std::string profile;                ///< "Main", or empty where the stream says none that is known
    std::string level;                  ///< "Main", "High-1440", "3.1", ..., or empty likewise
    int width = 0, height = 0;          ///< pixels
    core::Rational rate{0, 1};          ///< pictures per second as declared; 0: not said
    core::Rational pixel_aspect{0, 1};  ///< width by height of a pixel; 0: not said
    int color_primaries = 0;            ///< as declared: 1 BT.709, ...; 0: not said
    int matrix_coefficients = 0;        ///< as declared: 1 BT.709, 5 and 6 BT.601, 9 BT.2020; 0: not said
    int transfer_characteristics = 0;   ///< as declared: 1 and 6 BT.709's curve, 13 sRGB's, 16 PQ, 18 HLG; 0: not said
    double peak = 0;         ///< cd/m^2 of the display that it is made for, as the container says; 0: not said
    core::LightLevel light;  ///< likewise
    std::optional<encoder::SphereBounds> sphere;            ///< its pictures are panoramas, as the container says
    core::FramePacking packing = core::FramePacking::none;  ///< for two eyes, likewise
    std::string title, timecode;                            ///< UTF-8, as the container, or MPEG-2, says; empty: none
    int chapters = 0;                                       ///< likewise
    std::int64_t bit_rate = 0;                              ///< as declared, bits per second; 0: not said
    std::int64_t buffer_bits = 0;                           ///< of the decoder's buffer as declared; 0: not said
};

/// Vectors of one picture in one direction of time.
struct VectorFacts {
    double share = 0;    ///< of all macroblocks, how many are predicted from there
    double moving = 0;   ///< of all macroblocks, how many have a vector that is not zero
    double mean = 0;     ///< length of the vectors of these, pixels
    double longest = 0;  ///< pixels
};

/// One picture as it was coded. Two fields that make a frame are one picture.
struct PictureFacts {
    std::int64_t number = 0;     ///< in display order, from 0
    std::int64_t coded = 0;      ///< place in the stream's order, from 0
    char type = '?';             ///< I, P or B
    bool random_access = false;  ///< decoding can begin here: a sequence or GOP header with an I picture
    bool interlaced = false;
    bool top_field_first = false;
    int repeated_fields = 0;     ///< fields shown beyond two
    std::int64_t bytes = 0;      ///< of the picture with the headers before it
    std::int64_t position = -1;  ///< of its first byte in the file; -1: not known
    /// Over macroblocks: QP, or in MPEG-2 halves of quantiser_scale, which is quantiser_scale_code where it is linear.
    /// 0: the decoder does not tell.
    double mean_quantiser = 0;
    double min_quantiser = 0, max_quantiser = 0;
    double intra = 0;  ///< share of macroblocks without prediction, 0..1
    VectorFacts forward, backward;
    std::string damage;  ///< description of damage; empty: none
};

/// Result of reading a film.
struct Inspection {
    StreamFacts stream;
    std::vector<PictureFacts> pictures;  ///< in display order
    std::int64_t unshown =
        0;  ///< coded pictures that libavcodec does not show: broken, or what they refer to is not there
    std::vector<std::string> damage;  ///< of the stream or its container, where it belongs to no picture shown
};

/// Reads the first video stream of a film with libavcodec and tells how its pictures are coded. Damage is told, not
/// thrown: what can be decoded is. Throws core::Error for a file that cannot be opened or has no video of a codec that
/// films are made with. Of HEVC and AV1 libavcodec tells no quantisers.
Inspection inspect(const std::filesystem::path& file);

}  // namespace render2mpeg::av
