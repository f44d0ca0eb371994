#include "app/loop/statistics_recorder.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/numeric.h"
#include "perceptual/metrics.h"
#include "perceptual/pumping.h"

namespace render2mpeg::app {

void StatisticsRecorder::lit(const LitFrame& frame) {
    const renderer::Statistics &before = frame.before, &after = frame.after;
    FrameEntry entry;
    entry.frame = frame.world.frame;
    entry.cost.shadow_rays = after.shadow_rays - before.shadow_rays;
    entry.cost.gather_rays = after.gather_rays - before.gather_rays;
    entry.cost.exposure_rays = after.exposure_rays - before.exposure_rays;
    entry.cost.caustic_rays = after.caustic_rays - before.caustic_rays;
    const auto points = static_cast<double>(std::max<std::uint64_t>(1, after.gather_points - before.gather_points));
    entry.cost.direct_cut = static_cast<double>(after.direct_clusters - before.direct_clusters) / points;
    entry.cost.indirect_cut = static_cast<double>(after.indirect_clusters - before.indirect_clusters) / points;
    entry.cost.records = {after.cache.created - before.cache.created, after.cache.live,
                          static_cast<double>(after.cache.served - before.cache.served) / points};
    const bool first = statistics_.frames.size() == first_;
    statistics_.frames.push_back(entry);
    for (const std::uint8_t luma : frame.picture.y.values())
        statistics_.brightest_luma = std::max<int>(statistics_.brightest_luma, luma);
    statistics_.light += frame.picture.level;
    if (!coded_) return;
    const bool continues = !first && !frame.world.cut_before;
    keep(frame.picture, continues, continues ? frame.motion.to(entry.frame - 1) : nullptr);
}

void StatisticsRecorder::read(const core::Picture& picture, const core::MotionField* motion) {
    FrameEntry entry;
    entry.frame = picture.number;
    statistics_.frames.push_back(entry);
    statistics_.light += picture.level;
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
        const std::vector<renderer::ValidatedPixel> validated =
            renderer_.validate(frame.world, frame.lit, frame.tolerance, pixels);
        audit.split.add(validated, [&](glm::vec3 light) { return luma(light); });
        if (frame.world.frame == next_ && !frame.world.cut_before) follow(frame);
        keep(frame, validated);
    });
}

std::vector<std::optional<glm::ivec2>> Auditor::places_of_points(const LitFrame& frame) const {
    // chosen: depths of one point agree to a hundredth, as surfaces that hide each other seldom do.
    constexpr float same_depth = 0.01f;
    const core::MotionField& motion = frame.motion.exact_to(frame.world.frame - 1);
    const core::Visible& visible = frame.lit.frame.visible;
    core::Plane<int> point_at(visible.width(), visible.height(), -1);
    for (std::size_t i = 0; i < before_.size(); ++i)
        point_at.at(before_[i].place.x, before_[i].place.y) = static_cast<int>(i);
    std::vector<std::optional<glm::ivec2>> places(before_.size());
    std::vector<float> apart(before_.size(), 1.0f);
    for (int y = 0; y < visible.height(); ++y)
        for (int x = 0; x < visible.width(); ++x) {
            if (motion.kind.at(x, y) == core::PixelClass::none) continue;
            const glm::vec2 from = glm::vec2(x, y) + motion.vector.at(x, y);
            const glm::ivec2 nearest(glm::round(from));
            if (nearest.x < 0 || nearest.y < 0 || nearest.x >= visible.width() || nearest.y >= visible.height())
                continue;
            const int i = point_at.at(nearest.x, nearest.y);
            if (i < 0 || before_[static_cast<std::size_t>(i)].object != visible.address.at(x, y).object) continue;
            const auto k = static_cast<std::size_t>(i);
            if (!motion.depth_in_reference.empty() &&
                !(std::abs(motion.depth_in_reference.at(x, y) - before_[k].depth) <= same_depth * before_[k].depth))
                continue;
            const float distance = glm::distance(from, glm::vec2(nearest));
            if (!(distance < apart[k])) continue;
            apart[k] = distance;
            places[k] = glm::ivec2(x, y);
        }
    return places;
}

void Auditor::follow(const LitFrame& frame) {
    const std::vector<std::optional<glm::ivec2>> found = places_of_points(frame);
    std::vector<glm::ivec2> places;
    for (const auto& place : found)
        if (place) places.push_back(*place);
    const std::vector<renderer::AuditedPixel> pixels = renderer_.audit(frame.world, frame.lit, frame.tolerance, places);
    // Pixels that gather nothing are left out.
    std::size_t k = 0;
    for (const renderer::ValidatedPixel& now : renderer_.validate(frame.world, frame.lit, frame.tolerance, pixels)) {
        while (!found[k] || *found[k] != now.place) ++k;
        const auto code_value = [&](glm::vec3 light) { return luma(light); };
        statistics_.audit.split.add_change(before_[k].errors, renderer::code_errors(now, code_value));
    }
}

void Auditor::keep(const LitFrame& frame, std::span<const renderer::ValidatedPixel> pixels) {
    // chosen: a quarter, so that an audit takes a quarter more.
    constexpr std::size_t step = 4;
    const core::Visible& visible = frame.lit.frame.visible;
    before_.clear();
    next_ = frame.world.frame + 1;
    for (std::size_t i = 0; i < pixels.size(); i += step) {
        const glm::ivec2 at = pixels[i].place;
        before_.push_back({at, visible.address.at(at.x, at.y).object, visible.depth.at(at.x, at.y),
                           renderer::code_errors(pixels[i], [&](glm::vec3 light) { return luma(light); })});
    }
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
