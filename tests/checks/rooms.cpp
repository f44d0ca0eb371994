#include "checks/rooms.h"

#include <algorithm>
#include <string>
#include <string_view>

namespace render2mpeg::checks {
namespace {

/// Stands among a room's rooms for the headers of the part's own level: the room is built on them.
constexpr std::string_view own_level = ".";

/// A room, the rooms of its part that it may include, and the other parts that it may include.
struct Room {
    std::string_view name;
    std::vector<std::string_view> rooms;
    std::vector<std::string_view> parts;
};

/// A part that has rooms.
struct Building {
    std::string_view folder;   ///< where it lies, with '/'
    std::string_view include;  ///< how its headers begin, with '/'
    std::vector<Room> rooms;
    /// Headers of the part's own level that all its rooms may include, and that include no room: their names, no
    /// ending.
    std::vector<std::string_view> values = {};
};

const std::vector<Building>& buildings() {
    static const std::vector<Building> all = {
        {"src/scene/",
         "scene/",
         {{"model", {}, {"core"}},
          {"isolation", {}, {"core"}},
          {"pose", {"model"}, {"core"}},
          {"module", {"model"}, {"core"}},
          {"volumes", {"isolation", "module", "model"}, {"core"}},
          {"preparation", {"volumes", "pose", "model"}, {"core"}},
          {"gltf", {"module", "model"}, {"core"}},
          {"assimp", {"isolation", "model"}, {"core"}},
          {"blender", {"isolation"}, {"core"}},
          {"animation_file", {"model"}, {"core"}}}},
        {"src/renderer/",
         "renderer/",
         {{"base", {}, {"core", "scene", "parallel"}},
          {"geometry", {"base"}, {"core", "scene", "image"}},
          {"surface", {"geometry", "base"}, {"core", "scene", "image", "parallel"}},
          {"lights", {"surface", "geometry", "base"}, {"core", "scene", "image", "parallel"}},
          {"paths", {"lights", "subsurface", "surface", "geometry", "base"}, {"core", "scene", "image"}},
          {"caustics", {"lights", "surface", "geometry", "base"}, {"core", "scene", "parallel"}},
          {"tree", {"surface", "base"}, {"core", "parallel"}},
          {"subsurface", {"surface", "geometry", "base"}, {"core", "scene"}},
          {"view", {"surface", "base"}, {"core", "parallel"}},
          {"truth", {"paths", "view", "surface", "geometry", "base"}, {"core", "scene", "parallel"}},
          {"hair", {"gather", "paths", "subsurface", "surface", "geometry", "base"}, {"core", "scene", "parallel"}},
          {"cut", {"tree", "surface", "geometry", "base"}, {"core", "scene", "parallel"}},
          {"gather", {"paths", "lights", "cut", "surface", "geometry", "base"}, {"core", "scene", "parallel"}},
          {"air", {"gather", "cut", "tree", "lights", "surface", "geometry", "base"}, {"core", "scene", "parallel"}},
          {"calibration", {"cut", "tree", "surface", "geometry", "base"}, {"core", "scene", "parallel"}},
          {"cache", {"gather", "cut", "tree", "surface", "base"}, {"core", "scene", "parallel"}},
          {"draft", {"cache", "cut", "tree", "surface", "geometry", "base"}, {"core", "parallel"}}}},
        {"encoder/",
         "encoder/",
         {{"mpeg2", {}, {"core", "parallel"}},
          {"av", {own_level, "mpeg2"}, {"core"}},
          {"example", {own_level}, {"core"}}},
         {"types", "cadence", "timecode"}},
        {"encoder/mpeg2/",
         "encoder/mpeg2/",
         {{"bitstream", {}, {"core"}},
          {"kernels", {"bitstream"}, {"core"}},
          {"motion", {"kernels", "bitstream"}, {"core", "parallel"}},
          {"macroblock", {"motion", "kernels", "bitstream"}, {"core", "parallel"}},
          {"picture", {"macroblock", "motion", "kernels", "bitstream"}, {"core", "parallel"}},
          {"rate", {"picture", "macroblock", "motion", "kernels", "bitstream"}, {"core", "parallel"}}}},
        {"src/app/",
         "app/",
         {{"system", {}, {"core", "parallel", "image", "scene"}},
          {"options", {"system"}, {"core", "encoder", "perceptual"}},
          {"files", {"options", "system"}, {"core", "encoder"}},
          {"coupling", {"options"}, {"core", "scene", "renderer", "perceptual", "encoder"}},
          {"job",
           {"coupling", "files", "options", "system"},
           {"core", "parallel", "scene", "renderer", "perceptual", "encoder"}},
          // The only room that joins the parts.
          {"loop",
           {"job", "coupling", "files", "options", "system"},
           {"core", "parallel", "image", "scene", "renderer", "perceptual", "encoder"}},
          {"estimate",
           {"loop", "job", "coupling", "files", "options", "system"},
           {"core", "parallel", "image", "scene", "renderer", "encoder"}},
          {"report",
           {"estimate", "loop", "job", "coupling", "files", "options", "system"},
           {"core", "image", "perceptual", "encoder"}},
          {"production",
           {"report", "estimate", "loop", "job", "coupling", "files", "options", "system"},
           {"core", "parallel", "image", "scene", "renderer", "encoder"}},
          {"farm",
           {"production", "report", "estimate", "loop", "job", "coupling", "files", "options", "system"},
           {"core", "parallel", "encoder"}},
          {"experiments",
           {"production", "report", "estimate", "loop", "job", "coupling", "files", "options", "system"},
           {"core", "parallel", "scene", "renderer", "perceptual", "encoder"}},
          {"commands",
           {"experiments", "production", "report", "estimate", "loop", "job", "coupling", "files", "options", "system"},
           {"core", "parallel", "perceptual", "encoder"}}}},
    };
    return all;
}

bool holds(const std::vector<std::string_view>& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// Whether a name in a part's folder, with its ending, is one of the part's values.
bool is_value(const Building& building, std::string_view name) {
    return holds(building.values, name.substr(0, name.find('.')));
}

/// What is wrong with one include of a source on the part's own level, or nothing: values lie below all rooms, and
/// other sources below those rooms alone that are built on this level.
std::string wrong_on_own_level(const Building& building, std::string_view source, const std::string& header) {
    if (!header.starts_with(building.include)) return {};
    const std::string_view rest = std::string_view(header).substr(building.include.size());
    if (is_value(building, source) && !is_value(building, rest))
        return std::string(source) + " holds values of all rooms, but includes \"" + header + "\"";
    const auto room = std::find_if(building.rooms.begin(), building.rooms.end(),
                                   [&](const Room& r) { return r.name == rest.substr(0, rest.find('/')); });
    if (room == building.rooms.end() || !holds(room->rooms, own_level)) return {};
    return std::string(source) + " lies below the room " + std::string(room->name) + ", but includes \"" + header +
           "\"";
}

/// What is wrong with one include of a source in a room, or nothing.
std::string wrong_with(const Building& building, const Room& room, const std::string& header) {
    if (!header.starts_with(building.include)) {
        const std::string part = header.substr(0, header.find('/'));
        if (building.include.starts_with(part + "/") || holds(room.parts, part)) return {};
        return std::string(room.name) + " may not know " + part + ", but includes \"" + header + "\"";
    }
    const std::string rest = header.substr(building.include.size());
    const std::size_t slash = rest.find('/');
    if (slash == std::string::npos && (holds(room.rooms, own_level) || is_value(building, rest))) return {};
    if (slash == std::string::npos) return std::string(room.name) + " lies below \"" + header + "\", which it includes";
    const std::string other = rest.substr(0, slash);
    if (other == room.name || holds(room.rooms, other)) return {};
    return std::string(room.name) + " may not know the room " + other + ", but includes \"" + header + "\"";
}

/// The sentence of a README that says what its room may include, or nothing.
std::string touched_by(const std::string& readme) {
    const std::size_t begin = std::min({readme.find("May touch"), readme.find("May include"), readme.size()});
    const std::size_t end = std::min({readme.find(". ", begin), readme.find(".\n", begin), readme.find(';', begin)});
    return readme.substr(begin, end == std::string::npos ? end : end - begin);
}

}  // namespace

std::vector<Finding> room_breaches(const std::vector<File>& files) {
    std::vector<Finding> findings;
    for (const File& file : files)
        for (const Building& building : buildings()) {
            if (!file.is_cpp() || !file.is_product() || !file.begins_with(building.folder)) continue;
            const std::string rest = file.path.substr(building.folder.size());
            const bool above = rest.find('/') == std::string::npos;
            const auto room = std::find_if(building.rooms.begin(), building.rooms.end(),
                                           [&](const Room& r) { return r.name == rest.substr(0, rest.find('/')); });
            if (!above && room == building.rooms.end()) {
                findings.push_back({file.path, 0, "lies in no room of the table in tests/checks/rooms.cpp"});
                continue;
            }
            for (const Include& include : includes_of(file)) {
                if (!include.quoted) continue;
                const std::string wrong = above ? wrong_on_own_level(building, rest, include.name)
                                                : wrong_with(building, *room, include.name);
                if (!wrong.empty()) findings.push_back({file.path, include.line, wrong});
            }
        }
    return findings;
}

std::vector<Finding> rooms_without_readme(const std::vector<File>& files) {
    constexpr std::size_t most_lines = 10;
    std::vector<Finding> findings;
    const auto look = [&](const std::string& path) {
        const auto found = std::find_if(files.begin(), files.end(), [&](const File& f) { return f.path == path; });
        if (found == files.end())
            findings.push_back({path, 0, "is missing: what the room does, what it may touch, where to start reading"});
        else if (lines_of(found->text).size() > most_lines)
            findings.push_back({path, 0, "has more than " + std::to_string(most_lines) + " lines"});
    };
    for (const Building& building : buildings()) {
        look(std::string(building.folder) + "README.md");
        for (const Room& room : building.rooms)
            look(std::string(building.folder) + std::string(room.name) + "/README.md");
    }
    return findings;
}

std::vector<Finding> untrue_readmes(const std::vector<File>& files) {
    std::vector<Finding> findings;
    const auto text_of = [&](const std::string& path) {
        const auto found = std::find_if(files.begin(), files.end(), [&](const File& f) { return f.path == path; });
        return found == files.end() ? std::string() : found->text;
    };
    for (const Building& building : buildings())
        for (const Room& room : building.rooms) {
            const std::string path = std::string(building.folder) + std::string(room.name) + "/README.md";
            const std::string touched = touched_by(text_of(path));
            if (touched.find("all rooms") != std::string::npos) continue;
            for (const Room& other : building.rooms) {
                const bool named = !find_word(touched, other.name).empty();
                if (named != holds(room.rooms, other.name))
                    findings.push_back(
                        {path, 0,
                         std::string(named ? "says that it may touch " : "does not say that it may touch ") +
                             std::string(other.name)});
            }
        }
    // Large rooms, where a reader looks for a file by its duty.
    for (const std::string folder : {"src/core/", "src/renderer/base/", "src/app/loop/"}) {
        const std::string path = folder + "README.md", text = text_of(path);
        for (const File& file : files) {
            if (!file.is_cpp() || !file.begins_with(folder)) continue;
            const std::string name = file.path.substr(folder.size(), file.path.find('.') - folder.size());
            if (find_word(text, name).empty()) findings.push_back({path, 0, "does not name " + name});
        }
    }
    return findings;
}

}  // namespace render2mpeg::checks
