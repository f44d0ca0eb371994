#pragma once
// Light between the lit points of a lattice: joint bilateral weights.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "core/visible.h"

#include "renderer/cut/point_light.h"
#include "renderer/surface/gather_point.h"

namespace render2mpeg::renderer {

/// Pixels from one lit pixel to the next, both ways. [Herzog2010, 3]: a window of 4x4.
inline constexpr int lattice_step = 4;

/// The n-th place of a window's lit pixel: neighbours in this order lie far apart, and sixteen are all. [Bayer1973]
glm::ivec2 lattice_phase(std::int64_t n);

/// The windows of a frame in which a pixel is lit: all, or those of one colour of a chessboard.
enum class Windows { white, black, all };

/// Which pixels the n-th frame lights: one of each window where nothing is `carried` along, else one of every second
/// window, so that 32 frames in a row light every pixel once. chosen: 2 of 1 and 2, which is 0 to 0.4 dB worse, and a
/// fifth of the time for light.
struct LitPixels {
    glm::ivec2 phase{0};
    Windows windows = Windows::all;
};
LitPixels lit_pixels_of(std::int64_t n, bool carried);

/// Light that is smooth enough to be interpolated, textures not applied.
struct SmoothLight {
    glm::vec3 irradiance{0};  ///< over pi
    glm::vec3 glossy{0};      ///< radiance over the lobe's albedo
};

/// Reflectance of a point's lobe under even light; 0 where it has none.
glm::vec3 lobe_reflectance(const GatherPoint& p);

/// A point of the lattice that was lit.
struct LitSample {
    glm::vec3 position{0}, normal{0};  ///< world; of the surface without its normal map
    std::uint32_t object = 0;
    std::uint8_t path = direct_path;
    SmoothLight light;
};

/// The lit points of one frame, by the window of their pixels.
class Lattice {
  public:
    Lattice(int width, int height, glm::ivec2 phase, Windows windows = Windows::all);

    int across() const { return across_; }
    int down() const { return down_; }
    /// The lit pixel of a window, and its light.
    glm::ivec2 pixel_of(glm::ivec2 window) const { return window * lattice_step + phase_; }
    const std::vector<LitSample>& samples(glm::ivec2 window) const {
        return windows_[static_cast<std::size_t>(window.y) * static_cast<std::size_t>(across_) +
                        static_cast<std::size_t>(window.x)];
    }
    bool is_lit(int x, int y) const {
        return x % lattice_step == phase_.x && y % lattice_step == phase_.y &&
               (lit_ == Windows::all || (x / lattice_step + y / lattice_step) % 2 == static_cast<int>(lit_));
    }
    /// Points of lit pixels, in any order of pixels that is the same in every run.
    void add(int x, int y, const LitSample& sample);

    /// The light of a point of a pixel, by the four lit pixels about it [Herzog2010, eq. 8.1 and 8.2], and the sum of
    /// their weights, 0 to about 1; 0 where all of them are unlike it. `carries_on`: more is known of it, so that only
    /// near ones need count. `distance`: from the eye.
    struct Interpolated {
        SmoothLight light;
        float weight = 0;
        bool is_empty = true;  ///< no lit point there is in the least alike
    };
    Interpolated at(glm::ivec2 pixel, const GatherPoint& p, bool carries_on, float distance) const;
    /// The same by the sixteen windows about it, for points that the four nearest are all unlike.
    Interpolated at_from_afar(glm::ivec2 pixel, const GatherPoint& p, float distance) const;

  private:
    /// `reach`: windows to each side. `fall_off`: exponent by distance in the picture, 2 or 4.
    Interpolated interpolated(glm::ivec2 pixel, const GatherPoint& p, int reach, int fall_off, float distance) const;

    int across_, down_;
    glm::ivec2 phase_;
    Windows lit_;
    std::vector<std::vector<LitSample>> windows_;
};

/// The lattices of a frame: of surfaces seen directly, and of those seen in mirrors and through glass, which are lit
/// at the same pixels in every frame, since motion does not carry them along.
struct Lattices {
    Lattice straight, specular;
    const Lattice& of(const GatherPoint& p, core::PixelClass kind) const {
        return p.reached_by_specular() || kind != core::PixelClass::surface ? specular : straight;
    }
    Lattice& of(const GatherPoint& p, core::PixelClass kind) {
        return const_cast<Lattice&>(std::as_const(*this).of(p, kind));
    }
};

}  // namespace render2mpeg::renderer
