#pragma once

#include <span>
#include <vector>

#include "encoder/types.h"

/// Between two passes: what a first, cheap coding of a film tells of the quantisers that the real one needs.
namespace render2mpeg::encoder {

/// Of a coded picture. `starts_chunk`: it is the first of its chunk.
FirstPassPicture first_pass_picture(const CodedPicture& coded, bool starts_chunk);

/// Shares a film's bits out: one quantiser for all I and P pictures, and its ratio for B pictures, with which the film
/// comes to its bit rate; coarser over stretches that the buffer could not bring in time, and by chunks where the rate
/// is constant. `film` is the whole film in coding order, its first picture a chunk's first whatever it says, every
/// number there once, quantisers 1..31, bits and ratios finite and above 0; `scale`, likewise, is what the real
/// pictures' bits are over the first pass's at the same quantiser (a first pass may be smaller). Gives one allocation
/// per picture in display order: gaps between numbers do not count. Settings: `variable` or `constant` rate.
std::vector<BitAllocation> allocate_bits(const Settings& settings, std::span<const FirstPassPicture> film,
                                         double scale);

}  // namespace render2mpeg::encoder
