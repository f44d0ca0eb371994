#pragma once
// How far quantisation can move a block's coefficients: the worst case of eq. 7.3.
#include "core/dct.h"

namespace render2mpeg::perceptual {

/// Quantiser of luma: steps of the orthonormal 8x8 DCT's coefficients in code values, [v * 8 + u] with u the horizontal
/// frequency.
struct Quantisation {
    core::Block8x8
        intra{};  ///< matrix of intra macroblocks, > 0: the steps at scale 1. [0] is not looked at: see dc_step
    core::Block8x8 inter{};  ///< matrix of all others, > 0, for the residual
    float dc_step = 8.0f;    ///< of the mean coefficient of intra blocks, whatever the scale
    /// Share of a step below which a coefficient vanishes: half where levels are rounded, more with a dead zone.
    float intra_dead_zone = 0.5f, inter_dead_zone = 1.0f;

    bool operator==(const Quantisation&) const = default;
};

/// How one block was or will be quantised.
struct BlockCoding {
    float scale = 1.0f;  ///< qs, the steps' factor, > 0
    bool intra = true;
    /// Residual coefficients after prediction, for inter blocks; null: not known, taken for 0.
    const core::Block8x8* residual = nullptr;
};

/// Largest error of each coefficient that coding does or hides, with the coefficient's sign (0 counts as positive), for
/// the block `c` with thresholds `m` [Render2MPEG, eq. 7.3] (docs/model/tolerance.md). Never 0.
core::Block8x8 worst_errors(const core::Block8x8& c, const core::Block8x8& m, const Quantisation& quantisation,
                            const BlockCoding& coding);

/// Error of a block's mean over that of its samples, RMS, of blocks that all but vanish: in (0, 1].
float share_of_mean(const Quantisation& quantisation, const BlockCoding& coding);

/// RMS over the block's 64 samples, since the transform keeps energy.
float root_mean_square(const core::Block8x8& errors);

}  // namespace render2mpeg::perceptual
