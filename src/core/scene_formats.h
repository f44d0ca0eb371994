#pragma once
// Formats of scenes, by the endings of their names.
#include <array>
#include <filesystem>

#include "core/text.h"

namespace render2mpeg::core {

/// Who reads a scene.
enum class SceneReader { assimp, gltf, blender, animation_file };

struct SceneFormat {
    const char* ending;
    SceneReader reader;
};

/// Those that people's scenes have; Assimp reads others, too.
inline constexpr std::array<SceneFormat, 15> scene_formats{{{".blend", SceneReader::blender},
                                                            {".usd", SceneReader::blender},
                                                            {".usda", SceneReader::blender},
                                                            {".usdc", SceneReader::blender},
                                                            {".usdz", SceneReader::blender},
                                                            {".abc", SceneReader::blender},
                                                            {".glb", SceneReader::gltf},
                                                            {".gltf", SceneReader::gltf},
                                                            {".fbx", SceneReader::assimp},
                                                            {".obj", SceneReader::assimp},
                                                            {".dae", SceneReader::assimp},
                                                            {".3ds", SceneReader::assimp},
                                                            {".ply", SceneReader::assimp},
                                                            {".stl", SceneReader::assimp},
                                                            {".json", SceneReader::animation_file}}};

inline SceneReader scene_reader_of(const std::filesystem::path& file) {
    const std::string ending = ending_of(file);
    for (const SceneFormat& format : scene_formats)
        if (ending == format.ending) return format.reader;
    return SceneReader::assimp;
}

}  // namespace render2mpeg::core
