#include "encoder/av/module/sound_source.h"

#include "core/error.h"
#include "encoder/av/module/input.h"

namespace render2mpeg::av {

SoundSource::SoundSource(const std::string& file) : file_(file) {
    OpenStream open = open_stream(file, AVMEDIA_TYPE_AUDIO, AV_EF_EXPLODE, messages_);
    input_ = std::move(open.input);
    stream_ = open.stream->index;
    const AVCodec* codec = avcodec_find_decoder(open.stream->codecpar->codec_id);
    if (codec == nullptr) throw core::Error("reading", file_, "its sound is of a kind that is not understood");
    decoder_.reset(avcodec_alloc_context3(codec));
    if (!decoder_ || !packet_ || !frame_) check(AVERROR(ENOMEM));
    check(avcodec_parameters_to_context(decoder_.get(), open.stream->codecpar));
    decoder_->flags |= AV_CODEC_FLAG_BITEXACT;
    decoder_->thread_count = 1;
    check(avcodec_open2(decoder_.get(), codec, nullptr));
    av_channel_layout_default(&layout_, decoder_->ch_layout.nb_channels == 1 ? 1 : 2);
}

void SoundSource::check(int result) const {
    if (result < 0) throw core::Error("reading", file_, cause_of(result, messages_));
}

void SoundSource::convert_to(AVSampleFormat format) {
    format_ = format;
}

bool SoundSource::read(AVAudioFifo* into) {
    const int before = av_audio_fifo_size(into);
    while (!drained_ && av_audio_fifo_size(into) == before) {
        if (receive(into)) continue;
        const int result = av_read_frame(input_.get(), packet_.get());
        if (result == AVERROR_EOF) {
            check(avcodec_send_packet(decoder_.get(), nullptr));
            while (receive(into)) {
            }
            if (resampler_) add(into, nullptr);
            drained_ = true;
        } else {
            check(result);
            if (packet_->stream_index == stream_) check(avcodec_send_packet(decoder_.get(), packet_.get()));
            av_packet_unref(packet_.get());
        }
    }
    return av_audio_fifo_size(into) > before;
}

/// One decoded frame, if there is one.
bool SoundSource::receive(AVAudioFifo* into) {
    const int result = avcodec_receive_frame(decoder_.get(), frame_.get());
    if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return false;
    check(result);
    if (!resampler_) {
        SwrContext* made = nullptr;
        check(swr_alloc_set_opts2(&made, &layout_, format_, rate, &frame_->ch_layout,
                                  static_cast<AVSampleFormat>(frame_->format), frame_->sample_rate, 0, nullptr));
        resampler_.reset(made);
        check(swr_init(made));
    }
    add(into, frame_.get());
    return true;
}

/// Converts; null: flushes the resampler.
void SoundSource::add(AVAudioFifo* into, const AVFrame* frame) {
    const int given = frame != nullptr ? frame->nb_samples : 0;
    const Frame converted(av_frame_alloc());
    if (!converted) check(AVERROR(ENOMEM));
    const int most = swr_get_out_samples(resampler_.get(), given);
    check(most);
    if (most == 0) return;
    converted->nb_samples = most;
    converted->format = format_;
    converted->sample_rate = rate;
    check(av_channel_layout_copy(&converted->ch_layout, &layout_));
    check(av_frame_get_buffer(converted.get(), 0));
    const int made =
        swr_convert(resampler_.get(), converted->extended_data, most,
                    frame != nullptr ? const_cast<const std::uint8_t**>(frame->extended_data) : nullptr, given);
    check(made);
    check(av_audio_fifo_write(into, reinterpret_cast<void**>(converted->extended_data), made));
}

}  // namespace render2mpeg::av
