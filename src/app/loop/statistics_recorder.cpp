#include "app/loop/statistics_recorder.h"

#include <algorithm>

#include "core/error.h"
#include "core/numeric.h"
#include "perceptual/metrics.h"
#include "perceptual/pumping.h"

namespace render2mpeg::app {

void StatisticsRecorder::lit(const LitFrame& frame) {
    const renderer::Statistics &before = frame.before, &after = frame.after;
    FrameEntry entry;
    entry.frame = frame.world.frame;
    entry.shadow_rays = after.shadow_rays - before.shadow_rays;
    const auto points = static_cast<double>(std::max<std::uint64_t>(1, after.gather_points - before.gather_points));
    entry.direct_cut = static_cast<double>(after.direct_clusters - before.direct_clusters) / points;
    entry.indirect_cut = static_cast<double>(after.indirect_clusters - before.indirect_clusters) / points;
    entry.records = {after.cache.created - before.cache.created, after.cache.live,
                     static_cast<double>(after.cache.served - before.cache.served) / points};
    const bool first = statistics_.frames.size() == first_;
    statistics_.frames.push_back(entry);
    for (const std::uint8_t luma : frame.picture.y.values())
        statistics_.brightest_luma = std::max<int>(statistics_.brightest_luma, luma);
    if (!coded_) return;
    const bool continues = !first && !frame.world.cut_before;
    keep(frame.picture, continues, continues ? frame.motion.to(entry.frame - 1) : nullptr);
}

void StatisticsRecorder::read(const core::Picture& picture, const core::MotionField* motion) {
    FrameEntry entry;
    entry.frame = picture.number;
    statistics_.frames.push_back(entry);
    keep(picture, motion != nullptr, motion);
}

void StatisticsRecorder::keep(const core::Picture& picture, bool known, const core::MotionField* motion) {
    waiting_.emplace(picture.number, picture);
    Step& step = steps_[picture.number];
    step.known = known;
    if (known && motion) step.motion = {motion->picture, motion->reference, motion->vector, {}, motion->kind};
}

FrameEntry& StatisticsRecorder::entry_of(std::int64_t number) {
    return statistics_.frames[first_ + static_cast<std::size_t>(number - statistics_.frames[first_].frame)];
}

void StatisticsRecorder::measure_pumping(std::int64_t number) {
    const auto now = steps_.find(number), before = steps_.find(number - 1);
    if (now == steps_.end() || before == steps_.end()) return;
    if (now->second.error.empty() || before->second.error.empty()) return;
    if (now->second.known) {
        const Step& step = now->second;
        entry_of(number).pumping =
            perceptual::pumping(step.motion ? &*step.motion : nullptr, step.error, before->second.error).value_or(-1);
    }
    now->second.motion.reset();
    steps_.erase(before);
}

void Auditor::lit(const LitFrame& frame) {
    Audit& audit = statistics_.audit;
    timed(audit.seconds, [&] {
        const std::vector<renderer::AuditedPixel> pixels =
            renderer_.audit(frame.world, frame.lit, frame.tolerance, pixels_);
        for (const renderer::AuditedPixel& p : pixels) {
            const float absolute = frame.tolerance.is_reference() ? 0.0f : frame.tolerance.pixels.at(p.x, p.y).absolute;
            audit.errors.add(core::divide_or(p.error, std::max(p.luminance, absolute), 0.0f));
            audit.over += p.over() ? 1 : 0;
        }
        audit.split.add(renderer_.validate(frame.world, frame.lit, frame.tolerance, pixels),
                        [&](glm::vec3 light) { return static_cast<double>(perceptual::luma_of(display_, light)); });
    });
}

void StatisticsRecorder::coded(const encoder::CodedPicture& coded) {
    const auto original = waiting_.find(coded.plan.number);
    EXPECTS(original != waiting_.end());
    FrameEntry& entry = entry_of(coded.plan.number);
    entry.type = "-IPB"[static_cast<int>(coded.plan.type)];
    entry.quantiser = coded.quantiser;
    double sum = 0;
    for (const encoder::MacroblockRecord& macroblock : coded.macroblocks.values()) sum += macroblock.quantiser;
    entry.mean_quantiser = core::divide_or(sum, static_cast<double>(coded.macroblocks.size()), 0.0);
    entry.planned_quantiser = coded.plan.quantiser;
    entry.bytes = coded.bytes.size();
    entry.tries = coded.tries;
    entry.minimal = coded.minimal;
    entry.motion = coded.motion;
    entry.stuffing = coded.stuffing_bytes;
    entry.fullness_before = coded.fullness_before;
    entry.fullness_after = coded.fullness_after;
    entry.mse_y = perceptual::mean_squared_error(original->second.y, coded.reconstruction.y);
    entry.ssim_y = perceptual::ssim(original->second.y, coded.reconstruction.y);
    steps_[coded.plan.number].error = perceptual::luma_error(coded.reconstruction.y, original->second.y);
    waiting_.erase(original);
    measure_pumping(coded.plan.number);
    measure_pumping(coded.plan.number + 1);
}

}  // namespace render2mpeg::app
