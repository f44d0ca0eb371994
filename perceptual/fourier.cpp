#include "perceptual/fourier.h"

#include <kiss_fft.h>
#include <kiss_fftr.h>

#include <algorithm>
#include <cstdlib>
#include <new>

#include "core/error.h"

namespace render2mpeg::perceptual {
namespace {

struct Freed {
    void operator()(void* memory) const { std::free(memory); }
};
using Columns = std::unique_ptr<kiss_fft_state, Freed>;
using Rows = std::unique_ptr<kiss_fftr_state, Freed>;

template <class Transform>
Transform checked(Transform made) {
    if (!made) throw std::bad_alloc();
    return made;
}

// std::complex<float> has the layout of kiss_fft_cpx, two floats.
const kiss_fft_cpx* given(const std::complex<float>* values) {
    return reinterpret_cast<const kiss_fft_cpx*>(values);
}
kiss_fft_cpx* taken(std::complex<float>* values) {
    return reinterpret_cast<kiss_fft_cpx*>(values);
}

/// Transforms all columns of a spectrum with rows of `stride` values.
void transform_columns(kiss_fft_state* transform, int stride, int height, Fourier::Spectrum& spectrum) {
    // chosen: as many side by side as fill a line of the cache.
    constexpr int most = 8;
    const auto rows = static_cast<std::size_t>(height);
    std::vector<std::complex<float>> before(most * rows), after(rows);
    for (int first = 0; first < stride; first += most) {
        const int count = std::min(most, stride - first);
        for (int y = 0; y < height; ++y)
            for (int i = 0; i < count; ++i)
                before[static_cast<std::size_t>(i * height + y)] =
                    spectrum[static_cast<std::size_t>(y * stride + first + i)];
        for (int i = 0; i < count; ++i) {
            kiss_fft(transform, given(before.data() + i * height), taken(after.data()));
            std::copy_n(after.data(), height, before.data() + i * height);
        }
        for (int y = 0; y < height; ++y)
            for (int i = 0; i < count; ++i)
                spectrum[static_cast<std::size_t>(y * stride + first + i)] =
                    before[static_cast<std::size_t>(i * height + y)];
    }
}

}  // namespace

struct Fourier::Transforms {
    Rows rows, rows_back;
    Columns columns, columns_back;
};

Fourier::Fourier(int width, int height) {
    EXPECTS(width >= 1 && height >= 1);
    width_ = kiss_fftr_next_fast_size_real(width);
    height_ = kiss_fft_next_fast_size(height);
    transforms_ =
        std::make_unique<Transforms>(Transforms{checked(Rows(kiss_fftr_alloc(width_, 0, nullptr, nullptr))),
                                                checked(Rows(kiss_fftr_alloc(width_, 1, nullptr, nullptr))),
                                                checked(Columns(kiss_fft_alloc(height_, 0, nullptr, nullptr))),
                                                checked(Columns(kiss_fft_alloc(height_, 1, nullptr, nullptr)))});
}

Fourier::~Fourier() = default;
Fourier::Fourier(Fourier&&) noexcept = default;
Fourier& Fourier::operator=(Fourier&&) noexcept = default;

Fourier::Spectrum Fourier::spectrum(const core::Plane<float>& plane) {
    EXPECTS(plane.width() <= width_ && plane.height() <= height_);
    const int stride = width_ / 2 + 1;
    Spectrum spectrum(static_cast<std::size_t>(stride) * static_cast<std::size_t>(height_));
    std::vector<float> row(static_cast<std::size_t>(width_));
    for (int y = 0; y < plane.height(); ++y) {
        std::copy_n(plane.row(y), plane.width(), row.data());
        kiss_fftr(transforms_->rows.get(), row.data(), taken(spectrum.data() + y * stride));
    }
    transform_columns(transforms_->columns.get(), stride, height_, spectrum);
    return spectrum;
}

core::Plane<float> Fourier::plane(Spectrum spectrum) {
    const int stride = width_ / 2 + 1;
    EXPECTS(spectrum.size() == static_cast<std::size_t>(stride) * static_cast<std::size_t>(height_));
    transform_columns(transforms_->columns_back.get(), stride, height_, spectrum);
    core::Plane<float> plane(width_, height_);
    for (int y = 0; y < height_; ++y)
        kiss_fftri(transforms_->rows_back.get(), given(spectrum.data() + y * stride), plane.row(y));
    const float scale = 1.0f / (static_cast<float>(width_) * static_cast<float>(height_));
    for (float& value : plane.values()) value *= scale;
    return plane;
}

}  // namespace render2mpeg::perceptual
