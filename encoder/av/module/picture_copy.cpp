#include "encoder/av/module/picture_copy.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string_view>

#include "core/sampling.h"
#include "encoder/av/rgb_picture.h"

namespace render2mpeg::av {
namespace {

/// A frame's samples: bits, and by how many times two its chroma is smaller.
struct Layout {
    int depth = 8, across = 1, down = 1;
};

Layout layout_of(const AVFrame& frame) {
    const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
    return {format->comp[0].depth, format->log2_chroma_w, format->log2_chroma_h};
}

template <class Sample>
const Sample* row_of(const AVFrame& frame, int plane, int y) {
    return reinterpret_cast<const Sample*>(frame.data[plane] + static_cast<std::ptrdiff_t>(y) * frame.linesize[plane]);
}

template <class Sample>
Sample* row_of(AVFrame& frame, int plane, int y) {
    return reinterpret_cast<Sample*>(frame.data[plane] + static_cast<std::ptrdiff_t>(y) * frame.linesize[plane]);
}

int sample(const AVFrame& frame, int depth, int plane, int x, int y) {
    return depth == 8 ? row_of<std::uint8_t>(frame, plane, y)[x] : row_of<std::uint16_t>(frame, plane, y)[x];
}

/// Eight bits of `count` times a value.
std::uint8_t rounded(int sum, int count, int depth) {
    const int whole = count << (depth - 8);
    return static_cast<std::uint8_t>(std::min((sum + whole / 2) / whole, 255));
}

core::Plane<std::uint8_t> luma_of(const AVFrame& frame, const Layout& layout) {
    core::Plane<std::uint8_t> result(frame.width, frame.height);
    for (int y = 0; y < frame.height; ++y) {
        if (layout.depth == 8) {
            std::copy_n(row_of<std::uint8_t>(frame, 0, y), frame.width, result.row(y));
        } else {
            const std::uint16_t* in = row_of<std::uint16_t>(frame, 0, y);
            for (int x = 0; x < frame.width; ++x) result.at(x, y) = rounded(in[x], 1, layout.depth);
        }
    }
    return result;
}

/// Chroma as 4:2:0 has it: on the even columns by [1 2 1] / 4, and the mean of two rows (perceptual/display.cpp).
core::Plane<std::uint8_t> chroma_of(const AVFrame& frame, const Layout& layout, int plane) {
    core::Plane<std::uint8_t> result((frame.width + 1) / 2, (frame.height + 1) / 2);
    const int last_column = ((frame.width + (1 << layout.across) - 1) >> layout.across) - 1;
    const int last_row = ((frame.height + (1 << layout.down) - 1) >> layout.down) - 1;
    const auto across = [&](int x, int y) {
        const auto at = [&](int column) {
            return sample(frame, layout.depth, plane, std::clamp(column, 0, last_column), y);
        };
        return layout.across == 1 ? 4 * at(x) : at(2 * x - 1) + 2 * at(2 * x) + at(2 * x + 1);
    };
    for (int y = 0; y < result.height(); ++y)
        for (int x = 0; x < result.width(); ++x) {
            const int sum =
                layout.down == 1 ? 2 * across(x, y) : across(x, 2 * y) + across(x, std::min(2 * y + 1, last_row));
            result.at(x, y) = rounded(sum, 8, layout.depth);
        }
    return result;
}

/// Ten bits of unrounded luma: a random number decides between the two nearest, so that slow gradients show no steps.
void fill_dithered(AVFrame& frame, const core::Picture& picture) {
    for (int y = 0; y < picture.height(); ++y) {
        std::uint16_t* out = row_of<std::uint16_t>(frame, 0, y);
        for (int x = 0; x < picture.width(); ++x) {
            const auto place = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(picture.width()) +
                               static_cast<std::uint64_t>(x);
            const float noise = core::uniform(static_cast<std::uint64_t>(picture.number), place);
            const float value = std::floor(4.0f * picture.luma.at(x, y) + noise);
            out[x] = static_cast<std::uint16_t>(std::clamp(value, 64.0f, 940.0f));
        }
    }
}

void fill_plane(AVFrame& frame, int plane, const core::Plane<std::uint8_t>& samples, int depth) {
    for (int y = 0; y < samples.height(); ++y) {
        if (depth == 8) {
            std::copy_n(samples.row(y), samples.width(), row_of<std::uint8_t>(frame, plane, y));
        } else {
            std::uint16_t* out = row_of<std::uint16_t>(frame, plane, y);
            for (int x = 0; x < samples.width(); ++x)
                out[x] = static_cast<std::uint16_t>(samples.at(x, y) << (depth - 8));
        }
    }
}

/// A plane from code values of 8 bits that are not rounded.
void fill_exact(AVFrame& frame, int plane, int width, int height, int depth,
                const std::function<float(int x, int y)>& value_at) {
    const float scale = static_cast<float>(1 << (depth - 8));
    const long most = (1 << depth) - 1;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const long value = std::min(std::lround(scale * value_at(x, y)), most);
            if (depth == 8)
                row_of<std::uint8_t>(frame, plane, y)[x] = static_cast<std::uint8_t>(value);
            else
                row_of<std::uint16_t>(frame, plane, y)[x] = static_cast<std::uint16_t>(value);
        }
}

/// Chroma of 4:2:0 at the place of a pixel: between its columns and rows, which lie as MPEG-2 has them.
float between(const core::Plane<std::uint8_t>& plane, int x, int y) {
    const int left = x / 2, right = std::min(left + x % 2, plane.width() - 1);
    const int near = y / 2, far = std::clamp(y % 2 == 0 ? near - 1 : near + 1, 0, plane.height() - 1);
    const auto mean = [&](int row) { return 0.5f * static_cast<float>(plane.at(left, row) + plane.at(right, row)); };
    return 0.75f * mean(near) + 0.25f * mean(far);
}

/// Chroma of 4:2:0, before rounding where a picture has it so.
void fill_halved(AVFrame& frame, int plane, int depth, const core::Plane<float>& exact,
                 const core::Plane<std::uint8_t>& rounded) {
    if (depth == 8 || exact.empty()) return fill_plane(frame, plane, rounded, depth);
    fill_exact(frame, plane, exact.width(), exact.height(), depth, [&](int x, int y) { return exact.at(x, y); });
}

/// Chroma of 4:2:2 or 4:4:4, from full chroma where a picture has it. Sited as perceptual/display.cpp has it.
void fill_chroma(AVFrame& frame, int plane, const Layout& layout, const core::Plane<float>& full,
                 const core::Plane<std::uint8_t>& halved) {
    const auto at = [&](int x, int y) {
        return full.empty() ? between(halved, x, y) : full.at(std::clamp(x, 0, full.width() - 1), y);
    };
    const bool narrow = layout.across == 1;
    const auto across = [&](int x, int y) {
        if (!narrow) return at(x, y);
        if (full.empty()) return at(2 * x, y);
        return 0.25f * (at(2 * x - 1, y) + 2 * at(2 * x, y) + at(2 * x + 1, y));
    };
    fill_exact(frame, plane, narrow ? (frame.width + 1) / 2 : frame.width, frame.height, layout.depth, across);
}

/// GIF's; black where it is open.
core::Picture picture_of_bgra(const AVFrame& frame) {
    return picture_of_rgb(frame.width, frame.height, RgbMatrix::usual(frame.height), [&](int x, int y) {
        const std::uint8_t* at = row_of<std::uint8_t>(frame, 0, y) + 4 * static_cast<std::ptrdiff_t>(x);
        return at[3] == 0 ? Rgb{}
                          : Rgb{static_cast<float>(at[2]), static_cast<float>(at[1]), static_cast<float>(at[0])};
    });
}

/// Alpha has all of its range.
void fill_alpha(AVFrame& frame, const core::Plane<float>& alpha, int depth) {
    const float most = static_cast<float>((1 << depth) - 1);
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) {
            const long value = std::lround(most * (alpha.empty() ? 1.0f : alpha.at(x, y)));
            if (depth == 8)
                row_of<std::uint8_t>(frame, 3, y)[x] = static_cast<std::uint8_t>(value);
            else
                row_of<std::uint16_t>(frame, 3, y)[x] = static_cast<std::uint16_t>(value);
        }
}

}  // namespace

bool is_known(const AVFrame& frame) {
    if (frame.format == AV_PIX_FMT_BGRA) return true;
    const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
    constexpr auto others = AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_BE;
    if (format == nullptr || format->nb_components < 3 || (format->flags & others) != 0) return false;
    if (frame.color_range == AVCOL_RANGE_JPEG || std::string_view(format->name).starts_with("yuvj")) return false;
    const bool planar = format->comp[1].plane == 1 && format->comp[2].plane == 2;
    return planar && format->comp[0].depth >= 8 && format->comp[0].depth <= 12 && format->comp[0].shift == 0 &&
           format->log2_chroma_w <= 1 && format->log2_chroma_h <= format->log2_chroma_w;
}

core::Picture picture_of(const AVFrame& frame, std::int64_t number) {
    core::Picture picture;
    if (frame.format == AV_PIX_FMT_BGRA) {
        picture = picture_of_bgra(frame);
        picture.number = number;
        return picture;
    }
    const Layout layout = layout_of(frame);
    picture.number = number;
    picture.y = luma_of(frame, layout);
    picture.cb = chroma_of(frame, layout, 1);
    picture.cr = chroma_of(frame, layout, 2);
    return picture;
}

void fill(AVFrame& frame, const core::Picture& picture) {
    const Layout layout = layout_of(frame);
    if (frame.data[3] != nullptr) fill_alpha(frame, picture.alpha, layout.depth);
    if (layout.down == 1) {
        if (layout.depth == 10 && !picture.luma.empty())
            fill_dithered(frame, picture);
        else
            fill_plane(frame, 0, picture.y, layout.depth);
        fill_halved(frame, 1, layout.depth, picture.exact_cb, picture.cb);
        fill_halved(frame, 2, layout.depth, picture.exact_cr, picture.cr);
    } else {
        fill_exact(frame, 0, frame.width, frame.height, layout.depth, [&](int x, int y) {
            return picture.luma.empty() ? static_cast<float>(picture.y.at(x, y))
                                        : std::clamp(picture.luma.at(x, y), 16.0f, 235.0f);
        });
        fill_chroma(frame, 1, layout, picture.exact_cb, picture.cb);
        fill_chroma(frame, 2, layout, picture.exact_cr, picture.cr);
    }
}

}  // namespace render2mpeg::av
