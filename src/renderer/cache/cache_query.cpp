#include "renderer/cache/cache_query.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "core/standard_error.h"
#include "renderer/cache/local_regression.h"
#include "renderer/gather/ray_sums.h"

namespace render2mpeg::renderer {
namespace {

/// Light of a point as the regression's sum of records; `error` is that of cuts and of lobes that another eye saw.
PointLight blend(const LocalRegression& fit, const CacheQuery& q, const RecordStore& records, float error_scale,
                 std::int64_t frame) {
    PointLight light;
    glm::vec3 turned(0);
    float clamped = 0, age = 0, sum = 0, square = 0;
    for (std::size_t i = 0; i < fit.size(); ++i) {
        const float w = fit.weight(i);
        if (w == 0.0f) continue;
        const IrradianceRecord& r = records[fit.record(i)];
        light.direct += w * r.direct;
        light.indirect += w * (r.indirect + r.by_rays[0]);
        light.glossy += w * fit.lobe(i).radiance;
        turned += w * fit.lobe(i).turned;
        light.capped = light.capped || r.capped;
        clamped += w * r.clamped;
        age += std::abs(w) * static_cast<float>(frame - r.born);
        sum += std::abs(w);
        square += w * w * r.error.value * r.error.value;
    }
    light.direct = glm::max(light.direct, glm::vec3(0));
    light.indirect = glm::max(light.indirect, glm::vec3(0));
    light.glossy = glm::max(light.glossy, glm::vec3(0));
    light.clamped = std::max(clamped, 0.0f) * core::luminance(light.scattered(q.point));
    light.age = core::divide_or(age, sum, 0.0f);
    light.add_alone({q.receives * error_scale * std::sqrt(square) + turn_error * glm::length(turned)});
    light.served = true;
    return light;
}

/// A tolerance holds so many root mean squares of the distance of light without noise from planes. chosen: 2, as one
/// point in twenty exceeds it; not tuned.
constexpr float errors_of_detail = 2.0f;

/// Where both eyes see a place its light in the second may err so many times as much as in the first.
constexpr float most_rivalry = 1.2f;

/// Mean square error that is allowed to a point whose rays vary by so much, of which a share is left by its neighbours.
double allowed_square(const RegressionError& error, float tolerance, Allocation allocation) {
    if (!(error.batch_variance > 0.0)) return std::pow(tolerance / errors_of_detail, 2.0f);
    const double square = std::pow(tolerance / core::errors_of_noise, 2.0f);
    // Of rays of its own a block's mean has a 64th.
    const double alone = error.batch_variance * error.variance_share,
                 rays = samples_for(square, batch_rays, allocation.priced(alone, alone / 64), variance_power);
    return square * allocation.left(std::max(rays, 1.0 * pilot_rays));
}

}  // namespace

std::optional<PointLight> query_cache(const CacheQuery& q, const RecordGrid& grid, RecordStore& records,
                                      Allocation allocation, float error_scale, std::int64_t frame) {
    static thread_local LocalRegression fit;
    fit.collect(q, LocalRegression::Of::all_light, grid, records);
    const RegressionError error = fit.estimate();
    if (!error.is_valid()) return std::nullopt;
    PointLight light = blend(fit, q, records, error_scale, frame);
    const float found = core::luminance(light.scattered(q.point)), tolerance = q.tolerance.allows_samples(found);
    const bool as_other =
        q.other_error > 0.0f && light.error.value + std::sqrt(error.square) <= most_rivalry * q.other_error;
    if (!as_other && (!(tolerance > 0.0f) || !(core::errors_of_one_in_hundred * light.error.value <= tolerance) ||
                      !(allocation.priced(error.square, error.of_block) <=
                        allowed_square(error, q.tolerance.allows_noise(found), allocation))))
        return std::nullopt;
    light.error += {static_cast<float>(std::sqrt(error.square))};
    light.shared += {static_cast<float>(std::sqrt(error.of_block))};
    for (std::size_t i = 0; i < fit.size(); ++i)
        if (fit.weight(i) != 0.0f) records.mark_used(fit.record(i), frame);
    return light;
}

}  // namespace render2mpeg::renderer
