#include "renderer/hair/hair_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/base/lobe.h"
#include "renderer/subsurface/random_walk.h"

namespace render2mpeg::renderer {
namespace {

/// Rays of a sample at most. chosen: 64, with 16 samples 1,024 of a pixel; references take them all.
constexpr std::uint32_t most_rounds = 64;

/// Standard errors within a tolerance, as gather rays have them (final_gather.h).
constexpr double standard_errors = 1.3;

}  // namespace

/// Results of the samples of one pixel.
struct HairLight::Pixel {
    std::uint32_t tile = 0, first = 0, end = 0;  ///< of its samples
    glm::ivec2 place{0};
    std::uint32_t rounds = 0, wanted = 1;
    glm::vec3 light{0}, specular{0};  ///< sums over rounds
    double luminance = 0;             ///< of the first round
    double spread = 0;                ///< variance of its sum: of rays, and of what samples show
};

/// Results of one round for the pixels of a task.
struct HairLight::Traced {
    std::vector<RayTerm> terms;    ///< by sample of the task
    std::vector<glm::vec3> light;  ///< of each sample
    std::uint64_t rays = 0;
};

HairLight::HairLight(const PosedScene& posed_scene, const Plan& plan)
    : posed_scene_(posed_scene), gather_rays_(posed_scene, plan), cache_(posed_scene, plan) {}

/// Lights of one sample by next events, and one ray by the fibre's scattering, whose end the cache knows.
void HairLight::trace(const FibreSample& sample, std::uint64_t number, Traced& out) const {
    const auto index = static_cast<std::uint32_t>(out.light.size());
    SurfacePoint point = posed_scene_.surface_at(sample.address, sample.outgoing.unpack());
    if (sample.below) {
        point.below = true;
        point.bsdf.diffuse *= posed_scene_.animation().materials[point.material].subsurface->weight;
        const std::optional<SurfacePoint> place = random_walk(posed_scene_, point, core::mix(number + 1));
        if (!place) return void(out.light.emplace_back(0.0f));
        point = *place;
    }
    const Scatterer at(posed_scene_, point);
    glm::vec3& light = out.light.emplace_back(cache_.light().lamps(at, number, out.rays));
    const auto u = [&](std::uint64_t which) { return core::uniform(number, 16, which); };
    glm::vec3 direction, weight(0);
    const float density = at.sample(u(0), {u(1), u(2)}, direction, weight);
    if (!(density > 0.0f) || !at.query().may_see(direction) || !core::is_finite(weight)) return;
    const RayQuery ray{at.origin_of(direction), direction, std::numeric_limits<float>::infinity()};
    Hit hit;
    posed_scene_.tracer().any_nearest(std::span(&ray, 1), std::span(&hit, 1), false);
    const AskedLights asked{cache_.light().sources(), at.query(), density};
    RayRules rules;
    rules.brightest = std::numeric_limits<float>::infinity();
    rules.asked = &asked;
    const std::size_t first = out.terms.size();
    light +=
        weight * gather_rays_.follow(ray, hit, rules, lobe::inverse_pi, core::mix(number), index, out.terms, out.rays);
    ++out.rays;
    for (std::size_t k = first; k < out.terms.size(); ++k) out.terms[k].weight *= weight;
}

/// One more round of all pixels that want it.
void HairLight::take_round(std::span<const FibreTile> tiles, std::vector<Pixel>& pixels, std::uint32_t round,
                           HairCounts& counts) {
    std::vector<Pixel*> asked;
    for (Pixel& p : pixels)
        if (round < p.wanted) asked.push_back(&p);
    constexpr std::size_t together = 64;
    std::vector<Traced> found((asked.size() + together - 1) / together);
    const auto frame = static_cast<std::uint64_t>(posed_scene_.posed().frame);
    parallel::for_each(found.size(), [&](std::size_t task) {
        const FlushDenormals flushed;
        for (std::size_t k = task * together; k < std::min((task + 1) * together, asked.size()); ++k) {
            const Pixel& p = *asked[k];
            const std::uint64_t seed =
                core::mix(core::mix(0x4a12 + frame) ^ (std::uint64_t{static_cast<std::uint32_t>(p.place.y)} << 32 |
                                                       static_cast<std::uint32_t>(p.place.x)));
            for (std::uint32_t s = p.first; s < p.end; ++s)
                trace(tiles[p.tile][s], core::mix(seed + round * 0x10000u + (s - p.first)), found[task]);
        }
    });
    std::vector<std::vector<Sighting>> wanted(found.size());
    for (std::size_t task = 0; task < found.size(); ++task) {
        counts.rays += found[task].rays;
        for (const RayTerm& term : found[task].terms)
            if (cache_.find(term.place.key) == LightCells::none) wanted[task].push_back(term.place);
    }
    cache_.learn(std::move(wanted));
    parallel::for_each(found.size(), [&](std::size_t task) {
        Traced& t = found[task];
        for (const RayTerm& term : t.terms)
            t.light[term.ray] += term.weight * cache_.radiance(cache_.index_of(term.place.key));
        std::size_t next = 0;
        for (std::size_t k = task * together; k < std::min((task + 1) * together, asked.size()); ++k)
            add_round(tiles, std::span(t.light).subspan(next, asked[k]->end - asked[k]->first), *asked[k]),
                next += asked[k]->end - asked[k]->first;
    });
}

void HairLight::add_round(std::span<const FibreTile> tiles, std::span<const glm::vec3> lights, Pixel& p) {
    double sum = 0, squares = 0;
    for (std::uint32_t s = p.first; s < p.end; ++s) {
        const FibreSample& sample = tiles[p.tile][s];
        glm::vec3 light = sample.weight * lights[s - p.first];
        if (!core::is_finite(light)) light = glm::vec3(0);
        p.light += light;
        if (sample.specular) p.specular += light;
        const auto y = static_cast<double>(core::luminance(light));
        sum += y;
        squares += y * y;
    }
    if (p.rounds++ > 0) return;
    const double n = p.end - p.first;
    p.luminance = sum;
    p.spread = n > 1 ? std::max(squares - sum * sum / n, 0.0) * n / (n - 1) : squares;
}

/// How many rounds pixels want, by the spread of their tile: a pixel's own rays would tell it that they are enough
/// where they happened to meet no light.
void HairLight::want_rounds(std::span<Pixel> tile, const core::ToleranceMap& tolerance,
                            const core::Plane<glm::vec3>& known, HairCounts& counts) {
    double spread = 0, squares = 0;
    for (const Pixel& p : tile) {
        spread += p.spread;
        squares += p.luminance * p.luminance;
    }
    const double relative = core::divide_or(spread, squares, 0.0);
    for (Pixel& p : tile) {
        if (tolerance.is_reference()) {
            p.wanted = most_rounds;
            continue;
        }
        double near = 0, count = 0;
        for (const Pixel& other : tile) {
            const glm::ivec2 apart = glm::abs(other.place - p.place);
            if (apart.x > 1 || apart.y > 1) continue;
            near += other.luminance;
            count += 1;
        }
        near /= count;
        const auto luminance = static_cast<float>(near) + core::luminance(known.at(p.place.x, p.place.y));
        const double allowed =
            static_cast<double>(tolerance.pixels.at(p.place.x, p.place.y).allows(luminance)) / standard_errors;
        const double rounds = core::divide_or(relative * near * near, allowed * allowed, 1e9);
        counts.capped += rounds > most_rounds ? 1 : 0;
        p.wanted = static_cast<std::uint32_t>(std::clamp(std::ceil(rounds), 1.0, 1.0 * most_rounds));
    }
}

std::vector<HairLight::Pixel> HairLight::light(std::span<const FibreTile> tiles, int across,
                                               const core::ToleranceMap* tolerance, const core::Plane<glm::vec3>& known,
                                               HairCounts& counts) {
    std::vector<Pixel> pixels;
    std::vector<std::size_t> ends;
    for (std::uint32_t t = 0; t < tiles.size(); ++t) {
        const glm::ivec2 corner = tile_size * glm::ivec2(static_cast<int>(t) % across, static_cast<int>(t) / across);
        for (std::uint32_t k = 0; k < tiles[t].size(); ++k) {
            const int pixel = tiles[t][k].pixel;
            if (k == 0 || tiles[t][k - 1].pixel != pixel) {
                Pixel& p = pixels.emplace_back();
                p.tile = t;
                p.first = k;
                p.place = corner + glm::ivec2(pixel % tile_size, pixel / tile_size);
            }
            pixels.back().end = k + 1;
        }
        ends.push_back(pixels.size());
    }
    take_round(tiles, pixels, 0, counts);
    if (tolerance != nullptr)
        for (std::size_t t = 0; t < tiles.size(); ++t) {
            const std::size_t first = t == 0 ? 0 : ends[t - 1];
            want_rounds(std::span(pixels).subspan(first, ends[t] - first), *tolerance, known, counts);
        }
    std::uint32_t most = 1;
    for (const Pixel& p : pixels) most = std::max(most, p.wanted);
    for (std::uint32_t round = 1; round < most; ++round) take_round(tiles, pixels, round, counts);
    counts.pixels += pixels.size();
    return pixels;
}

void HairLight::add(const Frame& seen, const core::ToleranceMap* tolerance, UngatheredLight& sum, HairCounts& counts) {
    const int across = seen.tiles_across();
    const core::Plane<glm::vec3> black(seen.visible.width(), seen.visible.height(), glm::vec3(0));
    EffectLight hair{black, {}, {}};
    if (!seen.emitted_specular.empty()) hair.specular = black;
    cache_.forget({});
    for (const Pixel& p : light(seen.fibres, across, tolerance, sum.all(), counts)) {
        const float share = 1.0f / static_cast<float>(p.rounds);
        hair.all.at(p.place.x, p.place.y) = share * p.light;
        if (!hair.specular.empty()) hair.specular.at(p.place.x, p.place.y) = share * p.specular;
    }
    if (seen.exposure) {
        hair.exposed = black;
        for (const Pixel& p : light(seen.exposure->fibres, across, tolerance, seen.exposure->emitted, counts))
            hair.exposed.at(p.place.x, p.place.y) = p.light / static_cast<float>(p.rounds);
    }
    sum.add_hair(std::move(hair));
}

}  // namespace render2mpeg::renderer
