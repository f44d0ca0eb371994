#include "app/report/side_film.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/files/publish.h"
#include "app/options/output_kind.h"
#include "app/options/usage_error.h"
#include "app/report/heatmap_film.h"
#include "app/report/view_film.h"
#include "core/checksum.h"
#include "core/error.h"

namespace render2mpeg::app {
namespace {

/// Of chunks: another for each output, by its place beside the film's work folder, which may lie elsewhere on another
/// machine.
std::string name_of(const std::string& what, const std::filesystem::path& output, const WorkFolder& work) {
    const auto normal = [](const std::filesystem::path& p) { return std::filesystem::absolute(p).lexically_normal(); };
    core::Checksum sum;
    sum.add(normal(output).lexically_relative(normal(work.place("x")).parent_path()).string());
    return fmt::format("{}-{}", what, core::checksum_text(sum.value()));
}

/// Of a chunk's record.
constexpr const char *brightest_key = "max_cll", *mean_key = "max_fall";

}  // namespace

SideFilm::SideFilm(const std::string& what, const std::filesystem::path& output, const RenderJob& film,
                   const encoder::Settings& coding, WorkFolder& work)
    : output_(output), work_(work), name_(name_of(what, output, work)), film_(film.film()) {
    film_.coding = coding;
    film_.disc = false;
    work_.hold(output);
}

void SideFilm::take_up(const std::vector<ChunkFile>& chunks) {
    std::vector<Chunk> wanted;
    for (const ChunkFile& chunk : chunks) wanted.push_back(chunk.chunk());
    chunks_ = work_.finished(wanted, name_);
    if (chunks_.size() < wanted.size())
        throw core::Error("resuming", output_.string(),
                          "there is no such film of the frames that are there; leave it out, or begin the film anew "
                          "without --resume");
}

void SideFilm::append(SideFilm& part) {
    for (ChunkFile& chunk : part.chunks_) chunks_.push_back(std::move(chunk));
    part.chunks_.clear();
}

void SideFilm::append(const std::vector<encoder::CodedPicture>& pictures) {
    for (const encoder::CodedPicture& coded : pictures) chunks_.back().append(coded);
}

void SideFilm::begins(const Chunk& chunk) {
    chunks_.push_back(work_.open(chunk, name_));
    open(chunk);
}

void SideFilm::ends(const Chunk&) {
    core::LightLevel light;
    append(close(light));
    chunks_.back().finish({{brightest_key, light.most}, {mean_key, light.mean}});
}

void SideFilm::finish() {
    std::ranges::sort(chunks_, {}, index_of);
    Film whole = film_;
    for (const ChunkFile& chunk : chunks_) {
        const nlohmann::json facts = chunk.facts();
        whole.coding.light += {facts.value(brightest_key, 0.0f), facts.value(mean_key, 0.0f)};
    }
    const std::filesystem::path file = work_.begin(name_);
    assemble(chunks_, whole, file, output_);
    give_name(file, output_);
}

void SideFilm::discard() {
    std::error_code ignored;
    for (const ChunkFile& chunk : chunks_)
        for (const auto& file : {chunk.file(), ChunkFile::record_of(chunk.file())})
            std::filesystem::remove(file, ignored);
}

void check_side_films(const RenderOptions& options, const RenderJob& film) {
    for (const auto& [subject, file, view] : options.side_films) {
        const std::optional<HeatSubject> heat = heat_subject_of(subject);
        if (!heat && !view)
            throw UsageError("--heatmap " + subject +
                             ": expected tolerance, cut, error, quantiser, records, age or reuse");
        if (kind_of(file) != OutputKind::film)
            throw core::Error(fmt::format("{} {}: {} is no film; choose an ending such as {}",
                                          view ? "also" : "heatmap", subject, file.string(), view ? ".mp4" : ".mpg"));
        if (view)
            check_view_film({subject, file, view}, film);
        else
            check_heatmap(*heat, file, film);
        WorkFolder::check(file);
    }
}

SideFilms::SideFilms(const RenderOptions& options, const RenderJob& film, WorkFolder& work) {
    for (const SideFilmRequest& beside : options.side_films) {
        if (beside.view)
            films_.push_back(std::make_unique<ViewFilm>(beside, film, work));
        else
            films_.push_back(
                std::make_unique<HeatmapFilm>(heat_subject_of(beside.subject).value(), beside.file, film, work));
    }
}

}  // namespace render2mpeg::app
