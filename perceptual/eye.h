#pragma once
// An eye: its pupil, particles in it, and their diffraction pattern.
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

/// Diameter `seconds` later, since pupils never rest (hippus) [Ritschel2009]: 1.5 to 9 mm.
double restless_diameter(double mean, double seconds, std::uint64_t seed);

/// Transmission of the pupil, 0..1: a disc of this diameter, mm, with particles and fibres as they lie at this time
/// [Ritschel2009].
core::Plane<float> aperture(double diameter, double seconds, std::uint64_t seed);

/// The aperture without anything in it.
core::Plane<float> open_disc(double diameter);

/// Fraunhofer diffraction: |DFT|^2 of an aperture, direction (0, 0) at texel (eye_texels / 2, eye_texels / 2); sum 1.
core::Plane<float> diffraction(const core::Plane<float>& aperture);

/// The pattern outside the first dark ring of the empty pupil of this diameter, mm: scattered light. Sum 1.
core::Plane<float> scattered(core::Plane<float> pattern, double diameter);

/// A pattern of 575 nm for white light, linear BT.709, by 32 wavelengths and the observer of CIE 1931 [Wyman2013]. Each
/// channel's sum is 1; none is negative.
core::Plane<glm::vec3> in_colour(const core::Plane<float>& pattern);

}  // namespace render2mpeg::perceptual
