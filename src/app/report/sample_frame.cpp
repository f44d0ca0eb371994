#include "app/report/sample_frame.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/report/figures.h"
#include "app/report/heatmap_film.h"
#include "core/color.h"
#include "core/numeric.h"
#include "encoder/codec.h"

namespace render2mpeg::app {

SampleFrameObserver::SampleFrameObserver(const RenderJob& film)
    : frame_(film.frames.first + (film.frame_count() - 1) / 2),
      codec_(film.coding.codec),
      matrix_(perceptual::matrix_for(film.format.height)) {}

void SampleFrameObserver::lit(const LitFrame& frame) {
    if (frame.world.frame != frame_) return;
    const ViewBox box = view_of(frame.picture.width(), frame.picture.height());
    lit_ = part_of(frame.picture, box);
    const core::Plane<glm::vec3>& light = frame.lit.radiance.combined;
    const auto over_luminance = [&](auto&& value) {
        core::Plane<float> plane(light.width(), light.height());
        for (std::size_t i = 0; i < plane.size(); ++i)
            plane.values()[i] = core::divide_or(value(i), core::luminance(light.values()[i]), 1.0f);
        return part_of(plane, box);
    };
    if (!frame.tolerance.is_reference())
        tolerance_ = over_luminance([&](std::size_t i) {
            const core::Tolerance& t = frame.tolerance.pixels.values()[i];
            return t.allows(core::luminance(light.values()[i]));
        });
    if (!frame.lit.radiance.error.empty())
        error_ = over_luminance([&](std::size_t i) { return frame.lit.radiance.error.values()[i]; });
}

void SampleFrameObserver::coded(const encoder::CodedPicture& coded) {
    if (coded.plan.number != frame_) return;
    decoded_ = part_of(coded.reconstruction, view_of(coded.reconstruction.width(), coded.reconstruction.height()));
    coding_ =
        fmt::format("{} picture, {} {}, {}", "-IPB"[static_cast<int>(coded.plan.type)], encoder::facts_of(codec_).scale,
                    coded.quantiser, size_text(static_cast<double>(coded.bytes.size())));
}

nlohmann::json SampleFrameObserver::figures() const {
    if (!lit_) return earlier_;
    nlohmann::json all = nlohmann::json::array();
    if (decoded_)
        all.push_back(pair_of(fmt::format("Frame {}: {}", frame_, coding_), {"decoded", *decoded_},
                              {"as it was lit", *lit_}, matrix_, true));
    if (!tolerance_.empty())
        all.push_back(heat_of("What each pixel's light may be off by", tolerance_, scale_of(HeatSubject::tolerance)));
    if (!error_.empty())
        all.push_back(heat_of("What it may be off by as gathered", error_, scale_of(HeatSubject::tolerance)));
    return all;
}

}  // namespace render2mpeg::app
