#include "renderer/cut/cut_sums.h"

#include <algorithm>

#include "renderer/base/isa_clones.h"

namespace render2mpeg::renderer {
namespace {

RENDER2MPEG_ALWAYS_INLINED void add_to(RgbLanes& __restrict sum, const Lanes& __restrict unit,
                                       const float (*__restrict passes)[3], const glm::vec3& intensity) {
    const float red = intensity.x, green = intensity.y, blue = intensity.z;
    if (passes == nullptr) {
        for (int i = 0; i < lane_count; ++i) {
            sum.r[i] += unit[i] * red;
            sum.g[i] += unit[i] * green;
            sum.b[i] += unit[i] * blue;
        }
        return;
    }
    for (int i = 0; i < lane_count; ++i) {
        sum.r[i] += unit[i] * passes[i][0] * red;
        sum.g[i] += unit[i] * passes[i][1] * green;
        sum.b[i] += unit[i] * passes[i][2] * blue;
    }
}

RENDER2MPEG_ALWAYS_INLINED void add_to(RgbLanes& __restrict sum, const Lanes& __restrict unit,
                                       const Vec3Lanes& __restrict intensity) {
    for (int i = 0; i < lane_count; ++i) {
        sum.r[i] += unit[i] * intensity.x[i];
        sum.g[i] += unit[i] * intensity.y[i];
        sum.b[i] += unit[i] * intensity.z[i];
    }
}

void add_to(RgbLanes& sum, const RgbLanes& part) {
    for (int i = 0; i < lane_count; ++i) {
        sum.r[i] += part.r[i];
        sum.g[i] += part.g[i];
        sum.b[i] += part.b[i];
    }
}

}  // namespace

CutSums::CutSums(const GatherLanes& lanes) : lanes_(lanes) {}

RENDER2MPEG_CLONES
void CutSums::add(const UnitLight& unit, const glm::vec3& intensity, bool direct) {
    RgbLanes& irradiance = direct ? part_.direct : part_.indirect;
    add_to(irradiance, unit.diffuse, unit.passes, intensity);
    if (unit.f0 != nullptr) {
        add_to(part_.f0, *unit.f0, unit.passes, intensity);
        add_to(part_.schlick, *unit.schlick, unit.passes, intensity);
    }
    if (++in_part_ == part_length) flush();
}

RENDER2MPEG_CLONES
void CutSums::add(const RgbLanes& irradiance, const Lanes& share, bool direct) {
    RgbLanes& sum = direct ? part_.direct : part_.indirect;
    for (int i = 0; i < lane_count; ++i) {
        sum.r[i] += irradiance.r[i] * share[i];
        sum.g[i] += irradiance.g[i] * share[i];
        sum.b[i] += irradiance.b[i] * share[i];
    }
    if (++in_part_ == part_length) flush();
}

RENDER2MPEG_CLONES
void CutSums::add(const UnitLight& unit, const Vec3Lanes& intensity, bool direct) {
    add_to(direct ? part_.direct : part_.indirect, unit.diffuse, intensity);
    if (unit.f0 != nullptr) {
        add_to(part_.f0, *unit.f0, intensity);
        add_to(part_.schlick, *unit.schlick, intensity);
    }
    if (++in_part_ == part_length) flush();
}

void CutSums::add_clamped(const TreeLight& light, const UnitLight& visible, const glm::vec3& intensity,
                          GeometryClamp clamp) {
    LightLanes full;
    evaluate_light(lanes_, LightType::oriented, light, nullptr, GeometryClamp{1.0f, clamp.by_rays}, full);
    for (int i = 0; i < lane_count; ++i) {
        const bool lit = visible.diffuse[i] > 0.0f;
        full.diffuse[i] = lit ? std::max(full.diffuse[i] - visible.diffuse[i], 0.0f) : 0.0f;
        if (visible.f0 == nullptr) continue;
        full.f0[i] = lit ? std::max(full.f0[i] - (*visible.f0)[i], 0.0f) : 0.0f;
        full.schlick[i] = lit ? std::max(full.schlick[i] - (*visible.schlick)[i], 0.0f) : 0.0f;
    }
    add_luminance(lanes_, unit_light(lanes_, full), intensity, clamped_);
}

void CutSums::flush() {
    add_to(whole_.direct, part_.direct);
    add_to(whole_.indirect, part_.indirect);
    if (lanes_.glossy) {
        add_to(whole_.f0, part_.f0);
        add_to(whole_.schlick, part_.schlick);
    }
    part_ = {};
    in_part_ = 0;
}

void CutSums::store(GatheredLight& out) {
    flush();
    out.direct = whole_.direct;
    out.indirect = whole_.indirect;
    out.f0 = whole_.f0;
    out.schlick = whole_.schlick;
    std::copy(std::begin(clamped_), std::end(clamped_), std::begin(out.clamped));
}

}  // namespace render2mpeg::renderer
