#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "scene/animation_file/json.h"
#include "scene/animation_file/movement.h"
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Materials, images and sky of an animation file.
class Looks {
  public:
    /// `folder` is the film's own: images lie in it or below.
    Looks(Animation& film, std::filesystem::path folder, const FilmClock& clock)
        : film_(film), folder_(std::move(folder)), clock_(clock) {}

    /// Makes or changes a material of that name for each member; those of the scene file keep what is not said.
    void read_materials(const JsonValue& materials);

    /// The material that `value` means: a name, or an object in place of one. An object changes a copy of `base`; -1:
    /// of the default, a matt light grey. The same value gives the same material each time.
    int material_of(const JsonValue& value, int base);

    /// The matt light grey of what has no material.
    int default_material();

    /// A copy of a material in another colour: that of its light if it shines, else that of its surface.
    int recolored(int material, glm::vec3 color);

    /// Sets the sky: a colour, an image, or a gradient.
    void read_sky(const JsonValue& sky);

    /// Throws for a material of the file that nothing uses and that the scene does not know: most likely a misspelt
    /// name.
    void refuse_unused() const;

    /// The file that an image of the film means, below its folder.
    static std::filesystem::path file_below(const std::filesystem::path& folder, const JsonValue& name);

  private:
    void change(const JsonValue& value, int material);
    TextureUse texture_of(const JsonValue& value);
    TextureUse checker_of(const JsonValue& value);
    int add_image(ImageSource image);
    int gradient_image(glm::vec3 zenith, glm::vec3 horizon, glm::vec3 ground);

    Animation& film_;
    std::filesystem::path folder_;
    const FilmClock& clock_;
    std::map<std::string, JsonValue> unused_;  ///< materials that the file makes, until something uses them
    std::map<std::string, int> made_;          ///< by the place of the value in the file
    std::map<std::pair<int, std::string>, int> recolored_;
    int default_ = -1;
};

}  // namespace render2mpeg::scene
