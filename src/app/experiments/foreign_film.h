#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/view.h"

namespace render2mpeg::app {

/// A film of another renderer or encoder against its reference frames.
struct ForeignFilm {
    std::string name;
    int width = 0, height = 0;
    std::int64_t pictures = 0;                      ///< of the film
    std::int64_t compared = 0;                      ///< of these, that there is a reference frame of
    double bytes = 0;                               ///< of coded pictures, per picture
    double psnr_y = 0, ssim_y = 0, psnr_hvs_m = 0;  ///< +infinity where nothing differs
};

/// Pattern of the numbered images in a folder (frames.%04d.exr), or the pattern itself. Throws core::Error where it is
/// not unique.
std::filesystem::path image_sequence_in(const std::filesystem::path& place);

/// Decodes a film and compares it with numbered images from its first picture on; scene-linear ones are developed with
/// `exposure` EV and `view`, with the film's declared matrix. Throws core::Error where sizes differ or nothing is
/// there.
ForeignFilm look_at_foreign(const std::filesystem::path& film, const std::filesystem::path& reference, float exposure,
                            const core::View& view = {});

}  // namespace render2mpeg::app
