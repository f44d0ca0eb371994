#include "encoder/av/module/picture_copy.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/sampling.h"

namespace render2mpeg::av {
namespace {

template <class Sample>
const Sample* row_of(const AVFrame& frame, int plane, int y) {
    return reinterpret_cast<const Sample*>(frame.data[plane] + static_cast<std::ptrdiff_t>(y) * frame.linesize[plane]);
}

template <class Sample>
Sample* row_of(AVFrame& frame, int plane, int y) {
    return reinterpret_cast<Sample*>(frame.data[plane] + static_cast<std::ptrdiff_t>(y) * frame.linesize[plane]);
}

core::Plane<std::uint8_t> plane_of(const AVFrame& frame, int plane, int width, int height) {
    core::Plane<std::uint8_t> result(width, height);
    for (int y = 0; y < height; ++y) {
        if (frame.format == AV_PIX_FMT_YUV420P) {
            std::copy_n(row_of<std::uint8_t>(frame, plane, y), width, result.row(y));
        } else {
            const std::uint16_t* in = row_of<std::uint16_t>(frame, plane, y);
            for (int x = 0; x < width; ++x)
                result.at(x, y) = static_cast<std::uint8_t>(std::min((in[x] + 2) >> 2, 255));
        }
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

void fill_plane(AVFrame& frame, int plane, const core::Plane<std::uint8_t>& samples) {
    for (int y = 0; y < samples.height(); ++y) {
        if (frame.format == AV_PIX_FMT_YUV420P) {
            std::copy_n(samples.row(y), samples.width(), row_of<std::uint8_t>(frame, plane, y));
        } else {
            std::uint16_t* out = row_of<std::uint16_t>(frame, plane, y);
            for (int x = 0; x < samples.width(); ++x) out[x] = static_cast<std::uint16_t>(4 * samples.at(x, y));
        }
    }
}

}  // namespace

bool is_4_2_0(const AVFrame& frame) {
    return frame.format == AV_PIX_FMT_YUV420P || frame.format == AV_PIX_FMT_YUV420P10;
}

core::Picture picture_of(const AVFrame& frame, std::int64_t number) {
    core::Picture picture;
    picture.number = number;
    picture.y = plane_of(frame, 0, frame.width, frame.height);
    picture.cb = plane_of(frame, 1, (frame.width + 1) / 2, (frame.height + 1) / 2);
    picture.cr = plane_of(frame, 2, (frame.width + 1) / 2, (frame.height + 1) / 2);
    return picture;
}

void fill(AVFrame& frame, const core::Picture& picture) {
    if (frame.format == AV_PIX_FMT_YUV420P10 && !picture.luma.empty())
        fill_dithered(frame, picture);
    else
        fill_plane(frame, 0, picture.y);
    fill_plane(frame, 1, picture.cb);
    fill_plane(frame, 2, picture.cr);
}

}  // namespace render2mpeg::av
