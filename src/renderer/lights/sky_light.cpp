// Light of the sky: cells to choose directions by, and its light points.
#include "renderer/lights/light_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/base/discrete_distribution.h"
#include "renderer/base/lobe.h"

namespace render2mpeg::renderer {
namespace {

constexpr float whole_turn = 2.0f * std::numbers::pi_v<float>;

/// Cells of the sky that directions are chosen from: 0.7 degrees, since a sun of half a degree should fill one.
constexpr int sky_columns = 512, sky_rows = 256;

glm::vec3 sky_direction(float cos_polar, float azimuth) {
    const float sine = core::sqrt_or_zero(1.0f - cos_polar * cos_polar);
    return {sine * std::cos(azimuth), cos_polar, sine * std::sin(azimuth)};
}

float row_edge(int row) {
    return std::cos(std::numbers::pi_v<float> * static_cast<float>(row) / sky_rows);
}

float cell_angle(int row) {
    return (row_edge(row) - row_edge(row + 1)) * whole_turn / sky_columns;
}

/// A sky whose colours differ.
class SkyLight final : public Light {
  public:
    explicit SkyLight(const image::SkyMap& sky) : sky_(sky) {
        for (int row = 0; row < sky_rows; ++row) {
            const float angle = cell_angle(row), cosine = 0.5f * (row_edge(row) + row_edge(row + 1));
            for (int column = 0; column < sky_columns; ++column) {
                const float azimuth = whole_turn * (static_cast<float>(column) + 0.5f) / sky_columns;
                cells_.add(
                    static_cast<double>(angle * core::luminance(sky.radiance(sky_direction(cosine, azimuth), angle))));
            }
        }
    }

    SourceExtent extent() const override { return {glm::vec3(0), 0, cells_.total(), true}; }
    double weight(const LightQuery&) const override { return 1; }
    LightSample sample(const LightQuery& query, double part, glm::vec2 u) const override {
        const std::size_t cell = cells_.pick(part);
        const int row = static_cast<int>(cell) / sky_columns, column = static_cast<int>(cell) % sky_columns;
        LightSample sample;
        const float cosine = row_edge(row) + u.x * (row_edge(row + 1) - row_edge(row));
        sample.direction = sample.ray =
            sky_direction(cosine, whole_turn * (static_cast<float>(column) + u.y) / sky_columns);
        if (!query.may_see(sample.direction)) return {};
        sample.far = std::numeric_limits<float>::infinity();
        sample.density = static_cast<float>(cells_.chance(cell)) / cell_angle(row);
        if (!(sample.density > 0.0f)) return {};
        sample.light = sky_.radiance_of_ray(sample.direction, 0.0f) / sample.density;
        return sample;
    }
    float density(const LightQuery&, glm::vec3 direction, const core::SurfaceAddress&) const override {
        const float polar = core::acos_clamped(direction.y) / std::numbers::pi_v<float>;
        float turn = std::atan2(direction.z, direction.x) / whole_turn;
        if (turn < 0.0f) turn += 1.0f;
        const int row = std::clamp(static_cast<int>(polar * sky_rows), 0, sky_rows - 1);
        const int column = std::clamp(static_cast<int>(turn * sky_columns), 0, sky_columns - 1);
        const auto cell = static_cast<std::size_t>(row) * sky_columns + static_cast<std::size_t>(column);
        return static_cast<float>(cells_.chance(cell)) / cell_angle(row);
    }

  private:
    const image::SkyMap& sky_;
    DiscreteDistribution cells_;  ///< by their light
};

}  // namespace

Lights skies_of(const PosedScene& posed_scene) {
    Lights skies;
    const image::SkyMap* sky = posed_scene.sky();
    if (sky != nullptr && !sky->uniform()) skies.push_back(std::make_unique<SkyLight>(*sky));
    std::erase_if(skies, [](const auto& light) { return !(light->extent().power > 0.0); });
    return skies;
}

std::vector<LightPoint> sky_points(const image::SkyMap& sky, int count, const image::SkyImportance& importance) {
    std::vector<LightPoint> points;
    for (const image::SkySample& sample : sky.samples(count, importance)) {
        LightPoint p;
        p.type = LightType::directional;
        p.normal = -sample.direction;
        p.intensity = sample.irradiance;
        p.disc2 = sample.solid_angle * lobe::inverse_pi;
        p.id = first_sky_id + sample.id;
        if (p.shines()) points.push_back(p);
    }
    return points;
}

std::vector<LightPoint> beyond_rays(std::vector<LightPoint> points, float brightest) {
    std::erase_if(points, [&](LightPoint& p) {
        if (!p.is_of_sky()) return false;
        const float radiance = core::luminance(p.intensity) / (std::numbers::pi_v<float> * p.disc2);
        p.intensity *= radiance > 0.0f ? std::max(1.0f - brightest / radiance, 0.0f) : 0.0f;
        return !(core::luminance(p.intensity) > 0.0f);
    });
    return points;
}

}  // namespace render2mpeg::renderer
