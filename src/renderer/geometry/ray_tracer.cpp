#include "renderer/geometry/ray_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "core/error.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/base/isa_clones.h"
#include "renderer/base/light_packing.h"
#include "renderer/geometry/embree.h"
#include "renderer/geometry/embree_scene.h"
#include "renderer/geometry/nearest_hits.h"

namespace render2mpeg::renderer {
namespace {

/// Light behind several layers is a product, and a packet does not promise in which order its layers are met. Sums of
/// whole numbers do not depend on order: light is kept as its negative logarithm to base 2 in these steps, exact to
/// 1e-6.
constexpr float optical_steps = 0x1p20f;
constexpr std::int64_t opaque_depth = std::int64_t{1} << 32;  ///< 2^-4096

/// Boxes of moving objects. More are not asked one by one.
constexpr std::size_t most_boxes = 64;

/// Boxes are taken for so much larger than they are, against rounding: a share of their size and of where they lie.
constexpr float box_slack = 0x1p-16f;

/// Whether a ray may pass through a box at a distance in (0, far).
bool may_cross(const MiddleBox& box, glm::vec3 origin, glm::vec3 direction, float far) {
    float in = 0.0f, out = far;
    for (int axis = 0; axis < 3; ++axis) {
        const float half = box.half[axis] + box_slack * (box.half[axis] + std::abs(box.middle[axis]) +
                                                         std::abs(origin[axis] - box.middle[axis]));
        const float to = box.middle[axis] - origin[axis];
        if (direction[axis] == 0.0f) {
            if (std::abs(to) > half) return false;
            continue;
        }
        const float inverse = 1.0f / direction[axis], a = (to - half) * inverse, b = (to + half) * inverse;
        in = std::max(in, std::min(a, b));
        out = std::min(out, std::max(a, b));
    }
    return in <= out * (1.0f + box_slack);
}

/// 1 or 0, without a branch; 0 for NaN.
RENDER2MPEG_ALWAYS_INLINED int fits(float v) {
    return inlined::abs(v) <= largest_component ? 1 : 0;
}

/// Copies a packet's rays and marks those that can be traced. Returns whether there are any.
RENDER2MPEG_CLONES
bool load(const ShadowPacket& packet, RTCRay16& rays, int* valid) {
    int any = 0;
    for (int i = 0; i < 16; ++i) {
        const int asked = static_cast<int>(packet.active >> i & 1u);
        const int traced = asked & fits(packet.origin_x[i]) & fits(packet.origin_y[i]) & fits(packet.origin_z[i]) &
                           fits(packet.direction_x[i]) & fits(packet.direction_y[i]) & fits(packet.direction_z[i]) &
                           (packet.far[i] > 0.0f ? 1 : 0);
        valid[i] = -traced;
        any |= traced;
    }
    for (int i = 0; i < 16; ++i) {
        const bool traced = valid[i] != 0;
        rays.org_x[i] = traced ? packet.origin_x[i] : 0.0f;
        rays.org_y[i] = traced ? packet.origin_y[i] : 0.0f;
        rays.org_z[i] = traced ? packet.origin_z[i] : 0.0f;
        rays.dir_x[i] = traced ? packet.direction_x[i] : 0.0f;
        rays.dir_y[i] = traced ? packet.direction_y[i] : 0.0f;
        rays.dir_z[i] = traced ? packet.direction_z[i] : 0.0f;
        rays.tnear[i] = 0.0f;
        rays.tfar[i] = traced ? packet.far[i] : 0.0f;
        rays.time[i] = traced && packet.times != nullptr ? packet.times[i] : scene::middle_time;
        rays.mask[i] = 0xffffffffu;
        rays.id[i] = static_cast<unsigned>(i);
        rays.flags[i] = 0;
    }
    return any != 0;
}

/// Bit i: ray i was traced and met something. Such rays are traced no more.
RENDER2MPEG_CLONES
std::uint32_t take_blocked(const RTCRay16& rays, int* valid) {
    std::uint32_t blocked = 0;
    for (int i = 0; i < 16; ++i) {
        const bool hit = valid[i] != 0 && rays.tfar[i] < 0.0f;
        blocked |= hit ? 1u << i : 0u;
        valid[i] = hit ? 0 : valid[i];
    }
    return blocked;
}

}  // namespace

struct RayTracer::Impl {
    EmbreeScene scene;
    Transmittance transmittance;
    std::vector<MiddleBox> dynamic_objects;
    LayerLimit limit;

    struct Layer {
        std::uint32_t object;
        float distance;
    };
    /// Context that Embree hands through to our filters; its own part comes first, so that its pointer is ours.
    struct ShadowContext {
        embree::Context embree;
        const Impl* self;
        Bodies bodies;
        const float* direction[3];    ///< of the rays, in world space: x, y, z
        std::uint32_t met;            ///< bit i: ray i met a layer
        int known[16];                ///< layers so far
        int layers[16];               ///< of them those that take light
        int covers[16];               ///< of them those that the animation limits, holes included
        Layer layer[16][max_layers];  ///< the first of them
        std::unique_ptr<std::array<std::vector<Layer>, 16>> further;  ///< the others; null: there are none
        std::int64_t depth[16][3];                                    ///< optical depth so far, per channel

        glm::vec3 direction_of(unsigned ray) const { return {direction[0][ray], direction[1][ray], direction[2][ray]}; }

        bool is_known(unsigned ray, const Layer& met) const {
            const auto same = [&](const Layer& other) {
                return other.object == met.object && std::abs(other.distance - met.distance) <= coplanar * met.distance;
            };
            const Layer* first = layer[ray];
            if (std::any_of(first, first + std::min(known[ray], max_layers), same)) return true;
            return further && std::any_of((*further)[ray].begin(), (*further)[ray].end(), same);
        }

        void note(unsigned ray, const Layer& met) {
            if (known[ray] < max_layers) {
                layer[ray][known[ray]] = met;
            } else {
                if (!further) further = std::make_unique<std::array<std::vector<Layer>, 16>>();
                (*further)[ray].push_back(met);
            }
            ++known[ray];
        }

        /// Counts a layer, unless it takes nothing (foliage has many holes) and is not limited, or is known: a ray
        /// through an edge meets both its triangles, and Embree asks several times for one hit where the rays of a
        /// coherent packet lie in several octants.
        bool is_new_layer(unsigned ray, const Layer& met, glm::vec3 passing) {
            const bool takes = passing != glm::vec3{1.0f}, limited = self->limit.counts(met.object);
            if ((!takes && !limited) || is_known(ray, met)) return false;
            note(ray, met);
            layers[ray] += takes ? 1 : 0;
            covers[ray] += limited ? 1 : 0;
            return true;
        }
    };
    /// Prepares `context` for rays that may meet layers; costs nothing where there are none. `x`, `y`, `z`: their
    /// directions, which outlive it.
    void begin(ShadowContext& context, bool coherent, Bodies bodies, const float* x, const float* y,
               const float* z) const {
        context.embree.coherent = coherent;
        context.met = 0;
        if (!scene.any_translucent()) return;
        context.self = this;
        context.bodies = bodies;
        context.direction[0] = x;
        context.direction[1] = y;
        context.direction[2] = z;
        std::fill_n(context.known, 16, 0);
        std::fill_n(context.layers, 16, 0);
        std::fill_n(context.covers, 16, 0);
        std::fill_n(&context.depth[0][0], 48, std::int64_t{0});
    }

    static glm::vec3 light_through(const std::int64_t (&depth)[3]) {
        glm::vec3 light;
        for (int c = 0; c < 3; ++c) light[c] = std::exp2(-static_cast<float>(depth[c]) / optical_steps);
        return light;
    }

    static void filter_shadow(const RTCFilterFunctionNArguments* arguments);

    /// Result of RayTracer::occluded for baked geometry and these instances.
    std::uint32_t occluded(const ShadowPacket& packet, unsigned instances, glm::vec3* light) const;
};

/// Lets a shadow ray go on through a layer: takes the absorbed light, until nothing is left or there
/// were too many.
void RayTracer::Impl::filter_shadow(const RTCFilterFunctionNArguments* arguments) {
    auto& context = embree::context_of<ShadowContext>(arguments);
    const unsigned n = arguments->N;
    for (unsigned i = 0; i < n; ++i) {
        if (arguments->valid[i] != -1) continue;
        const unsigned ray = RTCRayN_id(arguments->ray, n, i);
        RTCHitN* const hit = arguments->hit;
        const core::SurfaceAddress address =
            context.self->scene.address(RTCHitN_instID(hit, n, i, 0), RTCHitN_geomID(hit, n, i),
                                        RTCHitN_primID(hit, n, i), RTCHitN_u(hit, n, i), RTCHitN_v(hit, n, i));
        const glm::vec3 passing = context.self->transmittance(address, context.direction_of(ray), context.bodies);
        if (!(passing.x > 0 || passing.y > 0 || passing.z > 0)) continue;
        if (!context.is_new_layer(ray, {address.object, RTCRayN_tfar(arguments->ray, n, i)}, passing)) {
            arguments->valid[i] = 0;
            continue;
        }
        if (context.layers[ray] > max_layers || context.self->limit.ends(context.covers[ray])) continue;
        for (int c = 0; c < 3; ++c) {
            context.depth[ray][c] +=
                passing[c] > 0 ? std::llround(-std::log2(std::min(passing[c], 1.0f)) * optical_steps) : opaque_depth;
        }
        context.met |= 1u << ray;
        arguments->valid[i] = 0;
    }
}

std::uint32_t RayTracer::Impl::occluded(const ShadowPacket& packet, unsigned instances, glm::vec3* light) const {
    const FlushDenormals flushed;
    alignas(64) int valid[16];
    RTCRayHit16 packet_hits;
    RTCRay16& rays = packet_hits.ray;
    if (!load(packet, rays, valid)) return 0;

    ShadowContext context;
    begin(context, true, packet.bodies, packet.direction_x, packet.direction_y, packet.direction_z);
    embree::occluded(valid, scene.baked(), context.embree, packet_hits);
    std::uint32_t blocked = take_blocked(rays, valid);
    const bool all_blocked = std::all_of(valid, valid + 16, [](int v) { return v == 0; });
    if (!all_blocked && instances != 0) {
        // Rays that nothing baked blocks may meet instances.
        std::fill(std::begin(rays.mask), std::end(rays.mask), instances);
        context.embree.coherent = false;
        embree::occluded(valid, scene.root(), context.embree, packet_hits);
        blocked |= take_blocked(rays, valid);
    }
    if (light != nullptr && context.met != 0) {
        for (int i = 0; i < 16; ++i)
            if ((context.met >> i) & 1u) light[i] *= light_through(context.depth[i]);
    }
    return blocked;
}

RayTracer::RayTracer(const scene::Animation& animation, core::Isa isa, std::vector<bool> translucent,
                     Transmittance transmittance)
    : impl_(new Impl{EmbreeScene(animation, isa, std::move(translucent), &Impl::filter_shadow),
                     std::move(transmittance),
                     {},
                     LayerLimit(animation)}) {}

RayTracer::RayTracer(const RayTracer& posed, Transmittance transmittance)
    : impl_(new Impl{EmbreeScene(posed.impl_->scene), std::move(transmittance), {}, posed.impl_->limit}) {}

RayTracer::~RayTracer() = default;
RayTracer::RayTracer(RayTracer&&) noexcept = default;

void RayTracer::pose(const scene::Snapshot& snapshot) {
    impl_->scene.pose(snapshot);
    impl_->dynamic_objects = impl_->scene.dynamic_object_boxes();
}

const LayerLimit& RayTracer::limit() const {
    return impl_->limit;
}

bool RayTracer::is_instanced(std::uint32_t object) const {
    return impl_->scene.is_instanced(object);
}

Hit RayTracer::nearest(glm::vec3 origin, glm::vec3 direction, float far, float time) const {
    return nearest_hit(impl_->scene, {origin, direction, far, time});
}

void RayTracer::nearest(std::span<const RayQuery> rays, std::span<Hit> hits) const {
    EXPECTS(hits.size() == rays.size());
    nearest_hits(impl_->scene, rays, hits);
}

void RayTracer::any_nearest(std::span<const RayQuery> rays, std::span<Hit> hits, bool coherent) const {
    EXPECTS(rays.size() == hits.size());
    any_nearest_hits(impl_->scene, rays, hits, coherent);
}

Hit RayTracer::nearest_of(std::uint32_t object, const RayQuery& ray) const {
    return nearest_hit_of(impl_->scene, object, ray);
}

bool RayTracer::meets(glm::vec3 origin, glm::vec3 direction, float far) const {
    return meets_any(impl_->scene.root(), 0xffffffffu, {origin, direction, far});
}

bool RayTracer::may_meet_dynamic(glm::vec3 origin, glm::vec3 direction, float far) const {
    const std::vector<MiddleBox>& boxes = impl_->dynamic_objects;
    return boxes.size() > most_boxes ? has_dynamic_objects()
                                     : std::any_of(boxes.begin(), boxes.end(), [&](const MiddleBox& box) {
                                           return may_cross(box, origin, direction, far);
                                       });
}

bool RayTracer::has_dynamic_objects() const {
    return impl_->scene.has_dynamic_objects();
}

std::uint32_t RayTracer::occluded(const ShadowPacket& packet, glm::vec3* light) const {
    return impl_->occluded(packet, impl_->scene.has_instances() ? EmbreeScene::instance_mask : 0, light);
}

glm::vec3 RayTracer::passes(glm::vec3 origin, glm::vec3 direction, float far, Bodies bodies) const {
    const RayQuery query{origin, direction, far};
    if (!is_traceable(query)) return glm::vec3{1.0f};
    const FlushDenormals flushed;
    Impl::ShadowContext context;
    impl_->begin(context, false, bodies, &query.direction.x, &query.direction.y, &query.direction.z);
    RTCRay ray = ray_of(query, 0.0f, far);
    embree::occluded(impl_->scene.root(), context.embree, ray);
    if (ray.tfar < 0.0f) return glm::vec3{0.0f};
    return context.met != 0 ? Impl::light_through(context.depth[0]) : glm::vec3{1.0f};
}

}  // namespace render2mpeg::renderer
