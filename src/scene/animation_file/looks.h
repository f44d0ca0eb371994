#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "scene/animation_file/json.h"
#include "scene/animation_file/movement.h"
#include "scene/model/animation.h"

namespace render2mpeg::scene {

class Looks {
  public:
    /// `folder` is the film's own: images lie in it or below.
    Looks(Animation& film, std::filesystem::path folder, const FilmClock& clock)
        : film_(film), folder_(std::move(folder)), clock_(clock) {}

    /// Makes or changes named materials.
    void read_materials(const JsonValue& materials);

    /// Material of `value`: a name, or an object that changes a copy of `base` (-1: the default). Equal values give one
    /// material.
    int material_of(const JsonValue& value, int base);

    /// Matt light grey.
    int default_material();

    /// A copy in another colour: of its light if it shines, else of its surface.
    int recolored(int material, glm::vec3 color);

    /// A colour, an image, or a gradient.
    void read_sky(const JsonValue& sky);

    /// Throws for an unused material of the file that the scene does not have: a misspelt name.
    void refuse_unused() const;

    /// File of an image, below the film's folder.
    static std::filesystem::path file_below(const std::filesystem::path& folder, const JsonValue& name);
    /// The same for a file that `name` leads to.
    static std::filesystem::path file_below(const std::filesystem::path& folder, const JsonValue& name,
                                            const std::string& text);

  private:
    void change(const JsonValue& value, int material);
    void change_by_angle(const JsonValue& value, Material& material);
    void copy_power(int from, int to);
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
