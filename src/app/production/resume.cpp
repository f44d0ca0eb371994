#include "app/production/resume.h"

#include <fmt/format.h>
#include <sys/xattr.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "app/estimate/first_pass.h"
#include "app/files/file_io.h"
#include "app/job/automatic_exposure.h"
#include "app/loop/kept_frames.h"
#include "app/system/interrupt.h"
#include "app/system/terminal.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

json options_of(const RenderOptions& options) {
    json words = options.said;
    for (const std::string& name : said_and(Idle::always, options.said)) words.erase(name);
    // Layers already written lie in this folder alone.
    if (options.layers) words["--aov"] = canonical_of(*options.layers).string();
    return words;
}

/// Files of a chunk's frames beside the coded stream.
std::vector<std::filesystem::path> products_of(const RenderJob& film, const RenderOptions& options,
                                               const WorkFolder& work, const Chunk& chunk) {
    std::vector<std::filesystem::path> files = images_of(film, options, {chunk.first, chunk.last});
    if (film.kind == OutputKind::y4m) files.push_back(frames_of(film, options, work, chunk));
    return files;
}

std::string range_of(const FrameRange& frames) {
    return fmt::format("{}:{}", frames.first, frames.last);
}

/// Checksums of files by their names. A missing image is shown as missing; a list of keyframes is no file.
json sums_by_name(const std::vector<std::filesystem::path>& files) {
    json sums = json::object();
    for (const std::filesystem::path& file : files) {
        if (!is_file(file)) continue;
        json& sum = sums[canonical_of(file).string()];
        if (sum.is_null()) sum = text_of(checksum_of(file));
    }
    return sums;
}

json sums_of(const std::vector<std::filesystem::path>& files) {
    json sums = json::array();
    for (const std::filesystem::path& file : files)
        sums.push_back(is_file(file) ? json(text_of(checksum_of(file))) : json());
    return sums;
}

/// Adds a chunk's record and returns true, if it is whole and its products are there.
bool take_in(const RenderJob& film, const RenderOptions& options, const WorkFolder& work, const ChunkFile& chunk,
             RunStatistics& statistics) {
    try {
        const json facts = chunk.facts();
        if (facts.at("products") != sums_of(products_of(film, options, work, chunk.chunk()))) return false;
        RunStatistics own;
        restore(own, facts.at("statistics"));
        const bool whole = static_cast<std::int64_t>(own.frames.size()) == chunk.chunk().frames();
        if (whole) statistics = sum_of(statistics, own);
        return whole;
    } catch (const std::exception&) {
        return false;  // a damaged record is none
    }
}

/// First frame that is not there; behind the last where all are. `work`: has lit frames of chunks without a file.
std::int64_t first_missing(const RenderJob& film, const std::vector<ChunkFile>& files,
                           const WorkFolder* work = nullptr) {
    const std::vector<Chunk> chunks = film.chunks();
    for (const Chunk& chunk : chunks) {
        const auto file = std::ranges::find(files, chunk.index, index_of);
        if (file != files.end() && is_whole(*file)) continue;
        if (file != files.end()) return chunk.first + file->lit();
        return chunk.first + (work == nullptr ? 0 : KeptFrames::left_beside(work->stream_of(chunk), chunk));
    }
    return chunks.back().last + 1;
}

constexpr const char* mark_name = "user.render2mpeg.film";

/// A whole film's first file, and the checksum of its identity and of all files' names, sizes and times; empty where
/// one is missing.
std::pair<std::filesystem::path, std::string> mark_of(const RenderJob& film, const RenderOptions& options,
                                                      const json& identity) {
    std::vector<std::filesystem::path> files = images_of(film, options, film.frames);
    if (is_one_file(film.kind)) files.insert(files.begin(), options.output);
    std::string text = json_text(identity);
    for (const SideFilmRequest& beside : options.side_films) {
        files.push_back(beside.file);
        text += beside.subject + "\n";
    }
    for (const auto& file : {options.stats, options.report})
        if (file) files.push_back(*file);
    for (const std::filesystem::path& file : files) {
        std::error_code error;
        const auto bytes = std::filesystem::file_size(file, error);
        const auto written = std::filesystem::last_write_time(file, error).time_since_epoch().count();
        if (error) return {};
        text += fmt::format("{}\n{}\n{}\n", canonical_of(file).string(), bytes, static_cast<std::int64_t>(written));
    }
    Checksum sum;
    sum.add(text);
    return {files[0], text_of(sum.value())};
}

/// All that decides the light on a film's surfaces, whatever its coding. Other frames and sizes find little of it; a
/// second eye finds it all.
json light_identity_of(const RenderJob& film, const RenderOptions& options) {
    const renderer::Settings& s = film.rendering;
    json words = json::object();
    for (const char* name : {"--animation", "--camera", "--projection", "--variant", "--sky", "--fog"})
        if (options.is_given(name)) words[name] = options.said.at(name);
    return {{"render2mpeg", program_text()},
            {"instruction set", core::name_of(s.isa)},
            {"inputs", sums_by_name(scene_files_of(film, options))},
            {"options", words},
            {"--light", options.light},
            {"--caustics", options.caustics},
            {"--limits", options.limits},
            {"--clamp", options.clamp},
            {"light points", s.direct_points},
            {"depth of mirrors", s.specular_depth},
            {"largest cut", s.max_cut},
            {"seed", s.seed},
            {"draw", s.draw}};
}

json json_of(const encoder::BitAllocation& a) {
    return {{"quantiser", a.quantiser},      {"bits", a.bits},
            {"bits_left", a.bits_left},      {"type", a.type ? json(static_cast<int>(*a.type)) : json(nullptr)},
            {"affordable", a.affordable},    {"ratio", or_null(a.ratio)},
            {"left_by_type", a.left_by_type}};
}

encoder::BitAllocation allocation_from(const json& written) {
    encoder::BitAllocation a;
    written.at("quantiser").get_to(a.quantiser);
    written.at("bits").get_to(a.bits);
    written.at("bits_left").get_to(a.bits_left);
    if (!written.at("type").is_null()) a.type = static_cast<encoder::PictureType>(written["type"].get<int>());
    written.at("affordable").get_to(a.affordable);
    if (!written.at("ratio").is_null()) a.ratio = written["ratio"].get<double>();
    written.at("left_by_type").get_to(a.left_by_type);
    return a;
}

/// Allocations of an earlier run; none where there are none.
std::vector<encoder::BitAllocation> allocations_from(const RenderJob& film, const json& written) {
    if (!written.is_array() || static_cast<std::int64_t>(written.size()) != film.frame_count()) return {};
    std::vector<encoder::BitAllocation> allocations;
    try {
        for (const json& one : written) allocations.push_back(allocation_from(one));
    } catch (const json::exception&) {
        return {};  // damaged: they are found again
    }
    return allocations;
}

}  // namespace

std::vector<std::filesystem::path> scene_files_of(const RenderJob& film, const RenderOptions& options) {
    std::vector<std::filesystem::path> files{options.input};
    for (const std::filesystem::path& file : film.animation->files) files.push_back(file);
    for (const scene::ImageSource& image : film.animation->images) files.push_back(image.path);
    for (const scene::Volume& volume : film.animation->volumes)
        for (const auto& own : {volume.files, volume.more_files}) files.insert(files.end(), own.begin(), own.end());
    return files;
}

std::vector<std::filesystem::path> images_of(const RenderJob& film, const RenderOptions& options,
                                             const FrameRange& frames) {
    std::vector<std::filesystem::path> files;
    for (std::int64_t n = frames.first; n <= frames.last; ++n) {
        if (film.kind == OutputKind::exr || film.kind == OutputKind::png) files.push_back(numbered(options.output, n));
        if (!options.layers) continue;
        files.push_back(numbered(layers_in(*options.layers), n));
        files.push_back(numbered(motion_in(*options.layers), n));
    }
    return files;
}

std::vector<Files> inputs_of(const RenderJob& film, const RenderOptions& options) {
    const std::vector<std::filesystem::path> scene = scene_files_of(film, options);
    std::vector<Files> inputs(scene.begin(), scene.end());
    inputs.emplace_back(options.coding.keyframes.value_or(""));
    inputs.emplace_back(film.sound.file);
    return inputs;
}

json identity_of(const RenderJob& film, const RenderOptions& options) {
    json inputs = sums_by_name(scene_files_of(film, options));
    inputs.update(sums_by_name({options.coding.keyframes.value_or(""), film.sound.file}));
    return {{"render2mpeg", program_text()},
            {"instruction set", core::name_of(film.rendering.isa)},
            {"frame range", range_of(film.frames)},
            {"options", options_of(options)},
            {"inputs", inputs}};
}

std::string why_no_light_file(const RenderJob& film) {
    if (scene::traits_of(*film.animation).changes_light()) return "light changes in this film";
    if (film.preview) return "a draft keeps no light";
    if (film.rendering.indirect != renderer::Indirect::rays || film.rendering.vpls == 0)
        return "rays gather no light (--indirect, --vpls)";
    return film.cache.keeps() ? "" : "no light is kept: " + film.cache.reason;
}

std::optional<LightFile> light_file_of(const RenderJob& film, const RenderOptions& options) {
    if (!options.light_cache || !why_no_light_file(film).empty()) return std::nullopt;
    return LightFile(*options.light_cache, light_identity_of(film, options));
}

json identity_of(const Film& film, const std::string& command) {
    std::error_code error;
    return {{"render2mpeg", program_text()},
            {"command", command},
            {"folder", std::filesystem::current_path(error).string()},
            {"input", film.source},
            {"frame range", range_of(film.frames)}};
}

std::filesystem::path frames_of(const RenderJob& film, const RenderOptions& options, const WorkFolder& work,
                                const Chunk& chunk) {
    return film.kind == OutputKind::y4m ? work.place(fmt::format("chunk_{:05}.y4m", chunk.index)) : options.output;
}

void mark_as_whole(const RenderJob& film, const RenderOptions& options, const json& identity) {
    const auto [file, mark] = mark_of(film, options, identity);
    const int failure = mark.empty() ? 0 : setxattr(file.c_str(), mark_name, mark.data(), mark.size(), 0);
    static_cast<void>(failure);  // then nobody will know it
}

bool is_done_already(const RenderJob& film, const RenderOptions& options, const json& identity) {
    // A run that was killed at its end goes on, and cleans up.
    if (!options.resume || WorkFolder::is_of(options.output, identity)) return false;
    const auto [file, mark] = mark_of(film, options, identity);
    std::string found(mark.size(), '\0');
    if (mark.empty() || getxattr(file.c_str(), mark_name, found.data(), found.size()) < 0 || found != mark)
        return false;
    if (!options.quiet) print_line(options.output.string() + " is whole already: nothing is left to be done");
    return true;
}

json chunk_record_of(const RenderJob& film, const RenderOptions& options, const WorkFolder& work, const Chunk& chunk,
                     const RunStatistics& statistics) {
    const std::vector<std::filesystem::path> products = products_of(film, options, work, chunk);
    for (const std::filesystem::path& file : products) bring_to_disk(file);
    return {{"statistics", json_of(statistics)}, {"products", sums_of(products)}};
}

std::vector<ChunkFile> take_up(const RenderJob& film, const RenderOptions& options, WorkFolder& work,
                               const std::function<void(const std::vector<ChunkFile>&)>& kept,
                               RunStatistics& statistics) {
    if (!options.resume) return {};
    std::vector<ChunkFile> left = work.finished(film.chunks()), chunks;
    RunStatistics earlier;
    for (ChunkFile& chunk : left)
        if (take_in(film, options, work, chunk, earlier)) chunks.push_back(std::move(chunk));
    earlier.earlier_seconds = earlier.seconds;
    // This run has read the scene so far.
    for (std::size_t i = 0; i < statistics.seconds.size(); ++i) earlier.seconds[i] += statistics.seconds[i];
    statistics = std::move(earlier);
    kept(chunks);
    std::vector<Chunk> missing = film.chunks();
    std::erase_if(missing,
                  [&](const Chunk& chunk) { return std::ranges::find(chunks, chunk.index, index_of) != chunks.end(); });
    work.drop_all_but(chunks, missing);
    std::int64_t lit = 0;
    for (const Chunk& chunk : missing) lit += KeptFrames::left_beside(work.stream_of(chunk), chunk);
    if (!options.quiet) {
        const std::string name = options.output.string();
        const std::string text =
            chunks.empty() && lit == 0
                ? fmt::format("--resume: no frame was left of {}, which begins anew", name)
                : fmt::format("resuming {} with frame {}: {} of {} are there", name, first_missing(film, chunks, &work),
                              static_cast<std::int64_t>(statistics.frames.size()) + lit, film.frame_count());
        print_line(text);
    }
    return chunks;
}

void settle(RenderJob& film, const RenderOptions& options, WorkFolder* work, RunStatistics& statistics) {
    const auto kept = [&](const char* name) { return work == nullptr ? json() : work->kept(name); };
    const auto keep = [&](const char* name, const json& value) {
        if (work != nullptr) work->keep(name, value);
    };
    if (const json exposure = kept("exposure"); !film.exposure && exposure.is_number())
        film.exposure = exposure.get<float>();
    if (!film.exposure) {
        film.exposure = timed(statistics, Stage::exposure, [&] { return measure_exposure(film); });
        keep("exposure", *film.exposure);
    }
    if (const auto light = light_file_of(film, options)) {
        // Others may add to the file while this film is made.
        const json before = kept("light");
        film.known_light = before.is_array() ? LightExtent{before.at(0), before.at(1)} : light->extent();
        keep("light", {film.known_light.bytes, film.known_light.checksum});
    }
    if (!film.two_passes || InterruptGuard::requested()) return;
    film.allocations = allocations_from(film, kept("allocations"));
    if (!film.allocations.empty()) return;
    film.allocations = timed(statistics, Stage::first_pass, [&] { return first_pass(film, options.quiet); });
    json written = json::array();
    for (const encoder::BitAllocation& a : film.allocations) written.push_back(json_of(a));
    if (!film.allocations.empty()) keep("allocations", written);
}

bool is_of_use(const std::vector<ChunkFile>& files) {
    return std::ranges::any_of(files, [](const ChunkFile& file) { return is_whole(file) || file.lit() > 0; });
}

std::string resuming_text(const RenderJob& film, const std::vector<ChunkFile>& files, const std::string& command) {
    const std::vector<Chunk> chunks = film.chunks();
    if (!is_of_use(files)) return "no frame is kept yet, so that --resume would begin anew";
    const std::int64_t next = first_missing(film, files);
    if (next > chunks.back().last) return "with --resume only what comes after the last frame is done again";
    std::int64_t behind = 0;
    for (const ChunkFile& file : files)
        if (file.chunk().first > next && is_whole(file)) behind += file.chunk().frames();
    return fmt::format("{} with --resume goes on with frame {}{}", command, next,
                       behind > 0 ? fmt::format("; {} behind it are there, too", behind) : "");
}

}  // namespace render2mpeg::app
