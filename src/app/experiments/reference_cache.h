#pragma once
// Cache of reference frames in a folder.
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "app/loop/render_job.h"
#include "core/plane.h"

namespace render2mpeg::app {

/// Reference light of one frame.
struct KeptReference {
    core::Plane<glm::vec3> light;  ///< radiance
    double seconds = 0;            ///< CPU that it took
};

/// Reference frames in files named by a key of their inputs: visible points, settings, version, instruction set, and
/// the light of some hundred pixels, gathered anew each time. Any change of scene or code changes the key.
class ReferenceCache {
  public:
    ReferenceCache() = default;
    /// Makes the folder. Throws core::Error where that fails.
    explicit ReferenceCache(std::filesystem::path folder);

    /// Key of a seen frame; the renderer has begun its chunk. 0 where nothing is kept.
    std::uint64_t key_of(const RenderJob& film, renderer::Renderer& renderer, const scene::Snapshot& world,
                         const renderer::PlacedFrame& placed) const;
    /// None without a whole file of this key and size.
    std::optional<KeptReference> find(std::uint64_t key, int width, int height) const;
    /// A full disk is no error.
    void keep(std::uint64_t key, const KeptReference& reference) const;

  private:
    std::filesystem::path file_of(std::uint64_t key) const;

    std::filesystem::path folder_;
};

/// The references' light in words: "64 light points and 4096 rays a point".
std::string reference_light(const RenderJob& film, std::size_t light_points);

}  // namespace render2mpeg::app
