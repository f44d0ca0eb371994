#include "renderer/cut_sums.h"

#include <algorithm>

#include "renderer/isa_clones.h"

namespace render2mpeg::renderer {
namespace {

RENDER2MPEG_ALWAYS_INLINED void add_to(RgbLanes& sum, const Lanes& unit, glm::vec3 intensity) {
    const float red = intensity.x, green = intensity.y, blue = intensity.z;
    for (int i = 0; i < lane_count; ++i) {
        sum.r[i] += unit[i] * red;
        sum.g[i] += unit[i] * green;
        sum.b[i] += unit[i] * blue;
    }
}

RENDER2MPEG_ALWAYS_INLINED void add_tinted(RgbLanes& sum, const Lanes& unit, const float (&passes)[lane_count][3],
                                           glm::vec3 intensity) {
    for (int i = 0; i < lane_count; ++i) {
        sum.r[i] += unit[i] * passes[i][0] * intensity.x;
        sum.g[i] += unit[i] * passes[i][1] * intensity.y;
        sum.b[i] += unit[i] * passes[i][2] * intensity.z;
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

CutSums::CutSums(const GatherLanes& lanes, bool translucent) : lanes_(lanes), translucent_(translucent) {}

RENDER2MPEG_CLONES
void CutSums::add(const LightLanes& unit, const float (&passes)[lane_count][3], glm::vec3 intensity, bool direct) {
    RgbLanes& irradiance = direct ? part_.direct : part_.indirect;
    if (translucent_) {
        add_tinted(irradiance, unit.diffuse, passes, intensity);
        if (lanes_.glossy) {
            add_tinted(part_.f0, unit.f0, passes, intensity);
            add_tinted(part_.schlick, unit.schlick, passes, intensity);
        }
    } else {
        add_to(irradiance, unit.diffuse, intensity);
        if (lanes_.glossy) {
            add_to(part_.f0, unit.f0, intensity);
            add_to(part_.schlick, unit.schlick, intensity);
        }
    }
    if (++in_part_ == part_length) flush();
}

void CutSums::add_clamped(LightFamily family, const TreeLight& light, const LightLanes& visible, glm::vec3 intensity) {
    LightLanes full;
    evaluate_light(lanes_, family, light, GeometryClamp{1.0f}, full);
    for (int i = 0; i < lane_count; ++i) {
        const bool lit = visible.diffuse[i] > 0.0f;
        full.diffuse[i] = lit ? std::max(full.diffuse[i] - visible.diffuse[i], 0.0f) : 0.0f;
        if (!lanes_.glossy) continue;
        full.f0[i] = lit ? std::max(full.f0[i] - visible.f0[i], 0.0f) : 0.0f;
        full.schlick[i] = lit ? std::max(full.schlick[i] - visible.schlick[i], 0.0f) : 0.0f;
    }
    add_luminance(lanes_, full, intensity, clamped_);
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
