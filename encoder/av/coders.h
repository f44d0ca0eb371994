#pragma once
// Coders of all codecs: our own, and those of libavcodec behind the same interface.
#include <memory>

#include "encoder/coder.h"
#include "encoder/types.h"

namespace render2mpeg::av {

/// Throws core::Error, in one line, where a film cannot be coded with these settings: beyond the codec's limits, a
/// feature of MPEG-2 only, or an encoder missing from this machine's libavcodec.
void check(const encoder::Settings& settings);

/// The coder of a film's codec. Throws as check() does.
///
/// Coders of libavcodec delay pictures until their decoder, which reports the result of each, shows them: an I or P
/// picture comes when the next one is coded, its B pictures behind it. Their quantisers are as planned; so are the
/// records of macroblocks without coded data. HEVC's and AV1's pictures come when their group ends: by count, never by
/// other libraries' threads.
std::unique_ptr<encoder::Coder> make_coder(const encoder::Settings& settings);

}  // namespace render2mpeg::av
