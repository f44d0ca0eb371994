#pragma once

// The only file that includes FFmpeg's headers.
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/audio_fifo.h>
#include <libavutil/channel_layout.h>
#include <libavutil/intreadwrite.h>
#include <libavutil/log.h>
#include <libavutil/mastering_display_metadata.h>
#include <libavutil/motion_vector.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
#include <libavutil/samplefmt.h>
#include <libavutil/spherical.h>
#include <libavutil/stereo3d.h>
#include <libavutil/timecode.h>
#include <libavutil/video_enc_params.h>
#include <libswresample/swresample.h>
}

#include <cstdint>
#include <memory>
#include <string>

#include "encoder/codec.h"

namespace render2mpeg::av {

/// Frees with the function that FFmpeg wants for it: those take the pointer's address.
template <class T, void (*free)(T**)>
struct Freed {
    void operator()(T* object) const { free(&object); }
};
using Packet = std::unique_ptr<AVPacket, Freed<AVPacket, av_packet_free>>;
using Frame = std::unique_ptr<AVFrame, Freed<AVFrame, av_frame_free>>;
using Resampler = std::unique_ptr<SwrContext, Freed<SwrContext, swr_free>>;
using Decoder = std::unique_ptr<AVCodecContext, Freed<AVCodecContext, avcodec_free_context>>;
struct FifoFreed {
    void operator()(AVAudioFifo* fifo) const { av_audio_fifo_free(fifo); }
};
using AudioFifo = std::unique_ptr<AVAudioFifo, FifoFreed>;
using Input = std::unique_ptr<AVFormatContext, Freed<AVFormatContext, avformat_close_input>>;

// FFmpeg 5.1 to 7.1 behind the same calls.

inline bool is_interlaced(const AVFrame& frame) {
#if LIBAVUTIL_VERSION_INT >= AV_VERSION_INT(58, 7, 100)
    return (frame.flags & AV_FRAME_FLAG_INTERLACED) != 0;
#else
    return frame.interlaced_frame != 0;
#endif
}

inline bool is_top_field_first(const AVFrame& frame) {
#if LIBAVUTIL_VERSION_INT >= AV_VERSION_INT(58, 7, 100)
    return (frame.flags & AV_FRAME_FLAG_TOP_FIELD_FIRST) != 0;
#else
    return frame.top_field_first != 0;
#endif
}

/// Has decoders number their frames: each gets the number of its packet.
inline void number_frames(AVCodecContext& decoder) {
#ifdef AV_CODEC_FLAG_COPY_OPAQUE
    decoder.flags |= AV_CODEC_FLAG_COPY_OPAQUE;
#else
    (void)decoder;
#endif
}

/// Called before the packet is sent.
inline void set_number(AVCodecContext& decoder, AVPacket& packet, std::int64_t number) {
#ifdef AV_CODEC_FLAG_COPY_OPAQUE
    (void)decoder;
    packet.opaque = reinterpret_cast<void*>(static_cast<std::intptr_t>(number));
#else
    (void)packet;
    decoder.reordered_opaque = number;
#endif
}

inline std::int64_t number_of(const AVFrame& frame) {
#ifdef AV_CODEC_FLAG_COPY_OPAQUE
    return reinterpret_cast<std::intptr_t>(frame.opaque);
#else
    return frame.reordered_opaque;
#endif
}

/// Null where a stream has none of a type.
template <class Content>
const Content* side_data_of(const AVStream& stream, AVPacketSideDataType type) {
    const std::uint8_t* data = nullptr;
    std::size_t size = 0;
#if LIBAVCODEC_VERSION_INT >= AV_VERSION_INT(60, 31, 100)
    const AVPacketSideData* found =
        av_packet_side_data_get(stream.codecpar->coded_side_data, stream.codecpar->nb_coded_side_data, type);
    if (found != nullptr) {
        data = found->data;
        size = found->size;
    }
#else
    data = av_stream_get_side_data(&stream, type, &size);
#endif
    return size >= sizeof(Content) ? reinterpret_cast<const Content*>(data) : nullptr;
}

/// Gives the stream `data`, which av_malloc made, and which the caller keeps if the result is negative.
inline int add_side_data(AVStream& stream, AVPacketSideDataType type, void* data, std::size_t size) {
#if LIBAVCODEC_VERSION_INT >= AV_VERSION_INT(60, 31, 100)
    AVCodecParameters& codec = *stream.codecpar;
    const AVPacketSideData* const added =
        av_packet_side_data_add(&codec.coded_side_data, &codec.nb_coded_side_data, type, data, size, 0);
    return added != nullptr ? 0 : AVERROR(ENOMEM);
#else
    return av_stream_add_side_data(&stream, type, static_cast<std::uint8_t*>(data), size);
#endif
}

/// Preferred sample format of an audio encoder.
inline AVSampleFormat first_sample_format(const AVCodec& codec) {
#if LIBAVCODEC_VERSION_INT >= AV_VERSION_INT(61, 13, 100)
    const void* formats = nullptr;
    const int result =
        avcodec_get_supported_config(nullptr, &codec, AV_CODEC_CONFIG_SAMPLE_FORMAT, 0, &formats, nullptr);
    return result < 0 || formats == nullptr ? AV_SAMPLE_FMT_FLTP : *static_cast<const AVSampleFormat*>(formats);
#else
    return codec.sample_fmts[0];
#endif
}

/// Whether an encoder takes pixels of this format.
inline bool takes(const AVCodec& codec, AVPixelFormat wanted) {
#if LIBAVCODEC_VERSION_INT >= AV_VERSION_INT(61, 13, 100)
    const void* formats = nullptr;
    if (avcodec_get_supported_config(nullptr, &codec, AV_CODEC_CONFIG_PIX_FORMAT, 0, &formats, nullptr) < 0)
        return false;
    const auto* format = static_cast<const AVPixelFormat*>(formats);
#else
    const AVPixelFormat* format = codec.pix_fmts;
#endif
    while (format != nullptr && *format != AV_PIX_FMT_NONE && *format != wanted) ++format;
    return format != nullptr && *format == wanted;
}

/// FFmpeg's number of a codec's streams.
inline AVCodecID id_of(encoder::Codec codec) {
    const AVCodecDescriptor* known = avcodec_descriptor_get_by_name(encoder::facts_of(codec).ffmpeg.stream.data());
    return known == nullptr ? AV_CODEC_ID_NONE : known->id;
}

/// Pixels of a film; alpha is left out where it has none and the codec can do without.
inline AVPixelFormat pixels_of(const encoder::Settings& settings) {
    const encoder::CodecFacts& facts = encoder::facts_of(settings.codec);
    const bool can_do_without = facts.has_alpha() && !facts.master;
    return can_do_without && !settings.alpha ? AV_PIX_FMT_YUV420P : av_get_pix_fmt(facts.ffmpeg.pixels.data());
}

/// Catches what FFmpeg would print on the terminal, while it lives and on its own thread: FFmpeg is asked for no
/// threads. Messages of threads that have no Messages are dropped.
class Messages {
  public:
    Messages();
    ~Messages();
    Messages(const Messages&) = delete;
    Messages& operator=(const Messages&) = delete;

    /// Whether something went wrong that a function's result need not tell: an error, or damage that was concealed.
    bool has_error() const { return !error_.empty(); }
    /// The first error's text; else the latest warning's; else empty.
    const std::string& text() const { return error_.empty() ? warning_ : error_; }

  private:
    static void receive(void* source, int level, const char* format, va_list arguments);

    std::string error_, warning_;
    Messages* outer_;
};

/// FFmpeg's words for one of its negative results, and what it said itself.
std::string cause_of(int result, const Messages& messages);

}  // namespace render2mpeg::av
