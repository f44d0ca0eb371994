#pragma once
// Warps what is known of one picture to another along exact motion.
#include <cstdint>
#include <glm/glm.hpp>

#include "core/motion_field.h"
#include "core/plane.h"
#include "core/visible.h"

/// Warps values from one picture to another along motion.
namespace render2mpeg::perceptual {

/// What pixels of another picture have stands for `no_partner` where nobody there is the same surface point.
inline constexpr float no_partner = -1.0f;

/// Fetches a value, or two, for every pixel of `here` from where its point was in the picture that saw `there`: the
/// mean of the four nearest pixels by bilinear weights, of those that show the same thing there [Render2MPEG, 4.3]: the
/// same kind, object and material, and the same triangle or at least a like depth and normal
/// (docs/model/tolerance.md). `no_partner` where none does or the place lies outside the picture. A null `motion` means
/// that nothing moves. No value is negative. T: float or glm::vec2.
template <class T>
core::Plane<T> warp(const core::Plane<T>& values, const core::Visible& there, const core::Visible& here,
                    const core::MotionField* motion);

/// What each pixel of a picture has in common with the ones to its right, below and below to the right: most pixels
/// that are fetched need to know no more. Made once of a picture that is asked for several others.
struct Quads {
    core::Plane<std::uint32_t> triangle;   ///< a hash of the one that all four show; 0 where they differ
    core::Plane<std::uint32_t> surface;    ///< the same of their object, material and normal
    core::Plane<float> nearest, farthest;  ///< of the four
};
Quads quads_of(const core::Visible& picture);

/// The same with the quads of `there`.
template <class T>
core::Plane<T> warp(const core::Plane<T>& values, const core::Visible& there, const Quads& quads,
                    const core::Visible& here, const core::MotionField* motion);

}  // namespace render2mpeg::perceptual
