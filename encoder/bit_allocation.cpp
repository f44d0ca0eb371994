#include "encoder/bit_allocation.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/numeric.h"
#include "encoder/cadence.h"
#include "encoder/codec.h"
#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/checks.h"
#include "encoder/mpeg2/rate/rate_model.h"
#include "encoder/mpeg2/rate/vbv_buffer.h"

namespace render2mpeg::encoder {
namespace {

struct Item {
    std::int64_t number;
    PictureType type;
    double complexity;        ///< bits at quantiser 1
    double ratio;             ///< of its quantiser to the base
    double arrivals;          ///< bits that the channel brings between this removal and the next
    double seconds;           ///< of the same time
    double finest, coarsest;  ///< quantisers of the codec
    double least = finest;    ///< quantiser, for the buffer's sake

    double quantiser(double base) const { return std::clamp(base * ratio, least, coarsest); }
    double bits(double base) const { return complexity * std::pow(quantiser(base), -mpeg2::rate_slope(type)); }
};
using Items = std::span<Item>;

double sum_of_bits(Items items, double base) {
    double sum = 0;
    for (const Item& item : items) sum += item.bits(base);
    return sum;
}

/// The quantiser with which the items come to `wanted` bits, as far as half the finest and twice the coarsest: beyond
/// nothing changes.
double base_for(Items items, double wanted) {
    if (items.empty()) return 1;
    double low = std::log2(0.5 * items.front().finest), high = std::log2(2 * items.front().coarsest);
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        (sum_of_bits(items, std::exp2(middle)) > wanted ? low : high) = middle;
    }
    return std::exp2(high);
}

/// Makes a stretch coarser, so that it comes to this share of its bits; false: it is as coarse as can be.
bool coarsen(Items stretch, double base, double share) {
    bool changed = false;
    for (Item& item : stretch) {
        const double before = item.quantiser(base);
        item.least = std::min(item.coarsest, before * std::pow(share, -1.0 / mpeg2::rate_slope(item.type)));
        changed = changed || before < item.coarsest;
    }
    return changed;
}

/// A stretch of pictures that takes more bits than the buffer brings; it ends where the buffer is emptiest.
struct Underflow {
    std::size_t end;   ///< behind the stretch: where the share is the smallest, or where the buffer is full again
    double share = 1;  ///< of the stretch's bits that the buffer can bring
    double fullness;   ///< behind the stretch once it has no more
};

/// Follows the buffer from a place on, until it is full.
Underflow find_underflow(Items chunk, std::size_t begin, double fullness, double base, const mpeg2::Channel& channel,
                         bool hands_over) {
    // chosen: a tenth of the buffer is left alone, since real sizes differ from those expected (0..0.2).
    const auto size = static_cast<double>(channel.usable_bits),
               chunk_fullness = static_cast<double>(channel.chunk_fullness);
    Underflow underflow{chunk.size(), 1, size};
    double bits = 0;
    for (std::size_t i = begin; i < chunk.size(); ++i) {
        bits += chunk[i].bits(base);
        fullness -= chunk[i].bits(base);
        const bool last = i + 1 == chunk.size();
        const double floor = std::max(0.1 * size, last && hands_over ? chunk_fullness - chunk[i].arrivals : 0.0);
        const double share = std::max(0.1, 1 - core::divide_or(floor - fullness, bits, 0.0));
        if (share < underflow.share) underflow = {i + 1, share, std::min(size, floor + chunk[i].arrivals)};
        fullness += chunk[i].arrivals;
        if (fullness < size) continue;
        if (underflow.share == 1) underflow.end = i + 1;
        break;
    }
    return underflow;
}

/// Makes the stretches of one chunk coarser that underflow the buffer; false: none does, or none can be coarser. Behind
/// one that is as coarse as can be, the buffer is where it has to be: its pictures will be made to fit (fitting.h).
bool fix_underflows(Items chunk, double base, const mpeg2::Channel& channel, bool hands_over) {
    bool helped = false;
    auto fullness = static_cast<double>(channel.chunk_fullness);
    for (std::size_t begin = 0; begin < chunk.size();) {
        const Underflow underflow = find_underflow(chunk, begin, fullness, base, channel, hands_over);
        // A ten-thousandth too much is what rounding leaves of a stretch that was fixed.
        if (underflow.share < 0.9999)
            helped |= coarsen(chunk.subspan(begin, underflow.end - begin), base, underflow.share);
        fullness = underflow.fullness;
        begin = underflow.end;
    }
    return helped;
}

/// Chunks of a film in coding order.
std::vector<Items> chunks_of(Items items, std::span<const FirstPassPicture> film) {
    std::vector<Items> chunks;
    std::size_t begin = 0;
    for (std::size_t i = 1; i <= items.size(); ++i)
        if (i == items.size() || film[i].starts_chunk) {
            chunks.push_back(items.subspan(begin, i - begin));
            begin = i;
        }
    return chunks;
}

/// Allocation for a group of chunks with a common bit budget.
struct Solution {
    double base;        ///< quantiser of I and P pictures
    double affordable;  ///< BitAllocation::affordable
};

/// The bits of a group that are wanted of it.
double wanted_bits(Items group, std::int64_t rate) {
    double seconds = 0;
    for (const Item& item : group) seconds += item.seconds;
    return static_cast<double>(rate) * seconds;
}

/// Where no buffer binds.
Solution solve_freely(Items group, std::int64_t rate) {
    const double wanted = wanted_bits(group, rate), base = base_for(group, wanted);
    return {base, core::divide_or(wanted, sum_of_bits(group, base), 1.0)};
}

/// Solves for the quantiser of a group of chunks that share their bits, and fixes underflows until there are none.
Solution solve(Items group, std::span<const Items> chunks, const mpeg2::Channel& channel, bool film_ends) {
    const double wanted = wanted_bits(group, channel.average_rate);
    double base = base_for(group, wanted);
    // chosen: every fix frees bits for others, which may then underflow; films converge within 10 (5..200).
    for (int round = 0; round < 60; ++round) {
        bool fixed_some = false;
        for (const Items& chunk : chunks)
            fixed_some |= fix_underflows(chunk, base, channel, !film_ends || chunk.data() != chunks.back().data());
        if (!fixed_some) break;
        base = base_for(group, wanted);
    }
    return {base, core::divide_or(wanted, sum_of_bits(group, base), 1.0)};
}

}  // namespace

FirstPassPicture first_pass_picture(const Settings& pass, const CodedPicture& coded, bool starts_chunk) {
    if (pass.codec != Codec::mpeg2)
        return {coded.plan.number,
                coded.plan.type,
                mpeg2_quantiser_like(pass.codec, pass.quantiser),
                8.0 * static_cast<double>(coded.bytes.size()),
                starts_chunk,
                1.0};
    return {coded.plan.number,
            coded.plan.type,
            static_cast<double>(coded.quantiser),
            8.0 * static_cast<double>(coded.bytes.size() - coded.stuffing_bytes),
            starts_chunk,
            mpeg2::ratio_of(coded.plan)};
}

std::vector<BitAllocation> allocate_bits(const Settings& settings, std::span<const FirstPassPicture> film, double scale,
                                         bool film_ends) {
    EXPECTS(settings.rate_control.bit_rate > 0 && std::isfinite(scale) && scale > 0);
    mpeg2::check_film(settings.codec, film);
    const bool buffered = settings.codec == Codec::mpeg2;
    const mpeg2::Channel channel =
        buffered ? mpeg2::channel_for(settings, mpeg2::level_for(settings)) : mpeg2::Channel{};
    const CodecFacts& facts = facts_of(settings.codec);
    const double finest = mpeg2_quantiser_like(settings.codec, facts.finest),
                 coarsest = mpeg2_quantiser_like(settings.codec, facts.coarsest);
    const double field = 0.5 / declared_rate(settings).hertz.value();
    std::vector<Item> items;
    for (std::size_t i = 0; i < film.size(); ++i) {
        const FirstPassPicture& p = film[i];
        const double seconds = field * mpeg2::fields_after(settings, static_cast<std::int64_t>(i));
        items.push_back({p.number, p.type, scale * p.bits * std::pow(p.quantiser, mpeg2::rate_slope(p.type)),
                         p.ratio.value_or(mpeg2::usual_quantiser_ratio(p.type, settings.gop)),
                         seconds * static_cast<double>(channel.bit_rate), seconds, finest, coarsest});
    }
    const std::vector<Items> chunks = chunks_of(items, film);

    // Each has its place among the film's pictures as displayed, whatever its number.
    std::vector<std::int64_t> numbers;
    for (const Item& item : items) numbers.push_back(item.number);
    std::sort(numbers.begin(), numbers.end());
    const auto place_of = [&](const Item& item) {
        return static_cast<std::size_t>(std::lower_bound(numbers.begin(), numbers.end(), item.number) -
                                        numbers.begin());
    };

    // A constant rate gives every chunk its own share; else all have one.
    std::vector<BitAllocation> allocated(items.size());
    const Solution common = channel.constant || items.empty() ? Solution{}
                            : buffered                        ? solve(items, chunks, channel, film_ends)
                                                              : solve_freely(items, settings.rate_control.bit_rate);
    for (std::size_t c = 0; c < chunks.size(); ++c) {
        const Items chunk = chunks[c];
        const auto [base, affordable] =
            channel.constant ? solve(chunk, {&chunks[c], 1}, channel, film_ends && c + 1 == chunks.size()) : common;
        double left = 0;
        std::array<double, 3> left_by_type{};
        std::vector<const Item*> shown;
        for (const Item& item : chunk) shown.push_back(&item);
        std::sort(shown.begin(), shown.end(), [](const Item* a, const Item* b) { return a->number > b->number; });
        for (const Item* item : shown) {
            left += item->bits(base);
            left_by_type[static_cast<std::size_t>(item->type) - 1] += item->bits(base);
            allocated[place_of(*item)] = {item->quantiser(base), item->bits(base), left, item->type, affordable,
                                          item->ratio,           left_by_type};
        }
    }
    return allocated;
}

}  // namespace render2mpeg::encoder
