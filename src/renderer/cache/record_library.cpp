#include "renderer/cache/record_library.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>
#include <utility>

#include "renderer/tree/light_tree.h"

namespace render2mpeg::renderer {
namespace {

auto place_of(const StoredRecord& r) {
    return std::tuple(r.near_field, r.address.object, r.address.primitive, r.address.u, r.address.v, r.back_side);
}

StoredRecord stored(const IrradianceRecord& r, std::uint32_t near_field) {
    StoredRecord s;
    s.address = r.address;
    s.position = r.position;
    s.geometric_normal = core::PackedNormal(r.geometric_normal);
    s.shading_normal = core::PackedNormal(r.shading_normal);
    s.outgoing = r.lobe.outgoing;
    s.near_field = near_field;
    const std::array<glm::vec3, 7> light = {r.direct,     r.indirect,   r.lobe.f0,   r.lobe.schlick,
                                            r.by_rays[0], r.by_rays[1], r.by_rays[2]};
    std::transform(light.begin(), light.end(), s.light.begin(),
                   [](glm::vec3 part) { return PackedLight(glm::max(part, glm::vec3(0))); });
    s.alpha = r.lobe.alpha;
    s.depth = r.lobe.depth;
    s.batch_variance = r.batch_variance;
    s.error = r.error.value;
    s.clamped = r.clamped;
    s.numbers = r.numbers;
    s.ray_count = r.ray_count;
    s.next_ray = r.next_ray;
    s.back_side = r.back_side ? 1 : 0;
    s.capped = r.capped ? 1 : 0;
    s.set = r.set;
    return s;
}

IrradianceRecord record_from(const StoredRecord& s, std::int64_t frame) {
    IrradianceRecord r;
    r.address = s.address;
    r.position = s.position;
    r.geometric_normal = s.geometric_normal.unpack();
    r.shading_normal = s.shading_normal.unpack();
    r.lobe.alpha = s.alpha;
    r.lobe.depth = s.depth;
    r.lobe.outgoing = s.outgoing;
    const std::array<glm::vec3*, 7> light = {&r.direct,        &r.indirect,   &r.lobe.f0,   &r.lobe.schlick,
                                             r.by_rays.data(), &r.by_rays[1], &r.by_rays[2]};
    for (std::size_t k = 0; k < light.size(); ++k) s.light[k].unpack(light[k]->x, light[k]->y, light[k]->z);
    r.batch_variance = s.batch_variance;
    r.error = {s.error};
    r.clamped = s.clamped;
    r.numbers = s.numbers;
    r.ray_count = r.known_rays = s.ray_count;
    r.next_ray = s.next_ray;
    r.back_side = s.back_side != 0;
    r.capped = s.capped != 0;
    r.set = s.set;
    r.born = r.used = frame;
    return r;
}

}  // namespace

std::vector<StoredRecord> stored_records(std::span<const std::byte> bytes) {
    std::vector<StoredRecord> records(bytes.size() / sizeof(StoredRecord));
    if (!records.empty()) std::memcpy(records.data(), bytes.data(), records.size() * sizeof(StoredRecord));
    return records;
}

bool is_sound(const StoredRecord& s) {
    const auto is_light = [](const PackedLight& packed) {
        glm::vec3 light;
        packed.unpack(light.x, light.y, light.z);
        return std::isfinite(light.x + light.y + light.z) && glm::all(glm::greaterThanEqual(light, glm::vec3(0)));
    };
    const glm::vec3 sum = s.position + s.outgoing;
    return std::isfinite(sum.x + sum.y + sum.z + s.address.u + s.address.v) && s.alpha >= 0 && s.alpha <= 1 &&
           s.depth >= 0 && std::isfinite(s.depth) && s.batch_variance >= 0 && s.error >= 0 && s.clamped >= 0 &&
           std::isfinite(s.batch_variance + s.error + s.clamped) && s.set < representative_sets &&
           std::all_of(s.light.begin(), s.light.end(), is_light);
}

void RecordLibrary::know(std::vector<StoredRecord> records) {
    notes_ = true;
    known_ = std::move(records);
    std::stable_sort(known_.begin(), known_.end(), [](const StoredRecord& a, const StoredRecord& b) {
        return std::tuple(place_of(a), b.ray_count) < std::tuple(place_of(b), a.ray_count);
    });
    known_.erase(std::unique(known_.begin(), known_.end(),
                             [](const StoredRecord& a, const StoredRecord& b) { return place_of(a) == place_of(b); }),
                 known_.end());
    start_chunk();
}

void RecordLibrary::start_chunk() {
    taken_.assign(known_.size(), 0);
}

std::optional<IrradianceRecord> RecordLibrary::take(const SurfacePoint& p, std::uint32_t near_field,
                                                    std::int64_t frame) {
    const auto place = std::tuple(near_field, p.address.object, p.address.primitive, p.address.u, p.address.v,
                                  static_cast<std::uint8_t>(p.back_side ? 1 : 0));
    const auto found = std::lower_bound(known_.begin(), known_.end(), place,
                                        [](const StoredRecord& r, const auto& wanted) { return place_of(r) < wanted; });
    if (found == known_.end() || place_of(*found) != place) return std::nullopt;
    std::uint8_t& taken = taken_[static_cast<std::size_t>(found - known_.begin())];
    if (taken != 0 || (found->alpha > 0.0f) != p.bsdf.has_glossy()) return std::nullopt;
    taken = 1;
    return record_from(*found, frame);
}

void RecordLibrary::note(std::span<const IrradianceRecord> records, std::uint32_t near_field,
                         std::vector<StoredRecord>& noted) const {
    if (!notes_) return;
    for (const IrradianceRecord& r : records)
        if (r.next_ray > r.known_rays) noted.push_back(stored(r, near_field));
}

}  // namespace render2mpeg::renderer
