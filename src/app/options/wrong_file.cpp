#include "app/options/wrong_file.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/text.h"

namespace render2mpeg::app {
namespace {

constexpr std::array films{".mpg", ".mpeg", ".vob", ".ts",   ".m2v", ".mkv", ".mp4", ".mov",
                           ".avi", ".webm", ".wmv", ".m2ts", ".gif", ".y4m", ".ogv", ".flv"};
constexpr std::array pictures{".png",  ".exr", ".jpg", ".jpeg", ".tif", ".tiff",
                              ".webp", ".bmp", ".tga", ".hdr",  ".psd"};
constexpr std::array scenes{".blend", ".glb", ".gltf", ".fbx", ".obj", ".dae", ".usd", ".usdz", ".3ds", ".ply", ".stl"};
constexpr std::array sounds{".wav", ".mp3", ".flac", ".ogg", ".aac", ".m4a"};
constexpr const char* kinds = "scenes are .blend, .glb, .gltf, .fbx, .obj and others, or animation files (.json)";

template <class Endings>
bool is_one_of(const Endings& endings, const std::filesystem::path& file) {
    return std::find(endings.begin(), endings.end(), core::ending_of(file)) != endings.end();
}

std::string of_folder(const std::filesystem::path& folder) {
    std::error_code error;
    if (std::filesystem::exists(folder / "film.json", error)) return {};
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
        if (is_one_of(scenes, entry.path())) found.push_back(entry.path().filename().string());
    std::sort(found.begin(), found.end());
    if (found.empty()) return std::string("this folder holds neither a film.json nor a scene; ") + kinds;
    return "this folder holds no film.json; give one of its scenes, such as " + (folder / found.front()).string();
}

}  // namespace

std::string not_a_scene(const std::filesystem::path& file) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) return of_folder(file);
    if (is_one_of(films, file)) return std::string("it is a film already; ") + kinds;
    if (is_one_of(pictures, file))
        return "it is a picture, not a scene; `encode frames.%04d.png -o film.mpg` makes a film of pictures";
    if (is_one_of(sounds, file)) return "it is sound, not a scene; --audio adds it to a film";
    if (core::ending_of(file) == ".blend1") return "it is Blender's backup; rename it to .blend";
    if (core::ending_of(file) == ".usd" || core::ending_of(file) == ".usdz" || core::ending_of(file) == ".usdc")
        return "USD is not read; export the scene as .glb";
    constexpr std::array others{".txt", ".md", ".py", ".sh", ".html", ".csv", ".pdf", ".zip", ".gz", ".tar", ".mtl"};
    if (is_one_of(others, file)) return std::string("it is no scene; ") + kinds;
    return {};
}

std::string not_a_film(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::exists(file, error)) return "there is no such file";
    if (std::filesystem::is_directory(file, error)) return "it is a folder; give the film in it";
    if (is_one_of(scenes, file) || core::ending_of(file) == ".json")
        return "it is a scene, not a film; `plan` tells about scenes";
    if (is_one_of(pictures, file)) return "it is a picture, not a film";
    if (core::ending_of(file) == ".y4m") return "its pictures are not coded; `encode` makes a film of them";
    return {};
}

std::string instead_of(const std::filesystem::path& output) {
    const std::string ending = core::ending_of(output);
    if (ending.empty()) return "its name needs an ending, such as " + output.filename().string() + ".mpg";
    if (ending == ".gif") return ".gif is not written; render a film, then `ffmpeg -i film.mpg film.gif`";
    if (is_one_of(pictures, output)) return ending + " is not written; of pictures only .png and .exr are";
    if (is_one_of(scenes, output))
        return "it would be a scene; which film is to be made of it? For example -o film.mpg";
    if (is_one_of(sounds, output)) return "it would be sound; --audio adds sound to a film";
    if (is_one_of(films, output)) return ending + " is not written; take .mp4 or .mkv, or .mpg";
    return {};
}

}  // namespace render2mpeg::app
