#pragma once
// Decodes a file's sound, with libavformat, libavcodec and libswresample.
#include <cstdint>
#include <string>

#include "encoder/av/module/ffmpeg.h"

namespace render2mpeg::av {

/// A file's first audio stream as samples at 48 kHz.
class SoundSource {
  public:
    static constexpr int rate = 48000;  ///< samples per second

    /// Throws core::Error where the file cannot be read or has no sound.
    explicit SoundSource(const std::string& file);

    /// 1, or 2 for whatever has more.
    int channels() const { return layout_.nb_channels; }
    /// In which form samples come. To be called once, before read().
    void convert_to(AVSampleFormat format);
    /// Adds the next samples to `into`, which has this format and so many channels. False at the end. Throws
    /// core::Error for damage.
    bool read(AVAudioFifo* into);

  private:
    void check(int result) const;
    bool receive(AVAudioFifo* into);
    void add(AVAudioFifo* into, const AVFrame* frame);

    std::string file_;
    Messages messages_;
    Input input_;
    int stream_ = -1;
    Decoder decoder_;
    AVChannelLayout layout_{};
    AVSampleFormat format_ = AV_SAMPLE_FMT_NONE;
    Resampler resampler_;
    Packet packet_{av_packet_alloc()};
    Frame frame_{av_frame_alloc()};
    bool drained_ = false;
};

}  // namespace render2mpeg::av
