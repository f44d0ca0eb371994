#pragma once

#include <cstdint>
#include <vector>

#include "core/motion_field.h"
#include "encoder/encoder.h"
#include "encoder/mpeg2/frame.h"
#include "encoder/mpeg2/levels.h"
#include "encoder/mpeg2/vector.h"

namespace render2mpeg::encoder::mpeg2 {

/// What a picture is coded from.
struct PictureTask {
    const Frame& source;
    const Frame* reference;               ///< null for an intra picture
    const core::MotionField* motion;      ///< to `reference`; null: none known
    const core::Plane<Vector>* previous;  ///< vectors of the picture before; null: none
    int lines;                            ///< of the picture as displayed
    int temporal_reference;
    int quantiser;
};

struct PictureResult {
    std::vector<std::uint8_t> bytes;  ///< picture header and slices
    Frame reconstruction;
    core::Plane<MacroblockRecord> records;
    core::Plane<Vector> vectors;  ///< those of inter macroblocks, zero elsewhere; empty for an intra picture
    std::uint64_t evaluations = 0;
};

/// Codes one picture, rows in parallel; the bytes do not depend on the number of threads.
PictureResult code_picture(const PictureTask& task, const Level& level);

}  // namespace render2mpeg::encoder::mpeg2
