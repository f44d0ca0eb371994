#pragma once
// Has Blender export a .blend, and what it imports: USD, Alembic.
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace render2mpeg::scene {

struct BlenderExport {
    std::filesystem::path film;      ///< the animation file
    std::vector<std::string> notes;  ///< losses of the export, one line each: object and reason
};

/// Export of a .blend, or of a scene that Blender imports, cached in FILE.export/ or the user's cache, keyed by the
/// file, our script and Blender, by other files it uses, and by `lines`, the height of the pictures that its textures
/// are baked for (0: the scene's own). Blender is $RENDER2MPEG_BLENDER, else `blender` on the PATH, limited in memory
/// and time, and ended with all that it started once `stops` says so. Throws core::Error.
BlenderExport export_by_blender(const std::filesystem::path& file, int lines, const std::function<bool()>& stops);

/// $RENDER2MPEG_BLENDER, a path or a name on the PATH, else `blender` there; empty where there is none.
std::filesystem::path blender_program();

/// Words that begin a command of Blender: the program, or, of a Python, that and the script by which its module bpy
/// takes Blender's words.
std::vector<std::string> words_of_blender(const std::filesystem::path& program);

/// Becomes Blender within a probe. `words`: program, script, scene, output folder, longest side of baked textures,
/// height of the pictures. Returns only on failure.
void become_blender(const std::vector<std::string>& words);

}  // namespace render2mpeg::scene
