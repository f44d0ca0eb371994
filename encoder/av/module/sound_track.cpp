#include "encoder/av/module/sound_track.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/error.h"

namespace render2mpeg::av {
namespace {

AVCodecID codec_for(const AVFormatContext& container, encoder::Codec codec, bool ac3) {
    const std::string format = container.oformat->name;
    // Masters' sound is not coded either, where their container can have such.
    if (encoder::facts_of(codec).master && format != "mp4") return AV_CODEC_ID_PCM_S24LE;
    if (format == "webm") return AV_CODEC_ID_OPUS;
    if (format == "matroska" || format == "mp4" || format == "mov") return AV_CODEC_ID_AAC;
    return ac3 || format == "dvd" ? AV_CODEC_ID_AC3 : AV_CODEC_ID_MP2;
}

/// chosen: samples in a packet of sound that is not coded, as many as AAC has.
constexpr int pcm_frame = 1024;

}  // namespace

SoundTrack::SoundTrack(const Sound& sound, AVFormatContext& container, encoder::Codec codec)
    : file_(sound.file.string()), container_(container), source_(file_), meter_(source_.channels(), SoundSource::rate) {
    if (!packet_) check(AVERROR(ENOMEM));
    total_ = std::llround(sound.seconds * SoundSource::rate);
    open_encoder(codec_for(container, codec, sound.ac3));
    frame_size_ = encoder_->frame_size > 0 ? encoder_->frame_size : pcm_frame;
    const AVSampleFormat format = encoder_->sample_fmt;
    source_.convert_to(format);
    samples_.reset(av_audio_fifo_alloc(format, source_.channels(), frame_size_));
    if (!samples_) check(AVERROR(ENOMEM));
    const std::int64_t begin = std::llround(sound.offset * SoundSource::rate);
    if (begin > 0) add_silence(std::min(begin, total_));
    skipped_ = std::max<std::int64_t>(0, -begin);
}

void SoundTrack::check(int result) const {
    if (result < 0) throw core::Error("writing the sound of", file_, cause_of(result, messages_));
}

void SoundTrack::open_encoder(AVCodecID id) {
    const AVCodec* codec = avcodec_find_encoder(id);
    if (codec == nullptr)
        throw core::Error("writing the sound of", file_, "this libavcodec does not encode such sound");
    encoder_.reset(avcodec_alloc_context3(codec));
    if (!encoder_) check(AVERROR(ENOMEM));
    encoder_->sample_rate = SoundSource::rate;
    encoder_->sample_fmt = first_sample_format(*codec);
    encoder_->time_base = {1, SoundSource::rate};
    encoder_->bit_rate = std::int64_t{id == AV_CODEC_ID_AAC ? aac_rate : other_rate} * source_.channels();
    encoder_->thread_count = 1;
    encoder_->flags |= AV_CODEC_FLAG_BITEXACT;
    if ((container_.oformat->flags & AVFMT_GLOBALHEADER) != 0) encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    av_channel_layout_default(&encoder_->ch_layout, source_.channels());
    check(avcodec_open2(encoder_.get(), codec, nullptr));
    stream_ = avformat_new_stream(&container_, nullptr);
    if (stream_ == nullptr) check(AVERROR(ENOMEM));
    stream_->time_base = encoder_->time_base;
    check(avcodec_parameters_from_context(stream_->codecpar, encoder_.get()));
}

Frame SoundTrack::silent_frame(int samples) const {
    Frame frame(av_frame_alloc());
    if (!frame) check(AVERROR(ENOMEM));
    frame->nb_samples = samples;
    frame->format = encoder_->sample_fmt;
    frame->sample_rate = SoundSource::rate;
    check(av_channel_layout_copy(&frame->ch_layout, &encoder_->ch_layout));
    check(av_frame_get_buffer(frame.get(), 0));
    check(av_samples_set_silence(frame->extended_data, 0, samples, source_.channels(), encoder_->sample_fmt));
    return frame;
}

void SoundTrack::add_silence(std::int64_t samples) {
    while (samples > 0) {
        const Frame frame = silent_frame(static_cast<int>(std::min<std::int64_t>(samples, 1 << 16)));
        check(av_audio_fifo_write(samples_.get(), reinterpret_cast<void**>(frame->extended_data), frame->nb_samples));
        samples -= frame->nb_samples;
    }
}

/// Sees that so many samples wait, as long as the file has more.
void SoundTrack::read_ahead(int samples) {
    while (!at_end_ && av_audio_fifo_size(samples_.get()) < samples) {
        at_end_ = !source_.read(samples_.get());
        const auto cut = static_cast<int>(std::min<std::int64_t>(skipped_, av_audio_fifo_size(samples_.get())));
        check(av_audio_fifo_drain(samples_.get(), cut));
        skipped_ -= cut;
    }
}

void SoundTrack::write_until(double seconds) {
    // chosen: half a second ahead, so that containers find the sound before the pictures it belongs to.
    const double wanted = (seconds + 0.5) * SoundSource::rate;
    while (static_cast<double>(encoded_) < wanted && encoded_ < total_) {
        read_ahead(frame_size_);
        const auto there = std::min<std::int64_t>({av_audio_fifo_size(samples_.get()), frame_size_, total_ - encoded_});
        if (there == 0) return;
        // The last frame is filled up with silence, for encoders that take whole ones only.
        const Frame frame = silent_frame(encoder_->frame_size > 0 ? frame_size_ : static_cast<int>(there));
        check(av_audio_fifo_read(samples_.get(), reinterpret_cast<void**>(frame->extended_data),
                                 static_cast<int>(there)));
        meter_.add(*frame, static_cast<int>(there));
        frame->pts = encoded_;
        encoded_ += there;
        encode(frame.get());
    }
}

std::optional<Loudness> SoundTrack::finish() {
    write_until(static_cast<double>(total_) / SoundSource::rate);
    encode(nullptr);
    return meter_.loudness();
}

/// Encodes a frame; null: flushes the encoder.
void SoundTrack::encode(const AVFrame* frame) {
    check(avcodec_send_frame(encoder_.get(), frame));
    while (true) {
        const int result = avcodec_receive_packet(encoder_.get(), packet_.get());
        if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return;
        check(result);
        packet_->stream_index = stream_->index;
        av_packet_rescale_ts(packet_.get(), encoder_->time_base, stream_->time_base);
        check(av_interleaved_write_frame(&container_, packet_.get()));
    }
}

}  // namespace render2mpeg::av
