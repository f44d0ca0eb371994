#pragma once
// Levels of H.264, HEVC and AV1: what decoders of a level hold.
#include <cstdint>
#include <string>

#include "encoder/types.h"

namespace render2mpeg::av {

/// What a stream of a level may be at most.
struct Level {
    int tenths;            ///< 41: level 4.1
    std::int64_t samples;  ///< luma samples of a picture
    std::int64_t rate;     ///< luma samples per second
    std::int64_t bits;     ///< bits per second, of the profile and tier that films have
    int width, height;     ///< largest sides
    std::int64_t buffer;   ///< luma samples of all decoded pictures that are kept; 0: six of the largest, or eight
};

/// Whether a codec's levels are known here.
bool has_levels(encoder::Codec codec);

/// The level of these settings: the asked one, else the lowest that holds size, pictures per second and bit rate, else
/// the highest. Throws core::Error, in one line, where the asked one is none or holds less. 0 for codecs whose levels
/// are not ours to choose.
int level_for(const encoder::Settings& settings);

/// Pictures that one may be predicted from in H.264: x264's own choice, and no more than the level's buffer holds.
int references_for(const encoder::Settings& settings);

/// Bits per second that decoders of a level such as "4.1" take; 0: not known.
std::int64_t bits_of_level(encoder::Codec codec, const std::string& level);

/// "4.1"
std::string level_text(int tenths);

}  // namespace render2mpeg::av
