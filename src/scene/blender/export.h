#pragma once
// Has Blender export a .blend.
#include <filesystem>
#include <string>
#include <vector>

namespace render2mpeg::scene {

/// What Blender made of a .blend.
struct BlenderExport {
    std::filesystem::path film;      ///< the animation file
    std::vector<std::string> notes;  ///< what could not be kept, one line each: object and reason
};

/// The export of a .blend: kept in FILE.blend.export/, or in the user's cache folder where the .blend's own cannot be
/// written to, under a name that the bytes of the .blend, our script and the Blender that is found decide. Made anew
/// where there is none or where another file that the .blend uses has changed since. Blender is what
/// $RENDER2MPEG_BLENDER names, else `blender` on the PATH. It is limited in memory and time, and executes no script of
/// the .blend. Throws core::Error: there is no Blender, or it cannot read the file.
BlenderExport export_blend(const std::filesystem::path& blend);

/// In the process of a probe: becomes Blender. `words`: program, script, .blend, folder for what it writes, side of
/// baked textures in pixels. Returns only where Blender cannot be started.
void become_blender(const std::vector<std::string>& words);

}  // namespace render2mpeg::scene
