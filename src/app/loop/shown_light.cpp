#include "app/loop/shown_light.h"

namespace render2mpeg::app {

ShownLight::ShownLight(const RenderJob& film, RunStatistics& statistics) : statistics_(statistics) {
    if (film.plan.runs(renderer::Pass::glare))
        glare_.emplace(film.animation->glare, film.format.width, film.format.height, film.format.pixel_aspect,
                       film.exposure.value_or(0));
}

const core::Radiance& ShownLight::of(const core::Radiance& light, const core::Rational& seconds) {
    if (!glare_) return light;
    const StageTimer stage(statistics_, Stage::develop);
    const StageTimer pass(statistics_, renderer::Pass::glare);
    shown_.frame = light.frame;
    shown_.combined = glare_->over(light.combined, seconds.value());
    return shown_;
}

}  // namespace render2mpeg::app
