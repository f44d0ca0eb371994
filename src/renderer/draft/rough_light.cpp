#include "renderer/draft/rough_light.h"

#include <algorithm>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/cut/point_light.h"

namespace render2mpeg::renderer {
namespace {

/// Pixels from one to the next that is lit. chosen: 4 of 2, 4, 8, by how far tolerances are from the finished frame's
/// (bench/tables/pictures.csv).
constexpr int step = 4;

bool is_lit(int x, int y) {
    return x % step == step / 2 && y % step == step / 2;
}

/// Column or row of a lit pixel near that of any; 0 where none is lit.
int lit_beside(int place, int size) {
    const int lit = place / step * step + step / 2;
    return std::max(lit < size ? lit : lit - step, 0);
}

/// Response of each pixel to white light.
core::Plane<glm::vec3> reflectances(const Frame& frame) {
    core::Plane<glm::vec3> plane(frame.visible.width(), frame.visible.height(), glm::vec3(0));
    for (std::size_t t = 0; t < frame.tiles.size(); ++t) {
        for (const GatherPoint& p : frame.tiles[t]) {
            const float cosine = glm::dot(p.point.shading_normal, p.point.outgoing);
            const glm::ivec2 place = frame.place_of(t, p.pixel);
            plane.at(place.x, place.y) +=
                p.weight * (diffuse_albedo(p.point.bsdf, cosine) + glossy_albedo(p.point.bsdf, cosine));
        }
    }
    return plane;
}

/// Weight of a lit pixel for another: of the same surface, a turned one, or another object.
float kinship(const core::Visible& visible, int x, int y, int lit_x, int lit_y) {
    const core::SurfaceAddress &a = visible.address.at(x, y), &b = visible.address.at(lit_x, lit_y);
    if (a.object != b.object) return 1e-4f;
    const bool turned =
        glm::dot(visible.geometric_normal.at(x, y).unpack(), visible.geometric_normal.at(lit_x, lit_y).unpack()) < 0.9f;
    return turned ? 1e-2f : 1.0f;
}

/// Mean of the lit neighbours by distance and kinship.
glm::vec3 light_at(const core::Visible& visible, const core::Plane<glm::vec3>& light, int x, int y) {
    const float column = static_cast<float>(x - step / 2) / step, row = static_cast<float>(y - step / 2) / step;
    const int left = static_cast<int>(std::floor(column)), top = static_cast<int>(std::floor(row));
    glm::vec3 sum(0);
    float weights = 0;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const int lit_x = (left + i) * step + step / 2, lit_y = (top + j) * step + step / 2;
            if (lit_x < 0 || lit_y < 0 || lit_x >= visible.width() || lit_y >= visible.height()) continue;
            const float near = (1.0f - std::abs(column - static_cast<float>(left + i))) *
                               (1.0f - std::abs(row - static_cast<float>(top + j)));
            const float weight = (near + 1e-3f) * kinship(visible, x, y, lit_x, lit_y);
            sum += weight * light.at(lit_x, lit_y);
            weights += weight;
        }
    return weights > 0.0f ? sum / weights : glm::vec3(0);
}

}  // namespace

Frame every_fourth_pixel(Frame frame) {
    for (GatherTile& tile : frame.tiles)
        std::erase_if(tile, [](const GatherPoint& p) { return !is_lit(p.pixel % tile_size, p.pixel / tile_size); });
    return frame;
}

void interpolate_light(const Frame& frame, const UngatheredLight& ungathered, core::Radiance& radiance) {
    const int width = frame.visible.width(), height = frame.visible.height();
    // Divide lit pixels by their reflectance.
    const core::Plane<glm::vec3> reflectance = reflectances(frame);
    core::Plane<glm::vec3> light(width, height, glm::vec3(0));
    for (int y = step / 2; y < height; y += step)
        for (int x = step / 2; x < width; x += step) {
            const glm::vec3 sent = radiance.combined.at(x, y) - ungathered.all().at(x, y);
            for (int k = 0; k < 3; ++k)
                light.at(x, y)[k] = std::max(core::divide_or(sent[k], reflectance.at(x, y)[k], 0.0f), 0.0f);
        }

    // Multiply interpolated light by each pixel's own.
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (is_lit(x, y)) continue;
            radiance.combined.at(x, y) =
                ungathered.all().at(x, y) + reflectance.at(x, y) * light_at(frame.visible, light, x, y);
            // Errors are those of the lit pixel of its 4x4, as shares of light.
            const int lit_x = lit_beside(x, width), lit_y = lit_beside(y, height);
            const float share = core::divide_or(core::luminance(reflectance.at(x, y)),
                                                core::luminance(reflectance.at(lit_x, lit_y)), 0.0f);
            // Those of hair are each pixel's own.
            PointLight own, of_lit;
            own.add_alone({value_or_zero(ungathered.hair().error, x, y)});
            of_lit.add_alone({value_or_zero(ungathered.hair().error, lit_x, lit_y)});
            const auto carry = [&](core::Plane<float>& errors, float hair, float lit_hair) {
                const float lit = errors.at(lit_x, lit_y);
                errors.at(x, y) = std::hypot(share * std::sqrt(std::max(lit * lit - lit_hair * lit_hair, 0.0f)), hair);
            };
            carry(radiance.error, own.error.value, of_lit.error.value);
            carry(radiance.shared_error, own.shared.value, of_lit.shared.value);
        }
}

}  // namespace render2mpeg::renderer
