#include "app/report/view_film.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "encoder/av/coders.h"
#include "encoder/cadence.h"
#include "encoder/codec.h"

namespace render2mpeg::app {
namespace {

core::View view_of(const SideFilmRequest& asked, const RenderJob& film) {
    core::View view = asked.view.value().view;
    view.peak = film.view.peak;
    return view;
}

encoder::Settings settings_of(const SideFilmRequest& asked, const RenderJob& film) {
    const core::View view = view_of(asked, film);
    const encoder::CodecFacts &facts = encoder::facts_of(asked.view.value().codec_in(asked.file)),
                              &render = encoder::facts_of(film.coding.codec);
    CodingOptions options;
    options.codec = facts.codec;
    options.gop = film.coding.gop;
    options.encoder = film.coding.effort == encoder::Effort::fast ? "fast" : "quality";
    if (render.most_b_pictures > 0) options.b_pictures = film.coding.b_pictures;
    if (!facts.master && film.kind == OutputKind::film && !render.master) {
        const double quantiser = encoder::mpeg2_quantiser_like(film.coding.codec, film.coding.quantiser) *
                                 film.view.coarseness() / view.coarseness();
        options.quantiser = static_cast<int>(std::clamp(std::lround(quantiser), 1L, 31L));
    }
    Shape shape;
    shape.size = {film.format.width, film.format.height};
    shape.rate = film.rate;
    shape.pixel_aspect = film.pixel_aspect;
    shape.aspect_ratio_code = film.coding.aspect_ratio_code;
    encoder::Settings coding = coding_settings(options, shape, film.frames.first, asked.file, view);
    coding.grain = film.coding.grain;
    coding.labels = film.coding.labels;
    const core::Rational rate = encoder::declared_rate(coding).hertz;  // pulldown has another
    if (!(rate == encoder::declared_rate(film.coding).hertz)) coding.labels.start.reset();
    coding.sphere = film.coding.sphere;
    coding.packing = film.coding.packing;
    coding.alpha = facts.has_alpha() && film.is_transparent();
    return coding;
}

}  // namespace

void check_view_film(const SideFilmRequest& asked, const RenderJob& film) {
    try {
        av::check(settings_of(asked, film));
        if (!film.sound.file.empty() && !av::can_have_sound(asked.file))
            throw core::Error("such a film has no sound; choose another ending");
    } catch (const core::Error& error) {
        throw core::Error("also " + asked.subject + ": " + asked.file.string() + " cannot be coded: " + error.what());
    }
}

ViewFilm::ViewFilm(const SideFilmRequest& asked, const RenderJob& film, WorkFolder& work)
    : SideFilm(asked.subject, asked.file, film, settings_of(asked, film), work),
      render_(film),
      view_(view_of(asked, film)),
      shots_(shots_of(*film.animation)) {}

void ViewFilm::open(const Chunk& chunk) {
    // The exposure may be measured after the side films are made.
    display_.emplace(render_.exposure.value_or(0), perceptual::matrix_for(render_.format.height, view_), view_,
                     encoder::facts_of(film().coding.codec).exact_chroma(), encoder::grain_of_pictures(film().coding));
    coder_ = std::make_unique<PictureCoder>(film(), chunk, std::span<const encoder::BitAllocation>(), shots_,
                                            statistics_, false);
    light_ = {};
}

void ViewFilm::lit(const LitFrame& frame) {
    core::Picture picture =
        film().coding.alpha ? display_->develop(frame.shown, frame.mattes) : display_->develop(frame.shown);
    picture.number = frame.world.frame;
    light_ += picture.level;
    const std::array<const core::Picture*, 1> shown{&picture};
    const encoder::PicturePlan plan = coder_->plan(picture.number, frame.world.cut_before, frame.motion, shown);
    append(coder_->code(picture, plan, frame.motion));
}

std::vector<encoder::CodedPicture> ViewFilm::close(core::LightLevel& light) {
    light = light_;
    return coder_->flush();
}

}  // namespace render2mpeg::app
