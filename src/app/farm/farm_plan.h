#pragma once
// A film's plan for many machines: the common decisions, and the frames of each part.
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/job/render_job.h"
#include "app/options/film.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// Of a plan's file in its folder.
inline constexpr const char* plan_name = "plan.json";

/// A part of a film: chunks that one machine makes, one after the other.
struct FilmPart {
    int number = 0;  ///< from 1, which by forecast takes longest
    ChunkRange chunks;
    FrameRange frames;
};

/// Contents and location of `plan.json`.
struct FarmPlan {
    std::filesystem::path folder;    ///< absolute
    std::vector<std::string> words;  ///< of the `render` that makes the same film
    std::filesystem::path start;     ///< absolute: where names in `words` begin
    bool packed = false;             ///< all inputs lie in `folder`
    std::string scheduler;
    std::string output_name;      ///< the film's, without its folder
    std::vector<FilmPart> parts;  ///< in the order of the film
    std::vector<double> shares;   ///< of each chunk in the film's CPU time by forecast (chunk_shares.h)
    /// `identity` as in resume.h, names of inputs in `folder` without it; `settled` what settle() finds out;
    /// `cost` seconds that the plan took.
    std::shared_ptr<nlohmann::json> facts;

    std::int64_t most_frames() const;             ///< of a part
    double share_of(const FilmPart& part) const;  ///< in the CPU time by forecast
    std::vector<FilmPart> longest_first() const;  ///< by their numbers
    std::filesystem::path inputs() const { return folder / "inputs"; }
    /// Says that the film is joined, and its parts gone.
    std::filesystem::path joined_mark() const { return folder / "joined"; }
    bool is_joined() const;
    /// Whether all chunks of a part have their records. They are proved when the film is joined.
    bool is_made(const FilmPart& part) const;
    /// Where everything of a part lies, e.g. film.mpg.farm/part_00003.
    std::filesystem::path folder_of(const FilmPart& part) const;
};

/// The folder of a film's farm: film.mpg.farm.
std::filesystem::path farm_folder_of(const std::filesystem::path& output);

/// Cuts a film into parts that take about as long as each other by the `shares` of their chunks: `parts` of them, fewer
/// where there are not so many chunks, or of `frames_per_part` frames on average; of one chunk where neither is given.
std::vector<FilmPart> parts_of(const std::vector<Chunk>& chunks, const std::vector<double>& shares,
                               std::optional<int> parts, std::optional<std::int64_t> frames_per_part);

/// Reads the plan in a folder, or the file of that name. Throws core::Error where there is none that can be read.
FarmPlan read_plan(const std::filesystem::path& place);
bool has_plan(const std::filesystem::path& folder);
/// Writes it whole or not at all. Throws core::Error.
void write_plan(const FarmPlan& plan);

/// Options parsed from the plan's words in their original folder: changes the process's current folder. The instruction
/// set is the plan's. Throws core::Error.
RenderOptions options_of(const FarmPlan& plan);

/// The options of one part: its outputs lie in its own folder. It goes on where it was ended.
RenderOptions part_options(const FarmPlan& plan, const FilmPart& part, const RenderOptions& film);

/// A film's identity as plans keep it.
nlohmann::json farm_identity(const FarmPlan& plan, const RenderJob& film, RenderOptions options);

/// Throws Refusal where this program is of another version or build than the plan's, or this processor lacks its
/// instruction set; names which.
void refuse_other_machine(const FarmPlan& plan);
/// Throws Refusal, naming the difference, where the film is not the plan's.
void refuse_other_film(const FarmPlan& plan, const RenderJob& film, const RenderOptions& options);

/// Numbers as schedulers read them: "1,3-5".
std::string part_list(std::vector<int> numbers);

}  // namespace render2mpeg::app
