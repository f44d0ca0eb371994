#pragma once
// Keeps reference frames in a folder for the next run.
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "app/loop/render_job.h"
#include "core/plane.h"

namespace render2mpeg::app {

/// Light of one frame by every light point.
struct KeptReference {
    core::Plane<glm::vec3> light;  ///< radiance
    double seconds = 0;            ///< CPU that it took
};

/// Frames lit by every light point, kept in files of a folder under a name that stands for all that they depend on:
/// every point that the frame shows, settings, version, instruction set, and the light of some hundred of its pixels,
/// gathered anew each time. Whatever changes them, a texture, a shape or the code that lights, makes another name.
class ReferenceCache {
  public:
    /// Keeps nothing.
    ReferenceCache() = default;
    /// Makes the folder. Throws core::Error where that fails.
    explicit ReferenceCache(std::filesystem::path folder);

    /// The name of a frame that is seen already; the renderer has begun its chunk. 0 where nothing is kept.
    std::uint64_t key_of(const RenderJob& film, renderer::Renderer& renderer, const scene::Snapshot& world,
                         const renderer::Seen& seen) const;
    /// None where no whole file has this name, or not a picture of this size.
    std::optional<KeptReference> find(std::uint64_t key, int width, int height) const;
    /// A disk that is full costs no more than the file.
    void keep(std::uint64_t key, const KeptReference& reference) const;

  private:
    std::filesystem::path file_of(std::uint64_t key) const;

    std::filesystem::path folder_;
};

/// The light of the film's references in words: "64 light points and 4096 rays a point".
std::string reference_light(const RenderJob& film, std::size_t light_points);

}  // namespace render2mpeg::app
