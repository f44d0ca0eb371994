#include "app/heatmap_film.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "app/output_kind.h"
#include "app/publish.h"
#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::app {
perceptual::HeatScale scale_of(HeatSubject subject) {
    switch (subject) {
        case HeatSubject::tolerance:
            return {"TOLERANCE / LUMINANCE",
                    0.01f,
                    1.0f,
                    true,
                    {{0.01f, "1%"},
                     {0.02f, "2%"},
                     {0.05f, "5%"},
                     {0.1f, "10%"},
                     {0.2f, "20%"},
                     {0.5f, "50%"},
                     {1.0f, "100%"}}};
        case HeatSubject::cut:
            return {"CUT: CLUSTERS PER PIXEL",
                    5.0f,
                    4000.0f,
                    true,
                    {{5, "5"}, {10, "10"}, {30, "30"}, {100, "100"}, {300, "300"}, {1000, "1000"}, {4000, "4000"}}};
        case HeatSubject::error:
            return {"ERROR REACHED / LUMINANCE",
                    0.001f,
                    1.0f,
                    true,
                    {{0.001f, "0.1%"},
                     {0.01f, "1%"},
                     {0.02f, "2%"},
                     {0.05f, "5%"},
                     {0.1f, "10%"},
                     {0.3f, "30%"},
                     {1.0f, "100%"}}};
        case HeatSubject::quantiser:
            break;
    }
    return {
        "QUANTISER SCALE CODE",
        1.0f,
        31.0f,
        true,
        {{1, "1"}, {2, "2"}, {3, "3"}, {4, "4"}, {6, "6"}, {8, "8"}, {12, "12"}, {16, "16"}, {24, "24"}, {31, "31"}}};
}

namespace {

core::Plane<float> values_of(HeatSubject subject, const LitFrame& frame) {
    const core::Plane<glm::vec3>& light = frame.radiance.combined;
    core::Plane<float> values(light.width(), light.height(), 0.0f);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float luminance = core::luminance(light.values()[i]);
        // Black counts as far off: any light is infinitely more.
        if (subject == HeatSubject::tolerance && !frame.tolerance.is_reference()) {
            const core::Tolerance& t = frame.tolerance.pixels.values()[i];
            values.values()[i] = std::max(core::divide_or(t.absolute, luminance, 1.0f), t.relative);
        } else if (subject == HeatSubject::cut) {
            values.values()[i] = frame.radiance.direct_cut.values()[i] + frame.radiance.indirect_cut.values()[i];
        } else if (subject == HeatSubject::error) {
            values.values()[i] = core::divide_or(frame.radiance.error.values()[i], luminance, 0.0f);
        }
    }
    return values;
}

/// Macroblocks as pixels.
core::Plane<float> quantisers_of(const encoder::CodedPicture& coded) {
    core::Plane<float> values(coded.reconstruction.width(), coded.reconstruction.height());
    for (int y = 0; y < values.height(); ++y)
        for (int x = 0; x < values.width(); ++x) values.at(x, y) = coded.macroblocks.at(x / 16, y / 16).quantiser;
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
encoder::Settings heatmap_settings(const Production& film) {
    encoder::Settings settings;
    settings.width =
        std::max(1, static_cast<int>(std::lround(static_cast<float>(film.format.width) * film.format.pixel_aspect)));
    settings.height = film.format.height + perceptual::legend_height;
    settings.rate = film.rate;
    settings.quantiser = 2;
    settings.gop = 1;
    settings.b_pictures = 0;
    settings.effort = encoder::Effort::fast;
    settings.matrix_coefficients = static_cast<int>(perceptual::matrix_for(film.format.height));
    return settings;
}

}  // namespace

HeatSubject heat_subject_from(const std::string& name) {
    if (name == "tolerance") return HeatSubject::tolerance;
    if (name == "cut") return HeatSubject::cut;
    if (name == "quantiser") return HeatSubject::quantiser;
    if (name == "error") return HeatSubject::error;
    throw core::Error("heatmap " + name + ": expected tolerance, cut, error or quantiser");
}

HeatmapFilm::HeatmapFilm(HeatSubject subject, const std::filesystem::path& output, const Production& film,
                         const std::string& command)
    : subject_(subject),
      output_(output),
      work_(output, film.film(), command),
      unfinished_(work_.place("film" + output.extension().string())),
      settings_(heatmap_settings(film)),
      matrix_(perceptual::matrix_for(film.format.height)),
      scale_(scale_of(subject)),
      first_(film.frames.first),
      next_(film.frames.first),
      encoder_(std::make_unique<encoder::Encoder>(settings_)),
      muxer_(std::make_unique<av::Muxer>(unfinished_, output_, settings_)) {}

HeatmapFilm::~HeatmapFilm() = default;

void HeatmapFilm::lit(const LitFrame& frame) {
    if (subject_ != HeatSubject::quantiser) show(frame.world.frame, values_of(subject_, frame));
}

void HeatmapFilm::coded(const encoder::CodedPicture& coded) {
    if (subject_ == HeatSubject::quantiser) show(coded.plan.number, quantisers_of(coded));
}

void HeatmapFilm::show(std::int64_t number, core::Plane<float> values) {
    early_.emplace(number, std::move(values));
    for (auto next = early_.find(next_); next != early_.end(); next = early_.find(next_)) {
        core::Picture picture = perceptual::heatmap(
            next->second.width() == settings_.width ? next->second : widened(next->second, settings_.width), scale_,
            matrix_);
        picture.number = next_;
        const encoder::PicturePlan plan = encoder_->plan(next_, {}, next_ == first_);
        for (encoder::CodedPicture& coded : encoder_->push(picture, plan, {})) {
            write();
            waiting_ = std::move(coded);
        }
        early_.erase(next);
        ++next_;
    }
}

void HeatmapFilm::write() {
    if (!waiting_) return;
    muxer_->write(waiting_->bytes, waiting_->plan.number - first_, waiting_->coding_order, waiting_->plan.starts_gop);
    waiting_.reset();
}

void HeatmapFilm::finish() {
    if (!waiting_) return;
    for (const std::uint8_t byte : encoder::sequence_end()) waiting_->bytes.push_back(byte);
    write();
    muxer_->finish();
    muxer_.reset();
    give_name(unfinished_, work_, output_, true);
}

void check_heatmaps(const RenderOptions& options, const Production& film) {
    for (const auto& [name, output] : options.heatmaps) {
        const HeatSubject subject = heat_subject_from(name);
        if (kind_of(output) != OutputKind::film)
            throw core::Error("heatmap " + name + ": " + output + " is no film; choose an ending such as .mpg");
        if (subject == HeatSubject::quantiser && film.kind != OutputKind::film)
            throw core::Error("heatmap quantiser: only films have one");
        if (subject == HeatSubject::tolerance && film.tolerance.reference)
            throw core::Error("heatmap tolerance: `--tolerance reference` has none");
        try {
            encoder::check(heatmap_settings(film));
        } catch (const core::Error& error) {
            throw core::Error("heatmap " + name + ": the film with a legend of " +
                              std::to_string(perceptual::legend_height) +
                              " lines below cannot be coded: " + error.what());
        }
        WorkFolder::check(output);
    }
}

HeatmapFilms::HeatmapFilms(const RenderOptions& options, const Production& film, const std::string& command) {
    for (const auto& [name, output] : options.heatmaps)
        films_.push_back(std::make_unique<HeatmapFilm>(heat_subject_from(name), output, film, command));
}

}  // namespace render2mpeg::app
