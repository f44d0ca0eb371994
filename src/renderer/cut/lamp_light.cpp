#include "renderer/cut/lamp_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/lobe.h"
#include "renderer/cut/lamp_irradiance.h"
#include "renderer/cut/shadow_rays.h"

namespace render2mpeg::renderer {
namespace {

/// Samples of a lane, step by step; the last are all that there are.
constexpr std::array<int, 5> steps{4, 16, 64, 256, 1024};
constexpr int all = steps.back();

/// Of its tolerance, the standard error that a lane's light may have since its lamp is sampled. chosen: 1/8 of 1/16 to
/// 1/2; what errs most decides how finely all the rest is gathered (cornell at 2 %: 22 million rays at 1/8, 23 at 1/16,
/// 28 at 1/4).
constexpr float part_of_tolerance = 0.125f;

/// Samples that lobes see where no ray is traced to each; they stand for discs of so many parts of the lamp. chosen: 16
/// of 16 and 64.
constexpr int of_lobes = 16;

/// Element `i` of the (0, 2)-sequence of Sobol: aligned runs of 4, 16 and 64 are stratified in both dimensions and
/// jointly [Sobol1967].
glm::vec2 sobol(std::uint32_t i) {
    std::uint32_t x = 0, y = 0, first = 0x80000000u, second = 0x80000000u;
    for (; i != 0; i >>= 1, first >>= 1, second ^= second >> 1) {
        if ((i & 1u) == 0) continue;
        x ^= first;
        y ^= second;
    }
    return {(static_cast<float>(x >> 8) + 0.5f) * 0x1p-24f, (static_cast<float>(y >> 8) + 0.5f) * 0x1p-24f};
}

/// All samples.
const std::array<glm::vec2, all> pattern = [] {
    std::array<glm::vec2, all> p;
    for (std::uint32_t i = 0; i < p.size(); ++i) p[i] = sobol(i);
    return p;
}();

/// Which sample a lane of a group takes as its k-th: the aligned runs of 4, 16, 64, 256 about a place of its own. The
/// sixty-fours of sixteen lanes are all samples, and their fours lie in all parts of the lamp. Groups of other sets of
/// representatives begin elsewhere.
std::size_t sample_index(int set, int lane, int k) {
    const int turned = (lane + 4 * set) & (lane_count - 1);
    const int own = 64 * turned + 4 * ((turned * 5 + turned / 4) & (lane_count - 1));
    return static_cast<std::size_t>(own ^ k);
}

/// A disc of radius 1, evenly, so that strata stay compact [Shirley1997].
glm::vec2 disc(glm::vec2 u) {
    const glm::vec2 p = 2.0f * u - 1.0f;
    if (p == glm::vec2(0)) return p;
    constexpr float quarter = std::numbers::pi_v<float> / 4;
    const bool wide = std::abs(p.x) > std::abs(p.y);
    const float r = wide ? p.x : p.y, turn = wide ? quarter * (p.y / p.x) : 2 * quarter - quarter * (p.x / p.y);
    return r * glm::vec2(std::cos(turn), std::sin(turn));
}

/// A place on a convex polygon, evenly: parallelograms keep the strata.
glm::vec3 on_polygon(const std::vector<glm::vec3>& c, glm::vec2 u) {
    if (c.size() == 4 && glm::length(c[0] + c[2] - c[1] - c[3]) <= 1e-4f * glm::length(c[2] - c[0]))
        return c[0] + u.x * (c[1] - c[0]) + u.y * (c[3] - c[0]);
    float area = 0;
    for (std::size_t i = 2; i < c.size(); ++i) area += glm::length(glm::cross(c[i - 1] - c[0], c[i] - c[0]));
    float left = u.x * area;
    for (std::size_t i = 2; i < c.size(); ++i) {
        const glm::vec3 a = c[i - 1] - c[0], b = c[i] - c[0];
        const float part = glm::length(glm::cross(a, b));
        if (left > part && i + 1 < c.size()) {
            left -= part;
            continue;
        }
        const glm::vec2 uv = core::sample_triangle({core::divide_or(std::min(left, part), part, 0.0f), u.y});
        return c[0] + uv.x * a + uv.y * b;
    }
    return c[0];
}

glm::vec3 at(const Vec3Lanes& lanes, int i) {
    return {lanes.x[i], lanes.y[i], lanes.z[i]};
}

void set(Vec3Lanes& lanes, int i, glm::vec3 v) {
    lanes.x[i] = v.x;
    lanes.y[i] = v.y;
    lanes.z[i] = v.z;
}

/// A sample of the lamp for each lane, as lights, and where their shadow rays end.
struct Samples {
    LightPacket lights;
    Vec3Lanes targets;

    void take_polygon(const WholeLamp& lamp, const GatherLanes& lanes, int lane, glm::vec2 u) {
        const glm::vec3 place = on_polygon(lamp.corners, u);
        const bool behind = lamp.two_sided && glm::dot(at(lanes.position, lane) - place, lamp.normal) < 0;
        const glm::vec3 normal = behind ? -lamp.normal : lamp.normal;
        set(lights.position, lane, place + lamp.clearance * normal);
        set(lights.normal, lane, normal);
        set(targets, lane, place + lamp.clearance * normal);
        lights.disc2[lane] = lamp.area / static_cast<float>(of_lobes) * lobe::inverse_pi;
    }

    /// The disc that the cone from the lane touches the sphere in; rays end where they enter the sphere.
    void take_sphere(const WholeLamp& lamp, const GatherLanes& lanes, int lane, glm::vec2 u) {
        const glm::vec3 origin = at(lanes.origin, lane), to_lamp = lamp.position - origin;
        const float distance = std::max(glm::length(to_lamp), lamp.radius * 1.0001f), sine = lamp.radius / distance;
        const glm::vec3 axis = core::normalize_or(to_lamp, {0, 0, 1});
        glm::vec3 tangent, bitangent;
        core::make_frame(axis, tangent, bitangent);
        const float half = lamp.radius * core::sqrt_or_zero(1 - sine * sine);
        const glm::vec2 q = half * disc(u);
        const glm::vec3 place = origin + axis * (distance * (1 - sine * sine)) + q.x * tangent + q.y * bitangent;
        set(lights.position, lane, place);
        set(lights.normal, lane, -axis);
        lights.disc2[lane] = half * half / static_cast<float>(of_lobes);
        const glm::vec3 direction = core::normalize_or(place - origin, axis);
        const float outer = lamp.radius + lamp.clearance, along = glm::dot(to_lamp, direction);
        const float enters =
            along - core::sqrt_or_zero(outer * outer - std::max(distance * distance - along * along, 0.0f));
        set(targets, lane, origin + std::max(enters, 0.0f) * direction);
    }

    void take_sun(const WholeLamp& lamp, int lane, glm::vec2 u) {
        glm::vec3 tangent, bitangent;
        core::make_frame(lamp.position, tangent, bitangent);
        // Evenly by solid angle: 1 - cos grows as the disc's squared radius.
        const float cosine = core::sqrt_or_zero(1 - lamp.radius * lamp.radius);
        const float most = lamp.radius * lamp.radius / (1 + cosine);  // 1 - cos
        const glm::vec2 p = disc(u);
        const float lowered = most * glm::dot(p, p), scale = core::sqrt_or_zero(most * (2 - lowered));
        const glm::vec3 direction = (1 - lowered) * lamp.position + scale * (p.x * tangent + p.y * bitangent);
        set(lights.position, lane, direction);
        set(lights.normal, lane, -direction);
        set(targets, lane, direction);
        lights.disc2[lane] = 2 * most / static_cast<float>(of_lobes);  // solid angle over pi
    }

    void take(const WholeLamp& lamp, const GatherLanes& lanes, int k) {
        for (int i = 0; i < lane_count; ++i) {
            const glm::vec2 u = pattern[sample_index(lanes.set, i, k)];
            switch (lamp.kind) {
                case WholeLamp::Kind::polygon:
                    take_polygon(lamp, lanes, i, u);
                    break;
                case WholeLamp::Kind::sphere:
                    take_sphere(lamp, lanes, i, u);
                    break;
                case WholeLamp::Kind::sun:
                    take_sun(lamp, i, u);
                    break;
            }
            lights.spot_scale[i] = lights.spot_offset[i] = 0.0f;
        }
    }
};

/// Sums over samples, lane by lane.
struct alignas(64) SampleSums {
    Lanes weight{}, seen{};  ///< of G, all and visible
    LightLanes lit{};        ///< what visible samples send
    Lanes whole_weight{};    ///< of samples without rays, for lobes
    LightLanes whole{};      ///< likewise
    Lanes passed[3]{};       ///< of visible G, times what translucent surfaces let through
    int traced[lane_count]{};

    bool is_dark(std::uint32_t asked) const {
        for (int i = 0; i < lane_count; ++i)
            if ((asked >> i & 1u) != 0 && seen[i] > 0) return false;
        return true;
    }
};

/// What samples send to the lanes, and their geometry terms alone.
void evaluate(const WholeLamp& lamp, const GatherLanes& lanes, const Samples& samples, LightLanes& unit, Lanes& g) {
    const LightPacket& p = samples.lights;
    evaluate_lights(lanes, type_of(lamp), p, GeometryClamp::none(), unit);
    if (!lanes.glossy) {
        std::copy(std::begin(unit.diffuse), std::end(unit.diffuse), std::begin(g));
        return;
    }
    // A lobe takes its part of what it covers.
    for (int i = 0; i < lane_count; ++i) {
        glm::vec3 to_light = at(p.position, i);
        float emitted = 1;
        if (type_of(lamp) == LightType::oriented) {
            to_light -= at(lanes.position, i);
            const float inverse = 1 / std::sqrt(std::max(glm::dot(to_light, to_light), lobe::tiny));
            to_light *= inverse;
            emitted = std::max(-glm::dot(at(p.normal, i), to_light), 0.0f) * inverse * inverse;
        }
        const bool in_front = glm::dot(at(lanes.geometric, i), to_light) > 0;
        g[i] = in_front ? std::max(glm::dot(at(lanes.normal.axis, i), to_light), 0.0f) * emitted : 0.0f;
    }
}

void add_lanes(const LightLanes& unit, const Lanes& share, bool glossy, LightLanes& sum) {
    for (int i = 0; i < lane_count; ++i) {
        sum.diffuse[i] += share[i] * unit.diffuse[i];
        if (!glossy) continue;
        sum.f0[i] += share[i] * unit.f0[i];
        sum.schlick[i] += share[i] * unit.schlick[i];
    }
}

/// Looks at samples k of the lanes in `asked`.
void trace_samples(const WholeLamp& lamp, const GatherLanes& lanes, bool translucent, std::uint32_t asked, int k,
                   ShadowTester& shadows, SampleSums& sums) {
    Samples samples;
    samples.take(lamp, lanes, k);
    LightLanes unit;
    alignas(64) Lanes g, visible{};
    evaluate(lamp, lanes, samples, unit, g);
    ShadowPacket packet;
    aim<Aimed::at_each>(lanes, type_of(lamp), samples.targets.x, samples.targets.y, samples.targets.z, packet);
    packet.active = 0;
    for (int i = 0; i < lane_count; ++i) packet.active |= (asked >> i & 1u) != 0 && g[i] > 0.0f ? 1u << i : 0u;
    glm::vec3 passes[lane_count];
    std::fill(std::begin(passes), std::end(passes), glm::vec3(1));
    const std::uint32_t hidden = packet.active == 0 ? 0 : shadows.blocked(packet, translucent ? passes : nullptr);
    for (int i = 0; i < lane_count; ++i) {
        if ((asked >> i & 1u) == 0) continue;
        ++sums.traced[i];
        visible[i] = (hidden >> i & 1u) != 0 ? 0.0f : 1.0f;
        sums.weight[i] += g[i];
        sums.seen[i] += visible[i] * g[i];
        for (int c = 0; c < 3; ++c) sums.passed[c][i] += visible[i] * g[i] * passes[i][c];
    }
    add_lanes(unit, visible, lanes.glossy, sums.lit);
}

/// What lobes see of the whole lamp, without rays.
void add_whole(const WholeLamp& lamp, const GatherLanes& lanes, SampleSums& sums) {
    Samples samples;
    LightLanes unit;
    alignas(64) Lanes g, every;
    std::fill(std::begin(every), std::end(every), 1.0f);
    for (int k = 0; k < of_lobes; ++k) {
        samples.take(lamp, lanes, k);
        evaluate(lamp, lanes, samples, unit, g);
        for (int i = 0; i < lane_count; ++i) sums.whole_weight[i] += g[i];
        add_lanes(unit, every, true, sums.whole);
    }
}

float visible_share(const SampleSums& sums, int lane) {
    return std::min(core::divide_or(sums.seen[lane], sums.weight[lane], 0.0f), 1.0f);
}

/// Of these lanes, which took `count` samples each: those whose light may still be off by too much. What errs are the
/// strata that a shadow's edge crosses, sqrt(n) of n, so that the visible share v is known to
/// 0.6 sqrt(v (1 - v)) n^(-3/4). Where all lanes see all of the lamp, or nothing, their samples count together, and a
/// share of one sample may have been missed.
std::uint32_t too_rough(const SampleSums& sums, std::uint32_t reached, int count, const Lanes& luminance,
                        const LampAccuracy& accuracy, Lanes& errors) {
    std::uint32_t lit = 0, dark = 0;
    for (int i = 0; i < lane_count; ++i) {
        if ((reached >> i & 1u) == 0) continue;
        const float share = visible_share(sums, i);
        lit |= share > 0 ? 1u << i : 0u;
        dark |= share < 1 ? 1u << i : 0u;
    }
    const bool agree = lit == 0 || dark == 0;
    const auto n = static_cast<float>(agree ? count * __builtin_popcount(reached) : count);
    const float digits = 0.6f / (std::sqrt(n) * std::sqrt(std::sqrt(n)));
    std::uint32_t lanes = 0;
    for (int i = 0; i < lane_count; ++i) {
        if ((reached >> i & 1u) == 0) continue;
        const float share = visible_share(sums, i), inside = std::clamp(share, 1 / n, 1 - 1 / n);
        errors[i] = luminance[i] * digits * std::sqrt(inside * (1 - inside));
        const GroupTolerance& t = *accuracy.tolerance;
        const float light = t.base[i] + (*accuracy.luminance)[i] + share * luminance[i];
        const float allowed = core::Tolerance{t.absolute[i], t.relative[i], t.background[i]}.allows(light);
        lanes |= errors[i] > part_of_tolerance * allowed ? 1u << i : 0u;
    }
    return lanes;
}

/// Traces as many samples of the lanes in `reached` as their tolerances ask for, by trace(lanes, first, end). `whole`:
/// their irradiance without occlusion.
template <class Trace>
void trace_as_needed(const WholeLamp& lamp, const GatherLanes& lanes, const Lanes& whole, std::uint32_t reached,
                     const LampAccuracy& accuracy, ShadowTester& shadows, const Trace& trace, const SampleSums& sums,
                     Lanes& errors) {
    LightLanes unshadowed{};
    std::copy(std::begin(whole), std::end(whole), std::begin(unshadowed.diffuse));
    alignas(64) Lanes luminance{};
    add_luminance(lanes, unit_light(lanes, unshadowed), lamp.radiance, luminance);
    std::uint32_t asked = reached;
    for (std::size_t s = 0; s < steps.size() && asked != 0; ++s) {
        trace(asked, s == 0 ? 0 : steps[s - 1], steps[s]);
        asked = too_rough(sums, asked, steps[s], luminance, accuracy, errors);
        // What seems dark may be so for certain.
        if (s == 0 && asked == reached && sums.is_dark(reached)) {
            std::uint16_t viable = GroupOccluders::all;
            if (!shadows.is_occluded(type_of(lamp), lamp.box, viable)) continue;
            std::fill(std::begin(errors), std::end(errors), 0.0f);
            return;
        }
    }
}

}  // namespace

void gather_lamp(const WholeLamp& lamp, const GatherLanes& lanes, bool translucent, const LampAccuracy& accuracy,
                 ShadowTester& shadows, LampLight& out) {
    // What arrives if nothing is in the way,
    alignas(64) Lanes whole{};
    std::uint32_t reached = 0;
    for (int i = 0; i < lanes.count; ++i) {
        whole[i] = unoccluded_irradiance(lamp, at(lanes.position, i), at(lanes.normal.axis, i));
        reached |= whole[i] > 0.0f ? 1u << i : 0u;
    }
    for (Lanes* part : {&out.unit.diffuse, &out.unit.f0, &out.unit.schlick}) std::fill(*part, *part + lane_count, 0.0f);
    out.unit.any_clamped = false;
    std::fill(&out.tint.passes[0][0], &out.tint.passes[0][0] + lane_count * 3, 1.0f);
    if (reached == 0) return;

    // and the share of the lamp that is seen, by more samples where its edge or a shadow's is.
    SampleSums sums;
    const auto trace = [&](std::uint32_t asked, int first, int end) {
        for (int k = first; asked != 0 && k < end; ++k)
            trace_samples(lamp, lanes, translucent, asked, k, shadows, sums);
    };
    if (accuracy.tolerance == nullptr)
        trace(reached, 0, all);
    else
        trace_as_needed(lamp, lanes, whole, reached, accuracy, shadows, trace, sums, out.error);

    if (lanes.glossy) add_whole(lamp, lanes, sums);
    for (int i = 0; i < lane_count; ++i) {
        if ((reached >> i & 1u) == 0) continue;
        const float share = visible_share(sums, i);
        out.unit.diffuse[i] = whole[i] * share;
        for (int c = 0; translucent && c < 3; ++c)
            out.tint.passes[i][c] = core::divide_or(sums.passed[c][i], sums.seen[i], 1.0f);
        if (!lanes.glossy) continue;
        const bool by_rays = sums.traced[i] >= of_lobes;
        const LightLanes& sent = by_rays ? sums.lit : sums.whole;
        const float scale = by_rays ? core::divide_or(whole[i], sums.weight[i], 0.0f)
                                    : share * core::divide_or(whole[i], sums.whole_weight[i], 0.0f);
        out.unit.diffuse[i] = scale * sent.diffuse[i];
        out.unit.f0[i] = scale * sent.f0[i];
        out.unit.schlick[i] = scale * sent.schlick[i];
    }
}

}  // namespace render2mpeg::renderer
