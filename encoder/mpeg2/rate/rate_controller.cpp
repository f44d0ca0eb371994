#include "encoder/mpeg2/rate/rate_controller.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/numeric.h"
#include "encoder/cadence.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// quantiser_scale_code of P pictures that nothing refers to, before the factor: 100 is 1, 20 less doubles it.
double quantiser_of_quality(double quality) {
    return std::exp2((100.0 - quality) / 20.0);
}

int whole(double quantiser) {
    return std::clamp(static_cast<int>(std::lround(quantiser)), 1, 31);
}

/// A picture may be expected to take this share of what the buffer can give it: models are wrong by about a tenth, and
/// coding twice costs time.
/// chosen: 0.85 (0.7..1).
constexpr double expected_share = 0.85;

/// Bits allocated to the pictures after one, by type; where they are known as a whole only, they count as this one's.
std::array<double, 3> rest_after(const std::optional<BitAllocation>& allocation, PictureType type) {
    std::array<double, 3> rest{};
    if (!allocation) return rest;
    const std::size_t own = static_cast<std::size_t>(allocation->type.value_or(type)) - 1;
    rest = allocation->left_by_type;
    if (rest == std::array<double, 3>{}) rest[own] = allocation->bits_left;
    rest[own] = std::max(0.0, rest[own] - allocation->bits);
    return rest;
}

/// Solves for the quantiser at which the decreasing `bits` equal `wanted`; both ends are beyond the coded range.
template <class Bits>
double solve(double wanted, const Bits& bits) {
    double low = std::log2(0.5), high = std::log2(62.0);
    for (int i = 0; i < 30; ++i) {
        const double middle = 0.5 * (low + high);
        (bits(std::exp2(middle)) > wanted ? low : high) = middle;
    }
    return std::exp2(high);
}

bool has_bit_rate(const Settings& settings) {
    const RateMode mode = settings.rate_control.mode;
    return mode == RateMode::variable || mode == RateMode::constant;
}

/// Of the constant modes. `ratio`: to P pictures that nothing refers to.
double steady_quantiser(const Settings& settings, double ratio, double quality_factor) {
    const encoder::RateControl& wanted = settings.rate_control;
    if (wanted.mode == RateMode::constant_quantiser) return settings.quantiser * ratio;
    return quantiser_of_quality(wanted.quality) * ratio * quality_factor;
}

/// The allocated quantiser is that of what the picture was: makes it that of what it is. Its bits stay, so that what
/// they are off by is learned together with what another type or other followers change.
void adapt(BitAllocation& allocation, PictureType type, double ratio, int gop) {
    allocation.type = allocation.type.value_or(type);
    allocation.quantiser *= ratio / allocation.ratio.value_or(usual_quantiser_ratio(*allocation.type, gop));
    allocation.ratio = ratio;
}

/// Numbers of I, P and B pictures.
using Counts = std::array<std::int64_t, 3>;

/// Of the first `count` pictures from a GOP's beginning on, in the regular pattern.
Counts regular_pattern(const Settings& settings, std::int64_t count) {
    const std::int64_t gop = settings.gop, distance = settings.b_pictures + 1;
    const auto within = [&](std::int64_t place) {  // of one GOP, the pictures before `place`
        const std::int64_t others = std::max<std::int64_t>(0, place - 1), end = place == gop && others % distance != 0;
        const std::int64_t predicted = others / distance + end;
        return Counts{place > 0 ? 1 : 0, predicted, others - predicted};
    };
    const Counts whole = within(gop), part = within(count % gop);
    Counts counts;
    for (std::size_t i = 0; i < 3; ++i) counts[i] = count / gop * whole[i] + part[i];
    return counts;
}

/// From the beginning of picture `first` to that of `end`.
double seconds(const Settings& settings, std::int64_t first, std::int64_t end) {
    const std::int64_t fields = fields_before(settings.cadence, end - settings.first_number) -
                                fields_before(settings.cadence, first - settings.first_number);
    return 0.5 * static_cast<double>(fields) / declared_rate(settings).hertz.value();
}

}  // namespace

RateController::RateController(const Settings& settings, const Channel& channel, const MinimalBits& minimal)
    : settings_(settings), channel_(channel), model_(settings, minimal) {}

int RateController::plan(const PicturePlan& picture, const PictureFacts& facts, bool first_of_chunk,
                         const VbvSchedule& schedule) {
    if (first_of_chunk) {
        chunk_start_ = picture.number;
        chunk_end_ = facts.left_in_chunk ? std::optional(picture.number + *facts.left_in_chunk + 1) : std::nullopt;
        hands_over_ = !facts.last_chunk;
        spent_ = rounding_ = steady_ = 0;
        coded_in_chunk_ = 0;
        planned_ = {};
        for (const FirstPassPicture& p : facts.trial) model_.expect(p.type, p.quantiser, p.bits);
        allocated_ = facts.allocation ? facts.allocation->affordable * facts.allocation->bits_left : 0;
    }
    if (picture.starts_gop) gop_start_ = picture.number;
    planned_end_ = picture.number + 1;
    ++planned_[static_cast<std::size_t>(picture.type) - 1];
    allocated_rest_ = rest_after(facts.allocation, picture.type);
    InFlight entry{picture.type,      1,
                   facts.allocation,  facts.quality_factor.value_or(1.0),
                   ratio_of(picture), !facts.allocation && !model_.knows(picture.type)};
    if (entry.allocation) adapt(*entry.allocation, entry.type, entry.ratio, settings_.gop);
    entry.quantiser = rounded(entry, nominal(picture.number, entry, schedule));
    in_flight_.insert_or_assign(picture.number, entry);
    return entry.quantiser;
}

int RateController::coding_quantiser(const PicturePlan& picture, const VbvSchedule& schedule) {
    const auto planned = in_flight_.find(picture.number);
    EXPECTS(planned != in_flight_.end());
    InFlight& entry = planned->second;
    const bool changed = entry.type != picture.type;
    entry.type = picture.type;
    if (changed) {
        entry.ratio = ratio_of(picture);
        if (entry.allocation) adapt(*entry.allocation, entry.type, entry.ratio, settings_.gop);
        return rounded(entry, nominal(picture.number, entry, schedule));
    }
    if (!has_bit_rate(settings_)) return picture.quantiser;

    // Keep the planned quantiser unless the model, updated since, asks for another step.
    const double wanted = std::clamp(nominal(picture.number, entry, schedule), 1.0, 31.0);
    if (++coded_in_chunk_ > settings_.b_pictures + 2) steady_ = solved_;
    const double off = wanted - picture.quantiser;
    if (entry.guessed && off > 1) return whole(wanted);
    return picture.quantiser + (off >= 1.0 ? 1 : off <= -1.0 ? -1 : 0);
}

int RateController::reconsider(const PicturePlan& picture, int quantiser, std::int64_t bits,
                               const VbvSchedule& schedule) {
    const auto planned = in_flight_.find(picture.number);
    EXPECTS(planned != in_flight_.end());
    const InFlight& entry = planned->second;
    const bool surprising = model_.surprised(picture.type, quantiser, bits);
    if (!has_bit_rate(settings_) || entry.allocation || (model_.knows(picture.type) && !surprising)) return quantiser;
    const RateModel model = model_;
    const double steady = steady_;
    model_.learn(picture.type, quantiser, bits);
    if (surprising) steady_ = 0;
    const int wanted = whole(nominal(picture.number, entry, schedule));
    model_ = model;
    if (wanted > quantiser + 1) {
        if (surprising) steady_ = solved_;
        return wanted;
    }
    steady_ = steady;
    return quantiser;
}

/// The whole quantiser for a picture. Of the two next to what is wanted, rates take the one that keeps the bits lost to
/// rounding near zero; but nothing refers to B pictures, so that they are never finer than what they refer to.
int RateController::rounded(const InFlight& entry, double wanted) {
    if (!has_bit_rate(settings_)) return whole(wanted);
    wanted = std::clamp(wanted, 1.0, 31.0);
    const bool bidirectional = entry.type == PictureType::bidirectional;
    const int fine = std::max(static_cast<int>(std::floor(wanted)), bidirectional ? reference_quantiser_ : 1);
    const int coarse = std::min(31, fine + 1);
    const double exact = bits(entry, wanted);
    const double by_fine = rounding_ + bits(entry, fine) - exact, by_coarse = rounding_ + bits(entry, coarse) - exact;
    const bool finer = std::abs(by_fine) <= std::abs(by_coarse);
    // chosen: a tenth is forgotten each time, so that a wrong model cannot build up a debt (0..0.3); no more is owed
    // than a picture.
    rounding_ = std::clamp(0.9 * (finer ? by_fine : by_coarse), -exact, exact);
    if (!bidirectional) reference_quantiser_ = finer ? fine : coarse;
    return finer ? fine : coarse;
}

void RateController::record(const PicturePlan& picture, int quantiser, std::int64_t bits, std::int64_t bits_sent) {
    const auto planned = in_flight_.find(picture.number);
    EXPECTS(planned != in_flight_.end());
    const InFlight& entry = planned->second;
    model_.learn(picture.type, quantiser, bits);
    if (entry.allocation) pass_.learn(picture.type, *entry.allocation, quantiser, bits);
    if (picture.number >= chunk_start_) spent_ += static_cast<double>(bits_sent);
    in_flight_.erase(planned);
}

double RateController::nominal(std::int64_t number, const InFlight& picture, const VbvSchedule& schedule) {
    if (!has_bit_rate(settings_)) return steady_quantiser(settings_, picture.ratio, picture.quality_factor);
    const double left = bits_for_rest(number, schedule);
    double quantiser;
    if (picture.allocation) {
        const double share = bits_as_allocated(picture);
        const double correction = core::divide_or(share, std::max(0.0, left), 1e3);
        quantiser = picture.allocation->quantiser *
                    damped(std::pow(std::max(correction, 1e-3), 1.0 / rate_slope(picture.type)));
    } else {
        const std::array<double, 3> rest = foreseen();
        const double base = solve(
            left, [&](double q) { return bits(picture, std::max(1.0, q * picture.ratio)) + bits_of_rest(rest, q); });
        quantiser = damped(base) * picture.ratio;
    }
    return limited(number, picture, quantiser, schedule);
}

/// Limits jumps of the solution, most of all near a chunk's end, where a small rest would be spent on one picture.
/// chosen: a third finer, half as much again coarser than for the picture before (1.2..2); no limit for the first
/// pictures of a chunk, since they measure its cost.
double RateController::damped(double solved) {
    solved_ = steady_ > 0 ? std::clamp(solved, steady_ / 1.33, steady_ * 1.5) : solved;
    return solved_;
}

double RateController::bits(const InFlight& picture, double quantiser) const {
    return picture.allocation ? pass_.bits(picture.type, *picture.allocation, quantiser)
                              : model_.bits(picture.type, quantiser);
}

double RateController::bits_as_allocated(const InFlight& picture) const {
    const PictureType then = picture.allocation->type.value_or(picture.type);
    double sum = 0;
    for (const PictureType type : {PictureType::intra, PictureType::predicted, PictureType::bidirectional}) {
        const double own = type == then ? picture.allocation->bits : 0.0;
        sum += pass_.excess(type) * (own + allocated_rest_[static_cast<std::size_t>(type) - 1]);
    }
    return sum;
}

/// First number of which nothing need be foreseen: the chunk's end, or in an endless chunk two GOPs or seconds on.
std::int64_t RateController::horizon() const {
    if (chunk_end_) return *chunk_end_;
    const auto second = static_cast<std::int64_t>(settings_.rate.hertz.value()) + 1;
    return planned_end_ + 2 * std::max<std::int64_t>(settings_.gop, second);
}

std::array<double, 3> RateController::foreseen() const {
    const Counts planned = regular_pattern(settings_, planned_end_ - gop_start_),
                 all = regular_pattern(settings_, horizon() - gop_start_);
    const auto intra = static_cast<double>(all[0] - planned[0]), predicted = static_cast<double>(all[1] - planned[1]),
               others = predicted + static_cast<double>(all[2] - planned[2]);
    // Runs of B pictures go on as they were. chosen: what was planned counts beside four regular pictures (2..15).
    constexpr double regular = 4;
    const double share = (static_cast<double>(planned_[1]) + regular * core::divide_or(predicted, others, 0.0)) /
                         (static_cast<double>(planned_[1] + planned_[2]) + regular);
    // Where the chunk ends within a GOP, its last picture is no B picture.
    const double least = chunk_end_ && others > 0 ? 1 : 0, of_rest = std::clamp(share * others, least, others);
    return {intra, of_rest, others - of_rest};
}

/// Expected bits of the pictures not planned yet, with `quantiser` in I and P pictures.
double RateController::bits_of_rest(const std::array<double, 3>& rest, double quantiser) const {
    double sum = 0;
    for (const PictureType type : {PictureType::intra, PictureType::predicted, PictureType::bidirectional})
        sum += rest[static_cast<std::size_t>(type) - 1] *
               model_.bits(type, std::clamp(quantiser * usual_quantiser_ratio(type, settings_.gop), 1.0, 31.0));
    return sum;
}

/// Bits for picture `number` and those not planned yet: of the chunk's what is neither spent nor in flight, and no more
/// than the channel brings in time.
double RateController::bits_for_rest(std::int64_t number, const VbvSchedule& schedule) const {
    double in_flight = 0, of_chunk = 0;
    for (const auto& [n, picture] : in_flight_) {
        if (n == number) continue;
        in_flight += bits(picture, picture.quantiser);
        if (n >= chunk_start_) of_chunk += bits(picture, picture.quantiser);
    }

    const double all = allocated_ > 0
                           ? allocated_
                           : static_cast<double>(channel_.average_rate) * seconds(settings_, chunk_start_, horizon());
    const double left = all - spent_ - of_chunk;
    const double brought = static_cast<double>(schedule.fullness()) +
                           static_cast<double>(channel_.bit_rate) * seconds(settings_, schedule.next(), horizon());
    const double kept = chunk_end_ && hands_over_ ? static_cast<double>(channel_.chunk_fullness) : 0.0;
    return std::max(1.0, std::min(left, brought - kept - in_flight));
}

/// Coarser where the buffer would hardly have room for the picture when its turn comes.
double RateController::limited(std::int64_t number, const InFlight& picture, double quantiser,
                               const VbvSchedule& schedule) const {
    double fullness = static_cast<double>(schedule.fullness());
    const std::int64_t next = schedule.next();
    for (const auto& [n, before] : in_flight_)
        if (n < number) fullness -= bits(before, before.quantiser);
    fullness += static_cast<double>(channel_.bit_rate) * seconds(settings_, next, std::max(next, number));
    const double room = expected_share * std::clamp(fullness, 1.0, static_cast<double>(channel_.usable_bits));
    if (bits(picture, quantiser) <= room) return quantiser;
    return std::max(quantiser, solve(room, [&](double q) { return bits(picture, q); }));
}

}  // namespace render2mpeg::encoder::mpeg2
