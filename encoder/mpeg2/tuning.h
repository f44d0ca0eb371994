#pragma once

/// The encoder's free constants, all in units of the quantiser_scale_code q, whose step is 2q for a matrix entry of 16.
namespace render2mpeg::encoder::mpeg2 {

/// Lagrangian of mode decision and quantisation: squared code values per bit = lambda_mode * q^2.
inline constexpr float lambda_mode = 0.85f;

/// Lagrangian of the choice of vectors: Hadamard sum (Kernels::satd_16x16) per bit = lambda_motion * q.
inline constexpr float lambda_motion = 2.0f;

}  // namespace render2mpeg::encoder::mpeg2
