#include "app/report/heatmap_film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/options/output_kind.h"
#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "encoder/av/coders.h"
#include "encoder/codec.h"

namespace render2mpeg::app {
namespace {

/// A subject's name in --heatmap, its legend's title, and the values on the legend, which spans them.
struct SubjectScale {
    const char* name;
    HeatSubject subject;
    const char* title;
    bool logarithmic, per_cent;
    std::vector<float> values;
    core::Plane<float> core::Radiance::*of_records = nullptr;  ///< shown as it is; null: not about records
};

const std::vector<SubjectScale>& subjects() {
    using enum HeatSubject;
    static const std::vector<SubjectScale> all{
        {"tolerance", tolerance, "TOLERANCE / LUMINANCE", true, true, {0.01f, 0.02f, 0.05f, 0.1f, 0.2f, 0.5f, 1}},
        {"cut", cut, "CUT: CLUSTERS PER PIXEL", true, false, {5, 10, 30, 100, 300, 1000, 4000}},
        {"error", error, "STANDARD ERROR / LUMINANCE", true, true, {0.001f, 0.01f, 0.02f, 0.05f, 0.1f, 0.3f, 1}},
        {"quantiser", quantiser, "QUANTISER SCALE CODE", true, false, {1, 2, 3, 4, 6, 8, 12, 16, 24, 31}},
        {"records", records, "RECORDS IN THE PIXEL", false, false, {0, 1, 2, 4, 6, 8}, &core::Radiance::record_density},
        {"age", age, "AGE OF LIGHT: FRAMES", false, false, {0, 10, 20, 30, 40, 50, 60}, &core::Radiance::record_age},
        {"reuse", reuse, "LIGHT REUSED", false, true, {0, 0.25f, 0.5f, 0.75f, 1}, &core::Radiance::record_reuse}};
    return all;
}

const SubjectScale& facts_of(HeatSubject subject) {
    return *std::ranges::find(subjects(), subject, &SubjectScale::subject);
}

}  // namespace

perceptual::HeatScale scale_of(HeatSubject subject) {
    const SubjectScale& s = facts_of(subject);
    perceptual::HeatScale scale{s.title, s.values.front(), s.values.back(), s.logarithmic, {}};
    for (const float value : s.values)
        scale.marks.push_back({value, s.per_cent ? fmt::format("{:.3g}%", 100 * value) : fmt::format("{:g}", value)});
    return scale;
}

namespace {

core::Plane<float> values_of(HeatSubject subject, const LitFrame& frame) {
    const core::Plane<glm::vec3>& light = frame.lit.radiance.combined;
    core::Plane<float> values(light.width(), light.height(), 0.0f);
    if (const auto of_records = facts_of(subject).of_records) {
        // None were kept where no light was.
        const core::Plane<float>& plane = frame.lit.radiance.*of_records;
        return plane.size() == light.size() ? plane : values;
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float luminance = core::luminance(light.values()[i]);
        // Black counts as far off: any light is infinitely more.
        if (subject == HeatSubject::tolerance && !frame.tolerance.is_reference()) {
            const core::Tolerance& t = frame.tolerance.pixels.values()[i];
            values.values()[i] = core::divide_or(t.allows(luminance), luminance, 1.0f);
        } else if (subject == HeatSubject::cut) {
            values.values()[i] =
                frame.lit.radiance.direct_cut.values()[i] + frame.lit.radiance.indirect_cut.values()[i];
        } else if (subject == HeatSubject::error) {
            values.values()[i] = core::divide_or(frame.lit.radiance.error.values()[i], luminance, 0.0f);
        }
    }
    return values;
}

/// Macroblocks as pixels: MPEG-2's quantiser of each pixel, or its equivalent at about the same quality.
core::Plane<float> quantisers_of(encoder::Codec codec, const encoder::CodedPicture& coded) {
    core::Plane<float> values(coded.reconstruction.width(), coded.reconstruction.height());
    for (int y = 0; y < values.height(); ++y)
        for (int x = 0; x < values.width(); ++x)
            values.at(x, y) = static_cast<float>(
                encoder::mpeg2_quantiser_like(codec, coded.macroblocks.at(x / 16, y / 16).quantiser));
    return values;
}

/// Stretched or shrunk to another width; every pixel is one of those that were.
core::Plane<float> widened(const core::Plane<float>& values, int width) {
    core::Plane<float> result(width, values.height());
    for (int y = 0; y < values.height(); ++y)
        for (int x = 0; x < width; ++x) result.at(x, y) = values.at((2 * x + 1) * values.width() / (2 * width), y);
    return result;
}

/// How a heatmap of the film is coded: every picture by itself and finely, since edges of false colours are not to
/// smear. In square pixels, whatever the film's are: with the legend the whole has a shape that MPEG-2 cannot say.
encoder::Settings heatmap_settings(const RenderJob& film, const std::filesystem::path& output) {
    encoder::Settings settings;
    settings.codec = codec_of({}, output);
    settings.width =
        std::max(1, static_cast<int>(std::lround(static_cast<float>(film.format.width) * film.format.pixel_aspect)));
    settings.height = film.format.height + perceptual::legend_height;
    settings.rate = film.rate;
    settings.quantiser = static_cast<int>(std::lround(encoder::quantiser_like(settings.codec, 2)));
    settings.gop = 1;
    settings.b_pictures = 0;
    settings.effort = encoder::Effort::fast;
    settings.matrix_coefficients = static_cast<int>(perceptual::matrix_for(film.format.height));
    return settings;
}

}  // namespace

std::optional<HeatSubject> heat_subject_of(const std::string& word) {
    const auto found = std::ranges::find(subjects(), word, &SubjectScale::name);
    return found == subjects().end() ? std::nullopt : std::optional(found->subject);
}

HeatmapFilm::HeatmapFilm(HeatSubject subject, const std::filesystem::path& output, const RenderJob& film,
                         WorkFolder& work)
    : SideFilm(facts_of(subject).name, output, film, heatmap_settings(film, output), work),
      subject_(subject),
      codec_(film.coding.codec),
      matrix_(perceptual::matrix_for(film.format.height)),
      scale_(scale_of(subject)) {
    be_silent();
}

void HeatmapFilm::lit(const LitFrame& frame) {
    if (subject_ != HeatSubject::quantiser) show(frame.world.frame, values_of(subject_, frame));
}

void HeatmapFilm::coded(const encoder::CodedPicture& coded) {
    if (subject_ == HeatSubject::quantiser) show(coded.plan.number, quantisers_of(codec_, coded));
}

void HeatmapFilm::open(const Chunk& chunk) {
    encoder_ = av::make_coder(film().coding);
    next_ = chunk.first;
    early_.clear();
}

std::vector<encoder::CodedPicture> HeatmapFilm::close(core::LightLevel&) {
    EXPECTS(early_.empty());
    return encoder_->flush();
}

void HeatmapFilm::show(std::int64_t number, core::Plane<float> values) {
    early_.emplace(number, std::move(values));
    for (auto next = early_.find(next_); next != early_.end(); next = early_.find(next_)) {
        core::Picture picture = perceptual::heatmap(
            next->second.width() == film().coding.width ? next->second : widened(next->second, film().coding.width),
            scale_, matrix_);
        picture.number = next_;
        encoder::PictureFacts facts;
        facts.left_in_chunk = chunk().last - next_;
        facts.last_chunk = chunk().last == film().frames.last;
        const encoder::PicturePlan plan = encoder_->plan(next_, facts, next_ == chunk().first);
        append(encoder_->push(picture, plan, {}));
        early_.erase(next);
        ++next_;
    }
}

void check_heatmap(HeatSubject subject, const std::filesystem::path& output, const RenderJob& film) {
    const SubjectScale& facts = facts_of(subject);
    const std::string name = facts.name;
    if (subject == HeatSubject::quantiser && film.kind != OutputKind::film)
        throw core::Error("heatmap quantiser: only films have one");
    if (facts.of_records && (film.rendering.cache == renderer::CacheUse::off || film.tolerance.reference))
        throw core::Error("heatmap " + name + ": there are no records without `--cache on`, nor with " +
                          "`--tolerance reference`");
    if (subject == HeatSubject::tolerance && film.tolerance.reference)
        throw core::Error("heatmap tolerance: `--tolerance reference` has none");
    try {
        av::check(heatmap_settings(film, output));
    } catch (const core::Error& error) {
        throw core::Error("heatmap " + name + ": the film with a legend of " +
                          std::to_string(perceptual::legend_height) + " lines below cannot be coded: " + error.what());
    }
}

}  // namespace render2mpeg::app
