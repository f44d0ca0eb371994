#include <algorithm>

#include "core/error.h"
#include "encoder/av/module/decoder.h"
#include "encoder/av/module/ffmpeg.h"
#include "encoder/av/module/transport_stream.h"

namespace render2mpeg::av {
namespace {

/// Without AV_EF_BITSTREAM, which takes a sequence end code behind the last slice for damage.
constexpr int strictness = AV_EF_EXPLODE | AV_EF_CRCCHECK | AV_EF_BUFFER;

/// One film being decoded.
class Film {
  public:
    Film(const std::filesystem::path& file, const std::function<void(const core::Picture&)>& picture)
        : file_(file.string()), picture_(picture) {
        open_file();
        open_decoder();
    }

    void decode() {
        int result = 0;
        while ((result = av_read_frame(input_.get(), packet_.get())) >= 0) {
            if (packet_->flags & AV_PKT_FLAG_CORRUPT) fail("the container marks a picture as damaged");
            if (packet_->stream_index == stream_) send(packet_.get());
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

    void open_file() {
        const auto refuse = [&](int result) { throw core::Error("reading", file_, cause_of(result, messages_)); };
        AVFormatContext* input = avformat_alloc_context();
        if (input == nullptr) refuse(AVERROR(ENOMEM));
        input->error_recognition = strictness;
        // The prefix keeps names with colons from being taken for network addresses. On failure `input` is freed.
        const AVInputFormat* format = transport_stream_format(file_);
        if (const int r = avformat_open_input(&input, ("file:" + file_).c_str(), format, nullptr); r < 0) refuse(r);
        input_.reset(input);
        if (const int r = avformat_find_stream_info(input, nullptr); r < 0) refuse(r);
        stream_ = av_find_best_stream(input, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
        if (stream_ < 0) refuse(stream_);
    }

    void open_decoder() {
        const AVStream* stream = input_->streams[stream_];
        const AVCodec* codec = avcodec_find_decoder(stream->codecpar->codec_id);
        if (codec == nullptr) fail("no decoder for this kind of stream");
        decoder_.reset(avcodec_alloc_context3(codec));
        if (!decoder_ || !packet_ || !frame_) fail(cause_of(AVERROR(ENOMEM), messages_));
        check(avcodec_parameters_to_context(decoder_.get(), stream->codecpar));
        decoder_->idct_algo = FF_IDCT_SIMPLE;
        decoder_->flags |= AV_CODEC_FLAG_BITEXACT;
        decoder_->err_recognition = strictness;
        decoder_->error_concealment = 0;
        decoder_->thread_count = 1;
        check(avcodec_open2(decoder_.get(), codec, nullptr));
    }

    /// Decodes one packet, or with null what is held back.
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
        if (frame_->format != AV_PIX_FMT_YUV420P) {
            const char* name = av_get_pix_fmt_name(static_cast<AVPixelFormat>(frame_->format));
            fail(std::string("pixels are ") + (name != nullptr ? name : "of an unknown kind") + ", not 8-bit 4:2:0");
        }
        core::Picture picture;
        picture.number = number_++;
        picture.y = copy(0, frame_->width, frame_->height);
        picture.cb = copy(1, (frame_->width + 1) / 2, (frame_->height + 1) / 2);
        picture.cr = copy(2, (frame_->width + 1) / 2, (frame_->height + 1) / 2);
        picture_(picture);
    }

    core::Plane<std::uint8_t> copy(int plane, int width, int height) const {
        core::Plane<std::uint8_t> result(width, height);
        for (int y = 0; y < height; ++y)
            std::copy_n(frame_->data[plane] + static_cast<std::ptrdiff_t>(y) * frame_->linesize[plane], width,
                        result.row(y));
        return result;
    }

    std::string file_;
    const std::function<void(const core::Picture&)>& picture_;
    Messages messages_;
    Input input_;
    Decoder decoder_;
    Packet packet_{av_packet_alloc()};
    Frame frame_{av_frame_alloc()};
    int stream_ = -1;
    std::int64_t number_ = 0;
};

}  // namespace

void decode_film(const std::filesystem::path& file, const std::function<void(const core::Picture&)>& picture) {
    Film(file, picture).decode();
}

}  // namespace render2mpeg::av
