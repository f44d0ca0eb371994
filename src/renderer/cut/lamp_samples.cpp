#include "renderer/cut/lamp_samples.h"

#include <array>
#include <cmath>
#include <numbers>

#include "core/sampling.h"
#include "renderer/base/isa_clones.h"

namespace render2mpeg::renderer {
namespace {

/// A disc of radius 1, evenly, so that strata stay compact [Shirley1997].
glm::vec2 on_disc(glm::vec2 u) {
    const glm::vec2 p = 2.0f * u - 1.0f;
    if (p == glm::vec2(0)) return p;
    constexpr float quarter = std::numbers::pi_v<float> / 4;
    const bool wide = std::abs(p.x) > std::abs(p.y);
    const float r = wide ? p.x : p.y, turn = wide ? quarter * (p.y / p.x) : 2 * quarter - quarter * (p.x / p.y);
    return r * glm::vec2(std::cos(turn), std::sin(turn));
}

/// All samples: of a square, and of a disc.
struct Pattern {
    std::array<glm::vec2, most_lamp_samples> square, disc;
};
const Pattern pattern = [] {
    Pattern p;
    for (std::uint32_t i = 0; i < p.square.size(); ++i) {
        p.square[i] = (glm::vec2(core::sobol(i) >> 8u) + 0.5f) * 0x1p-24f;
        p.disc[i] = on_disc(p.square[i]);
    }
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

}  // namespace

LampSampler::LampSampler(const AreaLamp& lamp, const GatherLanes& lanes)
    : lamp_(lamp), lanes_(lanes), view_(lanes.position) {
    lamp.look(view_);
    if (lanes.glossy) start_lobes();
}

void LampSampler::start_lobes() {
    const FrameLanes& n = lanes_.normal;
    for (int i = 0; i < lane_count; ++i) {
        const glm::vec3 out = lanes_.outgoing.axis.at(i);
        const glm::vec3 o = glm::normalize(
            glm::vec3(glm::dot(n.tangent.at(i), out), glm::dot(n.bitangent.at(i), out), lanes_.cos_outgoing[i]));
        alpha_[i] = std::sqrt(lanes_.lobe_width[i]);
        const glm::vec3 v = glm::normalize(glm::vec3(alpha_[i] * o.x, alpha_[i] * o.y, o.z));
        const float across2 = v.x * v.x + v.y * v.y;
        const glm::vec3 t = across2 > 0.0f ? glm::vec3(-v.y, v.x, 0) / std::sqrt(across2) : glm::vec3(1, 0, 0);
        put(outgoing_, i, o);
        put(facets_.axis, i, v);
        put(facets_.tangent, i, t);
        put(facets_.bitangent, i, glm::cross(v, t));
        hidden_[i] = 0.5f * (1.0f + v.z);
    }
}

SampleNumbers LampSampler::numbers(std::span<const glm::vec2> all, int k) const {
    SampleNumbers u;
    for (int i = 0; i < lane_count; ++i) {
        const glm::vec2 p = all[sample_index(lanes_.set, i, k)];
        u.x[i] = p.x;
        u.y[i] = p.y;
    }
    return u;
}

void LampSampler::take(int k, LampSamples& __restrict samples) const {
    lamp_.choose(view_, numbers(lamp_.is_round() ? pattern.disc : pattern.square, k), samples);
}

void LampSampler::start_at(int k, Vec3Lanes& origin) const {
    if (lanes_.places == 1) {
        origin = lanes_.origin;
        return;
    }
    for (int i = 0; i < lane_count; ++i) {
        // All digits of the sample's number to the base 4 decide.
        std::size_t place = 0;
        for (std::size_t left = sample_index(lanes_.set, i, k); left > 0; left >>= 2) place ^= left & 3u;
        const Vec3Lanes& from = origins(lanes_, static_cast<int>(place) % lanes_.places);
        origin.x[i] = from.x[i];
        origin.y[i] = from.y[i];
        origin.z[i] = from.z[i];
    }
}

void LampSampler::take_lobe(int k, LampSamples& samples) const {
    take_facets(numbers(pattern.disc, k), samples);
    lamp_.meet(view_, samples);
}

RENDER2MPEG_CLONES
void LampSampler::take_facets(const SampleNumbers& u, LampSamples& __restrict samples) const {
    const FrameLanes &f = facets_, &n = lanes_.normal;
    for (int i = 0; i < lane_count; ++i) {
        const float a = u.x[i], s = hidden_[i], upright = inlined::sqrt(inlined::max(1.0f - a * a, 0.0f));
        const float b = upright + s * (u.y[i] - upright), c = inlined::sqrt(inlined::max(1.0f - a * a - b * b, 0.0f));
        float hx = alpha_[i] * (a * f.tangent.x[i] + b * f.bitangent.x[i] + c * f.axis.x[i]);
        float hy = alpha_[i] * (a * f.tangent.y[i] + b * f.bitangent.y[i] + c * f.axis.y[i]);
        float hz = inlined::max(a * f.tangent.z[i] + b * f.bitangent.z[i] + c * f.axis.z[i], 1e-6f);
        const float inverse = 1.0f / inlined::sqrt(hx * hx + hy * hy + hz * hz);
        hx *= inverse;
        hy *= inverse;
        hz *= inverse;
        const float twice = 2.0f * (outgoing_.x[i] * hx + outgoing_.y[i] * hy + outgoing_.z[i] * hz);
        const float x = twice * hx - outgoing_.x[i], y = twice * hy - outgoing_.y[i], z = twice * hz - outgoing_.z[i];
        samples.direction.x[i] = x * n.tangent.x[i] + y * n.bitangent.x[i] + z * n.axis.x[i];
        samples.direction.y[i] = x * n.tangent.y[i] + y * n.bitangent.y[i] + z * n.axis.y[i];
        samples.direction.z[i] = x * n.tangent.z[i] + y * n.bitangent.z[i] + z * n.axis.z[i];
    }
}

}  // namespace render2mpeg::renderer
