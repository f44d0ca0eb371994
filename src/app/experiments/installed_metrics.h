#pragma once
// Metrics of other programs, where those are installed: XPSNR by ffmpeg 7.1 or newer, SSIMULACRA2 by libjxl's tool.
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/picture.h"
#include "perceptual/display.h"

namespace render2mpeg::app {

struct JudgedPicture {
    core::Picture reference, decoded;  ///< of one size
};

/// Of pictures: the mean, and that of the lowest twentieth, at least of one. Not finite: not known, or nothing differs.
struct MeanAndLow {
    double mean = std::numeric_limits<double>::quiet_NaN(), low = mean;
};
/// NaN of none.
MeanAndLow mean_and_low(std::vector<double> values);

/// Figures of decoded pictures.
struct InstalledQuality {
    MeanAndLow xpsnr_y;      ///< dB, of luma [Helmrich2020]; +infinity where nothing differs
    MeanAndLow ssimulacra2;  ///< 100: nothing differs; 90 and more: hardly anybody tells [SSIMULACRA2]
};

class InstalledMetrics {
  public:
    /// Looks for both programs.
    InstalledMetrics();

    bool has_xpsnr() const { return has_xpsnr_; }
    bool has_ssimulacra2() const { return has_ssimulacra2_; }
    /// Those that are missing, and where they come from; empty: none.
    std::string missing() const;

    /// Each picture counts alone, without what motion hides. NaN where a program is missing; of XPSNR in pictures
    /// of less than 2,025 pixels, of SSIMULACRA2 in views of high dynamic range. Throws core::Error where a program
    /// fails.
    InstalledQuality of(std::span<const JudgedPicture> pictures, const perceptual::PictureColors& colors) const;

  private:
    bool has_xpsnr_ = false, has_ssimulacra2_ = false;
};

}  // namespace render2mpeg::app
