#include "renderer/cache/record_change.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cache/record_plane.h"

namespace render2mpeg::renderer {
namespace {

/// Changes within so many pixels of a record count: some dozen on a lattice of 4.
constexpr int reach = 8;

/// A mover's box reaches out by this share of its diagonal: nearer, its shadow has edges of few pixels. chosen: 0.5,
/// not tuned.
constexpr float shadow_reach = 0.5f;

struct Box {
    glm::vec3 low{std::numeric_limits<float>::max()}, high{-std::numeric_limits<float>::max()};
    void add(glm::vec3 p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    bool holds(glm::vec3 p) const {
        return glm::all(glm::greaterThanEqual(p, low)) && glm::all(glm::lessThanEqual(p, high));
    }
};

void add_object(Box& box, const scene::Snapshot& at, std::size_t object) {
    const scene::ObjectState& state = at.objects[object];
    if (!state.present) return;
    if (state.deformed >= 0) {
        for (const glm::vec3& p : at.deformed[static_cast<std::size_t>(state.deformed)].positions) box.add(p);
        return;
    }
    const auto mesh = static_cast<std::size_t>(at.animation->objects[object].mesh);
    for (const glm::vec3& p : at.animation->meshes[mesh].positions)
        box.add(glm::vec3(state.to_world * glm::vec4(p, 1.0f)));
}

/// What changes did around one record.
class ChangeThere {
  public:
    ChangeThere(const RecordMap& map, const std::vector<LightChange>& changes) : map_(map), changes_(changes) {}

    /// Those around; false where they say too little.
    bool find(const RecordMark& mark, float pixel);
    /// Changes the record as they do, if they agree.
    bool apply(Record& record);

  private:
    /// What light was multiplied by, and what it is off that by, as a share of it.
    struct Ratio {
        float direct = 0, indirect = 0, off = 0;
    };
    void add(Record& record) const;
    static void scale_slopes(Record& record, float factor) {
        record.slopes.by_place *= factor;
        record.slopes.by_normal *= factor;
    }
    Ratio ratio() const;

    const RecordMap& map_;
    const std::vector<LightChange>& changes_;
    RecordPlane plane_;
    const LightChange* found_[RecordPlane::most] = {};
    float allowed_ = 0;
};

bool ChangeThere::find(const RecordMark& mark, float pixel) {
    plane_.clear();
    allowed_ = std::numeric_limits<float>::max();
    const int x = static_cast<int>(std::floor(mark.at.x)), y = static_cast<int>(std::floor(mark.at.y));
    constexpr float r2 = (reach + 0.5f) * (reach + 0.5f);
    for (int row = std::max(y - reach, -RecordMap::border);
         row <= std::min(y + reach, map_.height() + RecordMap::border - 1); ++row) {
        for (const RecordMark& m : map_.row(row, std::max(x - reach, -RecordMap::border),
                                            std::min(x + reach, map_.width() + RecordMap::border - 1))) {
            const glm::vec2 offset = m.at - mark.at;
            const float distance2 = glm::dot(offset, offset);
            if (distance2 > r2 || plane_.is_full() || !on_one_surface(mark, m, pixel * std::sqrt(distance2), pixel))
                continue;
            const LightChange& c = changes_[m.record];
            const float falloff = 1.0f - distance2 / (1.1f * r2);
            found_[plane_.count()] = &c;
            allowed_ = std::min(allowed_, c.allowed);
            plane_.add(offset, falloff * falloff / (4.0f + distance2),
                       c.place.direct + c.place.indirect - c.direct_before - c.indirect_before);
        }
    }
    return plane_.fit() || plane_.fit_level();
}

void ChangeThere::add(Record& record) const {
    glm::vec3 direct(0), indirect(0);
    for (int i = 0; i < plane_.count(); ++i) {
        direct += plane_.weight(i) * (found_[i]->place.direct - found_[i]->direct_before);
        indirect += plane_.weight(i) * (found_[i]->place.indirect - found_[i]->indirect_before);
    }
    const float before = core::luminance(record.direct + record.indirect);
    record.direct = glm::max(record.direct + direct, glm::vec3(0));
    record.indirect = glm::max(record.indirect + indirect, glm::vec3(0));
    // Nobody knows the slopes of what came; of what is left after something went, there is no more than was.
    const float now = core::luminance(record.direct + record.indirect);
    scale_slopes(record, std::min(core::divide_or(now, before, 0.0f), 1.0f));
}

ChangeThere::Ratio ChangeThere::ratio() const {
    const auto of = [](glm::vec3 now, glm::vec3 before) {
        return core::divide_or(core::luminance(now), core::luminance(before), 1.0f);
    };
    Ratio all;
    for (int i = 0; i < plane_.count(); ++i) {
        const LightChange& c = *found_[i];
        all.direct += plane_.weight(i) * of(c.place.direct, c.direct_before);
        all.indirect += plane_.weight(i) * of(c.place.indirect, c.indirect_before);
    }
    float square = 0;
    for (int i = 0; i < plane_.count(); ++i) {
        const LightChange& c = *found_[i];
        const float found = core::luminance(c.place.direct + c.place.indirect);
        const float told = core::luminance(all.direct * c.direct_before + all.indirect * c.indirect_before);
        const float relative = core::divide_or(found - told, std::max(found, told), 0.0f);
        square += relative * relative / static_cast<float>(plane_.count());
    }
    all.off = std::sqrt(square);
    return all;
}

bool ChangeThere::apply(Record& record) {
    // As where a lamp is dimmed or grows bright, which lights what is bright and what is not by one factor; or as where
    // something comes or goes, by one sum.
    const Ratio all = ratio();
    const bool has_ratio = all.direct >= 0.0f && all.indirect >= 0.0f;
    const float sum_off = plane_.residual(), ratio_off = all.off * core::luminance(record.direct + record.indirect);
    if (has_ratio && ratio_off <= sum_off && ratio_off <= allowed_) {
        const float before = core::luminance(record.direct + record.indirect);
        record.direct *= all.direct;
        record.indirect *= all.indirect;
        scale_slopes(record, core::divide_or(core::luminance(record.direct + record.indirect), before, 1.0f));
        return true;
    }
    if (!(sum_off <= allowed_)) return false;
    add(record);
    return true;
}

}  // namespace

bool same_light(const scene::Snapshot& a, const scene::Snapshot& b) {
    const auto same_object = [](const scene::ObjectState& x, const scene::ObjectState& y) {
        return x.to_world == y.to_world && x.present == y.present && x.deformed == y.deformed;
    };
    const auto same_lamp = [](const scene::LightState& x, const scene::LightState& y) {
        return x.kind == y.kind && x.position == y.position && x.direction == y.direction &&
               x.intensity == y.intensity && x.range == y.range && x.cos_inner == y.cos_inner &&
               x.cos_outer == y.cos_outer && x.id == y.id;
    };
    const auto same_shape = [](const scene::DeformedMesh& x, const scene::DeformedMesh& y) {
        return x.positions == y.positions && x.normals == y.normals;
    };
    return std::equal(a.objects.begin(), a.objects.end(), b.objects.begin(), b.objects.end(), same_object) &&
           std::equal(a.lights.begin(), a.lights.end(), b.lights.begin(), b.lights.end(), same_lamp) &&
           std::equal(a.deformed.begin(), a.deformed.end(), b.deformed.begin(), b.deformed.end(), same_shape) &&
           a.emission_factor == b.emission_factor;
}

void drop_disturbed(Records& records, const scene::Snapshot& before, const scene::Snapshot& now) {
    const std::size_t count = std::min(before.objects.size(), now.objects.size());
    std::vector<Box> boxes;
    std::vector<std::uint8_t> moves(now.objects.size(), 0);
    for (std::size_t o = 0; o < count; ++o) {
        const scene::ObjectState &a = before.objects[o], &b = now.objects[o];
        if (a.deformed < 0 && b.deformed < 0 && a.present == b.present && a.to_world == b.to_world) continue;
        moves[o] = 1;
        Box box;
        add_object(box, before, o);
        add_object(box, now, o);
        if (!(box.high.x >= box.low.x)) continue;
        const glm::vec3 margin(shadow_reach * glm::length(box.high - box.low));
        boxes.push_back({box.low - margin, box.high + margin});
    }
    std::vector<std::uint8_t> keeps;
    for (const Record& r : records.all())
        keeps.push_back(moves[r.address.object] == 0 && std::none_of(boxes.begin(), boxes.end(),
                                                                     [&](const Box& b) { return b.holds(r.position); })
                            ? 1
                            : 0);
    records.keep(keeps);
}

FollowedRecords follow(Records& records, const RecordMap& map, const std::vector<LightChange>& changes,
                       const scene::Camera& camera) {
    std::vector<Record> places;
    places.reserve(changes.size());
    for (const LightChange& c : changes) places.push_back(c.place);
    RecordMap around(map.width(), map.height());
    around.build(places, camera);

    const std::span<const RecordMark> marks = map.marks();
    std::vector<std::uint8_t> follows(records.size(), 0);
    constexpr std::size_t grain = 1024;
    parallel::for_ranges(marks.size(), grain, [&](std::size_t first, std::size_t last) {
        ChangeThere there(around, changes);
        for (std::size_t i = first; i < last; ++i) {
            const auto seen = camera.project(marks[i].position);
            if (!seen) continue;
            const float pixel = camera.pixel_size() * (camera.perspective() ? seen->depth : 1.0f);
            Record& record = records.change(marks[i].record);
            // What a lobe sends would need its own changes.
            if (record.lobe.alpha > 0.0f || !there.find(marks[i], pixel)) continue;
            record.followed = there.apply(record);
            follows[marks[i].record] = record.followed ? 1 : 0;
        }
    });
    FollowedRecords done;
    for (const std::uint8_t f : follows) ++(f != 0 ? done.changed : done.dropped);
    records.keep(follows);
    return done;
}

}  // namespace render2mpeg::renderer
