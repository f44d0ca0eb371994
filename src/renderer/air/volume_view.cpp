#include "renderer/air/volume_view.h"

#include <algorithm>
#include <cmath>

#include "core/numeric.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// Rays through a pixel, at places of a lattice that is turned against the picture's. chosen: 4, as eye samples are.
constexpr glm::vec2 ray_places[] = {{0.375f, 0.125f}, {0.875f, 0.375f}, {0.125f, 0.625f}, {0.625f, 0.875f}};

/// Adds the light of a pixel's straight spans.
void add_pixel(const PosedScene& scene, glm::ivec2 pixel, std::span<const AirSpan> spans, core::Plane<glm::vec3>& out) {
    const scene::Camera& camera = scene.posed().camera;
    std::vector<std::pair<float, glm::vec3>> ends;
    for (const AirSpan& span : spans) ends.emplace_back(span.distance, span.weight);
    std::stable_sort(ends.begin(), ends.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<float> distances;
    for (const auto& end : ends) distances.push_back(end.first);
    std::vector<glm::vec3> light(ends.size());
    constexpr float share = 1.0f / static_cast<float>(std::size(ray_places));
    for (const glm::vec2 place : ray_places) {
        const scene::Ray eye = camera.ray_through(glm::vec2(pixel) + place);
        const float cosine = glm::dot(eye.direction, camera.depth_axis(eye.direction));
        const float near = core::divide_or(std::max(camera.lens().near, 0.0f), cosine, 0.0f);
        std::fill(light.begin(), light.end(), glm::vec3(0));
        scene.air()->add_light(eye.origin + near * eye.direction, eye.direction, VolumeView::eye, distances.data(),
                               distances.size(), light.data());
        for (std::size_t i = 0; i < ends.size(); ++i) out.at(pixel.x, pixel.y) += share * ends[i].second * light[i];
    }
}

void add_tiles(const PosedScene& scene, const Frame& seen, const std::vector<SeenAir>& air,
               const core::Plane<std::uint8_t>* only, core::Plane<glm::vec3>& out, core::Plane<glm::vec3>* beyond) {
    parallel::for_each(air.size(), [&](std::size_t t) {
        const auto is_wanted = [&](glm::ivec2 p) { return only == nullptr || only->at(p.x, p.y) != 0; };
        const std::vector<AirSpan>& spans = air[t].straight;
        for (std::size_t from = 0; from < spans.size();) {
            std::size_t to = from;
            while (to < spans.size() && spans[to].pixel == spans[from].pixel) ++to;
            const glm::ivec2 p = seen.place_of(t, spans[from].pixel);
            if (is_wanted(p)) add_pixel(scene, p, std::span(spans).subspan(from, to - from), out);
            from = to;
        }
        for (const AirPath& path : air[t].beyond) {
            const glm::ivec2 p = seen.place_of(t, path.pixel);
            if (!is_wanted(p)) continue;
            const glm::vec3 light = path.weight * scene.air()->light_of_volumes(path.origin, path.direction,
                                                                                path.distance, VolumeView::eye);
            out.at(p.x, p.y) += light;
            if (beyond != nullptr && !beyond->empty()) beyond->at(p.x, p.y) += light;
        }
    });
}

}  // namespace

void add_volumes_seen(const PosedScene& posed_scene, const Frame& seen, EffectLight& light) {
    add_tiles(posed_scene, seen, seen.air, nullptr, light.all, &light.specular);
    if (seen.exposure && !seen.exposure->air.empty())
        add_tiles(posed_scene, seen, seen.exposure->air, &seen.exposure->exposed, light.exposed, nullptr);
}

}  // namespace render2mpeg::renderer
