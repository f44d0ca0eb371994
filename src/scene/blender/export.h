#pragma once
// Has Blender export a .blend, and what it imports: USD, Alembic.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace render2mpeg::scene {

/// Looked at while Blender exports a scene; each may be empty.
struct ExportWatch {
    std::function<bool()> stops{};                    ///< whether the export is to be given up
    std::function<void(const std::string&)> tells{};  ///< gets its step: "frame 3 of 72"
};

struct BlenderExport {
    std::filesystem::path film;      ///< the animation file
    std::vector<std::string> notes;  ///< losses of the export, one line each: object and reason
};

/// Part of a film that an export is for.
struct ExportWish {
    int lines = 0;  ///< height of the pictures, for which textures are baked; 0: the scene's own
    std::optional<std::int64_t> last_frame{};  ///< of the film at its own rate; none: its last
};

/// Export of a .blend, or of a scene that Blender imports, cached in FILE.export/ or the user's cache, keyed by the
/// file, our script and Blender, by other files it uses, and by the wish; one of the whole film serves each part of it.
/// Motion ends a frame after the last one. Blender is $RENDER2MPEG_BLENDER, else `blender` on the PATH, limited in
/// memory and time, and ended with all that it started once `watch.stops` says so. Throws core::Error.
BlenderExport export_by_blender(const std::filesystem::path& file, const ExportWish& wish, const ExportWatch& watch);

/// $RENDER2MPEG_BLENDER, a path or a name on the PATH, else `blender` there; empty where there is none.
std::filesystem::path blender_program();

/// Words that begin a command of Blender: the program, or, of a Python, that and the script by which its module bpy
/// takes Blender's words.
std::vector<std::string> words_of_blender(const std::filesystem::path& program);

/// Becomes Blender within a probe. `words`: program, script, scene, output folder, longest side of baked textures,
/// height of the pictures, last frame or -1. Returns only on failure.
void become_blender(const std::vector<std::string>& words);

}  // namespace render2mpeg::scene
