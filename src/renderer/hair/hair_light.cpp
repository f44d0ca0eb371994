#include "renderer/hair/hair_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/color.h"
#include "core/numeric.h"
#include "core/standard_error.h"
#include "parallel/loops.h"
#include "renderer/base/allocation.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/base/lobe.h"
#include "renderer/subsurface/random_walk.h"

namespace render2mpeg::renderer {
namespace {

/// Rays of a sample at most. chosen: 64, with 16 samples 1,024 of a pixel; references take them all.
constexpr std::uint32_t most_rounds = 64;

/// Rounds are worth it until rays err by this share of what eye samples do, variances. chosen: 1 of 0.5 to 2, for which
/// a head errs least for its time.
constexpr double worth_rounds = 1.0;

/// Samples of one task, and of those that are traced before what they ask is learnt. chosen: memory of some 60 MB.
constexpr std::size_t samples_of_task = 512, samples_at_once = std::size_t{1} << 18;

/// Rays that a round of a sample takes, about.
double rays_of_sample(const HairCounts& counts) {
    return std::max(core::divide_or(1.0 * counts.rays, 1.0 * counts.samples, 1.0), 1.0);
}

/// What a sample draws numbers for.
enum Number : std::uint64_t { walk, lamps, scattered, beyond };

}  // namespace

/// Results of the samples of one pixel.
struct HairLight::Pixel {
    std::uint32_t tile = 0, first = 0, end = 0;  ///< of its samples
    glm::ivec2 place{0};
    std::uint32_t rounds = 0, wanted = 0;
    glm::vec3 light{0}, specular{0};  ///< sums over rounds
    std::vector<float> lights;        ///< luminance of each sample, sum over rounds
    std::vector<float> first_lights;  ///< the same in the first round
    double variance = 0;              ///< of a round by its rays alone, by the first two; 0: it had one
    double squares = 0;               ///< sum over samples of the square of what these found for each, their mean

    /// Of a round, mean of all.
    double luminance() const { return static_cast<double>(core::luminance(light)) / rounds; }
    /// Of the mean of all rounds, by what samples differ by: they show other fibres, which no ray mends.
    double squared_error() const {
        double sum = 0, squares = 0;
        for (const float l : lights) {
            sum += static_cast<double>(l);
            squares += static_cast<double>(l) * static_cast<double>(l);
        }
        const auto n = static_cast<double>(lights.size());
        const double variance = n > 1 ? std::max(squares - sum * sum / n, 0.0) * n / (n - 1) : squares;
        return variance / (1.0 * rounds * rounds);
    }
    /// Whether it tells its tile how rays and samples vary, by two first rounds.
    bool tells() const { return (place.x + place.y) % 2 == 0; }
};

/// Results of some rounds of the pixels of a task.
struct HairLight::Traced {
    std::vector<RayTerm> terms;
    std::vector<glm::vec3> light;  ///< by pixel, round and sample
    std::uint64_t rays = 0;
};

HairLight::HairLight(const PosedScene& posed_scene, const Plan& plan, SurfaceCache& cache)
    : posed_scene_(posed_scene), gather_rays_(posed_scene, plan), cache_(cache) {}

/// Lights of one sample by next events, and one ray by the fibre's scattering, whose end the cache knows.
void HairLight::trace(const FibreSample& sample, const Stream& numbers, Traced& out) const {
    const auto index = static_cast<std::uint32_t>(out.light.size());
    SurfacePoint point = posed_scene_.surface_at(sample.address, sample.outgoing.unpack());
    if (sample.below) {
        point.below = true;
        point.bsdf.diffuse *= posed_scene_.animation().materials[point.material].subsurface->weight;
        const std::optional<SurfacePoint> place = random_walk(posed_scene_, point, numbers.at(walk));
        if (!place) return void(out.light.emplace_back(0.0f));
        point = *place;
    }
    const Scatterer at(posed_scene_, point);
    const LightChoices choices = cache_.light().light_choices();
    glm::vec3& light = out.light.emplace_back(cache_.light().lamps(at, numbers.at(lamps), choices, out.rays));
    const auto u = [&](std::uint64_t which) { return numbers.uniform(scattered, which); };
    glm::vec3 direction, weight(0);
    const float density = at.sample(u(0), {u(1), u(2)}, direction, weight);
    if (!(density > 0.0f) || !at.query().may_see(direction) || !core::is_finite(weight)) return;
    const RayQuery ray{at.origin_of(direction), direction, std::numeric_limits<float>::infinity()};
    Hit hit;
    posed_scene_.tracer().any_nearest(std::span(&ray, 1), std::span(&hit, 1), false);
    const AskedLights asked{cache_.light().sources(), at.query(), density, choices};
    RayRules rules;
    rules.brightest = std::numeric_limits<float>::infinity();
    rules.asked = &asked;
    const std::size_t first = out.terms.size();
    light += weight * gather_rays_.follow(ray, hit, rules, numbers.at(beyond), index, out.terms, out.rays);
    ++out.rays;
    for (std::size_t k = first; k < out.terms.size(); ++k) out.terms[k].weight *= weight;
}

/// Takes the rounds that pixels want and have not had.
void HairLight::take_rounds(std::span<const FibreTile> tiles, std::span<Pixel> pixels, HairCounts& counts) {
    std::vector<std::span<Pixel>> tasks;
    std::size_t first = 0, of_task = 0, at_once = 0;
    for (std::size_t k = 1; k <= pixels.size(); ++k) {
        const Pixel& p = pixels[k - 1];
        of_task += std::size_t{p.wanted - p.rounds} * (p.end - p.first);
        if (of_task < samples_of_task && k < pixels.size()) continue;
        tasks.push_back(pixels.subspan(first, k - first));
        first = k;
        at_once += std::exchange(of_task, 0);
        if (at_once < samples_at_once && k < pixels.size()) continue;
        trace_all(tiles, tasks, counts);
        tasks.clear();
        at_once = 0;
    }
}

void HairLight::trace_all(std::span<const FibreTile> tiles, std::span<const std::span<Pixel>> tasks,
                          HairCounts& counts) {
    std::vector<Traced> found(tasks.size());
    std::vector<std::vector<CellQuery>> wanted(tasks.size());
    parallel::for_each(tasks.size(), [&](std::size_t task) {
        const FlushDenormals flushed;
        for (const Pixel& p : tasks[task]) {
            const Stream numbers(Purpose::strands, {.pixel = p.place, .frame = posed_scene_.posed().frame});
            for (std::uint32_t round = p.rounds; round < p.wanted; ++round)
                for (std::uint32_t s = p.first; s < p.end; ++s)
                    trace(tiles[p.tile][s], numbers.at(round).at(s - p.first), found[task]);
        }
        for (const RayTerm& term : found[task].terms)
            if (cache_.find(term.place.key) == LightCells::none) wanted[task].push_back(term.place);
    });
    for (const Traced& t : found) {
        counts.rays += t.rays;
        counts.samples += t.light.size();
    }
    cache_.learn(std::move(wanted));
    parallel::for_each(tasks.size(), [&](std::size_t task) {
        std::vector<glm::vec3>& light = found[task].light;
        for (const RayTerm& term : found[task].terms)
            light[term.ray] += term.weight * cache_.radiance(cache_.index_of(term.place.key));
        std::size_t next = 0;
        for (Pixel& p : tasks[task])
            for (const std::size_t samples = p.end - p.first; p.rounds < p.wanted; next += samples)
                add_round(tiles, std::span(light).subspan(next, samples), p);
    });
}

void HairLight::add_round(std::span<const FibreTile> tiles, std::span<const glm::vec3> lights, Pixel& p) {
    const bool is_first = p.rounds == 0 && p.wanted > 1, is_second = !p.first_lights.empty();
    p.lights.resize(p.end - p.first);
    for (std::uint32_t s = p.first; s < p.end; ++s) {
        const FibreSample& sample = tiles[p.tile][s];
        glm::vec3 light = sample.weight * lights[s - p.first];
        if (!core::is_finite(light)) light = glm::vec3(0);
        p.light += light;
        if (sample.specular) p.specular += light;
        const float luminance = core::luminance(light);
        p.lights[s - p.first] += luminance;
        if (is_first) p.first_lights.push_back(luminance);
        if (!is_second) continue;
        const auto first = static_cast<double>(p.first_lights[s - p.first]), now = static_cast<double>(luminance);
        p.variance += 0.5 * (now - first) * (now - first);
        p.squares += 0.25 * (now + first) * (now + first);
    }
    if (is_second) p.first_lights = {};
    ++p.rounds;
}

/// How many rounds pixels want, by how rays of a sample vary in their tile: a pixel's own would tell it that they are
/// enough where they happened to meet no light. What samples show differs as well, and no ray mends that.
void HairLight::want_rounds(std::span<Pixel> tile, const core::ToleranceMap& tolerance,
                            const core::Plane<glm::vec3>& known, double rays, HairCounts& counts) {
    const Allocation allocation{tolerance.typical, tolerance.means, 0};
    double variance = 0, squares = 0, differ = 0;
    for (const Pixel& p : tile) {
        if (!p.tells()) continue;
        const double n = p.end - p.first, even = p.luminance() * p.luminance() / n;
        variance += p.variance;
        squares += even;
        if (n > 1) differ += (p.squares - even) * n / (n - 1) - 0.5 * p.variance;
    }
    const double relative = core::divide_or(variance, squares, 1e9);
    const double worth = core::divide_or(worth_rounds * variance, std::max(differ, 0.0), 1e9);
    for (Pixel& p : tile) {
        if (tolerance.is_reference()) {
            p.wanted = most_rounds;
            continue;
        }
        double near = 0, count = 0;
        for (const Pixel& other : tile) {
            const glm::ivec2 apart = glm::abs(other.place - p.place);
            if (apart.x > 1 || apart.y > 1) continue;
            near += other.luminance();
            count += 1;
        }
        near /= count;
        const auto luminance = static_cast<float>(near) + core::luminance(known.at(p.place.x, p.place.y));
        const double allowed =
            static_cast<double>(tolerance.pixels.at(p.place.x, p.place.y).allows(luminance)) / core::errors_of_noise;
        const double n = p.end - p.first, needs = samples_for(allowed * allowed, n, relative * near * near / n),
                     rounds = allocation.worth(needs, rays) / n;
        counts.capped += rounds > most_rounds ? 1 : 0;
        p.wanted = static_cast<std::uint32_t>(
            std::clamp(std::ceil(std::min(rounds, worth)), 1.0 * p.rounds, 1.0 * most_rounds));
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
    HairCounts own;
    for (Pixel& p : pixels) p.wanted = tolerance != nullptr && p.tells() ? 2 : 1;
    take_rounds(tiles, pixels, own);
    const double rays = rays_of_sample(own);
    if (tolerance != nullptr)
        for (std::size_t t = 0; t < tiles.size(); ++t) {
            const std::size_t first = t == 0 ? 0 : ends[t - 1];
            want_rounds(std::span(pixels).subspan(first, ends[t] - first), *tolerance, known, rays, own);
        }
    take_rounds(tiles, pixels, own);
    own.pixels = pixels.size();
    counts.add(own);
    return pixels;
}

Strands HairLight::look_at_strands(const Frame& seen, int samples, HairCounts& counts) {
    const int width = seen.visible.width(), height = seen.visible.height();
    core::Plane<float> squares(width, height, 0.0f);
    core::Plane<std::uint8_t> shown(width, height, 0);
    Strands strands{squares, squares};
    for (const Pixel& p : light(seen.fibres, seen.tiles_across(), nullptr, {}, counts)) {
        const double n = seen.samples.empty() ? samples : seen.samples.at(p.place.x, p.place.y);
        squares.at(p.place.x, p.place.y) = static_cast<float>(n * p.squared_error());
        strands.light.at(p.place.x, p.place.y) = static_cast<float>(p.luminance());
        const auto shows = std::span(seen.fibres[p.tile]).subspan(p.first, p.end - p.first);
        shown.at(p.place.x, p.place.y) = std::ranges::any_of(shows, [](const FibreSample& s) { return !s.below; });
    }
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (shown.at(x, y) == 0) continue;
            float sum = 0, count = 0;
            for (int j = std::max(y - 1, 0); j <= std::min(y + 1, height - 1); ++j)
                for (int i = std::max(x - 1, 0); i <= std::min(x + 1, width - 1); ++i) {
                    sum += static_cast<float>(shown.at(i, j)) * squares.at(i, j);
                    count += static_cast<float>(shown.at(i, j));
                }
            strands.of_sample.at(x, y) = std::sqrt(sum / count);
        }
    strands.rays = rays_of_sample(counts);
    return strands;
}

void HairLight::add(const Frame& seen, const core::ToleranceMap* tolerance, UngatheredLight& sum, HairCounts& counts) {
    const int across = seen.tiles_across();
    const core::Plane<glm::vec3> black(seen.visible.width(), seen.visible.height(), glm::vec3(0));
    const core::Plane<float> sure(seen.visible.width(), seen.visible.height(), 0.0f);
    EffectLight hair{black, {}, {}, sure, {}};
    if (!seen.emitted_specular.empty()) hair.specular = black;
    for (const Pixel& p : light(seen.fibres, across, tolerance, sum.all(), counts)) {
        const float share = 1.0f / static_cast<float>(p.rounds);
        hair.all.at(p.place.x, p.place.y) = share * p.light;
        hair.error.at(p.place.x, p.place.y) = static_cast<float>(std::sqrt(p.squared_error()));
        if (!hair.specular.empty()) hair.specular.at(p.place.x, p.place.y) = share * p.specular;
    }
    if (seen.exposure) {
        hair.exposed = black;
        hair.exposed_error = sure;
        for (const Pixel& p : light(seen.exposure->fibres, across, tolerance, seen.exposure->emitted, counts)) {
            hair.exposed.at(p.place.x, p.place.y) = p.light / static_cast<float>(p.rounds);
            hair.exposed_error.at(p.place.x, p.place.y) = static_cast<float>(std::sqrt(p.squared_error()));
        }
    }
    sum.add_hair(std::move(hair));
}

}  // namespace render2mpeg::renderer
