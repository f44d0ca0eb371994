#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "app/job/automatic_exposure.h"
#include "app/job/render_job.h"
#include "app/loop/pipeline.h"
#include "support/program.h"

/// How models without light look in the studio, by a picture of each.
namespace render2mpeg {
namespace {

/// Mean luma of what a picture shows of the model, and of all else; 0 to 255, black to white.
struct StudioLuma {
    double model = 0, around = 0;
};

StudioLuma luma_in_studio(const std::string& objects) {
    const support::Folder folder;
    std::ofstream(folder / "film.json") << R"({"objects": [)" << objects << "]}";
    app::RenderOptions options;
    options.input = folder / "film.json";
    options.size = {64, 48};
    options.samples = 1;
    options.tolerance = app::fixed_tolerance(0.02f);
    app::RenderJob film = app::prepare(options);
    film.exposure = app::measure_exposure(film);

    renderer::Renderer renderer = app::renderer_of(film);
    const scene::Snapshot world = film.snapshot(0);
    renderer.start_chunk(world);
    const renderer::Frame seen = renderer.look(world);
    const core::Picture picture = film.display().develop(
        renderer.light(world, seen, {film.tolerance_map(), renderer::LightingMode::rough}).radiance);
    const auto stage = static_cast<unsigned>(film.animation->stage);
    double sums[2]{}, counts[2]{};
    for (std::size_t i = 0; i < picture.y.size(); ++i) {
        const bool model =
            seen.visible.kind.values()[i] != core::PixelClass::sky && seen.visible.address.values()[i].object != stage;
        sums[model] += (picture.y.values()[i] - 16) * 255.0 / 219.0;
        ++counts[model];
    }
    EXPECT_GT(counts[1], 40) << "the model fills much of the picture";
    return {sums[1] / counts[1], sums[0] / counts[0]};
}

struct StudioModel {
    const char* name;
    const char* objects;
};
const std::vector<StudioModel> studio_models{
    {"white ball", R"({"shape": "sphere", "material": {"base_color": 0.95}})"},
    {"black box", R"({"shape": "box", "material": {"base_color": 0.02, "metallic": 0, "roughness": 0.5}})"},
    {"grey torus", R"({"shape": "torus", "material": {"base_color": 0.4}})"},
    {"gold ball",
     R"({"shape": "sphere", "material": {"base_color": [0.9, 0.7, 0.3], "metallic": 1, "roughness": 0.3}})"},
    {"mirror ball", R"({"shape": "sphere", "material": {"base_color": 0.9, "metallic": 1, "roughness": 0}})"},
    {"glass ball", R"({"shape": "sphere", "material": {"transmission": 1, "roughness": 0}})"},
    {"blue cone",
     R"({"shape": "cone", "material": {"base_color": [0.05, 0.1, 0.6], "metallic": 0, "roughness": 0.3}})"},
    {"tall post", R"({"shape": "cylinder", "radius": 0.2, "height": 3, "material": {"base_color": [0.8, 0.5, 0.3]}})"},
    {"flat slab", R"({"shape": "box", "size": [4, 0.2, 2], "material": {"base_color": [0.35, 0.2, 0.1]}})"},
    {"black and white", R"({"shape": "sphere", "material": {"base_color": 0.02}},
        {"shape": "box", "position": [2, 0, 0], "material": {"base_color": 0.9}})"},
};

TEST(StudioLightSlow, ExposesWhatIsShown) {
    for (const StudioModel& model : studio_models) {
        const StudioLuma luma = luma_in_studio(model.objects);
        EXPECT_GT(luma.model, 100) << model.name;
        EXPECT_LT(luma.model, 168) << model.name;
        EXPECT_LT(luma.around, 245) << model.name << ": nothing around it is burnt";
    }
}

TEST(StudioLightSlow, ShowsAWhiteBall) {
    const StudioLuma luma = luma_in_studio(studio_models.front().objects);
    EXPECT_GT(luma.model, luma.around + 15);
}

}  // namespace
}  // namespace render2mpeg
