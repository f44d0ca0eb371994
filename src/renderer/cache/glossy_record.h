#pragma once
// Glossy light in records, and how far it may be reused.
#include <optional>

#include "renderer/cache/cache_query.h"

namespace render2mpeg::renderer {

/// Standard error of a lobe's light as its half vectors turn by its width, beyond the change known by `seen_from`.
/// Counts by the weighted sum of the records' turns. chosen: 0.23 of 0, 0.12, 0.23 and 0.38
/// (docs/measurements.md#irradiance-cache).
inline constexpr float turn_error = 0.23f;

/// A record's lobe towards the eye of a point that asks, by the point's material.
struct SeenLobe {
    glm::vec3 radiance{0};
    glm::vec3 turned{0};  ///< change of half vectors since, in widths, beyond what the record followed; times luminance
};

/// None where it says nothing of the point's.
std::optional<SeenLobe> lobe_at(const CacheQuery& query, const IrradianceRecord& record);

/// Whether a record's lobe, if it has one, was seen much as this eye sees it.
bool is_lobe_seen_from(const IrradianceRecord& record, glm::vec3 eye);

/// Radiance of a place's lobe towards another eye than the record's, `outgoing`: what hides and shadows its facets
/// changes with the angle to the normal, for the rest it must be wide. By the material of `bsdf`.
glm::vec3 seen_from(const GlossyRecord& lobe, glm::vec3 normal, glm::vec3 outgoing, const Bsdf& bsdf);

}  // namespace render2mpeg::renderer
