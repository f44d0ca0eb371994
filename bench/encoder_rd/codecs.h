#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/picture.h"
#include "encoder/types.h"
#include "encoder_rd/clips.h"

namespace render2mpeg::bench {

/// Pictures of one type in a coded film.
struct TypeShare {
    std::int64_t pictures = 0;
    double bits = 0;
    double error = 0;  ///< sum of the pictures' mean squared errors of luma
};

/// What coding a clip came to.
struct Measured {
    int quantiser = 0;
    std::int64_t pictures = 0;
    double bits = 0;  ///< of the whole stream
    double psnr_y = 0, ssim_y = 0, psnr_hvs_m = 0;
    double seconds = 0;              ///< CPU, of encoding alone, in one thread
    double evaluations = 0;          ///< per predicted macroblock; ours only
    double intra = 0, skipped = 0;   ///< shares of predicted pictures' macroblocks; ours only
    std::array<TypeShare, 3> types;  ///< I, P, B

    double pictures_per_second() const { return seconds > 0 ? static_cast<double>(pictures) / seconds : 0; }
};

/// How good decoded pictures are, gathered one by one in any order.
class Quality {
  public:
    /// Returns the mean squared error of luma.
    double add(const core::Picture& decoded, const core::Picture& original);
    void write(Measured& to) const;

  private:
    double pictures_ = 0, error_ = 0, similarity_ = 0, seen_error_ = 0;
};

/// One way to use our encoder.
struct OwnCodec {
    std::string name;
    int gop = 15;
    encoder::Effort effort = encoder::Effort::quality;
    bool told = true;  ///< the exact motion: types, dependency and, without a search, vectors follow from it
    int search = 0;    ///< pixels to each side of a full search; 0: none, the product
    encoder::Tune tune = encoder::Tune::psnr;
    bool constant_quality = false;  ///< of 80 at quantiser 2, 60 at 4, 40 at 8, 20 at 16
    bool ahead = true;              ///< pictures to come are there, as for `encode`; false: as `render` codes
};

/// The ways that --codecs knows.
std::vector<OwnCodec> own_codecs();

/// Codes a clip in every way with every quantiser, all side by side, so that each motion field is made once. The result
/// is ordered as codecs, then quantisers.
std::vector<std::vector<Measured>> code_with_ours(const Clip& clip, const std::vector<OwnCodec>& codecs,
                                                  const std::vector<int>& quantisers);

/// One way to use ffmpeg's encoder.
struct FfmpegCodec {
    std::string name;
    std::string options;  ///< {q}: the quantiser; {L}: 118 times that, its Lagrangian
    int gop;
};

std::vector<FfmpegCodec> ffmpeg_codecs();

/// Codes a clip by the program `ffmpeg`, and decodes it as our product's tests do. Kept in `cache` by the pictures, the
/// command and the program's version. `seconds` is what the program needs more than for reading the pictures alone.
/// An I picture that ffmpeg makes of the last one, because its next group would have begun right behind it, is counted
/// with the bits of a mean P picture: a film of any length has at most one of these. Throws core::Error.
Measured code_with_ffmpeg(const Clip& clip, const FfmpegCodec& codec, int quantiser,
                          const std::filesystem::path& cache);

/// Largest difference, in dB, between our PSNR and SSIM of a stream that ffmpeg made of the clip and those of ffmpeg's
/// own filters.
double difference_of_metrics(const Clip& clip, const FfmpegCodec& codec, int quantiser,
                             const std::filesystem::path& cache);

/// SSIM as dB: -10 log10(1 - ssim).
double in_db(double ssim);

}  // namespace render2mpeg::bench
