#include "app/loop/glare_filter.h"

#include <algorithm>

#include "core/color.h"

namespace render2mpeg::app {

GlareFilter::GlareFilter(const RenderJob& film, RunStatistics& statistics) : statistics_(statistics) {
    if (film.plan.runs(renderer::Pass::glare))
        glare_.emplace(film.animation->glare, film.rendering.format.width, film.rendering.format.height,
                       film.format.pixel_aspect, film.exposure.value_or(0));
}

const core::Radiance& GlareFilter::of(const core::Radiance& light, const core::Rational& seconds) {
    if (!glare_) return light;
    const StageTimer stage(statistics_, Stage::develop);
    const StageTimer pass(statistics_, renderer::Pass::glare);
    shown_.frame = light.frame;
    shown_.combined = glare_->over(light.combined, seconds.value());
    veil_ = core::Plane<float>(light.combined.width(), light.combined.height());
    for (std::size_t i = 0; i < veil_.size(); ++i)
        veil_.values()[i] =
            std::max(core::luminance(shown_.combined.values()[i]) - core::luminance(light.combined.values()[i]), 0.0f);
    return shown_;
}

void GlareFilter::carry_back(core::ToleranceMap& tolerance) const {
    if (veil_.empty() || tolerance.is_reference()) return;
    for (std::size_t i = 0; i < veil_.size(); ++i) {
        core::Tolerance& t = tolerance.pixels.values()[i];
        t.background = std::max(t.background - veil_.values()[i], 0.0f);
    }
}

}  // namespace render2mpeg::app
