#include "app/loop/live_view.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include "core/motion_field.h"
#include "core/tolerance_map.h"
#include "parallel/loops.h"
#include "scene/pose/motion.h"

namespace render2mpeg::app {
namespace {

using Clock = std::chrono::steady_clock;

/// Seconds that a quick picture should take. chosen: 0.2 of 0.1 to 0.5: five pictures a second while one moves about.
constexpr double quick_seconds = 0.2;

/// A quick picture is smaller by one of these.
constexpr std::array smaller{1, 2, 4};

/// Of the picture by rays: that of images' default. chosen: alone; one within 8 % before it is more uneven than drafts.
constexpr float fine_tolerance = 0.02f;

Size divided(Size size, int by) {
    return {std::max(16, (size.width + by - 1) / by), std::max(16, (size.height + by - 1) / by)};
}

scene::PictureFormat format_of(Size size) {
    return {size.width, size.height, 1.0f};
}

bool is_same(const scene::PictureFormat& format, Size size) {
    return format.width == size.width && format.height == size.height;
}

}  // namespace

LiveView::LiveView(RenderJob film)
    : film_(std::move(film)), draft_film_(draft_of(film_)), draft_(renderer_of(draft_film_)) {
    draft_film_.format = draft_film_.rendering.format;  // of one eye
}

void LiveView::show(const LiveWish& wish) {
    wish_ = wish;
    wish_.frame = std::clamp(wish.frame, film_.frames.first, film_.frames.last);
    step_ = 0;
}

/// A snapshot for the next picture.
std::shared_ptr<const scene::Snapshot> LiveView::posed(Size size) {
    const scene::PictureFormat format = format_of(size);
    auto snapshot = std::make_shared<scene::Snapshot>(
        scene::snapshot_at(*film_.animation, wish_.frame, core::time_of(wish_.frame, film_.rate), format));
    if (wish_.from) scene::see_from(*wish_.from, format, *snapshot);
    snapshot->frame = ++number_;
    snapshot->cut_before = false;
    return snapshot;
}

Size LiveView::quick_size() const {
    if (pixel_seconds_ <= 0) return divided(wish_.size, smaller.back());
    for (const int by : smaller)
        if (area_of(divided(wish_.size, by)) * pixel_seconds_ <= quick_seconds) return divided(wish_.size, by);
    return divided(wish_.size, smaller.back());
}

core::Plane<glm::vec3> LiveView::draft(Size size) {
    if (!is_same(draft_film_.format, size)) {
        draft_film_.format = format_of(size);
        draft_.resize(draft_film_.format);
        drafted_.reset();
    }
    const auto snapshot = posed(size);
    {
        const parallel::StopWhen whole({});
        draft_.prepare(*snapshot);
    }
    posed_ = snapshot;
    const Clock::time_point start = Clock::now();
    renderer::Frame frame = draft_.look(*snapshot);
    const core::ToleranceMap tolerance = draft_film_.tolerance_map();
    renderer::LightOrder order{tolerance, renderer::LightingMode::draft};
    std::optional<core::MotionField> motion;
    if (drafted_) motion = scene::motion_between(frame.visible, *snapshot, *drafted_, &frame.imaged);
    order.to_before = motion ? &*motion : nullptr;
    renderer::Lit lit = draft_.light(*snapshot, std::move(frame), order);
    drafted_ = snapshot;
    pixel_seconds_ = std::chrono::duration<double>(Clock::now() - start).count() / area_of(size);
    return std::move(lit.radiance.combined);
}

core::Plane<glm::vec3> LiveView::lit() {
    const auto snapshot = posed(wish_.size);
    {
        const parallel::StopWhen whole({});
        if (!fine_) fine_.emplace(renderer_of(film_));
        fine_->resize(format_of(wish_.size));
        if (!fine_is_sound_) fine_->start_chunk(*snapshot);
        fine_->prepare(*snapshot);
    }
    fine_posed_ = snapshot;
    fine_is_sound_ = false;
    const core::ToleranceMap within =
        core::ToleranceMap::uniform(wish_.size.width, wish_.size.height, {0.0f, fine_tolerance});
    renderer::Lit lit = fine_->light(*snapshot, fine_->look(*snapshot), {within});
    fine_is_sound_ = true;
    return std::move(lit.radiance.combined);
}

/// What the draft's air has learnt may be there by half.
void LiveView::forget_stopped() {
    if (draft_film_.plan.runs(renderer::Pass::air)) draft_.start_chunk(*posed_);
}

std::optional<LivePicture> LiveView::next(const std::function<bool()>& stops) {
    const bool is_first = step_ == 0;
    try {
        const parallel::StopWhen stop(is_first ? std::function<bool()>() : stops);
        if (!is_first && stops()) return {};
        LivePicture picture;
        if (is_first) {
            picture = {draft(quick_size()), LiveLevel::quick, 1};
            // Where it was whole already, it was the first in full size.
            if (is_same(draft_film_.format, wish_.size)) ++step_;
        } else if (step_ <= drafts) {
            picture = {draft(wish_.size), LiveLevel::draft, step_};
        } else {
            picture = {lit(), LiveLevel::lit, 1};
        }
        ++step_;
        return picture;
    } catch (const parallel::Stopped&) {
        if (step_ <= drafts) forget_stopped();
        return {};
    }
}

}  // namespace render2mpeg::app
