#include "encoder/mpeg2/rate/vbv_schedule.h"

#include <algorithm>

#include "core/error.h"
#include "encoder/cadence.h"

namespace render2mpeg::encoder::mpeg2 {

VbvSchedule::VbvSchedule(const Settings& settings, const Channel& channel, const MinimalBits& minimal)
    : settings_(settings), constant_(channel.constant), minimal_(minimal), buffer_(settings, channel) {}

VbvSchedule::Horizon VbvSchedule::horizon(const Numbers& starts) const {
    if (chunk_end_) return {*chunk_end_, hands_over_ ? buffer_.chunk_fullness(*chunk_end_) : 0};
    // An endless chunk: its next regular GOP must be possible.
    return {*starts.rbegin() + settings_.gop, std::min(buffer_.fractions(minimal_.intra), buffer_.capacity())};
}

std::int64_t VbvSchedule::least(const Numbers& starts, std::int64_t number) const {
    const std::int64_t last = *starts.rbegin();
    const bool intra = number > last ? (number - last) % settings_.gop == 0 : starts.contains(number);
    return buffer_.fractions(intra ? minimal_.intra : minimal_.other);
}

std::int64_t VbvSchedule::back(const Numbers& starts, std::int64_t end, std::int64_t from, std::int64_t need) const {
    // A constant rate fills the buffer by whole bytes, of which the last may be stuffing.
    const std::int64_t capacity = buffer_.capacity() - (constant_ ? buffer_.fractions(8) : 0);
    for (std::int64_t n = end - 1; n >= from && need <= capacity; --n)
        need = std::max<std::int64_t>(0, need - buffer_.arrivals(fields(n))) + least(starts, n);
    return need <= capacity ? need : unbearable;
}

std::optional<std::int64_t> VbvSchedule::need(const Numbers& starts, std::int64_t from) const {
    const Horizon end = horizon(starts);
    std::int64_t n = end.number, need = end.fractions;

    // Leap over what is far away: there, all periods of GOPs and fields are alike, and what the end of one needs makes
    // need(end) = max(a, need - gain) at its beginning. Once two are gone through, a third needs no more.
    const std::int64_t period = settings_.gop * (settings_.cadence == Cadence::pulldown ? 4ll : 1ll);
    const std::int64_t regular = std::max(*starts.rbegin() + 1, from);
    if (n - regular > 4 * period) {
        need = back(starts, n, n - 2 * period, need);
        n -= 2 * period;
        std::int64_t gain = 0;
        for (std::int64_t i = n - period; i < n; ++i) gain += buffer_.arrivals(fields(i)) - least(starts, i);
        if (need != unbearable && gain >= 0) {
            const std::int64_t leaps = (n - regular) / period;
            const bool forgotten = gain > 0 && leaps > need / gain;
            need = std::max(back(starts, n, n - period, 0), forgotten ? 0 : need - leaps * gain);
            n -= leaps * period;
        }
    }
    if (need != unbearable) need = back(starts, n, from, need);
    return need == unbearable ? std::nullopt : std::optional(need);
}

bool VbvSchedule::feasible(const Numbers& starts, std::int64_t from, std::int64_t fullness) const {
    const std::optional<std::int64_t> needed = need(starts, from);
    return needed && *needed <= fullness;
}

bool VbvSchedule::affords_gop(std::int64_t number) const {
    Numbers starts = gop_starts_;
    starts.insert(number);
    return feasible(starts, next_, buffer_.fullness());
}

void VbvSchedule::plan(std::int64_t number, bool intra, bool first_of_chunk, std::optional<std::int64_t> left_in_chunk,
                       bool last_chunk) {
    if (intra) gop_starts_.insert(number);
    if (first_of_chunk || !started_) {
        chunk_end_ = left_in_chunk ? std::optional(number + *left_in_chunk + 1) : std::nullopt;
        hands_over_ = !last_chunk;
    }
    if (!started_) {
        next_ = number;
        buffer_.start_chunk(number);
    }
    started_ = true;
    planned_end_ = number + 1;
}

std::int64_t VbvSchedule::most_bits() const {
    EXPECTS(next_ < planned_end_);
    const Horizon end = horizon(gop_starts_);
    const std::int64_t after =
        next_ + 1 < end.number ? need(gop_starts_, next_ + 1).value_or(buffer_.capacity()) : end.fractions;
    const std::int64_t keep = std::max<std::int64_t>(0, after - buffer_.arrivals(fields(next_)));
    return buffer_.whole_bits(std::max<std::int64_t>(0, buffer_.fullness() - keep)) / 8 * 8;
}

Removal VbvSchedule::take(std::int64_t bits, std::int64_t bits_to_start_code) {
    Removal removal;
    removal.fullness_before = fullness();
    if (constant_) removal.delay = buffer_.delay(bits_to_start_code);
    const Horizon end = horizon(gop_starts_);
    const bool hands_over = hands_over_ && chunk_end_ == next_ + 1;
    removal.stuffing_bytes = buffer_.take(bits, fields(next_), hands_over ? &end.number : nullptr);
    removal.fullness_after = removal.fullness_before - bits - 8 * removal.stuffing_bytes;
    removal.fullness_next = fullness();
    ++next_;
    while (gop_starts_.size() > 1 && *std::next(gop_starts_.begin()) <= next_) gop_starts_.erase(gop_starts_.begin());
    return removal;
}

namespace {

/// Fewest fields that `count` pictures in a row are shown for.
std::int64_t fewest_fields(Cadence cadence, std::int64_t count) {
    std::int64_t fewest = std::numeric_limits<std::int64_t>::max();
    for (const std::int64_t phase : {0, 1, 2, 3})
        fewest = std::min(fewest, fields_before(cadence, phase + count) - fields_before(cadence, phase));
    return fewest;
}

}  // namespace

void check_channel(const Settings& settings, const Level& level) {
    const Channel channel = channel_for(settings, level);
    const MinimalBits minimal = minimal_bits(settings, level);
    const VbvBuffer buffer(settings, channel);
    const core::Rational hertz = declared_rate(settings).hertz;
    const std::int64_t longest = buffer.arrivals(3);
    const auto text = [](std::int64_t bits) { return std::to_string(bits); };

    // GOP by GOP no more may be needed than comes in.
    const std::int64_t per_gop = minimal.intra + (settings.gop - 1) * minimal.other;
    const std::int64_t fields = fewest_fields(settings.cadence, settings.gop);
    if (2 * per_gop * hertz.num > fields * channel.average_rate * hertz.den) {
        const std::int64_t unit = 400, needed = 2 * per_gop * hertz.num / (fields * hertz.den) + 1;
        throw core::Error("bit rate " + text(channel.average_rate) + ": even pictures without detail need " +
                          text((needed + unit - 1) / unit * unit) + " at this size, rate and GOP length");
    }
    if (minimal.intra > channel.chunk_fullness)
        throw core::Error("VBV buffer " + text(channel.usable_bits) + " bits: a GOP needs room for " +
                          text(minimal.intra) + " at its start, even without detail, in four fifths of the buffer");
    if (channel.constant && buffer.fractions(channel.chunk_fullness) < longest + buffer.fractions(16))
        throw core::Error("VBV buffer " + text(channel.usable_bits) + " bits: at a constant " + text(channel.bit_rate) +
                          " bits per second " + text(buffer.whole_bits(longest)) +
                          " arrive while a picture is shown; they must fit in four fifths of the buffer");

    // And picture by picture: then chunks of whole GOPs can be coded one after the other, since each finds what it
    // hands over. Where fields repeat, chunks begin at any of four phases.
    for (const std::int64_t phase : {0, 1, 2, 3}) {
        VbvSchedule schedule(settings, channel, minimal);
        schedule.plan(settings.first_number + phase, true, true, settings.gop - 1, false);
        if (!schedule.feasible())
            throw core::Error("bit rate " + text(channel.bit_rate) + " with a VBV buffer of " +
                              text(channel.usable_bits) + " bits: even a GOP without detail would not fit");
        if (settings.cadence != Cadence::pulldown) break;
    }
}

}  // namespace render2mpeg::encoder::mpeg2
