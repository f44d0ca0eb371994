#pragma once
// Irradiance records, the grid that finds them on the picture, and the store of a chunk.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "core/archive.h"
#include "core/plane.h"
#include "core/surface_address.h"
#include "renderer/base/stream.h"
#include "renderer/cut/point_light.h"
#include "renderer/surface/gather_point.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// Light of a surface's glossy lobe towards one direction, per unit of its two parts: radiance is f0 x `f0` +
/// `schlick`.
struct GlossyRecord {
    float alpha = 0;        ///< its width; 0: no lobe
    glm::vec3 outgoing{0};  ///< unit, world
    glm::vec3 f0{0}, schlick{0};
    float depth = 0;  ///< so far behind the surface, along the line of sight, lies what it shows
};

/// Light that the first rays of a record find at an instant (RayLight).
struct RecordPilot {
    std::array<glm::vec3, 3> light{};
    float difference = 0;  ///< luminance by the first 8 less that by the others, for a receiver that reflects all
};

/// A record at the instant of its rays. Later light is found as a change of it.
struct RecordBaseline {
    std::array<glm::vec3, 3> light{};  ///< by its rays
    RecordPilot pilot;
    double variance = 0;  ///< of `light`: luminance squared, for a receiver that reflects all
    std::uint32_t ray_count = 0;
};

/// Incident light at one place on a surface, independent of its texture (docs/model/irradiance-cache.md): kept where it
/// was gathered and never resampled. Exactly gathered lights are no part of it.
struct IrradianceRecord {
    core::SurfaceAddress address;
    bool back_side = false;
    std::uint8_t path = direct_path;  ///< GatherPoint's
    bool capped = false;              ///< its cut ended before its tolerance was kept
    std::uint8_t set = 0;             ///< of representatives that lit it, 0..3
    glm::vec3 position{0};            ///< world, at the instant of the frame
    glm::vec3 geometric_normal{0};    ///< likewise
    glm::vec3 shading_normal{0};
    glm::vec2 seen_at{0};              ///< place on the picture where it was gathered, pixels
    glm::vec3 direct{0}, indirect{0};  ///< irradiance over pi, of light trees
    GlossyRecord lobe;                 ///< likewise
    /// Light of gather rays (RayLight), their number, and the variance of the mean of 8 of them: luminance squared, for
    /// a receiver that reflects all.
    std::array<glm::vec3, 3> by_rays{};
    std::uint32_t ray_count = 0;  ///< effective number of rays at the last instant
    float batch_variance = 0;
    Stream numbers;                ///< of its rays
    std::uint32_t next_ray = 0;    ///< number of rays that were traced for it
    std::uint32_t known_rays = 0;  ///< of them in earlier runs
    RecordPilot pilot;
    bool is_pilot_now = true;                          ///< `pilot` is of the last instant
    std::shared_ptr<const RecordBaseline> baseline{};  ///< null: the last instant is that of all its rays
    PointTolerance tolerance;                          ///< that its trees' light is within
    /// Of light of trees for a white receiver, luminance, with an error scale of 1.
    core::StandardError error{};
    float clamped = 0;                ///< loss to the clamp of near lights, as a share of arriving light
    std::int64_t born = 0, used = 0;  ///< frames

    glm::vec3 irradiance() const { return direct + indirect + by_rays[0]; }  ///< over pi
    /// Whether it was seen in mirrors or through glass, and lasts for its frame alone.
    bool is_of_frame() const { return path != direct_path; }
};

/// Every member of a record.
template <class A>
void archive(A& a, IrradianceRecord& r) {
    auto& [address, back_side, path, capped, set, position, geometric_normal, shading_normal, seen_at, direct, indirect,
           lobe, by_rays, ray_count, batch_variance, numbers, next_ray, known_rays, pilot, is_pilot_now, baseline,
           tolerance, error, clamped, born, used] = r;
    a(address, back_side, path, capped, set, position, geometric_normal, shading_normal, seen_at);
    a(direct, indirect, lobe, by_rays, ray_count, batch_variance, numbers, next_ray, known_rays);
    a(pilot, is_pilot_now, baseline, tolerance, error, clamped, born, used);
}

/// A record as it is found from pixels.
struct SurfaceMark {
    glm::vec2 at{0};  ///< on the picture, pixels
    std::uint32_t record = 0;
    std::uint64_t surface = 0;  ///< `surface_of`
    glm::vec3 position{0};
    glm::vec3 geometric_normal{0};
    glm::vec3 shading_normal{0};
};

/// Records (and points) that may lie on one surface have this in common.
inline std::uint64_t surface_of(const core::SurfaceAddress& address, bool back_side, std::uint8_t path) {
    return std::uint64_t{path} << 33 | std::uint64_t{address.object} << 1 | (back_side ? 1u : 0u);
}

/// Whether two places `apart` on the picture lie on one smooth surface; both in world units at their distance, where a
/// pixel is so large. `error`: by how much either may lie off its surface.
bool on_one_surface(const SurfaceMark& a, const SurfaceMark& b, float apart, float pixel, float error = 0);

/// Where the records of a frame lie on its picture, pixel by pixel, and for some pixels around it.
class RecordGrid {
  public:
    /// Radius, in pixels, that look-ups may have, and width of the border.
    static constexpr int border = 9;

    RecordGrid() = default;
    RecordGrid(int width, int height) : width_(width), height_(height) {}

    /// Sorts the records in. Their order within a pixel is their own.
    void build(std::span<const IrradianceRecord> records, const scene::Camera& camera) {
        places_.clear();
        starts_.clear();
        extend(records, camera);
    }
    /// The same, where those of the last time lie where they did and others have come behind them.
    void extend(std::span<const IrradianceRecord> records, const scene::Camera& camera);

    /// Whether a look-up of up to `radius` pixels about a place of the picture may find any; not where that is not
    /// finite.
    bool reaches(glm::vec2 at, int radius) const {
        const auto margin = static_cast<float>(border + radius);
        return at.x >= -margin && at.y >= -margin && at.x < static_cast<float>(width_) + margin &&
               at.y < static_cast<float>(height_) + margin;
    }

    /// The marks of pixels [x0, x1] of a row, one after the other; all within the border. None where x0 > x1.
    std::span<const SurfaceMark> row(int y, int x0, int x1) const {
        if (x0 > x1) return {};
        const std::size_t base = static_cast<std::size_t>(y + border) * static_cast<std::size_t>(width_ + 2 * border);
        const std::size_t first = base + static_cast<std::size_t>(x0 + border);
        const std::size_t last = base + static_cast<std::size_t>(x1 + border) + 1;
        return std::span(marks_).subspan(starts_[first], starts_[last] - starts_[first]);
    }
    /// Calls visit(mark, aside) for the marks of pixels x0 to x1 of a row, where these lie within the border; with
    /// those beyond the seam of a picture that wraps, which lie `aside` from where their marks say.
    template <class Visit>
    void visit_row(int y, int x0, int x1, Visit&& visit) const {
        for (const SurfaceMark& m : row(y, std::max(x0, -border), std::min(x1, width_ + border - 1))) visit(m, 0.0f);
        if (!wraps_) return;
        const auto turn = static_cast<float>(width_);
        for (const SurfaceMark& m : row(y, x0 + width_, width_ - 1)) visit(m, -turn);
        for (const SurfaceMark& m : row(y, 0, x1 - width_)) visit(m, turn);
    }
    std::size_t size() const { return marks_.size(); }
    /// All marks, pixel by pixel.
    std::span<const SurfaceMark> marks() const { return marks_; }
    /// How many lie in each pixel of the picture.
    core::Plane<float> density() const;
    int width() const { return width_; }
    int height() const { return height_; }

  private:
    struct Place {
        glm::vec2 at{0};
        std::uint32_t pixel = 0;  ///< of the picture with its border; or nowhere
    };

    Place place_of(const IrradianceRecord& record, const scene::Camera& camera) const;

    int width_ = 0, height_ = 0;
    bool wraps_ = false;                 ///< as its camera's picture
    std::vector<Place> places_;          ///< of the records
    std::vector<std::uint32_t> starts_;  ///< of each pixel in `marks_`, and the end
    std::vector<SurfaceMark> marks_;
};

/// Calls visit(marks) for the marks of each pixel, given pixel by pixel, from many threads.
void for_each_pixel(std::span<const SurfaceMark> marks, const std::function<void(std::span<const SurfaceMark>)>& visit);

/// The records of a chunk.
class RecordStore {
  public:
    /// None: a chunk begins.
    void forget() { records_.clear(); }

    /// Drops those that `is_lost`, keeping the order of the others.
    template <class IsLost>
    void drop(IsLost&& is_lost) {
        std::erase_if(records_, is_lost);
    }

    /// Drops what was of no use for some frames, and the oldest of those that crowd one pixel of the frame's map.
    /// Returns them.
    std::vector<IrradianceRecord> thin(std::int64_t frame, const RecordGrid& map);

    std::uint32_t insert(IrradianceRecord record);
    IrradianceRecord& change(std::uint32_t index) { return records_[index]; }
    const IrradianceRecord& operator[](std::uint32_t index) const { return records_[index]; }
    std::span<const IrradianceRecord> all() const { return records_; }
    std::span<IrradianceRecord> all() { return records_; }
    std::size_t size() const { return records_.size(); }

    /// Notes that a record served; may be called from many threads.
    void mark_used(std::uint32_t index, std::int64_t frame);

    template <class A>
    friend void archive(A& a, RecordStore& store) {
        auto& [records] = store;
        a(records);
    }

  private:
    std::vector<IrradianceRecord> records_;
};

}  // namespace render2mpeg::renderer
