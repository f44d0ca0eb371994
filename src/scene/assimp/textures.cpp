#include "scene/assimp/textures.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <tuple>

#include "core/text.h"

namespace render2mpeg::scene {
namespace {

namespace fs = std::filesystem;

bool is_image_ending(const std::string& ending) {
    constexpr std::array<const char*, 16> known{"png", "jpg", "jpeg", "tga", "bmp", "tif",  "tiff", "gif",
                                                "hdr", "exr", "dds",  "ppm", "pgm", "webp", "jp2",  "psd"};
    return std::find(known.begin(), known.end(), ending) != known.end();
}

/// Letters that DOS keeps of a long name.
std::string dos_letters(const std::string& stem) {
    std::string kept;
    for (const char c : stem)
        if (c != ' ' && c != '.') kept += c;
    return kept;
}

std::pair<std::string, std::string> split_ending(const std::string& name) {
    const auto dot = name.rfind('.');
    if (dot == std::string::npos) return {name, ""};
    return {name.substr(0, dot), name.substr(dot + 1)};
}

}  // namespace

TextureFinder::TextureFinder(const fs::path& folder) {
    // chosen: four levels and 20000 files; scenes keep textures beside them or one folder down, and a scene that lies
    // in somebody's home must not read the whole of it.
    constexpr int deepest = 4;
    constexpr std::size_t most = 20000;
    std::error_code ignored;
    std::size_t seen = 0;
    fs::recursive_directory_iterator walk(folder, fs::directory_options::skip_permission_denied, ignored), end;
    for (; !ignored && walk != end && seen < most; walk.increment(ignored), ++seen) {
        if (walk.depth() >= deepest) walk.disable_recursion_pending();
        if (!walk->is_regular_file(ignored) || walk->is_symlink(ignored)) continue;
        Entry entry;
        entry.path = walk->path();
        entry.relative = core::lower_case(walk->path().lexically_relative(folder).generic_string());
        entry.name = core::lower_case(walk->path().filename().string());
        std::tie(entry.stem, entry.ending) = split_ending(entry.name);
        if (is_image_ending(entry.ending)) files_.push_back(std::move(entry));
    }

    // Sort, since directory order varies.
    const auto rank = [](const Entry& e) {
        const auto depth = std::count(e.relative.begin(), e.relative.end(), '/');
        const bool in_textures = e.relative.rfind("textures/", 0) == 0;
        return std::tuple(depth, !in_textures, e.relative);
    };
    std::sort(files_.begin(), files_.end(), [&](const Entry& a, const Entry& b) { return rank(a) < rank(b); });
}

const TextureFinder::Entry* TextureFinder::by_short_name(const std::string& name) const {
    const std::pair<std::string, std::string> parts = split_ending(name);
    const std::string &stem = parts.first, &ending = parts.second;
    const auto tilde = stem.rfind('~');
    if (tilde == std::string::npos || tilde + 1 >= stem.size() || tilde == 0) return nullptr;
    const std::string head = stem.substr(0, tilde);
    const std::string digits = stem.substr(tilde + 1);
    if (digits.size() > 3 ||
        !std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c); }))
        return nullptr;
    const std::size_t wanted = static_cast<std::size_t>(std::max(1, std::stoi(digits)));

    // Numbers follow the lost order of creation: same ending first, height maps last, then short names.
    std::vector<const Entry*> candidates;
    for (const Entry& e : files_)
        if (dos_letters(e.stem).rfind(head, 0) == 0) candidates.push_back(&e);
    const auto rank = [&](const Entry* e) {
        return std::tuple(e->ending.substr(0, 3) != ending.substr(0, 3), e->stem.find("bump") != std::string::npos,
                          e->stem.size(), e->relative);
    };
    std::sort(candidates.begin(), candidates.end(), [&](const Entry* a, const Entry* b) { return rank(a) < rank(b); });
    if (candidates.empty()) return nullptr;
    return candidates[std::min(wanted, candidates.size()) - 1];
}

std::optional<fs::path> TextureFinder::find(const std::string& written) const {
    std::string path = core::lower_case(written);
    std::replace(path.begin(), path.end(), '\\', '/');
    path = fs::path(path).lexically_normal().generic_string();
    const std::string name = fs::path(path).filename().string();
    if (name.empty()) return std::nullopt;

    for (const Entry& e : files_)
        if (e.relative == path) return e.path;
    for (const Entry& e : files_)
        if (e.name == name) return e.path;
    const std::string stem = split_ending(name).first;
    for (const Entry& e : files_)
        if (e.stem == stem) return e.path;
    if (const Entry* e = by_short_name(name)) return e->path;
    return std::nullopt;
}

}  // namespace render2mpeg::scene
