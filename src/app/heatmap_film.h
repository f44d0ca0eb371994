#pragma once

#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "app/pipeline.h"
#include "app/production.h"
#include "core/plane.h"
#include "encoder/av/av.h"
#include "perceptual/heatmap.h"

namespace render2mpeg::app {

/// What a false-colour film can show of a render.
enum class HeatSubject {
    tolerance,  ///< a pixel's tolerance over its luminance
    cut,        ///< clusters gathered
    error,      ///< by what the gathered light may be off over the pixel's luminance, as the stopping rule reckons
    quantiser,  ///< of macroblocks
};

/// The subject of that name. Throws core::Error with the list of names.
HeatSubject heat_subject_from(const std::string& name);

/// Refuses what --heatmap asks for where it has nothing to show, or its film cannot be coded. Writes nothing. Throws
/// core::Error that names the heatmap.
void check_heatmaps(const RenderOptions& options, const Production& film);

/// A false-colour film of a render with a legend below, as long as the render and in square pixels. It has its name
/// once it is whole.
class HeatmapFilm : public Watcher {
  public:
    HeatmapFilm(HeatSubject subject, std::filesystem::path output, const Production& film);
    ~HeatmapFilm() override;

    void lit(const LitFrame& frame) override;
    void coded(const encoder::CodedPicture& coded) override;
    /// After the film's last picture; without it no file is left.
    void finish();

    const std::filesystem::path& output() const { return output_; }

  private:
    /// Coded pictures come in another order.
    void show(std::int64_t number, core::Plane<float> values);
    /// Writes the picture that waited to learn whether it is the last.
    void write();

    HeatSubject subject_;
    std::filesystem::path output_, unfinished_;
    encoder::Settings settings_;
    perceptual::ColorMatrix matrix_;
    perceptual::HeatScale scale_;
    std::int64_t first_, next_;
    std::map<std::int64_t, core::Plane<float>> early_;
    std::unique_ptr<encoder::Encoder> encoder_;
    std::unique_ptr<av::Muxer> muxer_;
    std::optional<encoder::CodedPicture> waiting_;
};

/// All that --heatmap asks for.
class HeatmapFilms : public Watcher {
  public:
    /// Creates every file. Throws core::Error where one cannot be written; check_heatmaps() comes before.
    HeatmapFilms(const RenderOptions& options, const Production& film);

    bool empty() const { return films_.empty(); }
    void lit(const LitFrame& frame) override {
        for (HeatmapFilm& film : films_) film.lit(frame);
    }
    void coded(const encoder::CodedPicture& coded) override {
        for (HeatmapFilm& film : films_) film.coded(coded);
    }
    void finish() {
        for (HeatmapFilm& film : films_) film.finish();
    }

  private:
    std::list<HeatmapFilm> films_;
};

}  // namespace render2mpeg::app
