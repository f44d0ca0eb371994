#include "app/pipeline.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/bookkeeper.h"
#include "image/layers.h"
#include "scene/motion.h"

namespace render2mpeg::app {
namespace {

/// Motion from a picture to each of its references: exact at any distance, since a snapshot of any frame can be had.
/// None where nothing moves: then the encoder's zero vector is exact.
std::vector<core::MotionField> motion_of(const Production& film, const encoder::PicturePlan& coding,
                                         const core::Visible& visible, const scene::Snapshot& world) {
    std::vector<core::MotionField> fields;
    if (!film.plan.runs(renderer::Pass::motion)) return fields;
    for (const std::int64_t reference : coding.references)
        fields.push_back(scene::motion_between(visible, world, film.snapshot(reference)));
    return fields;
}

/// Pictures after frame n before another shot begins or the chunk ends.
std::int64_t frames_left(const Production& film, std::int64_t n, std::int64_t last) {
    std::int64_t left = last - n;
    for (const scene::Shot& shot : film.animation->shots)
        if (shot.frame > n) left = std::min(left, shot.frame - 1 - n);
    return left;
}

void write_frame_layers(const Production& film, const std::filesystem::path& folder, const core::Visible& visible,
                        const core::Radiance& radiance, const scene::Snapshot& world) {
    const core::MotionField before =
        scene::motion_between(visible, world, film.snapshot(std::max<std::int64_t>(0, world.frame - 1)));
    const core::MotionField after = scene::motion_between(visible, world, film.snapshot(world.frame + 1));
    image::write_layers(folder / fmt::format("frame_{:04}.exr", world.frame), visible, radiance, &before, &after);
}

}  // namespace

bool render_chunk(const Production& film, renderer::Renderer& renderer, const Chunk& chunk,
                  const Destination& destination, Ledger& ledger, const std::function<bool()>& frame_done) {
    const perceptual::Display display(film.exposure.value_or(0), perceptual::matrix_for(film.format.height));
    const core::ToleranceMap tolerance = film.tolerance_map();
    encoder::Encoder encoder(film.coding);
    Bookkeeper books(ledger);
    renderer.start_chunk(film.snapshot(chunk.first));
    const auto write = [&](const std::vector<encoder::CodedPicture>& pictures) {
        for (const encoder::CodedPicture& coded : pictures) {
            books.coded(coded);
            destination.film->append(coded);
        }
    };

    bool whole = true;
    for (std::int64_t n = chunk.first; n <= chunk.last && whole; ++n) {
        const double start = cpu_seconds();
        const renderer::Statistics before = renderer.statistics();
        const scene::Snapshot world = film.snapshot(n);

        // See, then light what is seen.
        const renderer::Seen seen = timed(ledger, Stage::see, [&] { return renderer.see(world); });
        const core::Radiance radiance =
            timed(ledger, Stage::shade, [&] { return renderer.shade(world, seen, tolerance); });
        books.rendered(n, before, renderer.statistics());

        // Develop it.
        core::Picture picture = timed(ledger, Stage::develop, [&] { return display.develop(radiance); });
        picture.number = n;
        for (const std::uint8_t luma : picture.y.values())
            ledger.brightest_luma = std::max<int>(ledger.brightest_luma, luma);

        // Encode it with the renderer's own motion, or write it as it is.
        if (destination.film != nullptr) {
            const encoder::PictureFacts facts{world.cut_before, frames_left(film, n, chunk.last)};
            const encoder::PicturePlan coding = encoder.plan(n, facts, n == chunk.first);
            books.keep(picture);
            const auto motion =
                timed(ledger, renderer::Pass::motion, [&] { return motion_of(film, coding, seen.visible, world); });
            write(timed(ledger, Stage::encode, [&] { return encoder.push(picture, coding, motion); }));
        }
        if (destination.sink != nullptr) destination.sink->write(radiance, picture);
        if (destination.layers != nullptr)
            timed(ledger, renderer::Pass::layers,
                  [&] { write_frame_layers(film, *destination.layers, seen.visible, radiance, world); });
        books.took(cpu_seconds() - start);
        whole = frame_done() || n == chunk.last;
    }
    if (destination.film != nullptr) write(timed(ledger, Stage::encode, [&] { return encoder.flush(); }));
    return whole;
}

}  // namespace render2mpeg::app
