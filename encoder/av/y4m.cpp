#include "encoder/av/y4m.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <sstream>
#include <system_error>

#include "core/error.h"

namespace render2mpeg::av {
std::string y4m_header(int width, int height, const core::FrameRate& rate, core::Rational pixel_aspect) {
    std::ostringstream text;
    text << "YUV4MPEG2 W" << width << " H" << height << " F" << rate.hertz.num << ':' << rate.hertz.den << " Ip A"
         << pixel_aspect.num << ':' << pixel_aspect.den << " C420mpeg2 XCOLORRANGE=LIMITED\n";
    return text.str();
}

void put_y4m_frame(const core::Picture& picture, const std::function<bool(std::span<const std::uint8_t>)>& sink) {
    static constexpr std::array<std::uint8_t, 6> word{'F', 'R', 'A', 'M', 'E', '\n'};
    if (!sink(word)) return;
    for (const core::Plane<std::uint8_t>* plane : {&picture.y, &picture.cb, &picture.cr})
        if (!sink(plane->values())) return;
}

Y4mWriter::Y4mWriter(const std::filesystem::path& file, int width, int height, const core::FrameRate& rate,
                     core::Rational pixel_aspect)
    : file_(file), temporary_(file), width_(width), height_(height) {
    EXPECTS(width > 0 && height > 0 && rate.hertz.num > 0 && pixel_aspect.num > 0 && pixel_aspect.den > 0);
    temporary_ += ".tmp";
    errno = 0;
    stream_.open(temporary_, std::ios::binary | std::ios::trunc);
    check("creating");
    stream_ << y4m_header(width, height, rate, pixel_aspect);
    check("writing");
}

Y4mWriter::~Y4mWriter() {
    if (finished_) return;
    stream_.close();
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
}

void Y4mWriter::write(const core::Picture& picture) {
    EXPECTS(!finished_ && picture.width() == width_ && picture.height() == height_);
    EXPECTS(picture.cb.width() == (width_ + 1) / 2 && picture.cb.height() == (height_ + 1) / 2);
    EXPECTS(picture.cr.width() == picture.cb.width() && picture.cr.height() == picture.cb.height());
    errno = 0;
    put_y4m_frame(picture, [&](std::span<const std::uint8_t> bytes) {
        stream_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        return true;
    });
    check("writing");
}

void Y4mWriter::finish() {
    EXPECTS(!finished_);
    errno = 0;
    stream_.close();
    check("writing");
    std::error_code failure;
    std::filesystem::rename(temporary_, file_, failure);
    if (failure) throw core::Error("writing", file_.string(), "cannot give it its name: " + failure.message());
    finished_ = true;
}

void Y4mWriter::check(const char* doing) {
    if (stream_) return;
    throw core::Error(doing, file_.string(), errno != 0 ? std::strerror(errno) : "the system gives no reason");
}

}  // namespace render2mpeg::av
