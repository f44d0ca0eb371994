#pragma once
// Codes a picture again, coarser, until it fits the buffer and the level.
#include <cstdint>

#include "encoder/mpeg2/picture/picture_coding.h"

/// Codes a picture again, coarser, until it has no more bits than the VBV allows.
namespace render2mpeg::encoder::mpeg2 {

/// Bits of a picture's header and slices.
std::int64_t bits_of(const PictureResult& picture);

struct Fitted {
    PictureResult picture;  ///< its evaluations are those of all tries
    int quantiser = 1;      ///< it was coded with
    int tries = 1;          ///< codings, the kept one included
    bool minimal = false;   ///< minimal_picture()
};

/// Codes a picture within `most_bits`: with the task's quantiser, else with coarser ones, then with ever less detail,
/// last as the minimal picture, which must fit. A function of the task and the limit alone.
Fitted code_within(const PictureTask& task, const Level& level, std::int64_t most_bits);

/// The later of two codings of a picture, with the tries and evaluations of both.
Fitted again(const Fitted& first, Fitted second);

}  // namespace render2mpeg::encoder::mpeg2
