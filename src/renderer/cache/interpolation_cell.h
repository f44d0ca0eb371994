#pragma once
// Interpolates points between four that records served.
#include <array>
#include <optional>

#include "renderer/cache/cache_query.h"

namespace render2mpeg::renderer {

/// A point at the corner of a cell of the lattice, and what records said of it.
struct CellCorner {
    SurfaceMark mark;
    float extent = 0;  ///< of a pixel there, across the line of sight; world
    const PointLight* light = nullptr;
    float receives = 0;         ///< as CacheQuery's
    float reflects = 0;         ///< luminance of the pixel by unit of light from all around, however dark
    float scattered = 0;        ///< luminance of what it sends into its pixel
    float allowed = 0;          ///< luminance that its pixel may be off by for it
    float residual_factor = 1;  ///< residual_factor, by that
};

/// Light between four points that records served, where it changes among them as it does from one to the next: lights
/// many points for the price of four queries (docs/model/irradiance-cache.md). Of surfaces without lobes.
class InterpolationCell {
  public:
    /// Of the corners left above, right above, left below, right below, so many pixels apart; none where they do not
    /// lie on one surface, or span no cell. Notes the use of records in it.
    static std::optional<InterpolationCell> between(const std::array<CellCorner, 4>& corners, int side,
                                                    const RecordGrid& grid, RecordStore& records, std::int64_t frame);

    /// Light of a point in the cell, if that is within its tolerance.
    bool interpolate(const CacheQuery& query, const CacheErrorModel& model, PointLight& light) const;

  private:
    /// What one thing is at a place, by the corners.
    template <typename T>
    T at(glm::vec2 place, const std::array<T, 4>& corners) const {
        return (1.0f - place.y) * ((1.0f - place.x) * corners[0] + place.x * corners[1]) +
               place.y * ((1.0f - place.x) * corners[2] + place.x * corners[3]);
    }
    /// From the corner left above, in sides.
    glm::vec2 place_of(glm::vec2 on_picture) const;
    /// What records in it are off the mean of the corners, what that may be off a plane, and what light may rise by up
    /// to the nearest corner where no record says that this is no step, by colour.
    void estimate_error(int side, float extent, const RecordGrid& grid, RecordStore& records, std::int64_t frame);

    std::array<SurfaceMark, 4> marks_;
    std::array<glm::vec3, 4> direct_, indirect_;  ///< irradiance over pi
    std::array<float, 4> clamped_, age_;          ///< the former as a share of light
    glm::vec3 off_{0}, rise_{0};                  ///< irradiance over pi
    float error_ = 0, disagreement_ = 0;          ///< luminance for a white receiver
    float residual_factor_ = 0;                   ///< the least of the corners'
    bool capped_ = false;
};

}  // namespace render2mpeg::renderer
