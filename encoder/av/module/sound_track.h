#pragma once
// Encodes a film's sound into a stream of its container, with libavcodec.
#include <cstdint>
#include <optional>
#include <string>

#include "encoder/av/module/ffmpeg.h"
#include "encoder/av/module/loudness_meter.h"
#include "encoder/av/module/sound_source.h"
#include "encoder/av/sound.h"

namespace render2mpeg::av {

/// A film's sound on its way from a file into a container's second stream.
class SoundTrack {
  public:
    /// Opens the file and adds the stream to `container`, whose header is not written yet and whose pictures are of
    /// `codec`.
    SoundTrack(const Sound& sound, AVFormatContext& container, encoder::Codec codec);

    /// Bits per second.
    std::int64_t bit_rate() const { return encoder_->bit_rate; }
    /// Writes what sounds before this instant of the film, and a little more.
    void write_until(double seconds);
    /// Writes the rest. Returns how loud all of it is before it is coded; none: silent.
    std::optional<Loudness> finish();

  private:
    void check(int result) const;
    void open_encoder(AVCodecID id);
    void read_ahead(int samples);
    Frame silent_frame(int samples) const;
    void add_silence(std::int64_t samples);
    void encode(const AVFrame* frame);

    std::string file_;
    Messages messages_;
    AVFormatContext& container_;
    AVStream* stream_ = nullptr;
    SoundSource source_;
    LoudnessMeter meter_;
    Decoder encoder_;
    AudioFifo samples_;
    std::int64_t skipped_ = 0;  ///< samples of the file's beginning that are still to be left out
    std::int64_t total_ = 0;    ///< samples of the film
    std::int64_t encoded_ = 0;
    int frame_size_ = 0;  ///< samples of a packet
    bool at_end_ = false;
    Packet packet_{av_packet_alloc()};
};

}  // namespace render2mpeg::av
