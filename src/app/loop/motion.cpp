#include "app/loop/motion.h"

#include <algorithm>
#include <utility>

namespace render2mpeg::app {

const core::MotionField* Motion::to(std::int64_t reference) {
    const auto known = found_.find(reference);
    if (known != found_.end()) return &known->second;
    std::optional<core::MotionField> field = find(reference);
    return field ? &found_.emplace(reference, std::move(*field)).first->second : nullptr;
}

std::vector<core::MotionField> Motion::take(std::span<const std::int64_t> references) {
    std::vector<core::MotionField> fields;
    for (const std::int64_t reference : references)
        if (to(reference) != nullptr) fields.push_back(std::move(found_.extract(reference).mapped()));
    return fields;
}

EyeSnapshots PosedFrames::at(std::int64_t frame) {
    // chosen: 6: a frame, the one before, two references, the frame that tolerances come from, and the horizon.
    constexpr std::size_t most = 6;
    const auto known = std::ranges::find(latest_, frame, [](const EyeSnapshots& eyes) { return eyes.front()->frame; });
    if (known != latest_.end()) {
        std::rotate(known, known + 1, latest_.end());
    } else {
        EyeSnapshots& now = latest_.emplace_back();
        for (const scene::Eye eye : eyes_of(job_.animation->stereo))
            now.push_back(std::make_shared<const scene::Snapshot>(job_.snapshot(frame, eye)));
    }
    if (latest_.size() > most) latest_.erase(latest_.begin());
    return latest_.back();
}

core::MotionField RenderedMotion::between(std::int64_t reference) {
    const StageTimer timer(statistics_, renderer::Pass::motion);
    const EyeSnapshots there = posed_.at(reference);
    std::vector<core::MotionField> eyes;
    for (std::size_t e = 0; e < worlds_.size(); ++e)
        eyes.push_back(scene::motion_between(seen_[e].visible, *worlds_[e], *there[e], &seen_[e].imaged));
    return packed(std::move(eyes), job_.animation->stereo);
}

std::optional<core::MotionField> RenderedMotion::find(std::int64_t reference) {
    if (!job_.plan.runs(renderer::Pass::motion)) return std::nullopt;
    return between(reference);
}

const core::MotionField& RenderedMotion::exact_to(std::int64_t reference) {
    if (const core::MotionField* field = to(reference)) return *field;
    return still_.insert_or_assign(reference, between(reference)).first->second;
}

const core::MotionField* RenderedMotion::onward(std::int64_t horizon) {
    if (const core::MotionField* field = to(horizon)) return field;
    core::MotionField still{worlds_.front()->frame, horizon, {}, {}, {}};
    const int width = job_.format.width, height = job_.format.height;
    still.vector = core::Plane<glm::vec2>(width, height, glm::vec2{0.0f});
    still.kind = core::Plane<core::PixelClass>(width, height, core::PixelClass::surface);
    return &still_.insert_or_assign(horizon, std::move(still)).first->second;
}

}  // namespace render2mpeg::app
