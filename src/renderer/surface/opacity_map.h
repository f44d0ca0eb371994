#pragma once
// Where surfaces that textures cut out are holes or opaque, by micro-triangles.
//
// After the opacity micromaps of [Gruen2020]: each triangle is split into 4^n similar ones of two bits each. We
// changed: triangles with the same texture coordinates share their bits, and bounds of the texels decide, so that no
// answer differs from the texture's.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/surface_address.h"
#include "renderer/surface/surface_material.h"

namespace render2mpeg::renderer {

/// Whether light passes a place: `mixed` where only the texture knows.
enum class Opacity : std::uint8_t { mixed, clear, opaque };

/// The objects of an animation whose materials are cut out (SurfaceMaterials::is_cut_out), at every instant.
class OpacityMaps {
  public:
    OpacityMaps(const scene::Animation& animation, const SurfaceMaterials& materials);

    /// As a sample of the textures without a footprint decides.
    Opacity at(const core::SurfaceAddress& address) const {
        const int map = map_of_.empty() ? -1 : map_of_[address.object];
        return map < 0 ? Opacity::mixed : maps_[static_cast<std::size_t>(map)].at(address);
    }

    /// Memory that all take, at most `most_bytes`.
    std::size_t bytes() const;
    static constexpr std::size_t most_bytes = std::size_t{16} << 20, most_bytes_of_triangle = 1028;

  private:
    /// Of a mesh in a material.
    class Map {
      public:
        Map(const scene::Mesh& mesh, const scene::Material& material, const MaterialTextures& textures,
            std::uint32_t index, std::size_t most);
        Opacity at(const core::SurfaceAddress& address) const;
        std::size_t bytes() const;

      private:
        std::vector<std::uint32_t> triangles_;  ///< level of subdivision in the lower bits; first byte of its states
        std::vector<std::uint8_t> states_;      ///< four to a byte
    };

    std::vector<int> map_of_;  ///< by object; -1: none. Empty: none has one
    std::vector<Map> maps_;
};

}  // namespace render2mpeg::renderer
