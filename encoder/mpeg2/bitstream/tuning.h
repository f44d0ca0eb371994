#pragma once

#include <cstdint>

/// The encoder's free constants, in units of the quantiser_scale_code q, whose step is 2q for a matrix entry of 16. All
/// were chosen by the mean BD-rate over the clips of bench/encoder_rd (1280x720, quantisers 2, 4, 8, 16); what
/// was tried is in docs/measurements.md#encoder.
namespace render2mpeg::encoder::mpeg2 {

/// Quantiser of B pictures over that of others. Nothing refers to them.
/// chosen: 1.5 of 1.25 to 1.75.
inline constexpr double quantiser_ratio_bidirectional = 1.5;

/// How far vectors of a macroblock hold: the motion's non-uniformity (encoder/motion_nonuniformity.h) times the
/// distance of P pictures, in pixels. chosen: 1.8, which takes the best of distances 2 to 4 for each clip.
inline constexpr double nonuniform_reach = 1.8;

/// Light that changes by more than this has one B picture between two others: code values per picture. chosen: 0.25: a
/// lamp that crosses a room has 1, ordinary films less than 0.2.
inline constexpr double steady_light = 0.25;

/// Weight of an error of a block's mean in P and B pictures: that of luma as a whole is seen to step.
/// chosen: 4 of 1 to 6.
inline constexpr float mean_weight = 4;

/// Exponent of the quantisers of I and P pictures: (1 + n)^-propagation_strength where n pictures depend on one.
/// chosen: 0.08 of 0 to 0.1.
inline constexpr double propagation_strength = 0.08;

/// More pictures than these that depend on one make it no finer.
/// chosen: 24; without a limit GOPs of 60 begin with quantiser 1 where 2 was asked for.
inline constexpr std::int64_t most_followers = 24;

/// Exponent of a macroblock's quantiser by the pictures that inherit its quality (macroblock_tree.h).
/// chosen: 0.26 of 0.16 to 0.33.
inline constexpr double inheritance_strength = 0.26;

/// Share of a macroblock's quality that is left after prediction between pixels. chosen: 0.5 of 0.5 to 1.
inline constexpr double kept_by_interpolation = 0.5;

/// Mean squared innovation of which quantisation leaves out half, in q^2. chosen: 3 of 0.1 to 10.
inline constexpr double unseen_innovation = 3;

/// Lagrangian of modes and levels in predicted pictures: squared code values per bit = lambda_predicted * q^2.
/// chosen: 1 of 0.7 to 1.2. (High-rate theory gives 0.46.)
inline constexpr float lambda_predicted = 1.0f;

/// The same in intra pictures: smaller, since every picture of the GOP inherits what they spend.
/// chosen: 0.35 of 0.2 to 0.85.
inline constexpr float lambda_intra = 0.35f;

/// The same in B pictures, with their own, coarser q.
/// chosen: 0.85 of 0.6 to 0.9.
inline constexpr float lambda_bidirectional = 0.85f;

/// Lagrangian of the choice of vectors: Hadamard sum (Kernels::satd_16x16) per bit = lambda_motion * q.
/// chosen: 3.5 of 1 to 4.5.
inline constexpr float lambda_motion = 3.5f;

/// Vectors whose cost is within this factor of the best, at most BestVectors::most, are tried in full.
/// chosen: 1.1 of 1.05 to 1.2, with at most three vectors.
inline constexpr float shortlist_reach = 1.1f;

/// Weight of a macroblock's cost to go (CostToGo) in B pictures, where the next one may use only one direction.
/// chosen: 0.5 of 0.25 to 1.
inline constexpr float cost_to_go_bidirectional = 0.5f;

/// Effort::fast tries no more vectors for a macroblock whose Hadamard sum is at most this times q.
/// chosen: 300 of 200 to 640: time against bits.
inline constexpr int enough_fast = 300;

/// Whole pixels to each side of the best vector so far that are searched (motion_search.h); multiples of 4.
/// chosen: 16 of 8 to 24 for Effort::quality, 8 of 0 to 24 for Effort::fast: time against bits.
inline constexpr int search_reach = 16, search_reach_fast = 8;

/// Nothing is searched for a macroblock where a Hadamard sum is at most this times q.
/// chosen: 400 of 0 to 800: time against bits.
inline constexpr int good_enough = 400;

/// Effort::fast skips a macroblock at once if that leaves a squared error of at most this times q^2.
/// chosen: 30 of 20 to 40: time against bits.
inline constexpr float skip_fast = 30;

/// Effort::fast leaves out blocks of an inter macroblock whose squared error is below this times the smallest step's
/// square; below 1 none of its coefficients reaches a step.
/// chosen: 2 of 1.5 to 6: time against bits.
inline constexpr float energy_fast = 2;

/// Effort::fast tries intra only where inter coding costs at least this number of bits.
/// chosen: 100 of 29 (the least that intra can take) to 100: time against bits.
inline constexpr int intra_bits_fast = 100;

/// Intra is tried where the block's activity is below this multiple of the residual's Hadamard sum.
/// chosen: 1.5; intra coding hardly ever wins above.
inline constexpr float intra_activity_limit = 1.5f;

}  // namespace render2mpeg::encoder::mpeg2
