#include "encoder/av/y4m_samples.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"

namespace render2mpeg::av {
namespace {

using Samples = core::Plane<std::uint8_t>;
using Values = core::Plane<float>;
using Chroma = Y4mFormat::Chroma;
using Siting = Y4mFormat::Siting;

struct Extent {
    int width, height;
    std::size_t samples() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

/// Of a plane of chroma.
Extent chroma_of(const Y4mFormat& format) {
    switch (format.chroma) {
        case Chroma::none:
            return {0, 0};
        case Chroma::c420:
            return {(format.width + 1) / 2, (format.height + 1) / 2};
        case Chroma::c422:
            return {(format.width + 1) / 2, format.height};
        default:
            return {format.width, format.height};
    }
}

std::size_t bytes_of_sample(const Y4mFormat& format) {
    return format.depth > 8 ? 2 : 1;
}

/// Weights of four neighbours for a point a quarter of the way back from sample 1 (of 0, 1, 2, 3 at -2, -1, 0, 1: from
/// the third towards the second), times 128: the cubic through the middle two. [Catmull1974]
constexpr std::array<int, 4> quarter_back{-3, 29, 111, -9};

/// Value at place i - 1/4 (direction -1) or i + 1/4 (direction 1) of a line of samples; ends are repeated.
template <class At>
float quarter(const At& at, int i, int last, int direction) {
    float sum = 0;
    for (int k = 0; k < 4; ++k)
        sum += static_cast<float>(quarter_back[static_cast<std::size_t>(k)]) *
               at(std::clamp(i - direction * (k - 2), 0, last));
    return std::clamp(sum / 128, 0.0f, 255.0f);
}

Values moved_across(const Values& from, int direction) {
    Values to(from.width(), from.height());
    for (int y = 0; y < from.height(); ++y)
        for (int x = 0; x < from.width(); ++x)
            to.at(x, y) = quarter([&](int i) { return from.at(i, y); }, x, from.width() - 1, direction);
    return to;
}

Values moved_down(const Values& from, int direction) {
    Values to(from.width(), from.height());
    for (int y = 0; y < from.height(); ++y)
        for (int x = 0; x < from.width(); ++x)
            to.at(x, y) = quarter([&](int i) { return from.at(x, i); }, y, from.height() - 1, direction);
    return to;
}

/// Takes 8-bit samples of one plane after the other.
class Bytes {
  public:
    explicit Bytes(std::span<const std::uint8_t> bytes) : rest_(bytes) {}
    void take(Samples& plane) {
        std::copy_n(rest_.begin(), plane.size(), plane.values().begin());
        rest_ = rest_.subspan(plane.size());
    }
    /// Code values of limited range, of 8 bits and not rounded. [BT709, 3.4 and 3.5]: all steps of full range become
    /// 219 of luma above 16 and 224 of chroma about 128.
    Values values(const Y4mFormat& format, Extent extent, bool is_chroma) {
        const double one = std::exp2(format.depth - 8), most = std::exp2(format.depth) - 1;
        const double middle = is_chroma ? 128 : 16, zero = is_chroma ? 128 * one : 0;
        Values plane(extent.width, extent.height);
        for (float& value : plane.values()) {
            const double code = next(format);
            const double limited =
                format.full_range ? middle + (code - zero) * (is_chroma ? 224 : 219) / most : code / one;
            value = static_cast<float>(std::clamp(limited, 0.0, most / one));
        }
        return plane;
    }

  private:
    int next(const Y4mFormat& format) {
        const int code = format.depth > 8 ? rest_[0] | rest_[1] << 8 : rest_[0];
        rest_ = rest_.subspan(bytes_of_sample(format));
        return code;
    }
    std::span<const std::uint8_t> rest_;
};

/// Brings both planes of 4:2:0 to where MPEG-2 has its samples; in their own places: `jpeg` lies a quarter too far
/// right; `paldv` has Cr a quarter too high and Cb a quarter too low.
void move_chroma(Siting siting, Values& cb, Values& cr) {
    if (siting == Siting::jpeg) {
        cb = moved_across(cb, -1);
        cr = moved_across(cr, -1);
    } else if (siting == Siting::paldv) {
        cb = moved_down(cb, -1);
        cr = moved_down(cr, 1);
    }
}

Samples rounded(const Values& values) {
    Samples samples(values.width(), values.height());
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples.values()[i] = static_cast<std::uint8_t>(std::min(std::lround(values.values()[i]), 255L));
    return samples;
}

/// Chroma of 4:2:0: over columns 1 2 1 of 4:4:4, over rows the mean.
Values quartered(const Values& chroma, const Y4mFormat& format) {
    if (format.chroma == Chroma::c420) return chroma;
    Values quarter((format.width + 1) / 2, (format.height + 1) / 2);
    const int last_x = chroma.width() - 1, last_y = chroma.height() - 1;
    const auto across = [&](int x, int y) {
        if (format.chroma == Chroma::c422) return chroma.at(x, y);
        const int at = 2 * x;
        return 0.25f *
               (chroma.at(std::max(at - 1, 0), y) + 2 * chroma.at(at, y) + chroma.at(std::min(at + 1, last_x), y));
    };
    for (int y = 0; y < quarter.height(); ++y)
        for (int x = 0; x < quarter.width(); ++x)
            quarter.at(x, y) = 0.5f * (across(x, 2 * y) + across(x, std::min(2 * y + 1, last_y)));
    return quarter;
}

/// Chroma at every pixel; samples lie on the even columns, those of 4:2:0 between two rows.
Values spread(const Values& chroma, const Y4mFormat& format) {
    if (format.chroma == Chroma::c444) return chroma;
    Values full(format.width, format.height);
    const int last_x = chroma.width() - 1, last_y = chroma.height() - 1;
    for (int y = 0; y < full.height(); ++y)
        for (int x = 0; x < full.width(); ++x) {
            const auto across = [&](int row) {
                return 0.5f * (chroma.at(x / 2, row) + chroma.at(std::min(x / 2 + x % 2, last_x), row));
            };
            const int near = format.chroma == Chroma::c420 ? y / 2 : y;
            const int far = format.chroma == Chroma::c420 ? std::clamp(y % 2 == 0 ? near - 1 : near + 1, 0, last_y) : y;
            full.at(x, y) = 0.75f * across(near) + 0.25f * across(far);
        }
    return full;
}

}  // namespace

std::size_t bytes_of(const Y4mFormat& format) {
    const Extent luma{format.width, format.height};
    return (luma.samples() + 2 * chroma_of(format).samples()) * bytes_of_sample(format);
}

core::Picture picture_of(const Y4mFormat& format, std::span<const std::uint8_t> samples, core::ExactChroma exact) {
    EXPECTS(samples.size() == bytes_of(format));
    const Extent quarter{(format.width + 1) / 2, (format.height + 1) / 2};
    core::Picture picture;
    Bytes bytes(samples);
    const bool has_8_bits = format.depth == 8 && format.chroma == Chroma::c420 && !format.full_range;
    if (has_8_bits && format.siting == Siting::mpeg2) {
        picture.y = Samples(format.width, format.height);
        picture.cb = picture.cr = Samples(quarter.width, quarter.height);
        for (Samples* plane : {&picture.y, &picture.cb, &picture.cr}) bytes.take(*plane);
        return picture;
    }
    picture.luma = bytes.values(format, {format.width, format.height}, false);
    picture.y = rounded(picture.luma);
    if (has_8_bits) picture.luma = {};
    if (format.chroma == Chroma::none) {
        picture.cb = picture.cr = Samples(quarter.width, quarter.height, 128);
        return picture;
    }
    Values cb = bytes.values(format, chroma_of(format), true), cr = bytes.values(format, chroma_of(format), true);
    if (format.chroma == Chroma::c420) move_chroma(format.siting, cb, cr);
    if (exact == core::ExactChroma::full) {
        picture.exact_cb = spread(cb, format);
        picture.exact_cr = spread(cr, format);
    }
    cb = quartered(cb, format);
    cr = quartered(cr, format);
    picture.cb = rounded(cb);
    picture.cr = rounded(cr);
    if (exact == core::ExactChroma::halved) {
        picture.exact_cb = std::move(cb);
        picture.exact_cr = std::move(cr);
    }
    return picture;
}

}  // namespace render2mpeg::av
