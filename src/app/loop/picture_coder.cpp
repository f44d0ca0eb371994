#include "app/loop/picture_coder.h"

#include <algorithm>

#include "encoder/av/coders.h"
#include "encoder/bit_allocation.h"
#include "encoder/codec.h"
#include "encoder/innovation.h"
#include "encoder/latitude.h"
#include "encoder/motion_nonuniformity.h"
#include "parallel/loops.h"
#include "perceptual/masking.h"
#include "perceptual/metrics.h"
#include "perceptual/pumping.h"

namespace render2mpeg::app {

std::vector<std::int64_t> shots_of(const scene::Animation& animation) {
    std::vector<std::int64_t> frames;
    for (const scene::Shot& shot : animation.shots) frames.push_back(shot.frame);
    return frames;
}

PictureCoder::PictureCoder(const Film& film, const Chunk& chunk, std::span<const encoder::BitAllocation> allocations,
                           std::vector<std::int64_t> shots, RunStatistics& statistics, bool lights_change,
                           encoder::LookAhead* ahead)
    : film_(film),
      chunk_(chunk),
      allocations_(allocations),
      shots_(std::move(shots)),
      statistics_(statistics),
      lights_change_(lights_change),
      ahead_(ahead),
      latitude_(encoder::latitude_factors(film.coding)),
      coder_(av::make_coder(film.coding)) {
    const encoder::RateControl& rate = film.coding.rate_control;
    if (rate.mode == encoder::RateMode::constant_quality) quality_.emplace(rate.quality);
}

std::int64_t PictureCoder::frames_left(std::int64_t number) const {
    std::int64_t left = chunk_.last - number;
    for (const std::int64_t shot : shots_)
        if (shot > number) left = std::min(left, shot - 1 - number);
    return film_.keyframes.frames_left(number, left);
}

encoder::PictureFacts PictureCoder::facts_of(std::int64_t number, bool cut_before) const {
    encoder::PictureFacts facts;
    facts.cut_before = cut_before;
    facts.frames_left = frames_left(number);
    facts.keyframe = film_.keyframes.begins_at(number);
    facts.left_in_chunk = chunk_.last - number;
    facts.last_chunk = chunk_.last == film_.frames.last;
    if (!allocations_.empty()) facts.allocation = allocations_[static_cast<std::size_t>(number - film_.frames.first)];
    return facts;
}

encoder::PicturePlan PictureCoder::plan(std::int64_t number, bool cut_before, Motion& motion,
                                        std::span<const core::Picture* const> pictures) {
    const parallel::StopWhen never({});  // plans follow from those before
    const bool first = number == chunk_.first;
    continues_ = !first && !cut_before;
    if (!continues_) light_change_.reset();
    const core::MotionField* moved = continues_ ? motion.to(number - 1) : nullptr;
    if (quality_ && cut_before) quality_->forget();
    if (quality_ && !continues_ && !pictures.empty()) try_quality(pictures);
    const StageTimer timer(statistics_, Stage::encode);
    encoder::PictureFacts facts = facts_of(number, cut_before);
    if (first) facts.trial = trial_;
    if (moved != nullptr) facts.motion_nonuniformity = encoder::motion_nonuniformity(*moved);
    if (quality_) facts.quality_factor = quality_->factor();
    // A chunk's or shot's first pictures: one B picture shows no stair and costs little.
    constexpr double not_known = 1.0;
    if (lights_change_) facts.light_change = light_change_.value_or(not_known);
    if (ahead_ != nullptr) look_ahead(facts, number);
    encoder::PicturePlan plan = coder_->plan(number, facts, first);
    if (plan.starts_gop) gop_start_ = number;
    return plan;
}

namespace {

/// Motion of pictures that nobody knows it of.
class UnknownMotion : public Motion {
    std::optional<core::MotionField> find(std::int64_t) override { return {}; }
};

/// Equivalent MPEG-2 quantiser without the ratio of type and followers.
double base_quantiser(const encoder::Settings& settings, const encoder::CodedPicture& coded) {
    if (settings.codec != encoder::Codec::mpeg2) return encoder::mpeg2_quantiser_like(settings.codec, coded.quantiser);
    return coded.quantiser / encoder::first_pass_picture(settings, coded, false).ratio.value_or(1.0);
}

}  // namespace

void PictureCoder::try_quality(std::span<const core::Picture* const> pictures) {
    std::size_t count = 1;
    while (count < pictures.size() && ahead_ != nullptr && !ahead_->cut_before(pictures[count]->number)) ++count;
    pictures = pictures.first(count);
    Film fast = film_;
    if (fast.coding.codec == encoder::Codec::mpeg2) fast.coding.effort = encoder::Effort::fast;
    PictureCoder trial(fast, {0, pictures.front()->number, pictures.back()->number}, {}, {}, statistics_, false,
                       ahead_);
    for (const core::Picture* picture : pictures) {
        UnknownMotion none;
        trial.code(*picture, trial.plan(picture->number, false, none), none);
    }
    trial.flush();
    quality_->expect(*trial.quality_);
}

void PictureCoder::judge(const std::vector<encoder::CodedPicture>& pictures) {
    if (!quality_) return;
    for (const encoder::CodedPicture& coded : pictures) {
        const auto source = unjudged_.extract(coded.plan.number);
        quality_->learn(coded.plan.type, base_quantiser(film_.coding, coded),
                        perceptual::masked_error(coded.reconstruction.y, source.mapped()));
    }
}

void PictureCoder::look_ahead(encoder::PictureFacts& facts, std::int64_t number) {
    facts.frames_left = std::min(facts.frames_left, ahead_->frames_left(number).value_or(facts.frames_left));
    if (!continues_) return;
    const std::int64_t next_gop = gop_start_ + film_.coding.gop;
    if (number >= next_gop) return;
    const std::int64_t last = std::min(number + facts.frames_left, next_gop - (film_.coding.closed_gops ? 1 : 0));
    // chosen: costs of searched vectors propose worse runs than exact motion does, by 0.3 % of bits in the mean of six
    // films and 5 % where the camera races (bench/tables/encoder.csv).
    if (!facts.motion_nonuniformity)
        facts.b_pictures = ahead_->b_pictures(number - 1, last);
    else if (ahead_->light_changes(number - 1, last))
        facts.b_pictures = 1;
}

core::Plane<float> PictureCoder::compare_with_last(const core::Picture& picture, bool innovation, Motion& motion) {
    const core::MotionField* moved = continues_ ? motion.to(picture.number - 1) : nullptr;
    const StageTimer timer(statistics_, Stage::encode);
    core::Plane<float> shown_anew;
    if (continues_ && lights_change_) light_change_ = perceptual::light_change(moved, picture.y, last_luma_);
    if (continues_ && innovation) shown_anew = encoder::innovation(moved, picture.y, last_luma_);
    last_luma_ = picture.y;
    return shown_anew;
}

std::vector<encoder::CodedPicture> PictureCoder::code(const core::Picture& picture, const encoder::PicturePlan& plan,
                                                      Motion& motion) {
    const core::Plane<float> innovation = compare_with_last(picture, plan.horizon.has_value(), motion);
    std::vector<core::MotionField> fields = motion.take(plan.references);
    if (fields.empty() && ahead_ != nullptr) {
        const StageTimer timer(statistics_, Stage::encode);
        for (const std::int64_t reference : plan.references) fields.push_back(ahead_->motion(plan.number, reference));
    }
    const core::MotionField* onward = plan.horizon ? motion.onward(*plan.horizon) : nullptr;
    const StageTimer timer(statistics_, Stage::encode);
    if (quality_) unjudged_.emplace(plan.number, picture.y);
    // MPEG-2's matrices follow the eye instead (docs/decisions.md#levers-that-do-not-pay).
    const bool by_contrast =
        film_.coding.tune == encoder::Tune::perceptual && film_.coding.codec != encoder::Codec::mpeg2;
    const core::Plane<float> hidden = by_contrast ? perceptual::hidden(picture) : core::Plane<float>();
    const auto if_any = [](const core::Plane<float>& map) { return map.empty() ? nullptr : &map; };
    std::vector<encoder::CodedPicture> complete =
        coder_->push(picture, plan, fields, {onward, if_any(innovation), if_any(hidden), if_any(latitude_)});
    judge(complete);
    return complete;
}

std::vector<encoder::CodedPicture> PictureCoder::flush() {
    const StageTimer timer(statistics_, Stage::encode);
    std::vector<encoder::CodedPicture> complete = coder_->flush();
    judge(complete);
    return complete;
}

}  // namespace render2mpeg::app
