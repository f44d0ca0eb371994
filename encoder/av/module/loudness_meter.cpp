#include "encoder/av/module/loudness_meter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <new>

#include "core/error.h"

namespace render2mpeg::av {

LoudnessMeter::LoudnessMeter(int channels, int rate)
    : channels_(channels),
      state_(ebur128_init(static_cast<unsigned>(channels), static_cast<unsigned long>(rate),
                          EBUR128_MODE_I | EBUR128_MODE_TRUE_PEAK | EBUR128_MODE_HISTOGRAM)) {
    if (!state_) throw std::bad_alloc();
}

template <class Sample>
void LoudnessMeter::interleave(const AVFrame& frame, bool is_planar, float full_scale) {
    const auto channels = static_cast<std::size_t>(channels_);
    for (std::size_t i = 0; i < interleaved_.size(); ++i) {
        const auto* samples = reinterpret_cast<const Sample*>(frame.extended_data[is_planar ? i % channels : 0]);
        interleaved_[i] = static_cast<float>(samples[is_planar ? i / channels : i]) / full_scale;
    }
}

void LoudnessMeter::add(const AVFrame& frame, int samples) {
    interleaved_.resize(static_cast<std::size_t>(samples) * static_cast<std::size_t>(channels_));
    const auto format = static_cast<AVSampleFormat>(frame.format);
    const bool is_planar = av_sample_fmt_is_planar(format) != 0;
    switch (av_get_packed_sample_fmt(format)) {
        case AV_SAMPLE_FMT_S16:
            interleave<std::int16_t>(frame, is_planar, 0x1p15f);
            break;
        case AV_SAMPLE_FMT_S32:
            interleave<std::int32_t>(frame, is_planar, 0x1p31f);
            break;
        default:
            EXPECTS(av_get_packed_sample_fmt(format) == AV_SAMPLE_FMT_FLT);
            interleave<float>(frame, is_planar, 1);
    }
    if (ebur128_add_frames_float(state_.get(), interleaved_.data(), static_cast<std::size_t>(samples)) !=
        EBUR128_SUCCESS)
        throw std::bad_alloc();
}

std::optional<Loudness> LoudnessMeter::loudness() const {
    Loudness found;
    if (ebur128_loudness_global(state_.get(), &found.integrated) != EBUR128_SUCCESS || !std::isfinite(found.integrated))
        return {};
    double peak = 0;
    for (int c = 0; c < channels_; ++c) {
        double of_channel = 0;
        ebur128_true_peak(state_.get(), static_cast<unsigned>(c), &of_channel);
        peak = std::max(peak, of_channel);
    }
    found.true_peak = 20 * std::log10(peak);
    return found;
}

}  // namespace render2mpeg::av
