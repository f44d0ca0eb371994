#include "scene/model/mesh.h"

#include <map>
#include <tuple>

namespace render2mpeg::scene {

std::vector<std::uint32_t> weld(const Mesh& mesh) {
    const auto less = [](const glm::vec3& a, const glm::vec3& b) {
        return std::tuple(a.x, a.y, a.z) < std::tuple(b.x, b.y, b.z);
    };
    std::map<glm::vec3, std::uint32_t, decltype(less)> first(less);
    std::vector<std::uint32_t> welded;
    for (std::uint32_t i = 0; i < mesh.positions.size(); ++i)
        welded.push_back(first.emplace(mesh.positions[i], i).first->second);
    return welded;
}

}  // namespace render2mpeg::scene
