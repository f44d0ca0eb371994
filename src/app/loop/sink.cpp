#include "app/loop/sink.h"

#include <algorithm>
#include <cmath>
#include <system_error>

#include "app/files/file_io.h"
#include "app/options/output_kind.h"
#include "core/error.h"
#include "encoder/av/y4m.h"
#include "encoder/av/y4m_reader.h"
#include "image/image.h"
#include "image/layers.h"
#include "image/motion_file.h"
#include "perceptual/display.h"

namespace render2mpeg::app {
namespace {

image::FrameFacts facts_of(const RenderJob& film, const LitFrame& frame) {
    const scene::Camera& camera = frame.world.camera;
    // No matrix leads to a panorama's picture, or to one of two eyes.
    return {film.format.pixel_aspect, film.exposure.value_or(0), film.rate.hertz, camera.world_to_camera(),
            camera.is_flat() && film.animation->stereo == core::FramePacking::none
                ? std::optional(camera.world_to_ndc())
                : std::nullopt};
}

/// sRGB code values with an alpha that they are not multiplied by.
std::vector<unsigned char> with_alpha(const perceptual::Display& display, const core::Radiance& shown,
                                      const core::Mattes& mattes) {
    const std::vector<std::uint8_t> colors = display.develop_srgb(perceptual::unmultiplied(shown, mattes));
    std::vector<unsigned char> codes;
    for (std::size_t i = 0; i < shown.combined.size(); ++i) {
        codes.insert(codes.end(), {colors[3 * i], colors[3 * i + 1], colors[3 * i + 2]});
        codes.push_back(static_cast<unsigned char>(std::lround(255 * mattes.alpha(i))));
    }
    return codes;
}

}  // namespace

LayersWriter::LayersWriter(std::filesystem::path folder, const RenderJob& film, RunStatistics& statistics)
    : folder_(std::move(folder)), film_(film), statistics_(statistics) {
    for (const scene::Object& object : film.animation->objects) names_.objects.push_back(object.name);
    for (const scene::Material& material : film.animation->materials) names_.materials.push_back(material.name);
}

void LayersWriter::lit(const LitFrame& frame) {
    const std::int64_t n = frame.world.frame;
    const core::MotionField& before = frame.motion.exact_to(std::max<std::int64_t>(0, n - 1));
    const core::MotionField& after = frame.motion.exact_to(n + 1);
    const StageTimer timer(statistics_, renderer::Pass::layers);
    image::write_layers(numbered(layers_in(folder_), n), frame.lit.frame.visible, frame.lit.radiance, &before, &after,
                        facts_of(film_, frame), &frame.tolerance, frame.mattes, names_);
    write_whole(numbered(motion_in(folder_), n), image::motion_file(before, after, frame.lit.frame.visible.kind));
}

void LastFrameWriter::lit(const LitFrame& frame) {
    const std::lock_guard lock(mutex_);
    if (clock_seconds() < written_ + 1) return;
    // Replaces the picture at once; a full disk is no error.
    const std::filesystem::path part = std::filesystem::path(file_) += ".part";
    std::error_code error;
    try {
        image::write_png(part, frame.picture.width(), frame.picture.height(), film_.display().develop_srgb(frame.shown),
                         film_.format.pixel_aspect);
        std::filesystem::rename(part, file_, error);
    } catch (const core::Error&) {
        std::filesystem::remove(part, error);
    }
    written_ = clock_seconds();
}

void join_y4m(const RenderJob& film, const std::vector<std::filesystem::path>& parts,
              const std::filesystem::path& file) {
    av::Y4mWriter writer(file, film.format.width, film.format.height, film.rate, film.pixel_aspect);
    for (const std::filesystem::path& part : parts) {
        av::Y4mReader reader(part);
        for (std::int64_t n = 0; n < reader.frames(); ++n) writer.write(reader.read(n));
    }
    writer.finish();
}

std::unique_ptr<Sink> make_sink(const RenderJob& film, const std::filesystem::path& output) {
    if (film.kind == OutputKind::film) return nullptr;
    if (film.kind == OutputKind::y4m) {
        const auto writer = std::make_shared<av::Y4mWriter>(output, film.format.width, film.format.height, film.rate,
                                                            film.pixel_aspect);
        return std::make_unique<FrameSink>([writer](const LitFrame& frame) { writer->write(frame.picture); },
                                           [writer] { writer->finish(); }, true);
    }
    if (film.kind == OutputKind::exr)
        return std::make_unique<FrameSink>([&film, output](const LitFrame& frame) {
            image::write_frame(numbered(output, frame.picture.number), frame.lit.radiance.combined,
                               facts_of(film, frame), film.has_alpha() ? frame.mattes : core::Mattes());
        });
    return std::make_unique<FrameSink>([&film, output, display = film.display()](const LitFrame& frame) {
        image::write_png(
            numbered(output, frame.picture.number), frame.picture.width(), frame.picture.height(),
            film.has_alpha() ? with_alpha(display, frame.shown, frame.mattes) : display.develop_srgb(frame.shown),
            film.format.pixel_aspect);
    });
}

}  // namespace render2mpeg::app
