#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/view.h"

namespace render2mpeg::app {

/// A film that another renderer or encoder made, against frames that say what it should look like.
struct ForeignFilm {
    std::string name;
    int width = 0, height = 0;
    std::int64_t pictures = 0;                      ///< of the film
    std::int64_t compared = 0;                      ///< of these, that there is a reference frame of
    double bytes = 0;                               ///< of coded pictures, per picture
    double psnr_y = 0, ssim_y = 0, psnr_hvs_m = 0;  ///< +infinity where nothing differs
};

/// The numbered images in a folder, as a pattern (frames.%04d.exr); a pattern is its own. Throws core::Error for a
/// folder in which there is no such sequence, or more than one.
std::filesystem::path image_sequence_in(const std::filesystem::path& place);

/// Decodes a film and compares its pictures with numbered images, the first of which is its first picture's.
/// Scene-linear ones are developed with `exposure` EV and `view`. Their luma is by the matrix that the film declares.
/// Throws core::Error where sizes differ, or there is nothing to compare.
ForeignFilm look_at_foreign(const std::filesystem::path& film, const std::filesystem::path& reference, float exposure,
                            const core::View& view = {});

}  // namespace render2mpeg::app
