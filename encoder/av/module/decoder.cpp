#include "encoder/av/module/decoder.h"
#include "core/error.h"
#include "encoder/av/module/ffmpeg.h"
#include "encoder/av/module/input.h"
#include "encoder/av/module/picture_copy.h"

namespace render2mpeg::av {
namespace {

/// Without AV_EF_BITSTREAM, which takes a sequence end code behind the last slice for damage.
constexpr int strictness = AV_EF_EXPLODE | AV_EF_CRCCHECK | AV_EF_BUFFER;

/// One film being decoded.
class DecodedFilm {
  public:
    DecodedFilm(const std::filesystem::path& file, const std::function<void(const core::Picture&)>& picture)
        : file_(file.string()), picture_(picture), film_(open_film(file_, strictness, messages_)) {
        open_decoder();
    }

    void decode() {
        int result = 0;
        while ((result = av_read_frame(film_.input.get(), packet_.get())) >= 0) {
            if (packet_->flags & AV_PKT_FLAG_CORRUPT) fail("the container marks a picture as damaged");
            if (packet_->stream_index == film_.stream->index) send(packet_.get());
            av_packet_unref(packet_.get());
        }
        if (result != AVERROR_EOF) fail(cause_of(result, messages_));
        send(nullptr);
    }

  private:
    [[noreturn]] void fail(const std::string& cause) const {
        throw core::Error("decoding", file_, "picture " + std::to_string(number_), cause);
    }
    void check(int result) const {
        if (result < 0 || messages_.has_error()) fail(cause_of(result, messages_));
    }

    void open_decoder() {
        const AVCodec* codec = avcodec_find_decoder(film_.stream->codecpar->codec_id);
        if (codec == nullptr) fail("no decoder for this kind of stream");
        decoder_.reset(avcodec_alloc_context3(codec));
        if (!decoder_ || !packet_ || !frame_) fail(cause_of(AVERROR(ENOMEM), messages_));
        check(avcodec_parameters_to_context(decoder_.get(), film_.stream->codecpar));
        decoder_->idct_algo = FF_IDCT_SIMPLE;
        decoder_->flags |= AV_CODEC_FLAG_BITEXACT;
        decoder_->err_recognition = strictness;
        decoder_->error_concealment = 0;
        decoder_->thread_count = 1;
        decoder_->export_side_data = AV_CODEC_EXPORT_DATA_FILM_GRAIN;  // pictures come without it
        check(avcodec_open2(decoder_.get(), codec, nullptr));
    }

    /// Decodes one packet; null: flushes the decoder.
    void send(const AVPacket* packet) {
        check(avcodec_send_packet(decoder_.get(), packet));
        while (true) {
            const int result = avcodec_receive_frame(decoder_.get(), frame_.get());
            if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return check(0);
            check(result);
            if (frame_->decode_error_flags != 0 || (frame_->flags & AV_FRAME_FLAG_CORRUPT))
                fail("the picture is damaged");
            deliver();
        }
    }

    void deliver() {
        if (!is_known(*frame_)) {
            const char* name = av_get_pix_fmt_name(static_cast<AVPixelFormat>(frame_->format));
            fail(std::string("pixels are ") + (name != nullptr ? name : "of an unknown kind") +
                 ", not Y'CbCr of 8 to 12 bits");
        }
        picture_(picture_of(*frame_, number_++));
    }

    std::string file_;
    const std::function<void(const core::Picture&)>& picture_;
    Messages messages_;
    OpenStream film_;
    Decoder decoder_;
    Packet packet_{av_packet_alloc()};
    Frame frame_{av_frame_alloc()};
    std::int64_t number_ = 0;
};

}  // namespace

void decode_film(const std::filesystem::path& file, const std::function<void(const core::Picture&)>& picture) {
    DecodedFilm(file, picture).decode();
}

}  // namespace render2mpeg::av
