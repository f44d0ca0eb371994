#include "app/loop/picture_coder.h"

#include <algorithm>

#include "encoder/av/coders.h"
#include "encoder/bit_allocation.h"
#include "encoder/codec.h"
#include "encoder/motion_nonuniformity.h"
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
                                        const core::Picture* picture) {
    const bool first = number == chunk_.first;
    continues_ = !first && !cut_before;
    if (!continues_) light_change_.reset();
    const core::MotionField* moved = continues_ ? motion.to(number - 1) : nullptr;
    const StageTimer timer(statistics_, Stage::encode);
    encoder::PictureFacts facts = facts_of(number, cut_before);
    if (first) facts.trial = trial_;
    if (moved != nullptr) facts.motion_nonuniformity = encoder::motion_nonuniformity(*moved);
    if (quality_) {
        if (cut_before) quality_->forget();
        if (!continues_ && picture != nullptr) try_quality(*picture);
        facts.quality_factor = quality_->factor();
    }
    // A chunk's or shot's first pictures: one B picture shows no stair and costs little.
    constexpr double not_known = 1.0;
    if (lights_change_) facts.light_change = light_change_.value_or(not_known);
    if (ahead_ != nullptr) look_ahead(facts, number);
    encoder::PicturePlan plan = coder_->plan(number, facts, first);
    if (plan.starts_gop) gop_start_ = number;
    return plan;
}

namespace {

/// Equivalent MPEG-2 quantiser without the ratio of type and followers.
double base_quantiser(const encoder::Settings& settings, const encoder::CodedPicture& coded) {
    if (settings.codec != encoder::Codec::mpeg2) return encoder::mpeg2_quantiser_like(settings.codec, coded.quantiser);
    return coded.quantiser / encoder::first_pass_picture(settings, coded, false).ratio.value_or(1.0);
}

}  // namespace

void PictureCoder::try_quality(const core::Picture& picture) {
    encoder::Settings settings = film_.coding;
    settings.gop = 1;
    const std::unique_ptr<encoder::Coder> trial = av::make_coder(settings);
    const encoder::PicturePlan plan = trial->plan(picture.number, {.quality_factor = quality_->factor()}, true);
    std::vector<encoder::CodedPicture> complete = trial->push(picture, plan, {}, {});
    for (encoder::CodedPicture& coded : trial->flush()) complete.push_back(std::move(coded));
    for (const encoder::CodedPicture& coded : complete)
        quality_->learn(coded.plan.type, base_quantiser(film_.coding, coded),
                        perceptual::masked_error(coded.reconstruction.y, picture.y), false);
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
    facts.b_pictures = ahead_->b_pictures(number - 1, last);
}

void PictureCoder::watch_light(const core::Picture& picture, Motion& motion) {
    if (!lights_change_) return;
    const core::MotionField* moved = continues_ ? motion.to(picture.number - 1) : nullptr;
    const StageTimer timer(statistics_, Stage::encode);
    if (continues_) light_change_ = perceptual::light_change(moved, picture.y, last_luma_);
    last_luma_ = picture.y;
}

std::vector<encoder::CodedPicture> PictureCoder::code(const core::Picture& picture, const encoder::PicturePlan& plan,
                                                      Motion& motion) {
    watch_light(picture, motion);
    std::vector<core::MotionField> fields = motion.take(plan.references);
    if (fields.empty() && ahead_ != nullptr) {
        const StageTimer timer(statistics_, Stage::encode);
        for (const std::int64_t reference : plan.references) fields.push_back(ahead_->motion(plan.number, reference));
    }
    const core::MotionField* onward = plan.horizon ? motion.onward(*plan.horizon) : nullptr;
    const StageTimer timer(statistics_, Stage::encode);
    if (quality_) unjudged_.emplace(plan.number, picture.y);
    std::vector<encoder::CodedPicture> complete = coder_->push(picture, plan, fields, {onward});
    judge(complete);
    return complete;
}

std::vector<encoder::CodedPicture> PictureCoder::flush() {
    const StageTimer timer(statistics_, Stage::encode);
    return coder_->flush();
}

}  // namespace render2mpeg::app
