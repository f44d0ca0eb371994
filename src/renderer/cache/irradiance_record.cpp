#include "renderer/cache/irradiance_record.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/numeric.h"

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

void RecordGrid::extend(std::span<const IrradianceRecord> records, const scene::Camera& camera) {
    if (!starts_.empty() && records.size() == places_.size()) return;
    const int across = width_ + 2 * border, down = height_ + 2 * border;
    const auto pixels = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
    for (std::size_t i = places_.size(); i < records.size(); ++i) {
        places_.push_back({{}, nowhere});
        const auto seen = camera.project(records[i].position);
        if (!seen) continue;
        const float x = std::floor(seen->position.x), y = std::floor(seen->position.y);
        if (!(x >= -border && y >= -border && x < static_cast<float>(width_ + border) &&
              y < static_cast<float>(height_ + border)))
            continue;
        places_.back() = {seen->position, static_cast<std::uint32_t>((static_cast<int>(y) + border) * across +
                                                                     static_cast<int>(x) + border)};
    }
    // Count, then place: the order within a pixel stays.
    starts_.assign(pixels + 1, 0);
    for (const Place& place : places_)
        if (place.pixel != nowhere) ++starts_[place.pixel + 1];
    for (std::size_t p = 0; p < pixels; ++p) starts_[p + 1] += starts_[p];
    marks_.resize(starts_[pixels]);
    std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
    for (std::size_t i = 0; i < records.size(); ++i) {
        const Place& place = places_[i];
        if (place.pixel == nowhere) continue;
        const IrradianceRecord& r = records[i];
        marks_[next[place.pixel]++] = {place.at,
                                       static_cast<std::uint32_t>(i),
                                       surface_of(r.address, r.back_side),
                                       r.position,
                                       r.geometric_normal,
                                       r.shading_normal};
    }
}

core::Plane<float> RecordGrid::density() const {
    core::Plane<float> count(width_, height_);
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) count.at(x, y) = static_cast<float>(row(y, x, x).size());
    return count;
}

std::uint32_t RecordStore::insert(const IrradianceRecord& record) {
    records_.push_back(record);
    return static_cast<std::uint32_t>(records_.size() - 1);
}

void RecordStore::mark_used(std::uint32_t index, std::int64_t frame) {
    std::atomic_ref<std::int64_t>(records_[index].used).store(frame, std::memory_order_relaxed);
}

std::vector<IrradianceRecord> RecordStore::thin(std::int64_t frame, const RecordGrid& map) {
    std::vector<std::uint8_t> keeps(records_.size(), 1);
    const std::span<const SurfaceMark> marks = map.marks();
    struct Crowding {
        std::uint32_t surface;
        std::int64_t born;
        std::uint32_t record;
    };
    std::vector<Crowding> of_pixel;
    for (std::size_t first = 0, last = 0; first < marks.size(); first = last) {
        const glm::vec2 pixel = glm::floor(marks[first].at);
        while (last < marks.size() && glm::floor(marks[last].at) == pixel) ++last;
        if (last - first < 2) continue;
        // Surface by surface, the oldest first: after a cut to a far view a pixel may hold thousands.
        of_pixel.clear();
        for (std::size_t i = first; i < last; ++i)
            of_pixel.push_back({marks[i].surface, records_[marks[i].record].born, marks[i].record});
        std::sort(of_pixel.begin(), of_pixel.end(), [](const Crowding& a, const Crowding& b) {
            return std::tie(a.surface, a.born, a.record) < std::tie(b.surface, b.born, b.record);
        });
        for (std::size_t i = 0; i + 1 < of_pixel.size(); ++i) {
            if (i + most_in_pixel < of_pixel.size() && of_pixel[i + most_in_pixel].surface == of_pixel[i].surface)
                keeps[of_pixel[i].record] = 0;
        }
    }
    std::vector<IrradianceRecord> dropped;
    for (std::size_t i = 0; i < records_.size(); ++i) {
        if (frame - records_[i].used > keeps_unused) keeps[i] = 0;
        if (keeps[i] == 0) dropped.push_back(records_[i]);
    }
    // In the order of the picture, since pixels ask for those around them: what is neither dropped nor seen comes last.
    std::vector<IrradianceRecord> kept;
    kept.reserve(records_.size());
    const auto take = [&](std::size_t i) {
        if (keeps[i] != 0) kept.push_back(records_[i]);
        keeps[i] = 0;
    };
    for (const SurfaceMark& m : marks) take(m.record);
    for (std::size_t i = 0; i < records_.size(); ++i) take(i);
    records_.swap(kept);
    return dropped;
}

}  // namespace render2mpeg::renderer
