#pragma once
// The interface of all coders: what plans and codes one picture after the other.
#include <cstdint>
#include <span>
#include <vector>

#include "core/motion_field.h"
#include "core/picture.h"
#include "encoder/types.h"

namespace render2mpeg::encoder {

/// Codes pictures, which come in display order, and gives them in coding order. Types and quantisers are settled before
/// a picture is made; what became of it comes back with its bytes.
///
/// Bytes do not depend on the number of threads nor on earlier chunks: only on what was planned and pushed since the
/// last chunk of promised length (PictureFacts::left_in_chunk) began and, where there is a bit rate, on how calls of
/// plan() and push() alternated. Without a promised length they depend on everything since the first such chunk.
class Coder {
  public:
    virtual ~Coder() = default;

    /// Decides type, references and quantiser of the next picture in display order; it may run ahead of push(), over
    /// the ends of chunks too. `first_of_chunk` starts a GOP. Numbers follow one another; a chunk may begin anywhere
    /// else once all that was planned is pushed, and then begins as if it were the first.
    /// A cut or keyframe begins a GOP only where the rate affords an intra picture.
    /// Neither it nor a cut or keyframe may come among the pictures promised by an earlier `frames_left`.
    /// Throws core::Error where not even pictures without detail would fit a chunk of such a length: it is too short
    /// for its rate.
    virtual PicturePlan plan(std::int64_t number, const PictureFacts& facts, bool first_of_chunk) = 0;

    /// Codes the next of the planned pictures, as it was planned. `motion` has one field per reference of the plan, or
    /// is empty: then the coder looks for vectors by itself. Returns the pictures that became complete: a coder may
    /// hold some back.
    virtual std::vector<CodedPicture> push(const core::Picture& picture, const PicturePlan& plan,
                                           std::span<const core::MotionField> motion, const Hints& hints) = 0;
    std::vector<CodedPicture> push(const core::Picture& picture, const PicturePlan& plan,
                                   std::span<const core::MotionField> motion) {
        return push(picture, plan, motion, {});
    }

    /// The pictures still held back. Where a film ends early, the last of them becomes a P picture, and its plan says
    /// so; pictures planned beyond are forgotten, and only a chunk can follow.
    virtual std::vector<CodedPicture> flush() = 0;
};

}  // namespace render2mpeg::encoder
