#include "renderer/hair/hair_light.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/paths/light_paths.h"

namespace render2mpeg::renderer {
namespace {

/// Paths of a sample at most. chosen: 64, with 16 samples 1,024 of a pixel; references take them all.
constexpr std::uint32_t most_rounds = 64;

/// Standard errors within a tolerance, as gather rays have them (final_gather.h).
constexpr float standard_errors = 1.3f;

/// What the samples of one pixel found.
struct PixelSum {
    std::size_t first = 0, end = 0;  ///< of its samples
    glm::vec3 light{0}, specular{0};
    double luminance = 0;  ///< of the first round
    double spread = 0;     ///< variance of the first round's sum: of paths, and of what the samples show
    std::uint32_t rounds = 0;
};

/// Lights the fibres of one tile.
class TileLight {
  public:
    TileLight(const PosedScene& scene, const LightPaths& paths, std::span<const FibreSample> samples, glm::ivec2 corner)
        : scene_(scene), paths_(paths), samples_(samples), corner_(corner) {
        for (std::size_t k = 0; k < samples.size(); ++k) {
            if (pixels_.empty() || samples[pixels_.back().first].pixel != samples[k].pixel) pixels_.push_back({k, k});
            pixels_.back().end = k + 1;
        }
    }

    /// `known`: what pixels show without hair.
    void light(const core::ToleranceMap* tolerance, const core::Plane<glm::vec3>& known, HairCounts& counts);

    template <class Take>
    void each(Take&& take) const {
        for (const PixelSum& p : pixels_) {
            const float share = 1.0f / static_cast<float>(p.rounds);
            const glm::ivec2 at = place(p);
            take(at.x, at.y, share * p.light, share * p.specular);
        }
    }

  private:
    glm::ivec2 place(const PixelSum& p) const {
        const int pixel = samples_[p.first].pixel;
        return corner_ + glm::ivec2(pixel % tile_size, pixel / tile_size);
    }
    void take_rounds(PixelSum& p, std::uint32_t until);
    double variance_of(const PixelSum& p) const;

    const PosedScene& scene_;
    const LightPaths& paths_;
    std::span<const FibreSample> samples_;
    glm::ivec2 corner_;
    std::vector<PixelSum> pixels_;
    double relative_ = 0;  ///< variance over squared luminance, of the tile
};

/// Sends one path of each of a pixel's samples, again and again.
void TileLight::take_rounds(PixelSum& p, std::uint32_t until) {
    const glm::ivec2 at = place(p);
    const std::uint64_t batch =
        core::mix(core::mix(0x4a12 + static_cast<std::uint64_t>(scene_.posed().frame)) ^
                  (std::uint64_t{static_cast<std::uint32_t>(at.y)} << 32 | static_cast<std::uint32_t>(at.x)));
    const std::size_t count = p.end - p.first;
    double sum = 0, squares = 0;
    for (; p.rounds < until; ++p.rounds) {
        for (std::size_t k = 0; k < count; ++k) {
            const FibreSample& s = samples_[p.first + k];
            PathNumbers numbers(batch, p.rounds * count + k);
            const SurfacePoint point = scene_.surface_at(s.address, s.outgoing.unpack());
            const glm::vec3 light = s.weight * paths_.scattered(point, numbers);
            p.light += light;
            if (s.specular) p.specular += light;
            const auto y = static_cast<double>(core::luminance(light));
            if (p.rounds == 0) sum += y, squares += y * y;
        }
        if (p.rounds > 0) continue;
        p.luminance = sum;
        const auto n = static_cast<double>(count);
        p.spread = count > 1 ? std::max(squares - sum * sum / n, 0.0) * n / (n - 1) : squares;
    }
}

/// Of the first round's sum: by the tile's, for a pixel's own paths would tell it that they are enough where they
/// happened to meet no light.
double TileLight::variance_of(const PixelSum& p) const {
    double near = 0, count = 0;
    for (const PixelSum& other : pixels_) {
        const glm::ivec2 apart = glm::abs(place(other) - place(p));
        if (apart.x > 1 || apart.y > 1) continue;
        near += other.luminance;
        count += 1;
    }
    near /= count;
    return relative_ * near * near;
}

void TileLight::light(const core::ToleranceMap* tolerance, const core::Plane<glm::vec3>& known, HairCounts& counts) {
    for (PixelSum& p : pixels_) take_rounds(p, 1);
    double spread = 0, squares = 0;
    for (const PixelSum& p : pixels_) {
        spread += p.spread;
        squares += p.luminance * p.luminance;
    }
    relative_ = core::divide_or(spread, squares, 0.0);
    for (PixelSum& p : pixels_) {
        std::uint32_t wanted = tolerance == nullptr ? 1 : most_rounds;
        if (tolerance != nullptr && !tolerance->is_reference()) {
            const glm::ivec2 at = place(p);
            const auto luminance = static_cast<float>(p.luminance) + core::luminance(known.at(at.x, at.y));
            const auto allowed =
                static_cast<double>(tolerance->pixels.at(at.x, at.y).allows(luminance) / standard_errors);
            const double rounds = core::divide_or(variance_of(p), allowed * allowed, 1e9);
            counts.capped += rounds > most_rounds ? 1 : 0;
            wanted = static_cast<std::uint32_t>(std::clamp(std::ceil(rounds), 1.0, static_cast<double>(most_rounds)));
        }
        take_rounds(p, wanted);
        counts.paths += static_cast<std::uint64_t>(p.rounds) * (p.end - p.first);
        ++counts.pixels;
    }
}

}  // namespace

void add_hair_light(const PosedScene& posed_scene, const Plan& plan, const core::ToleranceMap* tolerance, Seen& seen,
                    HairCounts& counts) {
    const int width = seen.visible.width(), height = seen.visible.height(), across = seen.tiles_across();
    const std::vector<FibreTile> fibres = std::move(seen.fibres);
    seen.fibres.clear();
    const std::vector<FibreTile> none(fibres.size());
    const std::vector<FibreTile>& exposed = seen.exposure ? seen.exposure->fibres : none;
    seen.hair = core::Plane<glm::vec3>(width, height, glm::vec3(0));
    if (seen.exposure) seen.hair_of_exposed = seen.hair;
    const core::Plane<glm::vec3>& known_of_exposed = seen.exposure ? seen.exposure->emitted : seen.emitted;
    const LightPaths paths(posed_scene, plan);
    std::vector<HairCounts> of_tile(fibres.size());
    parallel::for_each(fibres.size(), [&](std::size_t t) {
        const glm::ivec2 corner = tile_size * glm::ivec2(static_cast<int>(t) % across, static_cast<int>(t) / across);
        TileLight sharp(posed_scene, paths, fibres[t], corner), blurred(posed_scene, paths, exposed[t], corner);
        sharp.light(tolerance, seen.emitted, of_tile[t]);
        blurred.light(tolerance, known_of_exposed, of_tile[t]);
        sharp.each([&](int x, int y, glm::vec3 light, glm::vec3 specular) {
            seen.emitted.at(x, y) += light;
            seen.hair.at(x, y) = light;
            if (!seen.emitted_specular.empty()) seen.emitted_specular.at(x, y) += specular;
        });
        blurred.each([&](int x, int y, glm::vec3 light, glm::vec3) { seen.hair_of_exposed.at(x, y) = light; });
    });
    for (const HairCounts& c : of_tile) counts.add(c);
}

}  // namespace render2mpeg::renderer
