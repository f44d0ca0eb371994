#include "app/files/film_stream.h"

#include <span>

#include "core/error.h"
#include "encoder/codec.h"

namespace render2mpeg::app {
namespace {

av::Sound stream_sound(const Film& film) {
    av::Sound sound = film.sound;
    sound.seconds = static_cast<double>(film.frame_count()) / film.coding.rate.hertz.value();
    return sound;
}

}  // namespace

FilmStream::FilmStream(OutputStream& out, const std::filesystem::path& name, const Film& film)
    : out_(out),
      codec_(film.coding.codec),
      first_frame_(film.frames.first),
      muxer_([&out](std::span<const std::uint8_t> bytes) { return out.put(bytes); }, name, film.coding,
             stream_sound(film)) {}

void FilmStream::pass_on() {
    if (!waiting_) return;
    try {
        muxer_.write(waiting_->bytes, waiting_->number - first_frame_, coded_++, waiting_->starts_gop);
    } catch (const core::Error&) {
        out_.check();  // who reads, and why no more, is a better reason
        throw;
    }
    waiting_.reset();
    out_.check();
}

void FilmStream::write(const encoder::CodedPicture& picture) {
    pass_on();
    waiting_ = {picture.bytes, picture.plan.number, picture.plan.starts_gop};
}

void FilmStream::finish() {
    if (!waiting_) return;
    for (const std::uint8_t byte : encoder::end_of_stream(codec_)) waiting_->bytes.push_back(byte);
    pass_on();
    muxer_.finish();
}

}  // namespace render2mpeg::app
