#pragma once

#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <string>

namespace render2mpeg::test {

/// A .vdb file in the making, by OpenVDB itself.
class VdbFile {
  public:
    VdbFile();
    ~VdbFile();

    /// Voxels from `low` to `high`, both included.
    struct Place {
        glm::ivec3 low{0}, high{0};
        glm::dmat4 object_from_index{1};
        bool half = false, level_set = false;
    };
    using Amount = std::function<float(glm::ivec3)>;
    using Vector = std::function<glm::vec3(glm::ivec3)>;
    VdbFile& add(const std::string& name, const Place& place, const Amount& amount);
    VdbFile& add(const std::string& name, const Place& place, const Vector& vector);

    /// One value throughout, most of it in constant nodes.
    VdbFile& add_even(const std::string& name, const Place& place, float value);
    /// A grid whose voxels widen with depth.
    VdbFile& add_frustum(const std::string& name);
    VdbFile& add_whole_numbers(const std::string& name);

    std::filesystem::path write(const std::filesystem::path& file) const;

  private:
    struct Grids;
    std::unique_ptr<Grids> grids_;
};

}  // namespace render2mpeg::test
