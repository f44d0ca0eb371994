#pragma once

// The only file that includes FFmpeg's headers.
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/audio_fifo.h>
#include <libavutil/channel_layout.h>
#include <libavutil/log.h>
#include <libavutil/motion_vector.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
#include <libavutil/samplefmt.h>
#include <libavutil/video_enc_params.h>
#include <libswresample/swresample.h>
}

#include <memory>
#include <string>

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
