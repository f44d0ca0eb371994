#include "app/loop/automatic_exposure.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/color.h"
#include "perceptual/display.h"

namespace render2mpeg::app {
namespace {

/// White stays light and black dark: from the exposure to mid grey.
float studio_exposure(float to_mid_grey) {
    // chosen: means of what is shown of 90 to 160 of 255 (docs/scenes.md).
    constexpr float darkest = 0.14f, lightest = 0.3f;
    const float mean = 0.18f / std::exp2(to_mid_grey);
    return std::log2(std::clamp(mean, darkest, lightest) / mean);
}

/// Takes of a panorama's rows as many pixels as their solid angle is worth, evenly; all of a flat picture.
bool counts_in_mean(const scene::Camera& camera, int pixel, int width) {
    const float weight = camera.weight_of_row(pixel / width);
    const auto before = static_cast<float>(pixel % width);
    return std::floor((before + 1) * weight) > std::floor(before * weight);
}

}  // namespace

float measure_exposure(const RenderJob& film) {
    // chosen: of 3 to 12 frames and 48 to 192 pixels (bench/tables/pictures.csv). Light of one pixel in 4 x 4 costs
    // a quarter of that of all pixels of half the size, which smaller films have.
    constexpr int frames = 5, side_of_sparse = 192;
    const bool is_sparse = std::max(film.rendering.format.width, film.rendering.format.height) >= side_of_sparse;
    const int longest_side = is_sparse ? side_of_sparse : side_of_sparse / 2;
    // chosen: 0.2 of 0.1 to 0.6; 0.3 moves the exposure of five films by 0.04 EV at most, 0.6 by 0.07.
    constexpr float rough = 0.2f;
    const float scale =
        std::min(1.0f, static_cast<float>(longest_side) /
                           static_cast<float>(std::max(film.rendering.format.width, film.rendering.format.height)));
    RenderJob small = film;
    // Of two eyes, one is looked through.
    const auto side = [&](int pixels) {
        return std::max(1, static_cast<int>(std::lround(static_cast<float>(pixels) * scale)));
    };
    small.format = {side(film.rendering.format.width), side(film.rendering.format.height), film.format.pixel_aspect};
    small.rendering.format = small.format;
    small.rendering.mattes = small.rendering.transparent = false;
    small.rendering.samples = 1;
    small.rendering.edge_samples = small.rendering.most_samples = 0;
    // chosen: 8,192, not tuned.
    small.rendering.vpls = std::min(small.rendering.vpls, 8192);
    small.exposure.reset();
    small.tolerance = {};
    core::ToleranceMap about = core::ToleranceMap::uniform(small.format.width, small.format.height, {0.0f, rough});
    about.typical = rough;

    renderer::Renderer renderer = renderer_of(small);
    const renderer::LightingMode mode = is_sparse ? renderer::LightingMode::sparse : renderer::LightingMode::rough;
    std::vector<float> surfaces, sky;
    const int stage = film.animation->stage;
    std::int64_t last = film.frames.first - 1;
    for (int i = 0; i < frames; ++i) {
        const std::int64_t frame = film.frames.first + (film.frame_count() - 1) * (2 * i + 1) / (2 * frames);
        if (frame == std::exchange(last, frame)) continue;
        const scene::Snapshot world = small.snapshot(frame);
        if (i == 0) renderer.start_chunk(world);
        const renderer::Lit lit = renderer.light(world, renderer.look(world), {about, mode});
        const core::Radiance& radiance = lit.radiance;
        for (std::size_t p = 0; p < radiance.combined.size(); ++p) {
            if (!counts_in_mean(world.camera, static_cast<int>(p), small.format.width)) continue;
            const float luminance = core::luminance(radiance.combined.values()[p]);
            const bool of_stage =
                stage >= 0 && lit.frame.visible.address.values()[p].object == static_cast<unsigned>(stage);
            if (lit.frame.visible.kind.values()[p] == core::PixelClass::sky)
                sky.push_back(luminance);
            else if (!of_stage)
                surfaces.push_back(luminance);
        }
    }
    const float exposure = perceptual::auto_exposure(surfaces, sky);
    return stage < 0 ? exposure : studio_exposure(exposure);
}

}  // namespace render2mpeg::app
