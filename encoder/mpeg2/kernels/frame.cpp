#include "encoder/mpeg2/kernels/frame.h"

#include <algorithm>
#include <utility>

namespace render2mpeg::encoder::mpeg2 {
namespace {

using Samples = core::Plane<std::uint8_t>;

void pad_plane(const Samples& from, Samples& to) {
    EXPECTS(from.width() >= 1 && from.height() >= 1 && from.width() <= to.width() && from.height() <= to.height());
    for (int y = 0; y < to.height(); ++y) {
        const std::uint8_t* source = from.row(std::min(y, from.height() - 1));
        std::copy_n(source, from.width(), to.row(y));
        std::fill_n(to.row(y) + from.width(), to.width() - from.width(), source[from.width() - 1]);
    }
}

Samples crop_plane(const Samples& from, int width, int height) {
    Samples to(width, height);
    for (int y = 0; y < height; ++y) std::copy_n(from.row(y), width, to.row(y));
    return to;
}

}  // namespace

void pad(const core::Picture& picture, Frame& frame) {
    pad_plane(picture.y, frame.y);
    pad_plane(picture.cb, frame.cb);
    pad_plane(picture.cr, frame.cr);
}

core::Picture crop(const Frame& frame, int width, int height, std::int64_t number) {
    core::Picture picture;
    picture.number = number;
    picture.y = crop_plane(frame.y, width, height);
    picture.cb = crop_plane(frame.cb, (width + 1) / 2, (height + 1) / 2);
    picture.cr = crop_plane(frame.cr, (width + 1) / 2, (height + 1) / 2);
    return picture;
}

core::Picture crop(Frame&& frame, int width, int height, std::int64_t number) {
    if (frame.y.width() != width || frame.y.height() != height)
        return crop(std::as_const(frame), width, height, number);
    core::Picture picture;
    picture.number = number;
    picture.y = std::move(frame.y);
    picture.cb = std::move(frame.cb);
    picture.cr = std::move(frame.cr);
    return picture;
}

}  // namespace render2mpeg::encoder::mpeg2
