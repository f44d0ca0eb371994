#include "scene/load.h"

#include <cstdint>
#include <system_error>

#include "core/error.h"
#include "core/plain_file.h"
#include "core/scene_formats.h"
#include "scene/animation_file/load.h"
#include "scene/assimp/load.h"
#include "scene/blender/export.h"
#include "scene/gltf/load.h"
#include "scene/isolation/probe.h"
#include "scene/model/wording.h"
#include "scene/preparation/complete.h"

namespace render2mpeg::scene {
namespace {

void choose_camera(Animation& animation, const std::string& wanted) {
    std::vector<std::string> names;
    for (const CameraLens& lens : animation.cameras) names.push_back(lens.name);
    const std::optional<std::size_t> chosen = choose(wanted, names);
    if (!chosen) throw core::Error("reading", animation.source, no_such("camera", wanted, names));
    animation.shots = {{0, static_cast<int>(*chosen)}};
}

/// The exported film. Errors name the scene, not the files of its export, which nobody wrote.
Animation film_of(const BlenderExport& exported, const std::filesystem::path& scene, const LoadOptions& options) try {
    return load_animation_file(exported.film, options, load_as_is);
} catch (const core::Error& error) {
    const std::string inner = "reading " + exported.film.string() + ": ", said = error.what();
    throw core::Error("reading", scene.string(),
                      "its export by Blender: " + (said.starts_with(inner) ? said.substr(inner.size()) : said));
}

Animation load_by_blender(const std::filesystem::path& file, const LoadOptions& options) {
    const BlenderExport exported =
        export_by_blender(file, {options.lines, options.last_frame}, {options.stops, options.tells});
    Animation animation = film_of(exported, file, options);
    animation.files.insert(animation.files.begin(), file);
    animation.notes.insert(animation.notes.begin(), exported.notes.begin(), exported.notes.end());
    return animation;
}

}  // namespace

Animation load_as_is(const std::filesystem::path& file, const LoadOptions& options) {
    std::error_code failure;
    if (std::filesystem::is_directory(file, failure)) return load_animation_file(file, options, load_as_is);
    if (const std::string why = core::why_no_plain_file(file); !why.empty())
        throw core::Error("reading", file.string(), why);
    const core::SceneReader reader = core::scene_reader_of(file);
    if (reader == core::SceneReader::gltf)
        return load_gltf(file, options, [&](std::uintmax_t bytes) {
            // Decoders of compressed meshes are outside code.
            if (Probe::is_possible()) read_in_probe({"gltf", file.string()}, file.string(), limits_for(bytes));
        });
    if (reader == core::SceneReader::animation_file) return load_animation_file(file, options, load_as_is);
    if (reader == core::SceneReader::blender) return load_by_blender(file, options);
    if (options.variant) throw core::Error("reading", file.string(), no_such("variant", *options.variant, {}));
    // Assimp's parsers are outside code.
    if (Probe::is_possible()) {
        std::vector<std::string> words{"scene", file.string()};
        if (options.animation) words.push_back(*options.animation);
        read_in_probe(words, file.string(), limits_for(file));
    }
    return load_with_assimp(file, options);
}

Animation load(const std::filesystem::path& file, const LoadOptions& options) {
    Animation animation = load_as_is(file, options);
    animation.source = file.string();
    if (options.camera) choose_camera(animation, *options.camera);
    const bool no_sky = options.sky && *options.sky == "none";
    if (no_sky) animation.sky = {};
    if (options.sky && !no_sky) {
        if (const std::string why = core::why_no_plain_file(*options.sky); !why.empty())
            throw core::Error("reading", *options.sky, why);
        animation.sky = {};
        animation.sky.color = glm::vec3(1);
        animation.sky.image = static_cast<int>(animation.images.size());
        animation.images.push_back({*options.sky, *options.sky, {}});
    }
    complete(animation, no_sky ? DefaultLight::none : options.light);
    return animation;
}

}  // namespace render2mpeg::scene
