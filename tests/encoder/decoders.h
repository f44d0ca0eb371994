#pragma once

#include <algorithm>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/log.h>
#include <mpeg2dec/mpeg2.h>
}

#include "core/picture.h"

/// Foreign decoders, whose word counts.
namespace render2mpeg::encoder::testing {

inline core::Plane<std::uint8_t> copy_plane(const std::uint8_t* from, int stride, int width, int height) {
    core::Plane<std::uint8_t> plane(width, height);
    for (int y = 0; y < height; ++y) std::copy_n(from + static_cast<std::ptrdiff_t>(y) * stride, width, plane.row(y));
    return plane;
}

/// libavcodec with the transform our reconstruction promises to equal. Throws on any error and on any message it logs.
class Libavcodec {
  public:
    Libavcodec() : context_(avcodec_alloc_context3(avcodec_find_decoder(AV_CODEC_ID_MPEG2VIDEO))) {
        messages().clear();
        av_log_set_callback([](void*, int level, const char* format, va_list arguments) {
            if (level > AV_LOG_WARNING) return;
            char line[512];
            vsnprintf(line, sizeof line, format, arguments);
            messages() += line;
        });
        context_->idct_algo = FF_IDCT_SIMPLE;
        context_->flags |= AV_CODEC_FLAG_BITEXACT;
        context_->err_recognition = AV_EF_EXPLODE | AV_EF_BITSTREAM | AV_EF_BUFFER;
        context_->error_concealment = 0;
        context_->thread_count = 1;
        if (avcodec_open2(context_, nullptr, nullptr) < 0) throw std::runtime_error("libavcodec has no MPEG-2 decoder");
    }
    ~Libavcodec() { avcodec_free_context(&context_); }
    Libavcodec(const Libavcodec&) = delete;
    Libavcodec& operator=(const Libavcodec&) = delete;

    /// Takes one access unit.
    void push(std::span<const std::uint8_t> bytes) {
        std::vector<std::uint8_t> padded(bytes.begin(), bytes.end());
        padded.resize(bytes.size() + AV_INPUT_BUFFER_PADDING_SIZE);
        AVPacket* packet = av_packet_alloc();
        packet->data = padded.data();
        packet->size = static_cast<int>(bytes.size());
        const int status = avcodec_send_packet(context_, packet);
        av_packet_free(&packet);
        if (status < 0) throw std::runtime_error("libavcodec refuses an access unit: " + messages());
        receive();
    }
    /// All pictures in display order.
    std::vector<core::Picture> finish() {
        avcodec_send_packet(context_, nullptr);
        receive();
        if (!messages().empty()) throw std::runtime_error("libavcodec says: " + messages());
        return std::move(pictures_);
    }
    const AVCodecContext& context() const { return *context_; }
    /// Of each picture so far: fields it is shown for, and whether it begins with the upper lines.
    const std::vector<std::pair<int, bool>>& fields() const { return fields_; }

  private:
    static std::string& messages() {
        static std::string text;
        return text;
    }
    void receive() {
        AVFrame* frame = av_frame_alloc();
        while (avcodec_receive_frame(context_, frame) == 0) {
            const int w = frame->width, h = frame->height;
            core::Picture picture;
            picture.number = static_cast<std::int64_t>(pictures_.size());
            picture.y = copy_plane(frame->data[0], frame->linesize[0], w, h);
            picture.cb = copy_plane(frame->data[1], frame->linesize[1], (w + 1) / 2, (h + 1) / 2);
            picture.cr = copy_plane(frame->data[2], frame->linesize[2], (w + 1) / 2, (h + 1) / 2);
            if (frame->decode_error_flags != 0) throw std::runtime_error("libavcodec marks a picture as damaged");
            pictures_.push_back(std::move(picture));
#if LIBAVUTIL_VERSION_INT >= AV_VERSION_INT(58, 7, 100)
            const bool top_first = (frame->flags & AV_FRAME_FLAG_TOP_FIELD_FIRST) != 0;
#else
            const bool top_first = frame->top_field_first != 0;
#endif
            fields_.emplace_back(2 + frame->repeat_pict, top_first);
        }
        av_frame_free(&frame);
    }

    AVCodecContext* context_;
    std::vector<core::Picture> pictures_;
    std::vector<std::pair<int, bool>> fields_;
};

/// What libmpeg2 makes of a whole stream: pictures of whole macroblocks cropped to the display size, in display order.
inline std::vector<core::Picture> decode_with_libmpeg2(std::vector<std::uint8_t> stream) {
    const std::unique_ptr<mpeg2dec_t, void (*)(mpeg2dec_t*)> decoder(mpeg2_init(), mpeg2_close);
    const mpeg2_info_t* info = mpeg2_info(decoder.get());
    std::vector<core::Picture> pictures;
    mpeg2_buffer(decoder.get(), stream.data(), stream.data() + stream.size());
    for (;;) {
        switch (mpeg2_parse(decoder.get())) {
            case STATE_BUFFER:
                return pictures;
            case STATE_INVALID:
            case STATE_INVALID_END:
                throw std::runtime_error("libmpeg2 calls the stream invalid");
            case STATE_SLICE:
            case STATE_END: {
                if (!info->display_fbuf) break;
                const mpeg2_sequence_t& s = *info->sequence;
                const int w = static_cast<int>(s.picture_width), h = static_cast<int>(s.picture_height);
                core::Picture picture;
                picture.number = static_cast<std::int64_t>(pictures.size());
                picture.y = copy_plane(info->display_fbuf->buf[0], static_cast<int>(s.width), w, h);
                for (int i = 1; i <= 2; ++i)
                    (i == 1 ? picture.cb : picture.cr) = copy_plane(
                        info->display_fbuf->buf[i], static_cast<int>(s.chroma_width), (w + 1) / 2, (h + 1) / 2);
                pictures.push_back(std::move(picture));
                break;
            }
            default:
                break;
        }
    }
}

}  // namespace render2mpeg::encoder::testing
