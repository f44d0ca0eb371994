#include "renderer/cache/irradiance_record.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "core/numeric.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// Frames after which a record that served no pixel is forgotten. chosen: 8, a third of a second: what an edge hides
/// for a moment comes back; not tuned.
constexpr std::int64_t keeps_unused = 8;

/// Records of one surface in one pixel: more say no more. chosen: 4, one of each set of representatives; not tuned.
constexpr std::size_t most_in_pixel = 4;

/// chosen: looser than where samples of one surface are told apart (see.cpp), since a plane follows normals that change
/// evenly; not tuned.
constexpr float least_normal = 0.95f;
/// Off the surface's plane, in pixels' extents: near, and by pixel of distance. chosen: 0.3 and 0.09, lower than steps
/// that are seen as steps (see.cpp); not tuned.
constexpr float plane_near = 0.3f, plane_slope = 0.09f;

/// Records of one task.
constexpr std::size_t marks_at_once = 1024;

constexpr std::uint32_t nowhere = std::numeric_limits<std::uint32_t>::max();

}  // namespace

bool on_one_surface(const SurfaceMark& a, const SurfaceMark& b, float apart, float pixel, float error) {
    if (a.surface != b.surface || glm::dot(a.geometric_normal, b.geometric_normal) < least_normal) return false;
    const float alike = glm::dot(a.shading_normal, b.shading_normal);
    if (alike < least_normal) return false;
    const glm::vec3 between = b.position - a.position;
    const float off =
        std::max(std::abs(glm::dot(between, a.geometric_normal)), std::abs(glm::dot(between, b.geometric_normal)));
    // A surface that bends by an angle over a distance leaves its plane by half of their product.
    const float bend = 0.5f * glm::length(between) * core::sqrt_or_zero(2.0f - 2.0f * alike);
    return off <= pixel * plane_near + apart * plane_slope + bend + error;
}

namespace {

std::optional<glm::vec2> place_on_picture(const IrradianceRecord& record, const scene::Camera& camera) {
    if (record.is_of_frame()) return record.seen_at;
    const auto seen = camera.project(record.position - record.lobe.depth * record.lobe.outgoing);
    return seen ? std::optional(seen->position) : std::nullopt;
}

}  // namespace

RecordGrid::Place RecordGrid::place_of(const IrradianceRecord& record, const scene::Camera& camera) const {
    const std::optional<glm::vec2> at = place_on_picture(record, camera);
    if (!at) return {{}, nowhere};
    const float x = std::floor(at->x), y = std::floor(at->y);
    if (!(x >= -border && y >= -border && x < static_cast<float>(width_ + border) &&
          y < static_cast<float>(height_ + border)))
        return {{}, nowhere};
    const int across = width_ + 2 * border;
    return {*at, static_cast<std::uint32_t>((static_cast<int>(y) + border) * across + static_cast<int>(x) + border)};
}

void RecordGrid::extend(std::span<const IrradianceRecord> records, const scene::Camera& camera) {
    wraps_ = camera.wraps();
    if (!starts_.empty() && records.size() == places_.size()) return;
    const auto pixels = static_cast<std::size_t>(width_ + 2 * border) * static_cast<std::size_t>(height_ + 2 * border);
    const std::size_t known = places_.size();
    places_.resize(records.size());
    parallel::for_ranges(records.size() - known, marks_at_once, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = known + first; i < known + last; ++i) places_[i] = place_of(records[i], camera);
    });
    // Count, then place: the order within a pixel stays.
    starts_.assign(pixels + 1, 0);
    for (const Place& place : places_)
        if (place.pixel != nowhere) ++starts_[place.pixel + 1];
    for (std::size_t p = 0; p < pixels; ++p) starts_[p + 1] += starts_[p];
    std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1), order(starts_[pixels]);
    for (std::uint32_t i = 0; i < records.size(); ++i)
        if (places_[i].pixel != nowhere) order[next[places_[i].pixel]++] = i;
    marks_.resize(order.size());
    parallel::for_ranges(order.size(), marks_at_once, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            const IrradianceRecord& r = records[order[k]];
            marks_[k] = {places_[order[k]].at, order[k],           surface_of(r.address, r.back_side, r.path),
                         r.position,           r.geometric_normal, r.shading_normal};
        }
    });
}

core::Plane<float> RecordGrid::density() const {
    core::Plane<float> count(width_, height_);
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) count.at(x, y) = static_cast<float>(row(y, x, x).size());
    return count;
}

void for_each_pixel(std::span<const SurfaceMark> marks,
                    const std::function<void(std::span<const SurfaceMark>)>& visit) {
    const auto ends_pixel = [&](std::size_t i) {
        return i == marks.size() || glm::floor(marks[i].at) != glm::floor(marks[i - 1].at);
    };
    parallel::for_ranges(marks.size(), marks_at_once, [&](std::size_t first, std::size_t last) {
        // A task has the pixels that begin in its range.
        while (first > 0 && first < last && !ends_pixel(first)) ++first;
        while (first < last) {
            std::size_t end = first + 1;
            while (!ends_pixel(end)) ++end;
            visit(marks.subspan(first, end - first));
            first = end;
        }
    });
}

std::uint32_t RecordStore::insert(IrradianceRecord record) {
    records_.push_back(std::move(record));
    return static_cast<std::uint32_t>(records_.size() - 1);
}

void RecordStore::mark_used(std::uint32_t index, std::int64_t frame) {
    std::atomic_ref<std::int64_t>(records_[index].used).store(frame, std::memory_order_relaxed);
}

std::vector<IrradianceRecord> RecordStore::thin(std::int64_t frame, const RecordGrid& map) {
    std::vector<std::uint8_t> keeps(records_.size(), 1);
    const std::span<const SurfaceMark> marks = map.marks();
    struct Crowding {
        std::uint64_t surface;
        std::int64_t born;
        std::uint32_t record;
    };
    for_each_pixel(marks, [&](std::span<const SurfaceMark> here) {
        if (here.size() < 2) return;
        // Surface by surface, the oldest first: after a cut to a far view a pixel may hold thousands.
        std::vector<Crowding> crowd;
        for (const SurfaceMark& m : here) crowd.push_back({m.surface, records_[m.record].born, m.record});
        std::sort(crowd.begin(), crowd.end(), [](const Crowding& a, const Crowding& b) {
            return std::tie(a.surface, a.born, a.record) < std::tie(b.surface, b.born, b.record);
        });
        for (std::size_t i = 0; i + most_in_pixel < crowd.size(); ++i)
            if (crowd[i + most_in_pixel].surface == crowd[i].surface) keeps[crowd[i].record] = 0;
    });
    std::vector<IrradianceRecord> dropped;
    for (std::size_t i = 0; i < records_.size(); ++i) {
        const IrradianceRecord& r = records_[i];
        if (r.is_of_frame() || frame - r.used > keeps_unused) keeps[i] = 0;
        if (keeps[i] == 0 && !r.is_of_frame()) dropped.push_back(r);
    }
    // In the order of the picture, since pixels ask for those around them: what is neither dropped nor seen comes last.
    std::vector<std::uint32_t> order;
    order.reserve(records_.size());
    const auto take = [&](std::uint32_t i) {
        if (keeps[i] != 0) order.push_back(i);
        keeps[i] = 0;
    };
    for (const SurfaceMark& m : marks) take(m.record);
    for (std::uint32_t i = 0; i < records_.size(); ++i) take(i);
    std::vector<IrradianceRecord> kept(order.size());
    parallel::for_ranges(order.size(), marks_at_once, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) kept[k] = std::move(records_[order[k]]);
    });
    records_.swap(kept);
    return dropped;
}

}  // namespace render2mpeg::renderer
