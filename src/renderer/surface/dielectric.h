#pragma once
// Refraction and reflection at the boundary between two clear media, and the media that a ray is in.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "renderer/geometry/surface_footprint.h"
#include "scene/model/animation.h"

namespace render2mpeg::renderer {

/// Share of unpolarised light that a smooth boundary reflects, 0..1; `cosine` 0..1 to the normal before it, `index` >
/// 0: of the medium beyond over that before. 1 where all is reflected. [BornWolf, 1.5.2]
float dielectric_reflectance(float cosine, float index);

/// Where light goes beyond the boundary, unit; 0 where all is reflected. `direction` unit, `normal` unit and on the
/// side that it comes from; `index` as above.
glm::vec3 refracted(glm::vec3 direction, glm::vec3 normal, float index);

/// How the refracted direction differs for a neighbour whose direction and normal differ by so much. [Igehy1999,
/// "Refraction"] 0 where that has no bounds.
glm::vec3 refracted_change(glm::vec3 direction, glm::vec3 direction_change, glm::vec3 normal, glm::vec3 normal_change,
                           float index);

/// The same of the mirrored direction. [Igehy1999, "Reflection"]
glm::vec3 mirrored_change(glm::vec3 direction, glm::vec3 direction_change, glm::vec3 normal, glm::vec3 normal_change);

/// Which light a ray carries, where glass splits colours: all, or one channel.
enum class Band : std::uint8_t { all, red, green, blue };

/// Medium of a body of glass.
struct Medium {
    float index = 1;          ///< of refraction, of yellow light, >= 1
    float dispersion = 0;     ///< red light's is so much less, blue light's more
    glm::vec3 absorption{0};  ///< per scene unit, >= 0

    /// >= 1.
    float index_of(Band band) const;
    /// Share of light that is left after a way. [BornWolf, 4.11.4]
    glm::vec3 passes(float distance) const;
};

/// Share of light that passes one of a pane's two faces: the root of what passes both, all reflections between them
/// included [BornWolf, 7.6.1]. `reflected`: by one face, 0..1; `cosine` before it; `thickness` >= 0.
glm::vec3 passing_pane(const Medium& medium, float reflected, float cosine, float thickness);

/// As a material says. [KHR_materials_volume, KHR_materials_dispersion]
Medium medium_of(const scene::Material& material);

/// The bodies that a ray is in, those entered last on top. Where bodies overlap, or liquid touches its glass, the one
/// that was entered last counts. Holds four; those entered first are forgotten.
class MediaStack {
  public:
    /// Medium of the place; null: air.
    const Medium* top() const { return count_ > 0 ? entries_[static_cast<std::size_t>(count_ - 1)].medium : nullptr; }
    bool empty() const { return count_ == 0; }

    /// Makes known that the ray came within a body whose back it meets: the eye began inside.
    void begin_inside(std::uint32_t object, const Medium& medium);

    /// Index beyond the boundary of an object over that before it. `back`: the ray leaves the body.
    float index_across(std::uint32_t object, const Medium& medium, bool back, Band band) const;

    /// Passes the boundary.
    void cross(std::uint32_t object, const Medium& medium, bool back);

    bool holds(std::uint32_t object) const;

  private:
    struct Entry {
        std::uint32_t object = 0;
        const Medium* medium = nullptr;
    };
    std::array<Entry, 4> entries_{};
    int count_ = 0;
};

}  // namespace render2mpeg::renderer
