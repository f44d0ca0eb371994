#include "renderer/lights/light_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/base/lobe.h"
#include "renderer/lights/average_light.h"
#include "renderer/lights/emitters.h"
#include "renderer/lights/sky_importance.h"

namespace render2mpeg::renderer {
namespace {

LightPoint punctual_point(const scene::LightState& light) {
    LightPoint p;
    p.position = light.position;
    p.normal = light.direction;
    p.intensity = light.intensity;
    p.range = light.range;
    p.id = first_punctual_id + light.id;
    p.object = core::no_id;
    if (light.kind == scene::LightKind::directional) {
        p.kind = LightPointKind::directional;
        p.disc2 = std::sin(light.angle) * std::sin(light.angle);
    } else if (light.kind == scene::LightKind::spot) {
        // Falloff between the cones: scale = 1 / (cos inner - cos outer), offset = -cos outer x scale.
        // [KHR_lights_punctual]
        p.kind = LightPointKind::spot;
        p.spot_scale = 1.0f / std::max(light.cos_inner - light.cos_outer, 1e-3f);
        p.spot_offset = -light.cos_outer * p.spot_scale;
        p.spot_smooth = light.smooth_cosine ? 1.0f : 0.0f;
    } else {
        p.kind = LightPointKind::omni;
    }
    return p;
}

bool has_volume(const glm::mat4& m) {
    const float volume = glm::determinant(glm::mat3(m));
    return core::is_finite(m) && std::isfinite(volume) && volume != 0.0f;
}

bool shines(const LightPoint& p) {
    return core::is_finite(p.intensity) && core::luminance(p.intensity) > 0.0f;
}

}  // namespace

LightPoints::LightPoints(const PosedScene& posed_scene, const Plan& plan, int count, std::uint64_t seed)
    : animation_(posed_scene.animation()),
      punctual_(plan.runs(Pass::punctual_lights)),
      emissive_(plan.runs(Pass::emissive_lights)),
      seed_(seed) {
    const bool sky = plan.runs(Pass::sky_light) && posed_scene.sky() != nullptr;
    const int share = std::max(1, emissive_ && sky ? count / 2 : count);
    if (emissive_) emissive_count_ = share;
    if (!sky) return;
    sky_count_ = share;
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
    sky_.clear();
    for (const image::SkySample& sample : posed_scene.sky()->samples(sky_count_, sky_importance_)) {
        LightPoint p;
        p.kind = LightPointKind::directional;
        p.normal = -sample.direction;
        p.intensity = sample.irradiance;
        p.disc2 = sample.solid_angle * lobe::inverse_pi;
        p.id = first_sky_id + sample.id;
        p.object = core::no_id;
        if (shines(p)) sky_.push_back(p);
    }
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
        if (shines(p)) average_.push_back(p);
    }
    posed_scene.pose(first);
}

LightPoint LightPoints::emitter_point(const PosedScene& posed_scene, std::size_t index) const {
    const scene::Snapshot& now = posed_scene.posed();
    const EmitterPoint& e = emitters_[index];
    const scene::Object& object = animation_.objects[e.object];
    const scene::Triangle t = scene::triangle_of(now, e.object, e.primitive);
    const float area = 0.5f * glm::length(glm::cross(t.b - t.a, t.c - t.a)) * e.share;
    const glm::vec3 front = posed_scene.front_normal(e.object, e.primitive);
    LightPoint p;
    p.kind = LightPointKind::oriented;
    p.normal = e.front ? front : -front;
    const SurfacePoint surface = posed_scene.surface_at({e.object, e.primitive, e.u, e.v}, p.normal);
    p.position = offset_origin(surface, p.normal);
    p.intensity = e.radiance * (now.emission_factor[static_cast<std::size_t>(object.material)] * area);
    p.disc2 = area * lobe::inverse_pi;
    p.id = static_cast<std::uint32_t>(index);
    p.object = e.object;
    return p;
}

std::vector<LightPoint> LightPoints::at(const PosedScene& posed_scene) const {
    const scene::Snapshot& now = posed_scene.posed();
    std::vector<LightPoint> points;
    points.reserve(emitters_.size() + sky_.size() + now.lights.size());
    if (punctual_) {
        for (const scene::LightState& light : now.lights) {
            const LightPoint p = punctual_point(light);
            if (shines(p)) points.push_back(p);
        }
    }
    for (std::size_t i = 0; i < emitters_.size(); ++i) {
        if (!now.objects[emitters_[i].object].present) continue;
        const LightPoint p = emitter_point(posed_scene, i);
        if (shines(p)) points.push_back(p);
    }
    points.insert(points.end(), sky_.begin(), sky_.end());
    return points;
}

std::vector<LightPoint> beyond_rays(std::vector<LightPoint> points, float brightest) {
    std::erase_if(points, [&](LightPoint& p) {
        if (p.id < first_sky_id || p.id >= first_punctual_id) return false;
        const float radiance = core::luminance(p.intensity) / (std::numbers::pi_v<float> * p.disc2);
        p.intensity *= radiance > 0.0f ? std::max(1.0f - brightest / radiance, 0.0f) : 0.0f;
        return !(core::luminance(p.intensity) > 0.0f);
    });
    return points;
}

}  // namespace render2mpeg::renderer
