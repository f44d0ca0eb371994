#pragma once
// The display: exposure, tone curve, transfer function and Y'CbCr, with exact inverses.
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "core/mattes.h"
#include "core/picture.h"
#include "core/radiance.h"
#include "core/view.h"
#include "perceptual/signal_curve.h"
#include "perceptual/view_transform.h"

namespace render2mpeg::perceptual {

/// Codecs' matrix_coefficients.
enum class ColorMatrix { bt601 = 6, bt709 = 1, bt2020 = 9 };

/// What a picture's values mean.
struct PictureColors {
    ColorMatrix matrix = ColorMatrix::bt709;
    core::View view{};
};

/// Weights of R', G', B' in luma: [BT709, 3.2], [BT601, 2.5.1], and [BT2020, table 4] without constant luminance.
glm::vec3 luma_weights(ColorMatrix matrix);

/// Exposure, view (tone curve and transfer function) and matrix, each with an inverse (docs/model/display.md).
/// Immutable and thread-safe.
class Display {
  public:
    /// Exposures beyond +-`max_exposure` EV are a broken contract.
    static constexpr float max_exposure = 64.0f;

    /// `exposure` in EV: radiance is multiplied by 2^exposure. `matrix`: as matrix_for() says. `grain`: ISO of the film
    /// grain that pictures get, 0 for none (core/film_grain.h).
    Display(float exposure, ColorMatrix matrix, const core::View& view = {},
            core::ExactChroma chroma = core::ExactChroma::none, int grain = 0);

    /// Scene-linear radiance to a picture, with the grain of its frame. Non-finite input is a broken contract; negative
    /// light counts as none.
    core::Picture develop(const core::Radiance& radiance) const;

    /// The same with alpha, which `radiance` is multiplied by and the picture is not.
    core::Picture develop(const core::Radiance& radiance, const core::Mattes& mattes) const;

    /// The same to sRGB code values 0..255, 3 per pixel: the signals of the film; views of high dynamic range are shown
    /// as `neutral`.
    std::vector<std::uint8_t> develop_srgb(const core::Radiance& radiance) const;

    /// Monotone tone curve from exposed light >= 0 to [0, 1].
    static float tone_curve(float exposed);

    /// The radiance with the chromaticity of `radiance` whose luma is `luma`, clamped to 16..235
    /// (docs/model/display.md). Black has no chromaticity and is taken as grey. White lies at infinity, and the luma of
    /// a pure colour ends below white: there the largest component ends at SignalCurve::brightest, 2^18 times what the
    /// exposure makes 1, so that the result is finite and its luma never above l + 1e-4. Elsewhere it is l to 1e-4 code
    /// values.
    glm::vec3 with_luma(glm::vec3 radiance, float luma) const;

    /// Full-range R'G'B' of exposed light: sRGB code values over 255, but of views of high dynamic range.
    glm::vec3 signals_of(glm::vec3 exposed) const;

    float exposure() const { return exposure_; }
    ColorMatrix matrix() const { return matrix_; }
    /// Null for the view `neutral`.
    const std::shared_ptr<const ViewTransform>& view() const { return view_; }

  private:
    /// Luma from 0 to 1 of exposed light, and its derivative by the logarithm of the light.
    SignalCurve::Point luma_at(glm::vec3 exposed) const;
    /// Of the view `pq`.
    core::LightLevel level_of(const core::Plane<glm::vec3>& light) const;

    float exposure_;
    float gain_;
    ColorMatrix matrix_;
    core::ExactChroma chroma_;
    int grain_;
    bool is_hdr_;
    std::shared_ptr<const ViewTransform> view_;
};

/// Unrounded luma in code values, 16..235, of one radiance: the value of a pixel from Display::develop.
float luma_of(const Display& display, glm::vec3 radiance);

/// Light that is multiplied by alpha, without that; where alpha is 0 it is black.
core::Radiance unmultiplied(const core::Radiance& radiance, const core::Mattes& mattes);

/// A picture of full-range signals R', G', B', clamped to [0, 1], with BT.709's primaries: inverts develop_srgb but for
/// rounding. Finite values.
core::Picture picture_of_signals(const core::Plane<glm::vec3>& signals, ColorMatrix matrix,
                                 core::ExactChroma chroma = core::ExactChroma::none);

/// The matrix for a picture with this number of lines in this view.
inline ColorMatrix matrix_for(int height, const core::View& view = {}) {
    if (view.is_hdr()) return ColorMatrix::bt2020;
    return height < 720 ? ColorMatrix::bt601 : ColorMatrix::bt709;
}

/// The exposure in EV that brings the middle of these luminances to mid grey (0.18), for a whole film from samples of
/// some of its frames. Scene-linear luminances in any order, which does not change the result by a bit. `surfaces`
/// decide; `sky`, what was seen past them, only where surfaces are next to nothing of what is lit: a view through a
/// window is not to darken the room. Samples that are black, or ten stops below the bright ones and so black on the
/// display, do not count, nor do non-finite ones; of the rest only the middle half does, so that a lamp does not
/// decide. 0 if nothing is left.
/// Its size is at most Display::max_exposure.
float auto_exposure(std::span<const float> surfaces, std::span<const float> sky = {});

/// Full-range R'G'B' code values 0..255, 3 per pixel, with linearly interpolated chroma: inverts picture_of_signals()
/// but for rounding and lost chroma detail. Views of high dynamic range are shown as `neutral`, in sRGB.
std::vector<std::uint8_t> shown_rgb(const core::Picture& picture, const PictureColors& colors);

}  // namespace render2mpeg::perceptual
