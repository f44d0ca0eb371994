#include "scene/animation_file/volumes.h"

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/fog.h"
#include "core/text.h"
#include "scene/animation_file/keys.h"
#include "scene/animation_file/looks.h"

namespace render2mpeg::scene {
namespace {

namespace fs = std::filesystem;
namespace keys = animation_file_keys;

// chosen: as of lights.
constexpr double most = 1e6;
// chosen: an hour of film.
constexpr std::int64_t most_files = 100'000;

/// The place of "%04d" or "%d" in a name of numbered files; none of another.
struct Pattern {
    std::size_t begin = std::string::npos, end = 0, digits = 0;

    explicit Pattern(const std::string& text) {
        begin = text.find('%');
        if (begin == std::string::npos) return;
        end = begin + 1;
        if (end + 1 < text.size() && text[end] == '0' && text[end + 1] >= '1' && text[end + 1] <= '9') {
            digits = static_cast<std::size_t>(text[end + 1] - '0');
            end += 2;
        }
        if (end >= text.size() || text[end++] != 'd') begin = std::string::npos;
    }
    bool any() const { return begin != std::string::npos; }
    std::string name(const std::string& text, std::int64_t number) const {
        std::string told = std::to_string(number);
        if (told.size() < digits) told.insert(0, digits - told.size(), '0');
        return text.substr(0, begin) + told + text.substr(end);
    }
};

std::vector<fs::path> files_of(const JsonValue& value, std::string_view key, const fs::path& folder) {
    const JsonValue file = value.need(key);
    const auto frames = value.find("frames");
    std::vector<fs::path> files;
    if (file.is_list()) {
        if (frames) frames->fail("is of files with %d in their name");
        for (const JsonValue& one : file.list(1, most_files)) files.push_back(Looks::file_below(folder, one));
        return files;
    }
    const std::string text = file.text();
    const Pattern pattern(text);
    if (!frames) {
        if (pattern.any()) file.fail("names files by their numbers; `frames`, [first, last], tells which there are");
        return {Looks::file_below(folder, file)};
    }
    if (!pattern.any()) frames->fail("is of files with %d in their name");
    const std::vector<JsonValue> range = frames->list(2, 2);
    const std::int64_t first = range[0].integer(0, 1'000'000'000);
    const std::int64_t last = range[1].integer(first, first + most_files - 1);
    for (std::int64_t number = first; number <= last; ++number)
        files.push_back(Looks::file_below(folder, file, pattern.name(text, number)));
    return files;
}

/// A node for a volume, below one of the scene's where it names one.
int add_place(const JsonValue& value, const std::string& name, Animation& film, const FilmClock& clock) {
    int parent = -1;
    if (const auto node = value.find("node")) {
        const std::string wanted = node->text();
        std::vector<std::string_view> names;
        for (const Node& known : film.nodes) names.emplace_back(known.name);
        const auto at = std::find(names.begin(), names.end(), wanted);
        if (at == names.end())
            node->fail("there is no node \"" + wanted + "\"" + core::did_you_mean(wanted, names, "\"", "\""));
        parent = static_cast<int>(at - names.begin());
    }
    const int node = add_node(film, name, parent);
    place(film, node, value, clock, keys::volume_key);
    return node;
}

void read_medium(const JsonValue& value, Volume& volume) {
    value.set("density", volume.density, 0, most);
    value.set("anisotropy", volume.anisotropy, -core::most_anisotropy, core::most_anisotropy);
    value.set("emission", volume.emission_strength, 0, most);
    value.set("blackbody", volume.blackbody_intensity, 0, 1);
    value.set("temperature", volume.temperature, 0, most);
    const auto color = [&](std::string_view key, glm::vec3& into, double at_most) {
        if (const auto v = value.find(key)) into = v->color(at_most);
    };
    color("color", volume.color, 1);
    color("absorption_color", volume.absorption_color, 1);
    color("emission_color", volume.emission_color, most);
    color("blackbody_tint", volume.blackbody_tint, most);
}

void read_grids(const JsonValue& value, const fs::path& folder, Volume& volume) {
    const auto name = [&](std::string_view key, std::string& into) {
        if (const auto v = value.find(key)) into = v->text();
    };
    name("density_grid", volume.density_grid);
    name("temperature_grid", volume.temperature_grid);
    name("color_grid", volume.color_grid);
    if (value.has("file") == value.has("size"))
        value.fail("has either a `file`, or the `size` of a box that it fills evenly");
    if (value.has("file")) {
        volume.files = files_of(value, "file", folder);
        if (const auto more = value.find("more")) {
            volume.more_files = files_of(value, "more", folder);
            if (volume.more_files.size() != volume.files.size()) more->fail("has not as many files as `file`");
        }
        if (const auto v = value.find("first_frame")) volume.first_frame = v->integer(-10'000'000, 10'000'000);
        return;
    }
    for (const char* const key : {"more", "frames", "first_frame", "density_grid", "temperature_grid", "color_grid"})
        if (const auto v = value.find(key)) v->fail("is of volumes with a `file`");
    const glm::dvec3 half = 0.5 * sizes_or<3>(value, "size", 1);
    volume.grids = std::make_shared<VolumeGrids>(even_grids(-half, half));
}

}  // namespace

void read_volumes(const JsonValue& volumes, Animation& film, const fs::path& folder, const FilmClock& clock) {
    // chosen: each holds grids of its own.
    constexpr std::size_t most_volumes = 1000;
    for (const JsonValue& value : volumes.list(0, most_volumes)) {
        value.allow_only(keys::volume);
        Volume volume;
        volume.name = value.has("name") ? value.need("name").text() : value.place();
        read_medium(value, volume);
        read_grids(value, folder, volume);
        volume.node = add_place(value, volume.name, film, clock);
        film.volumes.push_back(std::move(volume));
    }
}

}  // namespace render2mpeg::scene
