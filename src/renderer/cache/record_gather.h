#pragma once
// Gathers light for new records.
#include <optional>
#include <vector>

#include "renderer/cache/lobe_trials.h"
#include "renderer/cache/record_groups.h"
#include "renderer/cache/records.h"
#include "renderer/cut/cut.h"
#include "renderer/cut/point_light.h"
#include "renderer/cut/shade.h"

namespace render2mpeg::renderer {

/// Whether a point's light may come from records: seen directly, without a lobe or with one that is not too narrow and
/// whose material's are served often enough.
bool takes_records(const GatherPoint& p, const LobeTrials& trials);

/// Luminance that a point's pixel gets of light 1 from all around; for records, which serve other textures as well, as
/// if it were not quite black.
float receives(const GatherPoint& p);

/// A receiver in a point's place whose light serves other textures as well: grey at least, and never quite black. What
/// a texture reflects more of than its luminance says, as deep blue, counts in full, so that light of many colours is
/// told well enough for it.
GatherPoint plain_receiver(const GatherPoint& p);

/// The record of what was gathered at a point with an error scale; none where that is not finite.
std::optional<Record> record_of(const GatherPoint& p, const PointLight& light, const RecordLobe& lobe,
                                float error_scale, std::int64_t frame);

/// What was found of some requests, in the order in which they were gathered.
struct GatheredRequests {
    std::vector<PointRef> points;
    std::vector<PointLight> light;
    std::vector<RecordLobe> lobes;
    std::vector<std::uint8_t> sets;  ///< of representatives
    ShadeCounts counts;
};

/// Gathers the requests of one area in groups, those that take records for these; `tolerances` are those of all points
/// of all tiles.
void gather_requests(const LightTrees& light_trees, const RayTracer& tracer, const Seen& seen, glm::vec3 eye,
                     const std::vector<std::vector<PointTolerance>>& tolerances, const CutLimits& limits,
                     const LobeTrials& trials, const std::vector<PointRef>& requests, GatheredRequests& out);

}  // namespace render2mpeg::renderer
