#include "app/files/consent.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <system_error>

#include "app/options/output_kind.h"
#include "core/error.h"

namespace render2mpeg::app {
namespace {

/// Something that is not to be done without a word.
struct Doubt {
    std::filesystem::path file;
    std::string text;  ///< what is so, and what -y does
};

bool holds_a_film(const std::filesystem::path& file) {
    std::error_code error;
    return std::filesystem::is_regular_file(file, error) && std::filesystem::file_size(file, error) > 0 && !error;
}

std::vector<Doubt> doubts_of(const Wishes& wishes) {
    std::vector<Doubt> doubts;
    std::vector<std::filesystem::path> all = wishes.beside;
    for (const Files& film : wishes.films) {
        all.push_back(film.name);
        if (!film.frames && holds_a_film(film.name)) doubts.push_back({film.name, "is there already; -y replaces it"});
        if (!film.frames) continue;
        const std::vector<std::int64_t> there = numbers_on_disk(film.name);
        const auto count = std::count_if(there.begin(), there.end(), [&](std::int64_t n) {
            return n >= film.frames->first && n <= film.frames->last;
        });
        if (count > 0)
            doubts.push_back({film.name, fmt::format("{} of these images are there already; -y replaces them", count)});
    }
    std::vector<std::filesystem::path> folders;
    for (const std::filesystem::path& file : all) {
        std::error_code error;
        const std::filesystem::path folder = file.parent_path();
        if (file.empty() || folder.empty() || std::filesystem::exists(folder, error)) continue;
        if (std::find(folders.begin(), folders.end(), folder) != folders.end()) continue;
        folders.push_back(folder);
        doubts.push_back({file, "there is no folder " + folder.string() + "; -y makes it"});
    }
    return doubts;
}

}  // namespace

void require_consent(const Wishes& wishes, bool agreed) {
    if (agreed) return;
    for (const Doubt& doubt : doubts_of(wishes)) throw core::Error("writing", doubt.file.string(), doubt.text);
}

std::vector<std::string> doubts_about(const Wishes& wishes) {
    std::vector<std::string> lines;
    for (const Doubt& doubt : doubts_of(wishes)) lines.push_back(doubt.file.string() + ": " + doubt.text);
    return lines;
}

}  // namespace render2mpeg::app
