#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "app/pipeline.h"
#include "app/production.h"
#include "core/picture.h"
#include "core/radiance.h"

namespace render2mpeg::bench {

/// Light of some frames without clustering, and what films are held against.
struct Reference {
    std::vector<std::int64_t> firsts;  ///< first frames of pairs of adjacent ones
    std::map<std::int64_t, core::Plane<glm::vec3>> light;
    std::map<std::int64_t, core::Picture> pictures;  ///< not coded
};

/// Pairs spread over the film. Kept in files in `cache`, named by what they depend on.
Reference reference_of(const app::Production& film, int pairs, const std::filesystem::path& cache);

/// One film's cost and what it came to, over all frames (cost, bytes) or the reference's (quality).
struct Outcome {
    double shade_seconds = 0;  ///< CPU, rough first looks included
    double preview_seconds = 0;
    double tolerate_seconds = 0;
    double rays = 0;       ///< shadow rays
    double cut = 0;        ///< clusters per point over light points
    double capped = 0;     ///< share of points
    double tolerance = 0;  ///< mean of tolerance over luminance at the reference's frames, where it has light
    double over = 0;       ///< share of pixels whose luminance is off by more than their tolerance
    double bytes = 0;
    double psnr_y = 0, ssim = 0, hvs_m = 0;  ///< decoded against the reference not coded
    double light_mse = 0;                    ///< of luma before coding against the reference, code values squared
    double flicker = 0;                      ///< temporal difference along motion, less the reference's; code values
};

/// Lit by `film.tolerance`, coded, decoded and measured.
Outcome made(const app::Production& film, const Reference& reference);

/// Films lit by a fixed tolerance do not depend on how they are coded: lit once, coded as often as asked.
class LitFilm {
  public:
    LitFilm(const app::Production& film, const Reference& reference);
    Outcome coded(int quantiser) const;

  private:
    app::Production film_;
    const Reference& reference_;
    Outcome lit_;
    std::vector<core::Visible> visible_;
    std::vector<core::Picture> pictures_;
};

}  // namespace render2mpeg::bench
