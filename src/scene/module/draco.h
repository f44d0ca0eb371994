#pragma once
// Interface of the module for compressed meshes.
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace render2mpeg::scene::gltf {

struct DracoMesh {
    std::size_t vertices = 0;
    std::vector<std::uint32_t> corners;  ///< three to a triangle, each below `vertices`
    struct Values {
        int components = 1;
        std::vector<float> values;  ///< `components` for each vertex; normalised where the bytes say so
        bool normalized = false;
    };
    std::map<std::uint32_t, Values> attributes;  ///< by Draco's own number
};

class DracoDecoder {
  public:
    virtual ~DracoDecoder() = default;

    /// Decodes a mesh with these attributes. Throws std::invalid_argument. The library trusts its input: probe
    /// strangers' files first.
    virtual DracoMesh decode(std::span<const std::byte> bytes, std::span<const std::uint32_t> attributes) const = 0;
};

}  // namespace render2mpeg::scene::gltf
