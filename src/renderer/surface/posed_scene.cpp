#include "renderer/surface/posed_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "renderer/base/sampled_clock.h"
#include "renderer/geometry/strands.h"
#include "renderer/geometry/surface_shape.h"
#include "renderer/surface/opacity_map.h"
#include "renderer/surface/surface_material.h"
#include "renderer/surface/texture_store.h"
#include "scene/volumes/volume_reader.h"

namespace render2mpeg::renderer {
namespace {

std::optional<FogMedium> fog_of(const scene::Animation& film, const Plan& plan) {
    if (!plan.runs(Pass::air)) return {};
    core::Fog fog = film.fog;
    fog.height -= static_cast<float>(film.origin.y);
    return FogMedium(fog, film.bounds_min, film.bounds_max);
}

std::vector<bool> translucent_materials(const SurfaceMaterials& materials, std::size_t count) {
    std::vector<bool> translucent(count);
    for (std::size_t m = 0; m < count; ++m) translucent[m] = materials.is_translucent(static_cast<std::uint32_t>(m));
    return translucent;
}

/// Of each object; without any, empty.
std::vector<std::optional<Medium>> media_of(const scene::Animation& animation, const Plan& plan) {
    std::vector<std::optional<Medium>> media;
    if (!plan.runs(Pass::refraction)) return media;
    for (const scene::Object& object : animation.objects) {
        std::optional<Medium>& medium = media.emplace_back();
        if (object.body != scene::Body::none)
            medium = medium_of(animation.materials[static_cast<std::size_t>(object.material)]);
    }
    return media;
}

}  // namespace

/// What is the same at every instant.
struct PosedScene::Still {
    Still(const scene::Animation& film, const Plan& plan, TextureStore& store)
        : materials(film, plan, store),
          opacity(film, materials),
          media(media_of(film, plan)),
          sky(plan.runs(Pass::sky_background) || plan.runs(Pass::sky_light) ? store.sky() : nullptr),
          notes(store.notes()),
          fog(fog_of(film, plan)),
          has_volumes(plan.runs(Pass::volumes)),
          volume_reader(film) {}

    SurfaceMaterials materials;
    OpacityMaps opacity;
    std::vector<std::optional<Medium>> media;
    std::shared_ptr<const image::SkyMap> sky;
    std::vector<std::string> notes;
    std::optional<FogMedium> fog;
    bool has_volumes;
    mutable scene::VolumeReader volume_reader;
};

struct PosedScene::Impl {
    Impl(const scene::Animation& film, core::Isa isa, const Plan& plan, TextureStore& store)
        : animation(film),
          still(std::make_shared<Still>(film, plan, store)),
          tracer(film, isa, translucent_materials(still->materials, film.materials.size()), passing()) {
        fill_air({});
    }
    explicit Impl(const Impl& posed) : animation(posed.animation), still(posed.still), tracer(posed.tracer, passing()) {
        fill_air({});
    }

    static glm::vec3 passing(Opacity known) { return glm::vec3(known == Opacity::clear ? 1.0f : 0.0f); }

    /// The ray tracer's question, asked of this object.
    RayTracer::Transmittance passing() {
        return [this](const core::SurfaceAddress& address, glm::vec3 direction, Bodies bodies) {
            if (bodies == Bodies::block && animation.objects[address.object].body == scene::Body::solid)
                return glm::vec3{0.0f};
            if (const Opacity known = still->opacity.at(address); known != Opacity::mixed) return passing(known);
            return layer_clock.time([&] { return transmittance(address, direction); });
        };
    }

    std::uint32_t material_of(std::uint32_t object) const {
        return static_cast<std::uint32_t>(animation.objects[object].material);
    }

    SurfaceShape shape(const ObjectInstant& object, const core::SurfaceAddress& address,
                       const SurfaceFootprint& footprint) const {
        EXPECTS_DEBUG(snapshot != nullptr && address.object < animation.objects.size());
        return renderer::shape_at(object, address, footprint, tracer.is_instanced(address.object));
    }
    SurfaceShape shape(const core::SurfaceAddress& address, const SurfaceFootprint& footprint) const {
        return shape(ObjectInstant(*snapshot, address.object), address, footprint);
    }

    /// Between a ray and the normal that is interpolated, whatever its side; 1 where there is none.
    float cosine_at(const core::SurfaceAddress& address, const SurfaceShape& shape, glm::vec3 direction) const {
        if (shape.mesh->has_curves()) return 1.0f;
        const scene::ObjectState& state = snapshot->objects[address.object];
        const std::vector<glm::vec3>& normals =
            state.deformed >= 0 ? snapshot->deformed[static_cast<std::size_t>(state.deformed)].normals
                                : shape.mesh->normals;
        glm::vec3 normal{0.0f};
        if (!normals.empty()) {
            for (int k = 0; k < 3; ++k) normal += shape.weights[k] * normals[shape.corners[k]];
            if (state.deformed < 0) normal = state.normal_to_world * normal;
        } else {
            const scene::Triangle t = scene::triangle_of(*snapshot, address.object, address.primitive);
            normal = glm::cross(t.b - t.a, t.c - t.a);
        }
        const float lengths = glm::length(normal) * glm::length(direction);
        return std::min(core::divide_or(std::abs(glm::dot(normal, direction)), lengths, 1.0f), 1.0f);
    }

    glm::vec3 transmittance(const core::SurfaceAddress& address, glm::vec3 direction) const {
        const std::uint32_t material = material_of(address.object);
        // Textures and vertex colours need the mesh and the weights, but not where the triangle is.
        SurfaceShape shape;
        shape.mesh = &animation.meshes[static_cast<std::size_t>(animation.objects[address.object].mesh)];
        set_corners(shape, address);
        const scene::Object& object = animation.objects[address.object];
        const scene::Material& m = animation.materials[material];
        const bool by_angle = m.transmission > 0.0f || !m.by_angle.empty();
        const bool is_pane = object.body == scene::Body::slab && !still->media.empty();
        return still->materials.transmittance_at(
            material, shape, *snapshot, by_angle ? cosine_at(address, shape, direction) : 1.0f,
            is_pane ? &*still->media[address.object] : nullptr, object.pane_thickness);
    }

    void fill_air(std::vector<VolumeMedium> volumes) {
        if (still->fog || still->has_volumes) air.emplace(still->fog, std::move(volumes));
    }

    /// Where volumes are as they were, their light stays.
    void pose_volumes(const scene::Snapshot& now) {
        if (!still->has_volumes || now.volumes == volumes) return;
        volumes = now.volumes;
        std::vector<VolumeMedium> media;
        fields.resize(volumes.size());
        for (std::size_t i = 0; i < volumes.size(); ++i) {
            if (!volumes[i].present) continue;
            const scene::Volume& volume = animation.volumes[i];
            PosedField& field = fields[i];
            if (field.field == nullptr || field.file != volumes[i].file)
                field = {volumes[i].file,
                         std::make_shared<const VolumeField>(volume, still->volume_reader.grids(i, volumes[i].file))};
            const VolumeMedium medium(volume, field.field, volumes[i].world_from_object);
            if (!medium.empty()) media.push_back(medium);
        }
        fill_air(std::move(media));
    }

    /// A volume's grids of one file.
    struct PosedField {
        std::size_t file = 0;
        std::shared_ptr<const VolumeField> field;
    };

    const scene::Animation& animation;
    std::shared_ptr<const Still> still;
    std::optional<Air> air;
    std::vector<scene::VolumeState> volumes;
    std::vector<PosedField> fields;
    SampledClock layer_clock;
    RayTracer tracer;
    const scene::Snapshot* snapshot = nullptr;
};

PosedScene::PosedScene(const scene::Animation& animation, core::Isa isa, const Plan& plan, TextureStore* store) {
    std::optional<TextureStore> own;
    impl_ = std::make_unique<Impl>(animation, isa, plan, store != nullptr ? *store : own.emplace(animation));
}
PosedScene::PosedScene(const PosedScene& posed) : impl_(std::make_unique<Impl>(*posed.impl_)) {}
PosedScene::~PosedScene() = default;
PosedScene::PosedScene(PosedScene&&) noexcept = default;

void PosedScene::pose(const scene::Snapshot& snapshot) {
    EXPECTS(snapshot.animation == &impl_->animation);
    impl_->snapshot = &snapshot;
    impl_->pose_volumes(snapshot);
    impl_->tracer.pose(snapshot);
}

const scene::Snapshot& PosedScene::posed() const {
    EXPECTS(impl_->snapshot != nullptr);
    return *impl_->snapshot;
}

const RayTracer& PosedScene::tracer() const {
    return impl_->tracer;
}
const scene::Animation& PosedScene::animation() const {
    return impl_->animation;
}
std::vector<std::string> PosedScene::notes() const {
    std::vector<std::string> all = impl_->still->notes;
    for (const std::string& note : impl_->still->volume_reader.notes()) all.push_back(note);
    return all;
}
double PosedScene::layer_seconds() const {
    return impl_->layer_clock.seconds();
}
const Air* PosedScene::air() const {
    return impl_->air ? &*impl_->air : nullptr;
}
void PosedScene::light_volumes(std::vector<VolumeLight> lights) {
    EXPECTS(impl_->air && (lights.empty() || lights.size() == impl_->air->volumes().size()));
    impl_->air->light(std::move(lights));
}
void PosedScene::darken_air() {
    light_volumes({});
    light_fog({});
}
void PosedScene::light_fog(LitFog light) {
    EXPECTS(impl_->air);
    impl_->air->light(std::move(light));
}

const image::SkyMap* PosedScene::sky() const {
    return impl_->still->sky.get();
}

const Medium* PosedScene::medium_within(std::uint32_t object) const {
    const std::vector<std::optional<Medium>>& media = impl_->still->media;
    return media.empty() || !media[object] ? nullptr : &*media[object];
}
bool PosedScene::has_bodies() const {
    return !impl_->still->media.empty();
}

bool PosedScene::passes_straight(std::uint32_t object) const {
    return impl_->animation.materials[impl_->material_of(object)].transmission > 0.0f &&
           !(has_bodies() && impl_->animation.objects[object].body == scene::Body::solid);
}

SurfacePoint PosedScene::surface_at(const core::SurfaceAddress& address, glm::vec3 outgoing,
                                    const SurfaceFootprint& footprint, float time) const {
    return surface_in({}, Band::all, address, outgoing, footprint, time);
}

SurfacePoint PosedScene::surface_in(const MediaStack& media, Band band, const core::SurfaceAddress& address,
                                    glm::vec3 outgoing, const SurfaceFootprint& footprint, float time,
                                    Holes holes) const {
    const ObjectInstant object(*impl_->snapshot, address.object, time);
    const bool is_strand = object.mesh().has_curves();
    const SurfaceShape shape =
        is_strand ? strand_shape_at(object, address, outgoing, impl_->tracer.is_instanced(address.object))
                  : impl_->shape(object, address, footprint);
    SurfacePoint point;
    point.address = address;
    point.material = impl_->material_of(address.object);
    point.position = shape.position;
    point.position_error = shape.position_error;
    point.outgoing = outgoing;
    point.back_side = glm::dot(shape.front_normal, outgoing) < 0.0f;
    point.geometric_normal = point.back_side ? -shape.front_normal : shape.front_normal;
    if (!is_strand) point.smooth = smooth_surface_at(object, shape, point.back_side);
    float index = 0.0f;
    if (const Medium* medium = medium_within(address.object)) {
        point.bounds_body = true;
        MediaStack around = media;
        if (point.back_side) around.begin_inside(address.object, *medium);
        index = around.index_across(address.object, *medium, point.back_side, band);
    }
    impl_->still->materials.fill(point, shape, object, index, holes);
    return point;
}

SurfacePoint PosedScene::other_side(const SurfacePoint& point, const SurfaceFootprint& footprint, float time) const {
    const glm::vec3 n = point.geometric_normal;
    SurfacePoint other =
        surface_at(point.address, point.outgoing - 2.0f * glm::dot(point.outgoing, n) * n, footprint, time);
    other.bsdf = {};
    other.bsdf.diffuse = point.bsdf.diffuse_transmission;
    other.emission = glm::vec3{0.0f};
    return other;
}

HairScattering PosedScene::hair_at(const SurfacePoint& point, float time) const {
    const ObjectInstant object(*impl_->snapshot, point.address.object, time);
    const StrandPoint strand = strand_at(object, point.address);
    scene::Hair hair = *impl_->animation.materials[point.material].hair;
    if (!object.mesh().colors.empty()) {
        SurfaceShape shape;
        shape.mesh = &object.mesh();
        set_corners(shape, point.address);
        hair.absorption += scene::absorption_of(glm::vec3(vertex_color(shape)), hair.azimuthal_roughness);
    }
    return {hair, {strand.axis, strand.tangent, strand.radius, 2.0f * point.address.v - 1.0f}, point.outgoing};
}

SurfaceShape PosedScene::shape_at(const core::SurfaceAddress& address, float time) const {
    return impl_->shape(ObjectInstant(*impl_->snapshot, address.object, time), address, {});
}

glm::vec3 PosedScene::transmittance_at(const core::SurfaceAddress& address, glm::vec3 direction) const {
    const Opacity known = impl_->still->opacity.at(address);
    return known != Opacity::mixed ? Impl::passing(known) : impl_->transmittance(address, direction);
}

glm::vec3 PosedScene::origin_behind(const core::SurfaceAddress& address, glm::vec3 direction) const {
    const SurfaceShape shape = impl_->shape(address, {});
    const float side = glm::dot(shape.front_normal, -direction) < 0.0f ? 1.0f : -1.0f;
    // In the triangle's plane a ray goes on above it, as offset_origin has it.
    const bool behind = side * glm::dot(direction, shape.front_normal) > 0.0f;
    return shape.position + (behind ? side : -side) * shape.position_error * shape.front_normal;
}

glm::vec3 PosedScene::front_normal(std::uint32_t object, std::uint32_t primitive) const {
    return impl_->shape({object, primitive, 0.0f, 0.0f}, {}).front_normal;
}

glm::vec3 PosedScene::mean_emission(std::uint32_t object, std::uint32_t primitive) const {
    const std::uint32_t material = impl_->material_of(object);
    const scene::Material& m = impl_->animation.materials[material];
    if (m.unlit || !m.emits() || !impl_->snapshot->objects[object].present) return glm::vec3{0.0f};
    const float factor = impl_->snapshot->emission_factor[material];
    SurfaceShape shape = impl_->shape({object, primitive, 0.0f, 0.0f}, {});
    if (!m.emission_texture.present()) return factor * impl_->still->materials.emission_at(material, shape, {});

    // Average over 4 x 4 similar triangles, each filtered over a parallelogram of its area.
    constexpr int split = 4;
    const float side = std::sqrt(0.5f) / split;
    shape.barycentric_dx = {side, 0.0f};
    shape.barycentric_dy = {0.0f, side};
    glm::vec3 sum{0.0f};
    for (int i = 0; i < split; ++i) {
        for (int j = 0; j < 2 * (split - i) - 1; ++j) {
            const float third = j % 2 == 0 ? 1.0f / 3.0f : 2.0f / 3.0f;
            const float u = (static_cast<float>(j / 2) + third) / split, v = (static_cast<float>(i) + third) / split;
            shape.weights = {1.0f - u - v, u, v};
            sum += impl_->still->materials.emission_at(material, shape, {});
        }
    }
    return factor * sum / static_cast<float>(split * split);
}

glm::vec3 PosedScene::mean_emission(const core::SurfaceAddress& address, const SurfaceFootprint& footprint) const {
    const std::uint32_t material = impl_->material_of(address.object);
    return impl_->snapshot->emission_factor[material] *
           impl_->still->materials.emission_at(material, impl_->shape(address, footprint), {});
}

SurfaceFootprint PosedScene::normal_change(const core::SurfaceAddress& address, const SurfaceFootprint& footprint,
                                           float time) const {
    const ObjectInstant object(*impl_->snapshot, address.object, time);
    if (object.mesh().has_curves()) return {};
    const SurfaceShape shape = impl_->shape(object, address, footprint);
    const auto change = [&](glm::vec2 d) {
        // Beyond the triangle's neighbours its own curvature says nothing.
        const glm::vec2 step = glm::clamp(d, glm::vec2{-1.0f}, glm::vec2{1.0f});
        return smooth_normal_at(object, shape, address.u + step.x, address.v + step.y) - shape.smooth_normal;
    };
    return {change(shape.barycentric_dx), change(shape.barycentric_dy)};
}

glm::vec3 offset_origin(const SurfacePoint& point, glm::vec3 direction) {
    const bool behind = glm::dot(direction, point.geometric_normal) < 0.0f;
    return point.position + (behind ? -point.position_error : point.position_error) * point.geometric_normal;
}

float brightest_of_rays(const image::SkyMap* sky) {
    return sky == nullptr || sky->uniform() ? std::numeric_limits<float>::infinity()
                                            : 8.0f * core::luminance(sky->mean());
}

}  // namespace render2mpeg::renderer
