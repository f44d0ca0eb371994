#pragma once
// Films that a render writes beside its own, of the same light.
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/files/work_folder.h"
#include "app/job/render_job.h"
#include "app/loop/observer.h"
#include "app/system/error_collector.h"

namespace render2mpeg::app {

/// A film as long as the render, made of what the render tells in passing. It has its name once it is whole; until then
/// it lies in the work folder of the render's own film.
class SideFilm : public LoopObserver {
  public:
    /// `what`: a word for file names; `coding`: the side film's.
    SideFilm(const std::string& what, const std::filesystem::path& output, const RenderJob& film,
             const encoder::Settings& coding, WorkFolder& work);

    /// Goes on where an earlier run left these chunks of the film. Throws core::Error where it left fewer of this one.
    void take_up(const std::vector<ChunkFile>& chunks);
    /// Takes over the chunks of a part, which stay where they are.
    void append(SideFilm& part);
    void begins(const Chunk& chunk) override;
    void ends(const Chunk& chunk) override;
    /// After the film's last picture: gives it its name. What it was made of stays.
    void finish();
    /// Leaves nothing of it.
    void discard();

  protected:
    const Film& film() const { return film_; }
    const Chunk& chunk() const { return chunks_.back().chunk(); }
    void append(const std::vector<encoder::CodedPicture>& pictures);
    void be_silent() { film_.sound = {}; }

  private:
    virtual void open(const Chunk& chunk) = 0;
    /// The chunk's last pictures, and how bright all of it is.
    virtual std::vector<encoder::CodedPicture> close(core::LightLevel& light) = 0;

    std::filesystem::path output_;
    WorkFolder& work_;
    std::string name_;  ///< of its streams in the work folder
    Film film_;         ///< the side film's
    std::vector<ChunkFile> chunks_;
};

/// Refuses a side film that has nothing to show, or that cannot be coded. Writes nothing. Throws core::Error naming the
/// option or the file.
void check_side_films(const RenderOptions& options, const RenderJob& film);

/// All side films that options ask for. One that fails ends; the render and the others go on.
class SideFilms : public LoopObserver {
  public:
    /// Creates every file. Throws core::Error where one cannot be written; check_side_films() comes before.
    SideFilms(const RenderOptions& options, const RenderJob& film, WorkFolder& work);

    bool empty() const { return films_.empty(); }
    void take_up(const std::vector<ChunkFile>& chunks) {
        for (const std::unique_ptr<SideFilm>& film : films_) film->take_up(chunks);
    }
    void append(SideFilms& part) {
        for (std::size_t i = 0; i < films_.size(); ++i) films_[i]->append(*part.films_[i]);
    }
    void begins(const Chunk& chunk) override { each(&LoopObserver::begins, chunk); }
    void ends(const Chunk& chunk) override { each(&LoopObserver::ends, chunk); }
    void lit(const LitFrame& frame) override { each(&LoopObserver::lit, frame); }
    void coded(const encoder::CodedPicture& coded) override { each(&LoopObserver::coded, coded); }
    /// Gives the films their names, after the film's last picture. Returns whether all succeeded; the rest may be named
    /// later, by --resume.
    bool finish() {
        std::size_t named = 0, made = 0;
        for (const std::unique_ptr<SideFilm>& film : films_) {
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
        for (std::unique_ptr<SideFilm>& film : films_) {
            if (film == nullptr) continue;
            if (failures_.attempt([&] { std::invoke(step, *film, arguments...); })) continue;
            lost_ = true;
            film->discard();
            film.reset();
        }
    }

    std::vector<std::unique_ptr<SideFilm>> films_;
    bool lost_ = false;
    ErrorCollector failures_;
};

}  // namespace render2mpeg::app
