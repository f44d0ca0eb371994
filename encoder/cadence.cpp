#include "encoder/cadence.h"

#include "core/error.h"

namespace render2mpeg::encoder {
namespace {

/// Pictures and fields after which the pulldown begins anew: 3 + 2 + 3 + 2 fields for four pictures.
constexpr std::int64_t pulldown_pictures = 4, pulldown_fields = 10;

/// Where number lies in the pulldown, 0..3.
int phase_of(std::int64_t index) {
    return static_cast<int>(((index % pulldown_pictures) + pulldown_pictures) % pulldown_pictures);
}

}  // namespace

core::FrameRate declared_rate(const Settings& settings) {
    if (settings.cadence != Cadence::pulldown) return settings.rate;
    for (const core::FrameRate& rate : core::mpeg2_frame_rates())
        if (rate.hertz.num * 4 * settings.rate.hertz.den == settings.rate.hertz.num * 5 * rate.hertz.den) return rate;
    return settings.rate;  // refused by check()
}

ShownFields fields_of(const Settings& settings, std::int64_t number) {
    if (settings.cadence == Cadence::frames) return {};
    if (settings.cadence == Cadence::fields) return {true, false, 2};
    // top bottom top, bottom top, bottom top bottom, top bottom.
    static constexpr ShownFields fields[] = {{true, true, 3}, {false, false, 2}, {false, true, 3}, {true, false, 2}};
    return fields[phase_of(number - settings.first_number)];
}

std::int64_t fields_before(Cadence cadence, std::int64_t index) {
    if (cadence != Cadence::pulldown) return 2 * index;
    static constexpr std::int64_t before[] = {0, 3, 5, 8};
    const int phase = phase_of(index);
    return (index - phase) / pulldown_pictures * pulldown_fields + before[phase];
}

}  // namespace render2mpeg::encoder
