#include "scene/volumes/volume_reader.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <sstream>
#include <system_error>

#include "core/error.h"
#include "core/module.h"
#include "scene/module/vdb.h"
#include "scene/volumes/stored_grids.h"

namespace render2mpeg::scene {
namespace {

/// By the files' sizes: OpenVDB's nodes take at most 33 bytes for each of their masks' bytes, which are never packed.
/// Even parts are let in as they are found, and 2 GiB of packed voxels take some 20 s.
ProbeLimits limits_of(std::span<const std::filesystem::path> files) {
    std::uintmax_t bytes = 0;
    for (const std::filesystem::path& file : files) {
        std::error_code failure;
        const std::uintmax_t size = std::filesystem::file_size(file, failure);
        bytes += failure ? 0 : size;
    }
    return {limits_for(bytes).memory, 120, 1200};
}

const VdbReader& reader() {
    static const VdbReader& reader = *core::module_function<const VdbReader*()>("vdb", "render2mpeg_vdb_reader")();
    return reader;
}

/// A number as it is.
std::string exact(double value) {
    char text[40];
    std::snprintf(text, sizeof(text), "%a", value);
    return text;
}

/// What a probe needs to know of a volume.
std::vector<std::string> words_of(const char* kind, const Volume& volume) {
    return {kind, volume.density_grid, volume.reads_temperature() ? volume.temperature_grid : "", volume.color_grid,
            volume.more_files.empty() ? "1" : "2"};
}

constexpr std::size_t facts = 4;  ///< before the files

Volume volume_of(const std::vector<std::string>& words) {
    Volume volume;
    volume.density_grid = words.at(0);
    volume.temperature_grid = words.at(1);
    volume.blackbody_intensity = 1;
    volume.color_grid = words.at(2);
    return volume;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

void add(std::vector<std::string>& words, const std::vector<std::filesystem::path>& files) {
    for (const std::filesystem::path& file : files) words.push_back(file.string());
}

VolumeGrids read_in_other_process(const Volume& volume, const std::vector<std::filesystem::path>& files,
                                  std::vector<std::string>& notes) {
    const std::string file = files.front().string();
    std::vector<std::string> words = words_of("volume", volume);
    add(words, files);
    const ProbeLimits limits = limits_of(files);
    Probe probe(limits, words);
    const std::string said = text_of(probe.end(), file, limits);
    const int stored = probe.take_input();
    struct Closed {
        ~Closed() { close(file); }
        int file;
    } const closed{stored};
    notes = lines_of(said);
    return stored_grids(stored, file);
}

VolumeOutline outline_from(const std::string& text) {
    VolumeOutline outline;
    const char* at = text.c_str();
    for (glm::dvec3* p : {&outline.box.low, &outline.box.high})
        for (int k = 0; k < 3; ++k) {
            char* end = nullptr;
            (*p)[k] = std::strtod(at, &end);
            at = end;
        }
    outline.bytes = std::strtoull(at, nullptr, 10);
    return outline;
}

}  // namespace

std::shared_ptr<const VolumeGrids> read_volume(const Volume& volume, std::size_t file,
                                               std::vector<std::string>& notes) {
    if (volume.grids) return volume.grids;
    EXPECTS(file < volume.files.size());
    const std::vector<std::filesystem::path> files = volume.files_of(file);
    std::vector<std::string> own;
    auto grids =
        std::make_shared<VolumeGrids>(Probe::is_possible() ? read_in_other_process(volume, files, own)
                                                           : reader().read(files, volume, own, [](std::uintmax_t) {}));
    for (const std::string& note : own) notes.push_back(files.front().string() + ": " + note);
    return grids;
}

VolumeOutline outline_of(const Volume& volume) {
    if (volume.grids) return outline_of(*volume.grids);
    // chosen: 16 of a long sequence, whose first files may be smaller than its later ones.
    const std::size_t count = std::min<std::size_t>(volume.files.size(), 16);
    VolumeOutline outline;
    std::vector<std::string> words = words_of("outlines", volume);
    std::vector<std::filesystem::path> all;
    for (std::size_t i = 0; i < count; ++i) {
        const std::vector<std::filesystem::path> files =
            volume.files_of(count == 1 ? 0 : i * (volume.files.size() - 1) / (count - 1));
        add(words, files);
        all.insert(all.end(), files.begin(), files.end());
        if (!Probe::is_possible()) outline.hold(reader().outline(files, volume));
    }
    if (!Probe::is_possible()) return outline;
    for (const std::string& line : lines_of(read_in_probe(words, volume.files.front().string(), limits_of(all))))
        outline.hold(outline_from(line));
    return outline;
}

VolumeReader::VolumeReader(const Animation& animation) : animation_(animation) {
    for (std::size_t i = 0; i < animation.volumes.size(); ++i) held_.push_back(std::make_unique<Held>());
}

std::shared_ptr<const VolumeGrids> VolumeReader::grids(std::size_t volume, std::size_t file) {
    EXPECTS(volume < held_.size());
    if (animation_.volumes[volume].grids) return animation_.volumes[volume].grids;
    const std::filesystem::path& path = animation_.volumes[volume].files.at(file);
    Held& held = *held_[volume];
    const std::lock_guard lock(held.reading);
    const auto known =
        std::find_if(held.files.begin(), held.files.end(), [&](const auto& f) { return f.first == path; });
    if (known != held.files.end()) {
        held.files.splice(held.files.begin(), held.files, known);
        return held.files.front().second;
    }
    // What was not asked for last goes before more comes.
    if (held.files.size() > 1) held.files.pop_back();
    std::vector<std::string> notes;
    held.files.emplace_front(path, read_volume(animation_.volumes[volume], file, notes));
    const std::lock_guard noting(notes_mutex_);
    notes_.insert(notes.begin(), notes.end());
    return held.files.front().second;
}

std::set<std::string> VolumeReader::notes() const {
    const std::lock_guard lock(notes_mutex_);
    return notes_;
}

std::string read_probed_volume(const std::vector<std::string>& words, const BeginLimits& begin_limits) {
    const VdbReader& library = reader();
    const Volume volume = volume_of(words);
    begin_limits();
    std::vector<std::string> notes;
    const std::vector<std::filesystem::path> files(words.begin() + facts, words.end());
    store_grids(library.read(files, volume, notes, allow_more_memory), STDIN_FILENO);
    std::string text;
    for (const std::string& note : notes) text += note + "\n";
    return text;
}

std::string read_probed_outlines(const std::vector<std::string>& words, const BeginLimits& begin_limits) {
    const VdbReader& library = reader();
    const Volume volume = volume_of(words);
    begin_limits();
    std::string text;
    const std::vector<std::filesystem::path> files(words.begin() + facts, words.end());
    const std::size_t together = words[facts - 1] == "2" ? 2 : 1;
    for (std::size_t i = 0; i + together <= files.size(); i += together) {
        const VolumeOutline outline = library.outline({&files[i], together}, volume);
        for (const glm::dvec3& p : {outline.box.low, outline.box.high})
            for (int k = 0; k < 3; ++k) text += exact(p[k]) + " ";
        text += std::to_string(outline.bytes) + "\n";
    }
    return text;
}

}  // namespace render2mpeg::scene
