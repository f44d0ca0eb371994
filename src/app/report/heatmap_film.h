#pragma once
// Writes the false-colour films of `--heatmap`.
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "app/files/work_folder.h"
#include "app/loop/observer.h"
#include "app/loop/render_job.h"
#include "app/system/error_collector.h"
#include "core/plane.h"
#include "encoder/coder.h"
#include "perceptual/heatmap.h"

namespace render2mpeg::app {

/// Quantity of a render shown by a false-colour film.
enum class HeatSubject {
    tolerance,  ///< a pixel's tolerance over its luminance
    cut,        ///< clusters gathered
    error,      ///< standard error of the gathered light over the pixel's luminance
    quantiser,  ///< of macroblocks
    records,    ///< that lie in a pixel
    age,        ///< frames since a pixel's light was gathered
    reuse,      ///< share of a pixel's points whose light was not gathered for them
};

/// Meaning of the subject's colours.
perceptual::HeatScale scale_of(HeatSubject subject);

/// Refuses a --heatmap that has nothing to show, or a film that cannot be coded. Writes nothing. Throws core::Error
/// naming the heatmap or its file.
void check_heatmaps(const RenderOptions& options, const RenderJob& film);

/// A false-colour film of a render with a legend below, as long as the render and in square pixels. It has its name
/// once it is whole; until then it lies in the film's work folder.
class HeatmapFilm : public LoopObserver {
  public:
    HeatmapFilm(HeatSubject subject, const std::filesystem::path& output, const RenderJob& film, WorkFolder& work);
    ~HeatmapFilm() override;

    /// Goes on where an earlier run left these chunks of the film. Throws core::Error where it left fewer of this one.
    void take_up(const std::vector<ChunkFile>& chunks);
    /// Takes over the chunks of a part, which stay where they are.
    void append(HeatmapFilm& part);
    void begins(const Chunk& chunk) override;
    void ends(const Chunk& chunk) override;

    void lit(const LitFrame& frame) override;
    void coded(const encoder::CodedPicture& coded) override;
    /// After the film's last picture: gives it its name. What it was made of stays.
    void finish();
    /// Leaves nothing of it.
    void discard();

  private:
    /// Coded pictures come in another order.
    void show(std::int64_t number, core::Plane<float> values);

    HeatSubject subject_;
    std::filesystem::path output_;
    WorkFolder& work_;
    std::string name_;  ///< of its streams in the work folder
    Film film_;         ///< the heatmap's, not the one that it shows
    std::vector<ChunkFile> chunks_;
    encoder::Codec codec_;  ///< of the film itself
    perceptual::ColorMatrix matrix_;
    perceptual::HeatScale scale_;
    std::int64_t next_ = 0;
    std::map<std::int64_t, core::Plane<float>> early_;
    std::unique_ptr<encoder::Coder> encoder_;  ///< of a chunk
};

/// All that --heatmap asks for. One that fails ends; the render and the others go on.
class HeatmapFilms : public LoopObserver {
  public:
    /// Creates every file. Throws core::Error where one cannot be written; check_heatmaps() comes before.
    HeatmapFilms(const RenderOptions& options, const RenderJob& film, WorkFolder& work);

    bool empty() const { return films_.empty(); }
    void take_up(const std::vector<ChunkFile>& chunks) {
        for (const std::unique_ptr<HeatmapFilm>& film : films_) film->take_up(chunks);
    }
    void append(HeatmapFilms& part) {
        for (std::size_t i = 0; i < films_.size(); ++i) films_[i]->append(*part.films_[i]);
    }
    void begins(const Chunk& chunk) override { each(&HeatmapFilm::begins, chunk); }
    void ends(const Chunk& chunk) override { each(&HeatmapFilm::ends, chunk); }
    void lit(const LitFrame& frame) override { each(&HeatmapFilm::lit, frame); }
    void coded(const encoder::CodedPicture& coded) override { each(&HeatmapFilm::coded, coded); }
    /// Gives the films their names, after the film's last picture. Returns whether all succeeded; the rest may be named
    /// later, by --resume.
    bool finish() {
        std::size_t named = 0, made = 0;
        for (const std::unique_ptr<HeatmapFilm>& film : films_) {
            if (film == nullptr) continue;
            ++made;
            if (failures_.attempt([&] { film->finish(); })) ++named;
        }
        return named == made;
    }
    /// Whether one failed; only a film that begins anew makes it.
    bool has_lost() const { return lost_; }
    /// Throws the first failure, also one from the making of the film.
    void rethrow() const { failures_.rethrow(); }

  private:
    template <class Step, class... Arguments>
    void each(Step step, const Arguments&... arguments) {
        for (std::unique_ptr<HeatmapFilm>& film : films_) {
            if (film == nullptr) continue;
            if (failures_.attempt([&] { std::invoke(step, *film, arguments...); })) continue;
            lost_ = true;
            film->discard();
            film.reset();
        }
    }

    std::vector<std::unique_ptr<HeatmapFilm>> films_;
    bool lost_ = false;
    ErrorCollector failures_;
};

}  // namespace render2mpeg::app
