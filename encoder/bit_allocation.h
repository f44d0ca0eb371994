#pragma once

#include <span>
#include <vector>

#include "encoder/types.h"

/// Bit allocation between two passes: from a first, cheap coding of a film to the quantisers of the real one.
namespace render2mpeg::encoder {

/// Of a coded picture of a pass with these settings. `starts_chunk`: it is the first of its chunk.
FirstPassPicture first_pass_picture(const Settings& pass, const CodedPicture& coded, bool starts_chunk);

/// Allocates a film's bits. All I and P pictures get one quantiser, and B pictures its ratio, such that the film keeps
/// its bit rate; stretches that would underflow the VBV get a coarser one. With a constant rate this is done chunk by
/// chunk. `film` is the whole film in coding order, its first picture a chunk's first whatever it says, every
/// number there once, quantisers of MPEG-2 1..31, bits and ratios finite and above 0; `scale`, likewise, is what the
/// real pictures' bits are over the first pass's at the same quantiser (a first pass may be smaller). Gives one
/// allocation per picture in display order: gaps between numbers do not count. Settings: `variable` or `constant` rate.
/// Other codecs than MPEG-2 have no buffer here, and one quantiser for all.
/// `film_ends`: nothing follows that a full buffer is left for.
std::vector<BitAllocation> allocate_bits(const Settings& settings, std::span<const FirstPassPicture> film, double scale,
                                         bool film_ends = true);

}  // namespace render2mpeg::encoder
