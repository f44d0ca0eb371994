#include "tests/hard_cases/hard_case.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "app/loop/pipeline.h"
#include "core/color.h"
#include "scene/preparation/complete.h"
#include "scene/preparation/traits.h"
#include "tests/encoder/decoders.h"

namespace render2mpeg::test {
namespace {

class Keeper : public app::LoopObserver {
  public:
    explicit Keeper(Lit& lit) : lit_(lit) {}
    void lit(const app::LitFrame& frame) override { lit_.frames.push_back(frame.lit.radiance); }
    void coded(const encoder::CodedPicture& picture) override {
        decoder_.push(picture.bytes);
        lit_.bytes += picture.bytes.size();
        made_.push_back(picture);
    }
    /// Throws where the decoder shows anything else than the encoder reconstructed.
    void finish() {
        lit_.decoded = decoder_.finish();
        if (lit_.decoded.size() != made_.size()) throw std::runtime_error("pictures are missing in the decoded film");
        for (const encoder::CodedPicture& picture : made_) {
            const core::Picture& shown = lit_.decoded.at(static_cast<std::size_t>(picture.plan.number));
            const core::Picture& meant = picture.reconstruction;
            if (!same_values(shown.y, meant.y) || !same_values(shown.cb, meant.cb) || !same_values(shown.cr, meant.cr))
                throw std::runtime_error("the decoded picture is not the reconstruction");
        }
    }

  private:
    Lit& lit_;
    encoder::testing::Libavcodec decoder_;
    std::vector<encoder::CodedPicture> made_;
};

app::RenderJob render_job(const HardCase& hard_case, scene::Animation film, Way way) {
    app::RenderJob p;
    p.rate = core::frame_rate_from("25");
    p.frames = {0, hard_case.frames - 1};
    p.format = {hard_case.size.x, hard_case.size.y, 1.0f};
    p.rendering.format = p.format;
    p.rendering.samples = 1;
    p.rendering.direct_points = 64;
    const bool rays = way == Way::records || way == Way::coupled;
    p.rendering.indirect = rays ? renderer::Indirect::rays : renderer::Indirect::lightcuts;
    p.rendering.vpls = 8192;
    p.rendering.isa = core::detect_isa();
    p.rendering.cache = rays ? renderer::CacheUse::static_light : renderer::CacheUse::off;
    p.plan = renderer::make_plan(scene::traits_of(film), {});
    p.coding.width = hard_case.size.x;
    p.coding.height = hard_case.size.y;
    p.coding.rate = p.rate;
    p.exposure = 0.0f;
    p.tolerance.reference = way == Way::reference;
    p.tolerance.coupled = way == Way::coupled;
    p.animation = std::make_shared<const scene::Animation>(std::move(film));
    return p;
}

}  // namespace

const char* name_of(Way way) {
    constexpr const char* names[] = {"reference", "lightcuts", "records", "coupled"};
    return names[static_cast<std::size_t>(way)];
}

double Lit::mean(std::size_t frame) const {
    double sum = 0;
    for (const glm::vec3& value : frames.at(frame).combined.values())
        sum += static_cast<double>(core::luminance(value));
    return sum / static_cast<double>(frames.at(frame).combined.size());
}

float Lit::brightest() const {
    float most = 0;
    for (const core::Radiance& frame : frames)
        for (const glm::vec3& value : frame.combined.values()) most = std::max({most, value.x, value.y, value.z});
    return most;
}

Lit lit(const HardCase& hard_case, const SceneBuilder& scene, Way way) {
    scene::Animation film = scene.unfinished();
    film.source = "built";
    // Cases count time in seconds, one frame each; films have 25.
    for (scene::Track& track : film.tracks)
        for (float& time : track.times) time /= 25;
    scene::complete(film, hard_case.default_light ? scene::DefaultLight::even : scene::DefaultLight::none);

    Lit result;
    result.way = way;
    result.notes = film.notes;
    const app::RenderJob p = render_job(hard_case, std::move(film), way);
    renderer::Renderer renderer(*p.animation, p.rendering, p.plan);
    app::RunStatistics statistics;
    Keeper keeper(result);
    for (const app::Chunk& chunk : app::chunks_of(p.frames, p.coding.gop))
        app::render_chunk(p, renderer, chunk, keeper, statistics, [] { return true; });
    keeper.finish();
    result.statistics = renderer.statistics();
    return result;
}

void expect_like(const Lit& film, const SceneBuilder& other, double tolerance) {
    const HardCase plain;
    const double expected = lit(plain, other, film.way).mean();
    EXPECT_GT(expected, 0.0);
    EXPECT_NEAR(film.mean() / expected, 1.0, tolerance);
}

SceneBuilder floor_from_above(float height, float albedo) {
    SceneBuilder b;
    b.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, b.add_material(glm::vec3(albedo)));
    b.add_camera({0, height, 0}, {0, 0, 0}, 0.9f);
    return b;
}

SceneBuilder small_room(float radiance) {
    SceneBuilder b;
    const int white = b.add_material({0.7f, 0.7f, 0.7f});
    b.add_box({0, 0, 0}, {4, 3, 4}, white, true);
    b.add_quad({1.5f, 2.99f, 1.5f}, {1, 0, 0}, {0, 0, 1}, b.add_emitter(glm::vec3(radiance)));
    b.add_box({2.2f, 0, 0.8f}, {3.2f, 1.4f, 1.8f}, b.add_material({0.2f, 0.3f, 0.7f}));
    b.add_camera({2.0f, 1.6f, 3.8f}, {2.0f, 1.0f, 0.0f}, 1.1f);
    return b;
}

}  // namespace render2mpeg::test
