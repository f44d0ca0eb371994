#include "renderer/lights/light_points.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/color.h"
#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

bool has_volume(const glm::mat4& m) {
    const float volume = glm::determinant(glm::mat3(m));
    return core::is_finite(m) && std::isfinite(volume) && volume != 0.0f;
}

}  // namespace

LightPoints::LightPoints(const PosedScene& posed_scene, const Plan& plan, int count, std::uint64_t seed)
    : animation_(posed_scene.animation()),
      lamps_(plan.runs(Pass::punctual_lights)),
      emissive_(plan.runs(Pass::emissive_lights)),
      seed_(seed) {
    if (emissive_) emissive_count_ = std::max(1, count);
    if (!plan.runs(Pass::sky_light) || posed_scene.sky() == nullptr) return;
    sky_count_ = std::max(1, count);
    divide_sky(posed_scene);
}

std::uint64_t LightPoints::look_at_sky(PosedScene& posed_scene) {
    if (sky_count_ == 0 || std::exchange(looked_at_sky_, true)) return 0;
    std::uint64_t rays = 0;
    sky_importance_ = renderer::sky_importance(posed_scene, rays);
    if (sky_importance_) divide_sky(posed_scene);
    return rays;
}

void LightPoints::divide_sky(const PosedScene& posed_scene) {
    sky_ = sky_points(*posed_scene.sky(), sky_count_, sky_importance_);
    std::vector<float> parts;
    for (const LightPoint& p : sky_)
        parts.push_back(core::luminance(p.intensity) * (sky_importance_ ? sky_importance_(-p.normal) : 1.0f));
    std::sort(parts.begin(), parts.end());
    if (!parts.empty()) sky_part_ = parts[parts.size() / 2];
}

void LightPoints::place(PosedScene& posed_scene, const scene::Snapshot& first) {
    // Look at every emitter at its full strength: one that is off or hidden now may be lit later in the chunk.
    scene::Snapshot lit = first;
    std::fill(lit.emission_factor.begin(), lit.emission_factor.end(), 1.0f);
    for (scene::ObjectState& object : lit.objects)
        object.present = object.present || (object.deformed < 0 && has_volume(object.to_world));
    emitters_.clear();
    if (emissive_) {
        posed_scene.pose(lit);
        emitters_ = place_emitters(posed_scene, lit, emissive_count_, seed_);
    }

    const scene::Snapshot average = with_average_light(lit);
    posed_scene.pose(average);
    average_ = at(posed_scene);
    // Emitters without a surface yet lie where their mesh does.
    for (std::size_t i = 0; i < emitters_.size(); ++i) {
        const EmitterPoint& e = emitters_[i];
        if (average.objects[e.object].present) continue;
        const scene::Object& object = animation_.objects[e.object];
        const scene::Mesh& mesh = animation_.meshes[static_cast<std::size_t>(object.mesh)];
        LightPoint p;
        p.position = mesh.positions[mesh.triangles[e.primitive].x];
        p.intensity = e.radiance;
        p.id = static_cast<std::uint32_t>(i);
        p.object = e.object;
        if (p.shines()) average_.push_back(p);
    }
    posed_scene.pose(first);
}

std::vector<LightPoint> LightPoints::at(const PosedScene& posed_scene) const {
    const scene::Snapshot& now = posed_scene.posed();
    std::vector<LightPoint> points;
    points.reserve(emitters_.size() + sky_.size() + now.lights.size());
    if (lamps_)
        for (const auto& lamp : lamps_of(posed_scene)) points.push_back(lamp->point().value());
    for (std::size_t i = 0; i < emitters_.size(); ++i) {
        if (!now.objects[emitters_[i].object].present) continue;
        const LightPoint p = point_at(posed_scene, emitters_[i], static_cast<std::uint32_t>(i));
        if (p.shines()) points.push_back(p);
    }
    points.insert(points.end(), sky_.begin(), sky_.end());
    return points;
}

}  // namespace render2mpeg::renderer
