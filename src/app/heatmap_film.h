#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/attempts.h"
#include "app/pipeline.h"
#include "app/production.h"
#include "app/work_folder.h"
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

/// What its colours mean.
perceptual::HeatScale scale_of(HeatSubject subject);

/// Refuses what --heatmap asks for where it has nothing to show, or its film cannot be coded. Writes nothing. Throws
/// core::Error that names the heatmap or its file.
void check_heatmaps(const RenderOptions& options, const Production& film);

/// A false-colour film of a render with a legend below, as long as the render and in square pixels. It has its name
/// once it is whole; until then it lies in a work folder of its own.
class HeatmapFilm : public Watcher {
  public:
    HeatmapFilm(HeatSubject subject, const std::filesystem::path& output, const Production& film,
                const std::string& command);
    ~HeatmapFilm() override;

    void lit(const LitFrame& frame) override;
    void coded(const encoder::CodedPicture& coded) override;
    /// After the film's last picture; without it no file is left.
    void finish();

  private:
    /// Coded pictures come in another order.
    void show(std::int64_t number, core::Plane<float> values);
    /// Writes the picture that waited to learn whether it is the last.
    void write();

    HeatSubject subject_;
    std::filesystem::path output_;
    WorkFolder work_;
    std::filesystem::path unfinished_;
    encoder::Settings settings_;
    perceptual::ColorMatrix matrix_;
    perceptual::HeatScale scale_;
    std::int64_t first_, next_;
    std::map<std::int64_t, core::Plane<float>> early_;
    std::unique_ptr<encoder::Encoder> encoder_;
    std::unique_ptr<av::Muxer> muxer_;
    std::optional<encoder::CodedPicture> waiting_;
};

/// All that --heatmap asks for. One that fails ends; the render and the others go on.
class HeatmapFilms : public Watcher {
  public:
    /// Creates every file. Throws core::Error where one cannot be written; check_heatmaps() comes before.
    HeatmapFilms(const RenderOptions& options, const Production& film, const std::string& command);

    bool empty() const { return films_.empty(); }
    void lit(const LitFrame& frame) override {
        each([&](HeatmapFilm& film) { film.lit(frame); });
    }
    void coded(const encoder::CodedPicture& coded) override {
        each([&](HeatmapFilm& film) { film.coded(coded); });
    }
    /// After the film's last picture. Throws what went wrong first, be it while the film was made.
    void finish() {
        each([](HeatmapFilm& film) { film.finish(); });
        failures_.rethrow();
    }

  private:
    template <class Step>
    void each(Step&& step) {
        for (std::unique_ptr<HeatmapFilm>& film : films_) {
            bool done = film == nullptr;
            if (!done)
                failures_.attempt([&] {
                    step(*film);
                    done = true;
                });
            if (!done) film.reset();
        }
    }

    std::vector<std::unique_ptr<HeatmapFilm>> films_;
    Attempts failures_;
};

}  // namespace render2mpeg::app
