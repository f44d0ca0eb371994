#include "encoder/mpeg2/rate/vbv_buffer.h"

#include <algorithm>

#include "core/error.h"
#include "encoder/cadence.h"

namespace render2mpeg::encoder::mpeg2 {

VbvBuffer::VbvBuffer(const Settings& settings, const Channel& channel)
    : constant_(channel.constant),
      rate_(channel.bit_rate),
      cadence_(settings.cadence),
      first_number_(settings.first_number) {
    const core::Rational hertz = declared_rate(settings).hertz;
    per_bit_ = 2 * hertz.num;
    per_field_ = rate_ * hertz.den;
    capacity_ = fractions(channel.usable_bits);
    chunk_fullness_ = fractions(channel.chunk_fullness);
    fullness_ = chunk_fullness(first_number_);
}

std::int64_t VbvBuffer::chunk_fullness(std::int64_t number) const {
    if (!constant_) return chunk_fullness_;
    // Arrivals until then, modulo whole bytes. Each factor is reduced first to prevent overflow.
    const std::int64_t index = number - first_number_, byte = fractions(8);
    const std::int64_t fields = fields_before(cadence_, index - 1) - fields_before(cadence_, -1);
    return chunk_fullness_ + (per_field_ % byte) * (((fields % byte) + byte) % byte) % byte;
}

void VbvBuffer::start_chunk(std::int64_t number) {
    fullness_ = chunk_fullness(number);
}

std::int64_t VbvBuffer::take(std::int64_t bits, int fields, const std::int64_t* next_chunk) {
    const std::int64_t byte = fractions(8);
    std::int64_t next = fullness_ - fractions(bits);
    EXPECTS(next >= 0);
    next += arrivals(fields);
    if (!constant_) {
        fullness_ = std::min(next, capacity_);
        return 0;
    }
    const std::int64_t wanted = next_chunk ? chunk_fullness(*next_chunk) : capacity_;
    const std::int64_t stuffing = std::max<std::int64_t>(0, (next - wanted + byte - 1) / byte);
    fullness_ = next - stuffing * byte;
    EXPECTS(fullness_ >= arrivals(fields));
    return stuffing;
}

int VbvBuffer::delay(std::int64_t bits) const {
    constexpr std::int64_t clock = 90'000;
    // Rounded up: who decodes by it decodes no picture before it is whole.
    const std::int64_t second = rate_ * per_bit_;
    return static_cast<int>(((fullness_ - fractions(bits)) * clock + second - 1) / second);
}

int fields_after(const Settings& settings, std::int64_t order) {
    return fields_of(settings, settings.first_number + order - 1).count;
}

}  // namespace render2mpeg::encoder::mpeg2
