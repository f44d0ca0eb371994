#pragma once
// Which points use the cache, and as what receiver they are gathered for it.
#include <optional>

#include "renderer/cache/irradiance_record.h"
#include "renderer/cut/point_light.h"
#include "renderer/gather/final_gather.h"

namespace render2mpeg::renderer {

/// Whether a point's light may come from records: seen directly, without a lobe or with one that is not too narrow.
bool uses_cache(const GatherPoint& p);

/// Luminance that a point's pixel gets of light 1 from all around; for records, which serve other textures as well, as
/// if it were not quite black.
float receives(const GatherPoint& p);

/// A receiver in a point's place whose light serves other textures as well: grey at least, and never quite black. What
/// a texture reflects more of than its luminance says, as deep blue, counts in full, so that light of many colours is
/// told well enough for it.
GatherPoint plain_receiver(const GatherPoint& p);

/// The record of light that trees and rays bring to a point's plain receiver, with an error scale; none where it is not
/// finite.
std::optional<IrradianceRecord> record_of(const GatherPoint& p, const PointLight& trees, const GlossyRecord& lobe,
                                          const RayLight& rays, float error_scale, std::int64_t frame);

/// Light that a record's first rays found, for its plain receiver.
RecordPilot pilot_of(const RayLight& rays, const GatherPoint& plain);

/// A record as its own baseline.
RecordBaseline baseline_of(const IrradianceRecord& record);

/// Adds rays to a record; `plain` is the receiver that they were traced for. False, and nothing is added, where they
/// found light that is not finite.
bool take_rays(const RayLight& rays, const GatherPoint& plain, IrradianceRecord& record);

}  // namespace render2mpeg::renderer
