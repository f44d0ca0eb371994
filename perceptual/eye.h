#pragma once
// An eye that looks into light: its pupil, what floats in it, and the pattern that this diffracts light into.
#include <complex>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "core/plane.h"

namespace render2mpeg::perceptual {

/// Discrete Fourier transforms of real planes of one size. Not for several threads at once.
class Fourier {
  public:
    /// Non-redundant half of a plane's spectrum: rows of width / 2 + 1 values.
    using Spectrum = std::vector<std::complex<float>>;

    /// For planes of at least this size, >= 1: of the next one that is transformed fast.
    Fourier(int width, int height);
    ~Fourier();
    Fourier(Fourier&&) noexcept;
    Fourier& operator=(Fourier&&) noexcept;

    int width() const { return width_; }
    int height() const { return height_; }

    /// Of a plane of that size or less, which zeros surround to the right and below. Finite values.
    Spectrum spectrum(const core::Plane<float>& plane);
    /// The plane of that size with this spectrum.
    core::Plane<float> plane(Spectrum spectrum);

  private:
    struct Transforms;
    int width_, height_;
    std::unique_ptr<Transforms> transforms_;
};

/// Side of apertures and of their patterns, texels.
inline constexpr int eye_texels = 512;
/// Side of apertures, mm: a little more than the widest pupil.
inline constexpr double aperture_mm = 10;

/// Mean diameter of the pupil, mm, of an eye that sees this luminance, cd/m^2 > 0 [Ritschel2009].
double pupil_diameter(double luminance);

/// What it is `seconds` later: pupils never rest (hippus) [Ritschel2009]. Within 1.5 and 9 mm.
double restless_diameter(double mean, double seconds, std::uint64_t seed);

/// What of light passes each place of the pupil, 0..1: a disc of this diameter, in mm, with particles and fibres of the
/// lens and particles of the vitreous body [Ritschel2009], as they lie at this time.
core::Plane<float> aperture(double diameter, double seconds, std::uint64_t seed);

/// The aperture without anything in it.
core::Plane<float> open_disc(double diameter);

/// Fraunhofer diffraction: |DFT|^2 of an aperture, direction (0, 0) at texel (eye_texels / 2, eye_texels / 2); sum 1.
core::Plane<float> diffraction(const core::Plane<float>& aperture);

/// Such a pattern of a pupil of this diameter, mm, without what lies within the first dark ring of the empty pupil:
/// that light is not scattered. Sum 1.
core::Plane<float> scattered(core::Plane<float> pattern, double diameter);

/// A pattern of light of 575 nm as one of white light, scene-linear BT.709: 32 wavelengths, each scaled by its own
/// length and seen by the observer of CIE 1931 [Wyman2013]. Each channel's sum is 1; none is negative.
core::Plane<glm::vec3> in_colour(const core::Plane<float>& pattern);

}  // namespace render2mpeg::perceptual
