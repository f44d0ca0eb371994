#pragma once
// Looks at pictures to come where nobody knows their motion: cuts, runs of B pictures, rough motion.
#include <cstdint>
#include <memory>
#include <optional>

#include "core/motion_field.h"
#include "core/picture.h"

namespace render2mpeg::encoder {

/// Look-ahead analysis for a caller that has nothing but pictures. Works at half the pictures' size, in blocks of
/// 16x16 there, by a sparse search. All results depend on the pictures alone.
class LookAhead {
  public:
    /// Number of following pictures on which the result for a picture depends; all of them must be there unless no
    /// more follow.
    static constexpr std::int64_t depth = 9;

    /// Size of the pictures; most B pictures in a row, 0..3.
    LookAhead(int width, int height, int b_pictures);
    ~LookAhead();

    /// The next picture in display order. After forget_before() has left none, numbers may begin anywhere.
    void add(const core::Picture& picture);
    /// No picture follows.
    void end();
    /// Pictures before this one are no longer asked for.
    void forget_before(std::int64_t number);

    /// Whether the picture shows nothing of the one before, and is not a flash. False where that is not there.
    bool cut_before(std::int64_t number);
    /// Pictures that follow before the next cut or the end; none where neither is seen.
    std::optional<std::int64_t> frames_left(std::int64_t number);
    /// Whether light changes along motion from the I or P picture `reference` on, so that one B picture should stand
    /// alone: the mean of two references is right in the middle between them alone.
    bool light_changes(std::int64_t reference, std::int64_t last);
    /// How many B pictures should follow the I or P picture `reference` where a P picture or none comes at last at
    /// `last` > `reference`.
    int b_pictures(std::int64_t reference, std::int64_t last);
    /// Motion between two pictures that are there, at most four apart.
    core::MotionField motion(std::int64_t picture, std::int64_t reference);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace render2mpeg::encoder
