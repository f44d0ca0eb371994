#pragma once
// Fourier transforms of real planes.
#include <complex>
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

}  // namespace render2mpeg::perceptual
