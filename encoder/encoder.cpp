// The encoder's way through a film: plans, delayed B pictures, coding, and results.
#include "encoder/encoder.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "encoder/cadence.h"
#include "encoder/mpeg2/bitstream/bit_writer.h"
#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/bitstream/syntax.h"
#include "encoder/mpeg2/checks.h"
#include "encoder/mpeg2/kernels/frame.h"
#include "encoder/mpeg2/macroblock/intra_refresh.h"
#include "encoder/mpeg2/macroblock/overrides.h"
#include "encoder/mpeg2/macroblock/weighting_matrices.h"
#include "encoder/mpeg2/motion/candidates.h"
#include "encoder/mpeg2/motion/picture_order.h"
#include "encoder/mpeg2/picture/fitting.h"
#include "encoder/mpeg2/rate/rate_controller.h"
#include "encoder/mpeg2/rate/vbv_schedule.h"

/// Plans pictures, holds B pictures back until their later reference is coded, and codes each within what the VBV
/// allows.
namespace render2mpeg::encoder {

namespace {

/// A coded I or P picture, as others refer to it.
struct Reference {
    std::int64_t number = 0;
    std::int64_t refers_to = 0;  ///< where `vectors` lead
    mpeg2::Frame frame;
    core::Plane<mpeg2::Vector> vectors;  ///< empty: none
};

/// A B picture that waits for the later one that it refers to.
struct DelayedB {
    PicturePlan plan;
    mpeg2::Frame source;
    std::vector<core::Plane<mpeg2::Candidates>> exact;  ///< per reference of the plan, or empty
    mpeg2::MacroblockOverrides overrides;
};

/// Pictures that share a buffer and a budget: one chunk of promised length, or all that follow one another without a
/// promise. Nothing of one session is known in another, so that bytes are a function of the session.
struct Session {
    std::int64_t first;               ///< number
    std::optional<std::int64_t> end;  ///< first number after the chunk planned last, if it is promised
    mpeg2::VbvSchedule schedule;
    mpeg2::RateController rate;
};

/// The reference's vectors as a guess for motion over other distances in time: half pixels times `distance`, per
/// picture of theirs.
core::Plane<mpeg2::Vector> stretched(const Reference& from, std::int64_t distance) {
    const std::int64_t theirs = from.refers_to - from.number;
    core::Plane<mpeg2::Vector> vectors = from.vectors;
    if (distance == theirs) return vectors;
    for (mpeg2::Vector& v : vectors.values()) {
        const auto stretch = [&](int component) {
            return static_cast<std::int16_t>(std::clamp<std::int64_t>(component * distance / theirs, -4096, 4095));
        };
        v = {stretch(v.x), stretch(v.y)};
    }
    return vectors;
}

}  // namespace

struct Encoder::Impl {
    explicit Impl(const Settings& s)
        : settings(s),
          level(mpeg2::level_for(s)),
          channel(mpeg2::channel_for(s, level)),
          minimal(mpeg2::minimal_bits(s, level)),
          source((s.width + 15) / 16, mpeg2::macroblock_rows(s)),
          quantisers(mpeg2::matrices_for(s.tune)),
          refresh(source.columns(), source.rows()),
          order(s.gop, s.b_pictures) {}

    const Settings settings;
    const mpeg2::Level& level;
    const mpeg2::Channel channel;
    const mpeg2::MinimalBits minimal;
    mpeg2::Frame source;  ///< the picture being coded; kept for its memory

    const mpeg2::QuantiserSet quantisers;
    mpeg2::IntraRefresh refresh;

    // Decisions of plan() so far; it may run ahead of push().
    mpeg2::PictureOrder order;
    std::deque<PicturePlan> planned;  ///< and not pushed
    std::deque<Session> sessions;     ///< of pictures not yet coded; the last is the one planned in
    bool cut_short = false;           ///< the chunk planned last ended before its promise

    // Where push() stands.
    std::optional<Reference> earlier, later;  ///< the newest two I and P pictures
    std::vector<DelayedB> delayed;            ///< for the one after `later`
    std::int64_t gop_start = 0;               ///< first picture of the GOP in display order
    std::int64_t coding_order = 0;

    void enter(std::int64_t number, const PictureFacts& facts, bool first_of_chunk);
    Session& session_of(std::int64_t number);
    void write_headers(mpeg2::BitWriter& out, const PicturePlan& plan) const;
    mpeg2::PictureTask task_for(const mpeg2::Frame& picture, const PicturePlan& plan,
                                std::span<const core::Plane<mpeg2::Candidates>> exact,
                                const mpeg2::MacroblockOverrides& overrides,
                                core::Plane<mpeg2::Vector> (&predictors)[2]) const;
    CodedPicture code(const mpeg2::Frame& picture, const PicturePlan& plan,
                      std::span<const core::Plane<mpeg2::Candidates>> exact,
                      const mpeg2::MacroblockOverrides& overrides);
    void keep(const PicturePlan& plan, mpeg2::PictureResult result, CodedPicture& coded);
    void code_delayed(std::vector<CodedPicture>& complete);
};

/// Finds the session that a picture to be planned belongs to, or begins one.
void Encoder::Impl::enter(std::int64_t number, const PictureFacts& facts, bool first_of_chunk) {
    const bool follows = order.last() && !cut_short && number == *order.last() + 1;
    EXPECTS(follows || first_of_chunk || !order.last());
    if (!follows) {
        EXPECTS(planned.empty());
        sessions.clear();
    }
    if (follows && sessions.back().end) EXPECTS(first_of_chunk == (number == *sessions.back().end));

    const auto end = facts.left_in_chunk ? std::optional(number + *facts.left_in_chunk + 1) : std::nullopt;
    if (sessions.empty() || (first_of_chunk && sessions.back().end)) {
        sessions.push_back({number, end, {settings, channel, minimal}, {settings, channel, minimal}});
    } else if (first_of_chunk) {
        sessions.back().end = end;
    } else if (sessions.back().end) {
        EXPECTS(!end || end == sessions.back().end);
    }
    cut_short = false;
}

/// Forgets the sessions before: pictures are coded chunk by chunk.
Session& Encoder::Impl::session_of(std::int64_t number) {
    while (sessions.size() > 1 && sessions[1].first <= number) sessions.pop_front();
    return sessions.front();
}

void Encoder::Impl::write_headers(mpeg2::BitWriter& out, const PicturePlan& plan) const {
    if (!plan.starts_gop) return;
    mpeg2::write_sequence(out, settings, level, mpeg2::matrices_for(settings.tune));
    mpeg2::write_gop(out, settings, gop_start, gop_start == plan.number);
}

/// Inputs for coding a picture. `predictors` stores the vectors suggested by another picture.
mpeg2::PictureTask Encoder::Impl::task_for(const mpeg2::Frame& picture, const PicturePlan& plan,
                                           std::span<const core::Plane<mpeg2::Candidates>> exact,
                                           const mpeg2::MacroblockOverrides& overrides,
                                           core::Plane<mpeg2::Vector> (&predictors)[2]) const {
    mpeg2::PictureTask task{picture,
                            plan.type,
                            {},
                            {},
                            {},
                            settings.height,
                            static_cast<int>(plan.number - gop_start),
                            plan.quantiser,
                            settings.effort,
                            fields_of(settings, plan.number)};
    task.quantisers = &quantisers;
    task.weights = mpeg2::weights_for(settings.tune, plan.type);
    if (plan.type == PictureType::predicted) task.intra_due = &refresh.due();
    if (!overrides.quantiser_factors.empty()) task.quantiser_factors = &overrides.quantiser_factors;
    if (!overrides.forced.empty()) task.forced = &overrides.forced;
    for (std::size_t i = 0; i < plan.references.size(); ++i) {
        const bool forward = plan.type == PictureType::bidirectional && i == 0;
        task.reference[i] = forward ? &earlier->frame : &later->frame;
        if (i < exact.size()) task.exact[i] = &exact[i];
        if (later->vectors.empty()) continue;
        predictors[i] = stretched(*later, plan.references[i] - plan.number);
        task.predictors[i] = &predictors[i];
    }
    return task;
}

/// Codes a picture whose references are there; an I or P picture becomes the newest one.
CodedPicture Encoder::Impl::code(const mpeg2::Frame& picture, const PicturePlan& plan,
                                 std::span<const core::Plane<mpeg2::Candidates>> exact,
                                 const mpeg2::MacroblockOverrides& overrides) {
    core::Plane<mpeg2::Vector> predictors[2];
    mpeg2::PictureTask task = task_for(picture, plan, exact, overrides, predictors);
    mpeg2::BitWriter headers;
    write_headers(headers, plan);

    // Code it within the bits in the buffer.
    auto& [first, end, schedule, rate] = session_of(plan.number);
    task.quantiser = rate.coding_quantiser(plan, schedule);
    const auto header_bits = static_cast<std::int64_t>(headers.bit_count());
    const std::int64_t most_bits = schedule.most_bits() - header_bits;
    mpeg2::Fitted fitted = mpeg2::code_within(task, level, most_bits);
    const int better = rate.reconsider(plan, fitted.quantiser, header_bits + mpeg2::bits_of(fitted.picture), schedule);
    if (better > fitted.quantiser) {
        task.quantiser = better;
        fitted = mpeg2::again(fitted, mpeg2::code_within(task, level, most_bits));
    }

    // Take it out of the decoder's buffer.
    mpeg2::PictureResult& result = fitted.picture;
    const std::int64_t bits = header_bits + mpeg2::bits_of(result);
    const mpeg2::Removal removal = schedule.take(bits, header_bits + mpeg2::start_code_bits);
    rate.record(plan, fitted.quantiser, bits, bits + 8 * removal.stuffing_bytes);
    mpeg2::set_vbv_delay(result.bytes, removal.delay);
    mpeg2::add_stuffing(result.bytes, static_cast<std::size_t>(removal.stuffing_bytes));

    // Report the result.
    CodedPicture coded;
    coded.plan = plan;
    coded.quantiser = fitted.quantiser;
    coded.tries = fitted.tries;
    coded.minimal = fitted.minimal;
    coded.stuffing_bytes = static_cast<std::uint64_t>(removal.stuffing_bytes);
    coded.fullness_before = removal.fullness_before;
    coded.fullness_after = removal.fullness_after;
    coded.fullness_next = removal.fullness_next;
    coded.coding_order = coding_order++;
    coded.bytes = headers.take();
    coded.bytes.insert(coded.bytes.end(), result.bytes.begin(), result.bytes.end());
    coded.macroblocks = std::move(result.records);
    coded.block_evaluations = result.evaluations;
    coded.motion = result.motion;
    refresh.record(plan.type, coded.macroblocks);
    keep(plan, std::move(result), coded);
    return coded;
}

/// Gives the coded picture its reconstruction; that of an I or P picture becomes the newest reference, too.
void Encoder::Impl::keep(const PicturePlan& plan, mpeg2::PictureResult result, CodedPicture& coded) {
    const auto shown = [&](auto&& frame) {
        return mpeg2::crop(std::forward<decltype(frame)>(frame), settings.width, settings.height, plan.number);
    };
    if (plan.type == PictureType::bidirectional) {
        coded.reconstruction = shown(std::move(result.reconstruction));
        return;
    }
    coded.reconstruction = shown(result.reconstruction);
    earlier = std::move(later);
    later = Reference{plan.number, plan.references.empty() ? plan.number : plan.references[0],
                      std::move(result.reconstruction), std::move(result.vectors)};
}

/// Codes the B pictures between the newest two others.
void Encoder::Impl::code_delayed(std::vector<CodedPicture>& complete) {
    for (const DelayedB& w : delayed) complete.push_back(code(w.source, w.plan, w.exact, w.overrides));
    delayed.clear();
}

void check(const Settings& settings) {
    mpeg2::check_channel(settings, mpeg2::level_for(settings));
}

Declaration declaration_of(const Settings& settings) {
    if (settings.codec != Codec::mpeg2) return {};
    check(settings);
    const mpeg2::Level& level = mpeg2::level_for(settings);
    const mpeg2::Channel channel = mpeg2::channel_for(settings, level);
    return {level.name, channel.bit_rate, channel.buffer_bits, channel.chunk_fullness};
}

Encoder::Encoder(const Settings& settings) {
    check(settings);
    impl_ = std::make_unique<Impl>(settings);
}
Encoder::~Encoder() = default;

PicturePlan Encoder::plan(std::int64_t number, const PictureFacts& facts, bool first_of_chunk) {
    Impl& m = *impl_;
    mpeg2::check_facts(number, facts);
    m.enter(number, facts, first_of_chunk);
    Session& session = m.sessions.back();
    first_of_chunk = first_of_chunk || !m.order.last();
    const bool starts_gop = first_of_chunk || m.order.gop_is_over(number) ||
                            ((facts.cut_before || facts.keyframe) && session.schedule.affords_gop(number));
    mpeg2::PictureOrder order = m.order;
    const bool may_open = !m.settings.closed_gops && !starts_gop && session.schedule.affords_gop(number);
    PicturePlan plan = order.plan(number, facts, starts_gop, may_open);
    session.schedule.plan(number, order.intra_stands_there(), first_of_chunk, facts.left_in_chunk, facts.last_chunk);
    if (first_of_chunk && !session.schedule.feasible())
        throw core::Error("bit rate " + std::to_string(m.channel.bit_rate) + ": a chunk of " +
                          std::to_string(facts.left_in_chunk.value_or(0) + 1) +
                          " pictures cannot be coded so that the next one finds its buffer filled");
    plan.quantiser = session.rate.plan(plan, facts, first_of_chunk, session.schedule);
    m.order = order;
    m.planned.push_back(plan);
    return plan;
}

std::vector<CodedPicture> Encoder::push(const core::Picture& picture, const PicturePlan& plan,
                                        std::span<const core::MotionField> motion, const Hints& hints) {
    Impl& m = *impl_;
    EXPECTS(!m.planned.empty() && plan == m.planned.front());
    mpeg2::check_pushed(m.settings, picture, plan, motion, hints);
    m.planned.pop_front();
    if (plan.starts_gop) m.gop_start = m.delayed.empty() ? plan.number : m.delayed.front().plan.number;
    std::vector<core::Plane<mpeg2::Candidates>> exact;
    for (const core::MotionField& field : motion)
        exact.push_back(mpeg2::exact_candidates(field, m.source.columns(), m.source.rows(), m.level.horizontal_f_code));

    const bool delays = plan.type == PictureType::bidirectional;
    mpeg2::Frame waiting = delays ? mpeg2::Frame(m.source.columns(), m.source.rows()) : mpeg2::Frame();
    mpeg2::Frame& padded = delays ? waiting : m.source;
    mpeg2::pad(picture, padded);
    mpeg2::MacroblockOverrides overrides =
        mpeg2::overrides_from(hints, m.source.columns(), m.source.rows(), plan.quantiser);
    std::vector<CodedPicture> complete;
    if (delays) {
        m.delayed.push_back(DelayedB{plan, std::move(waiting), std::move(exact), std::move(overrides)});
        return complete;
    }
    complete.push_back(m.code(m.source, plan, exact, overrides));
    m.code_delayed(complete);
    return complete;
}

std::vector<CodedPicture> Encoder::flush() {
    Impl& m = *impl_;
    std::vector<CodedPicture> complete;
    m.order.cut_short();

    // Neither the pictures planned beyond this one nor the promised ones will come.
    const auto promised = m.sessions.empty() ? std::nullopt : m.sessions.back().end;
    if (!m.planned.empty() || (promised && *m.order.last() + 1 != *promised)) m.cut_short = true;
    m.planned.clear();
    if (m.delayed.empty()) return complete;

    // The last one takes their reference's place, and of the others' motion the forward part holds.
    DelayedB last = std::move(m.delayed.back());
    m.delayed.pop_back();
    last.plan.type = PictureType::predicted;
    last.plan.references.pop_back();
    for (DelayedB& w : m.delayed) w.plan.references[1] = last.plan.number;
    for (DelayedB& w : m.delayed) w.exact.resize(std::min<std::size_t>(w.exact.size(), 1));
    last.exact.resize(std::min<std::size_t>(last.exact.size(), 1));
    complete.push_back(m.code(last.source, last.plan, last.exact, last.overrides));
    m.code_delayed(complete);
    return complete;
}

}  // namespace render2mpeg::encoder
