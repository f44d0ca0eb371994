#include "app/job/automatic_exposure.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "app/job/eyes.h"
#include "core/color.h"
#include "core/numeric.h"
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

/// Takes of a panorama's rows as many pixels as their solid angle is worth, evenly, and all of its largest row; all of
/// a flat picture.
std::vector<std::uint8_t> counted_in_mean(const scene::Camera& camera, const scene::PictureFormat& format) {
    std::vector<float> weights;
    for (int y = 0; y < format.height; ++y) weights.push_back(camera.weight_of_row(y));
    const float largest = *std::ranges::max_element(weights);
    std::vector<std::uint8_t> counted;
    for (const float weight : weights)
        for (int x = 0; x < format.width; ++x) {
            const float share = core::divide_or(weight, largest, 1.0f), before = static_cast<float>(x);
            counted.push_back(std::floor((before + 1) * share) > std::floor(before * share) ? 1 : 0);
        }
    return counted;
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
    const Size whole{film.rendering.format.width, film.rendering.format.height},
        size = scaled(whole, std::min(1.0, 1.0 * longest_side / std::max(whole.width, whole.height)), {});
    RenderJob small = film;
    // Of two eyes each looks at every second frame.
    small.format = {size.width, size.height, film.format.pixel_aspect};
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
    const std::span<const scene::Eye> eyes = eyes_of(film.animation->stereo);
    std::set<std::pair<std::int64_t, scene::Eye>> looked;
    for (int i = 0; i < frames; ++i) {
        const std::int64_t frame = film.frames.first + (film.frame_count() - 1) * (2 * i + 1) / (2 * frames);
        const scene::Eye eye = eyes[static_cast<std::size_t>(i) % eyes.size()];
        if (!looked.emplace(frame, eye).second) continue;
        const scene::Snapshot world = small.snapshot(frame, eye);
        if (i == 0) renderer.start_chunk(world);
        const renderer::Lit lit = renderer.light(world, renderer.look(world), {about, mode});
        const core::Radiance& radiance = lit.radiance;
        const std::vector<std::uint8_t> counted = counted_in_mean(world.camera, small.format);
        for (std::size_t p = 0; p < radiance.combined.size(); ++p) {
            if (counted[p] == 0) continue;
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
