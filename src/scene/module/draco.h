#pragma once
// What the module of compressed meshes offers to the light library in front of it.
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace render2mpeg::scene::gltf {

/// A mesh out of Draco's bytes.
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

/// What the module render2mpeg_draco_module.so offers.
class DracoDecoder {
  public:
    virtual ~DracoDecoder() = default;

    /// The mesh that the bytes hold, with these attributes. Throws std::invalid_argument with the cause. The library
    /// below trusts what it reads: bytes of strangers go there in a process of their own first.
    virtual DracoMesh decode(std::span<const std::byte> bytes, std::span<const std::uint32_t> attributes) const = 0;
};

}  // namespace render2mpeg::scene::gltf
