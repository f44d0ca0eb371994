#pragma once
// The encoder: plans and codes one picture after the other into an MPEG-2 stream.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/motion_field.h"
#include "core/picture.h"
#include "encoder/types.h"

/// The encoder: pictures in display order become coded pictures in coding order.
namespace render2mpeg::encoder {

/// Throws core::Error, naming the limit, where no level of Main Profile allows size and rates, or where even pictures
/// without any detail would not fit the rate.
void check(const Settings& settings);

/// Throws as check() does.
Declaration declaration_of(const Settings& settings);

/// Codes pictures, which come in display order, and gives them in coding order. Exact motion comes first; it searches
/// where that is not good enough.
///
/// Bytes do not depend on the number of threads nor on earlier chunks: only on what was planned and pushed since the
/// last chunk of promised length (PictureFacts::left_in_chunk) began and, where there is a bit rate, on how calls of
/// plan() and push() alternated. Without a promised length they depend on everything since the first such chunk.
class Encoder {
  public:
    /// Throws as check() does.
    explicit Encoder(const Settings& settings);
    ~Encoder();

    /// Decides type, references and quantiser of the next picture in display order; it may run ahead of push(), over
    /// the ends of chunks too. `first_of_chunk` starts a GOP. Numbers follow one another; a chunk may begin anywhere
    /// else once all that was planned is pushed, and then begins as if it were the first.
    /// A cut or keyframe begins a GOP only where the rate affords an intra picture.
    /// Neither it nor a cut or keyframe may come among the pictures promised by an earlier `frames_left`.
    /// Throws core::Error where not even pictures without detail would fit a chunk of such a length: it is too short
    /// for its rate. check() made sure of chunks of whole GOPs.
    PicturePlan plan(std::int64_t number, const PictureFacts& facts, bool first_of_chunk);

    /// Codes the next of the planned pictures, as it was planned. `motion` has one field per reference of the plan, or
    /// is empty: then vectors come from predictors, zero and a search. Returns the pictures that became complete.
    std::vector<CodedPicture> push(const core::Picture& picture, const PicturePlan& plan,
                                   std::span<const core::MotionField> motion, const Hints& hints = {});

    /// The pictures still held back: none at the end of what was promised to plan(). Where a film ends early, the last
    /// of them becomes a P picture, and its plan says so; pictures planned beyond are forgotten, and only a chunk can
    /// follow.
    std::vector<CodedPicture> flush();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// sequence_end_code: ends the last picture of a film; without it libmpeg2 drops pictures.
std::vector<std::uint8_t> sequence_end();

}  // namespace render2mpeg::encoder
