#pragma once

#include <cstdint>
#include <vector>

#include "encoder/types.h"

/// Capabilities of this encoder, for programs that have to choose settings. Queries cost nothing.
namespace render2mpeg::encoder {

/// Limits of a level of Main Profile. [H262, tables 8-11 to 8-14]
struct LevelLimits {
    const char* name;          ///< "Main", "High-1440", "High"
    int indication;            ///< level_identification in the sequence extension
    int width, height;         ///< largest picture
    int hertz;                 ///< highest declared rate
    std::int64_t samples;      ///< luma samples per second, of whole macroblocks
    std::int64_t bit_rate;     ///< bits per second
    std::int64_t buffer_bits;  ///< VBV size
    int vector_x, vector_y;    ///< motion reaches from minus this to just below it, in pixels
};

struct Capabilities {
    const char* profile;              ///< "Main": 4:2:0, 8 bits, progressive frame pictures
    std::vector<LevelLimits> levels;  ///< ascending
    int quantiser_min, quantiser_max;
    int most_b_pictures;         ///< in a row
    int fields_per_picture;      ///< motion fields that push() takes: one per reference
    int candidates;              ///< different vectors taken from a macroblock's motion, per reference
    int most_block_evaluations;  ///< 16x16 differences per macroblock, at the greatest effort
    double vector_step;          ///< to what motion is rounded, pixels
    bool quantiser_factors;      ///< per macroblock: Hints::quantiser_factors
    bool forced_macroblocks;     ///< Hints::forced
    bool interlaced;             ///< field pictures or field prediction
    std::vector<Effort> efforts;
    std::vector<Tune> tunes;
    std::vector<Cadence> cadences;
    std::vector<RateMode> rate_modes;
};
Capabilities capabilities();

/// The level that a stream of these settings declares: the lowest that allows them. Throws core::Error as check() does.
LevelLimits level_of(const Settings& settings);

}  // namespace render2mpeg::encoder
