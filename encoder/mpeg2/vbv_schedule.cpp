#include "encoder/mpeg2/vbv_schedule.h"

#include <algorithm>

#include "core/error.h"
#include "encoder/cadence.h"

namespace render2mpeg::encoder::mpeg2 {

VbvSchedule::VbvSchedule(const Settings& settings, const Channel& channel, const MinimalBits& minimal)
    : settings_(settings), constant_(channel.constant), minimal_(minimal), buffer_(settings, channel) {}

VbvSchedule::Horizon VbvSchedule::horizon(const Numbers& starts, std::int64_t from) const {
    const auto chunk = chunk_starts_.upper_bound(from);
    if (chunk != chunk_starts_.end()) return {*chunk, buffer_.border(*chunk)};
    if (chunk_end_) return {*chunk_end_, hands_over_ ? buffer_.border(*chunk_end_) : 0};
    // An endless chunk: its next regular GOP must be possible.
    return {*starts.rbegin() + settings_.gop, std::min(buffer_.fractions(minimal_.intra), buffer_.capacity())};
}

std::optional<std::int64_t> VbvSchedule::need(const Numbers& starts, std::int64_t from) const {
    const Horizon end = horizon(starts, from);
    // A constant rate fills the buffer by whole bytes, of which the last may be stuffing.
    const std::int64_t capacity = buffer_.capacity() - (constant_ ? buffer_.fractions(8) : 0);
    std::int64_t need = end.fractions;
    for (std::int64_t n = end.number - 1; n >= from; --n) {
        const std::int64_t last = *starts.rbegin();
        const bool intra = n > last ? (n - last) % settings_.gop == 0 : starts.contains(n);
        need = std::max<std::int64_t>(0, need - buffer_.arrivals(fields(n)));
        need += buffer_.fractions(intra ? minimal_.intra : minimal_.other);
        if (need > capacity) return {};
    }
    return need;
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

void VbvSchedule::plan(std::int64_t number, bool starts_gop, bool first_of_chunk,
                       std::optional<std::int64_t> left_in_chunk, bool last_chunk) {
    // A chunk whose length is known hands its buffer over in a known state, and so finds one.
    const bool enters = first_of_chunk && (!started_ || promised_);
    if (!started_) next_ = number;
    if (starts_gop) gop_starts_.insert(number);
    if (enters && started_) chunk_starts_.insert(number);
    if (first_of_chunk || !started_) {
        promised_ = left_in_chunk.has_value();
        chunk_end_ = left_in_chunk ? std::optional(number + *left_in_chunk + 1) : std::nullopt;
        hands_over_ = !last_chunk;
    }
    if (!started_) buffer_.start_chunk(number);
    started_ = true;
    planned_end_ = number + 1;
}

std::int64_t VbvSchedule::most_bits() const {
    EXPECTS(next_ < planned_end_);
    const Horizon end = horizon(gop_starts_, next_);
    const std::int64_t after =
        next_ + 1 < end.number ? need(gop_starts_, next_ + 1).value_or(buffer_.capacity()) : end.fractions;
    const std::int64_t keep = std::max<std::int64_t>(0, after - buffer_.arrivals(fields(next_)));
    return buffer_.whole_bits(std::max<std::int64_t>(0, buffer_.fullness() - keep)) / 8 * 8;
}

Removal VbvSchedule::take(std::int64_t bits, std::int64_t bits_to_start_code) {
    Removal removal;
    removal.fullness_before = fullness();
    if (constant_) removal.delay = buffer_.delay(bits_to_start_code);
    const Horizon end = horizon(gop_starts_, next_);
    const bool hands_over =
        end.number == next_ + 1 && (chunk_starts_.contains(end.number) || (chunk_end_ == end.number && hands_over_));
    removal.stuffing_bytes = buffer_.take(bits, fields(next_), hands_over ? &end.number : nullptr);
    removal.fullness_after = removal.fullness_before - bits - 8 * removal.stuffing_bytes;

    removal.fullness_next = fullness();

    // The next chunk finds what it was promised, and no more.
    ++next_;
    if (hands_over) buffer_.start_chunk(next_);
    chunk_starts_.erase(next_);
    while (gop_starts_.size() > 1 && *std::next(gop_starts_.begin()) <= next_) gop_starts_.erase(gop_starts_.begin());
    return removal;
}

void check_channel(const Settings& settings, const Level& level) {
    const Channel channel = channel_for(settings, level);
    const MinimalBits minimal = minimal_bits(settings, level);
    const VbvBuffer buffer(settings, channel);
    const std::int64_t period = 2 * channel.average_rate * declared_rate(settings).hertz.den;
    const std::int64_t longest = buffer.arrivals(3);
    const std::int64_t intra = buffer.fractions(minimal.intra), other = buffer.fractions(minimal.other);
    const auto text = [](std::int64_t bits) { return std::to_string(bits); };

    // GOP by GOP no more may be needed than comes in.
    if (intra + (settings.gop - 1) * other > settings.gop * period) {
        const std::int64_t per_gop = minimal.intra + (settings.gop - 1) * minimal.other;
        const core::Rational hertz = declared_rate(settings).hertz;
        throw core::Error("bit rate " + text(channel.average_rate) + ": even pictures without detail need " +
                          text(per_gop * hertz.num / (settings.gop * hertz.den) + 1) +
                          " at this size, rate and GOP length");
    }
    if (minimal.intra > channel.border_bits)
        throw core::Error("VBV buffer " + text(channel.usable_bits) + " bits: a GOP needs room for " +
                          text(minimal.intra) + " at its start, even without detail, in four fifths of the buffer");
    if (channel.constant && buffer.fractions(channel.border_bits) < longest + buffer.fractions(16))
        throw core::Error("VBV buffer " + text(channel.usable_bits) + " bits: at a constant " + text(channel.bit_rate) +
                          " bits per second " + text(buffer.whole_bits(longest)) +
                          " arrive while a picture is shown; they must fit in four fifths of the buffer");
}

}  // namespace render2mpeg::encoder::mpeg2
