#pragma once

#include <cstdint>

/// The encoder's free constants, in units of the quantiser_scale_code q, whose step is 2q for a matrix entry of 16. All
/// were chosen by the mean BD-rate over the clips of tests/bench/encoder_rd (1280x720, quantisers 2, 4, 8, 16).
namespace render2mpeg::encoder::mpeg2 {

/// Quantiser of B pictures over that of others. Nothing refers to them.
/// chosen: 1.5; 1.25 loses 0.6 to 0.9 %.
inline constexpr double quantiser_ratio_bidirectional = 1.5;

/// How far vectors of a macroblock hold: unevenness (encoder/unevenness.h) times the distance of P pictures, in pixels.
/// chosen: 1.8. Films with an unevenness of 0.2 to 0.3 need 0.4 to 1.8 % fewer bits at a distance of 3 and 4 than of 3,
/// one with 1.1 4.0 % fewer at a distance of 2, and 2.4 % more at 3 and 4.
inline constexpr double uneven_reach = 1.8;

/// Exponent of the quantisers of I and P pictures: (1 + n)^-inheritance_strength where n pictures depend on one.
/// chosen: 0.08; with quantisers alike a slow walk needs 1.7 to 2 % more bits, others 0.3 to 0.5 %; 0.1 loses 0.5 % in
/// crowds and with fast cameras.
inline constexpr double inheritance_strength = 0.08;

/// More pictures than these that depend on one make it no finer.
/// chosen: 24; without, GOPs of 60 need 0.3 to 1.0 % more bits, and begin with quantiser 1 where 2 was asked for; 14
/// loses 0.1 %.
inline constexpr std::int64_t most_followers = 24;

/// Exponent of the quantiser of what later pictures copy unchanged (dependency.h).
/// chosen: 0.26, on a room with six moving spheres before a camera that stands still: 9.5 % fewer bits than 0; 0.2 and
/// 0.33 lose 0.3 %, 0.5 loses 5 %. Macroblocks that stand still by nine tenths lose 0.4 %, by six tenths 1.1 %. What
/// leaves the picture before then, coded more coarsely: loses 0.5 % on walks through it.
inline constexpr float dependency_strength = 0.26f;

/// Lagrangian of modes and levels in predicted pictures: squared code values per bit = lambda_predicted * q^2.
/// chosen: 0.85; 0.6 loses 0.3 %, 0.9 gains nothing. (High-rate theory gives 0.46.)
inline constexpr float lambda_predicted = 0.85f;

/// The same in intra pictures: smaller, since every picture of the GOP inherits what they spend.
/// chosen: 0.35; tried 0.2..0.85, which loses 0.3 %.
inline constexpr float lambda_intra = 0.35f;

/// The same in B pictures, with their own, coarser q.
/// chosen: 0.85; 0.6 loses 0.1 to 0.5 %, 0.9 gains nothing.
inline constexpr float lambda_bidirectional = 0.85f;

/// Lagrangian of the choice of vectors: Hadamard sum (Kernels::satd_16x16) per bit = lambda_motion * q.
/// chosen: 2.6; 1 loses 3 %, 2 and 4 lose 0.5 %.
inline constexpr float lambda_motion = 2.6f;

/// Vectors whose cost is within this factor of the best, at most VectorChoice::most, are tried in full.
/// chosen: 1.1; 1.05 loses 0.3 %, 1.2 gains nothing. One vector alone loses 1.5 %, two lose 0.7 %, and code a fifth
/// faster.
inline constexpr float shortlist_reach = 1.1f;

/// Effort::fast tries no more vectors for a macroblock whose Hadamard sum is at most this times q: coefficients of a
/// third of q on average, of which next to none reach the step of 2q.
/// chosen: 640; 512 and 384 save 0.3 and 0.6 % of the bits and take a fifteenth and an eighth longer.
inline constexpr int enough_fast = 640;

/// Effort::fast skips a macroblock at once if that leaves a squared error of at most this times q^2.
/// chosen: 30; 20 saves 0.1 % of the bits, 40 loses 0.1 to 0.4 % and gains 2 %.
inline constexpr float skip_fast = 30;

/// Effort::fast leaves out blocks of an inter macroblock whose squared error is below this times the smallest step's
/// square; below 1 none of its coefficients reaches a step.
/// chosen: 3; 2 saves up to 0.1 % of the bits, 4 and 6 lose up to 0.2 and 0.9 % and gain 2 and 5 %.
inline constexpr float energy_fast = 3;

/// Effort::fast tries intra only where inter coding comes to the cost of this many bits.
/// chosen: 100: a twelfth faster than 29, the least that intra can take, for 0.3 to 0.6 % more bits.
inline constexpr int intra_bits_fast = 100;

/// Intra is tried where the block's activity is below this multiple of the residual's Hadamard sum.
/// chosen: 1.5; intra coding hardly ever wins above.
inline constexpr float intra_activity_limit = 1.5f;

}  // namespace render2mpeg::encoder::mpeg2
