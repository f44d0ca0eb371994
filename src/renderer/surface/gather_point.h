#pragma once
// A gather point: a surface point that light is gathered for.
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/mattes.h"
#include "core/packed_normal.h"
#include "core/visible.h"
#include "renderer/surface/surface_point.h"

namespace render2mpeg::renderer {

/// Pixels of a tile: one macroblock.
inline constexpr int tile_size = 16;

/// Two samples of a pixel lie on one surface if their normals differ by less than this. chosen: cos 11 degrees, where
/// the cosine of light at 45 degrees changes by a fifth over the pixel; tried 0.9..0.999 on the rim of a sphere.
inline constexpr float same_normal = 0.98f;

/// Places of a pixel's surface that shadow rays may leave beside the first.
inline constexpr int most_other_places = 3;

/// The mirrors and panes of glass between the eye and a point, nearest first: a one, then a bit each, 1 for a mirror.
/// From the eighth on the oldest are forgotten and the highest bit stays.
inline constexpr std::uint8_t straight_way = 1;
inline std::uint8_t longer_way(std::uint8_t way, bool mirror) {
    return static_cast<std::uint8_t>((way << 1) | (way & 128) | (mirror ? 1 : 0));
}

/// One surface in one pixel (or seen from it in a mirror or through glass) that wants light. A pixel's samples on one
/// surface share one gather point; its textures are averaged over them.
struct GatherPoint {
    SurfacePoint point;
    std::uint16_t pixel = 0;  ///< within its tile: y * tile_size + x
    std::uint8_t way = straight_way;
    glm::vec3 weight{1};  ///< share of the pixel x what mirrors, glass and translucent layers let through
    /// Where shadow rays leave the same surface elsewhere in the pixel, world; the first `others` of them: shadows have
    /// edges within pixels.
    std::array<glm::vec3, most_other_places> elsewhere{};
    std::uint8_t others = 0;
    /// When its shadow rays leave: 0 in the middle of the shutter; else in strata of its time, each in the same one of
    /// 16 parts, this less one: where what moves may throw shadows on what does not.
    std::uint8_t shadow_part = 0;
    /// Further places; null: none. Only where contrast is high (look_closer.h).
    std::shared_ptr<const std::vector<glm::vec3>> more_places{};

    bool reached_by_specular() const { return way != straight_way; }
};

/// A gather point that was lit at another place of its pixel, on the same surface.
struct MovedPoint {
    std::uint32_t index = 0;  ///< within its tile
    glm::vec3 position{0};    ///< world
    glm::vec3 geometric_normal{0}, shading_normal{0};
    glm::vec3 outgoing{0};
};
/// Those of a frame, tile by tile, in the order of its points.
using MovedPoints = std::vector<std::vector<MovedPoint>>;

/// All gather points of one 16x16 tile, by pixel in raster order.
using GatherTile = std::vector<GatherPoint>;

/// What one sample of the eye shows of a fibre, or of light below a surface, which is found by itself (hair_light.h).
struct FibreSample {
    core::SurfaceAddress address;
    core::PackedNormal outgoing;  ///< to where it is seen from
    glm::vec3 weight{1};          ///< as GatherPoint's
    std::uint16_t pixel = 0;      ///< likewise
    bool specular = false;        ///< seen in mirrors or through glass
    bool below = false;           ///< SurfacePoint's
};
/// Those of a tile, by pixel in raster order.
using FibreTile = std::vector<FibreSample>;

/// Light of the air on a straight way from the eye: `weight` times what air scatters to the eye from that far on.
struct AirSpan {
    std::uint16_t pixel = 0;  ///< as GatherPoint's
    float distance = 0;       ///< from where the eye's ray begins; infinite: to the sky
    glm::vec3 weight{0};      ///< may be below 0: the way begins there
};

/// The same of a way that mirrors or glass have turned.
struct AirWay {
    std::uint16_t pixel = 0;
    std::uint8_t way = straight_way;  ///< GatherPoint::way
    glm::vec3 origin{0}, direction{0};
    float distance = 0;
    glm::vec3 weight{0};
};

/// Which air the pixels of a tile show, by pixel in raster order.
struct SeenAir {
    std::vector<AirSpan> straight;
    std::vector<AirWay> beyond;
};

/// What covers the pixels of a tile, by pixel in raster order (mattes.h).
struct SeenMatte {
    std::uint16_t pixel = 0;  ///< as GatherPoint's
    core::Matte matte;
};

/// How often pixels are sampled that shutter or lens blur, 1 to 4096 times: `fewest` where they blur little, up to
/// `most` where much.
struct ExposureSamples {
    int fewest = 1, most = 1;
    /// How a grey luminance is shown, in code values; empty: nobody knows, and no pixel is sampled again.
    std::function<float(float)> shown = {};
    /// Standard error, in code values, beyond which pixels are sampled again that show what is as bright as white.
    float visible = 0;
};

/// What one gather point gives one pixel that is exposed.
struct Contribution {
    std::uint32_t point = 0;  ///< of all points of the frame: Exposure::first_point of its tile and its place there
    glm::vec3 weight{0};      ///< share of the pixel x what mirrors, glass and layers let through, summed over samples
    glm::vec3 diffuse{0};     ///< the same times each sample's own diffuse reflectance: textures are the samples' own
};

/// How points give light to the pixels that the shutter or the lens blurs (docs/model/exposure.md). Light is gathered
/// once for a surface point, in the middle of the shutter's time; where it goes is sampled.
struct Exposure {
    core::Plane<std::uint8_t> exposed;  ///< 1: the pixel is the sum of its contributions and `emitted`
    std::vector<std::vector<Contribution>> contributions;  ///< by tile, by pixel in raster order
    std::vector<std::vector<std::uint32_t>> starts;  ///< by tile: where each of its pixels' begin, and the end; or none
    core::Plane<float>
        coverage;  ///< share of a pixel's samples that show the object that its middle shows; 1 elsewhere
    core::Plane<glm::vec3> emitted, emitted_specular;  ///< as Seen's, of exposed pixels
    std::vector<std::uint32_t> first_point;            ///< by tile: points of all tiles before it; one more: of all
    std::vector<SeenAir> air{};                        ///< as Seen's, of exposed pixels
    std::vector<std::vector<SeenMatte>> mattes{};      ///< likewise
    std::vector<FibreTile> fibres{};                   ///< likewise

    bool is_exposed(std::size_t tile) const { return !starts[tile].empty(); }
    /// Of a pixel of a tile that has any: GatherPoint::pixel.
    std::span<const Contribution> of_pixel(std::size_t tile, int pixel) const {
        const std::vector<std::uint32_t>& s = starts[tile];
        const auto p = static_cast<std::size_t>(pixel);
        return std::span(contributions[tile]).subspan(s[p], s[p + 1] - s[p]);
    }
};

/// What mirrors and glass throw onto a gather point.
struct ThrownLight {
    glm::vec3 irradiance{0};  ///< over pi
    glm::vec3 glossy{0};      ///< radiance that its lobe scatters
};

/// What `see` finds in one frame: what is kept for other frames, and what this frame's `shade` consumes.
struct Seen {
    core::Visible visible;
    std::vector<GatherTile> tiles;            ///< row by row, (width + 15) / 16 per row
    core::Plane<glm::vec3> emitted;           ///< radiance that needs no gathering: emission, sky, unlit surfaces
    core::Plane<glm::vec3> emitted_specular;  ///< the part of `emitted` seen by mirrors or glass; empty without them
    /// Parts of `emitted` that caustics brought (caustics.h): to what is seen straight, and (a part of
    /// `emitted_specular`) by mirrors or glass. Empty without them.
    core::Plane<glm::vec3> caustics{}, caustics_specular{};
    std::vector<ThrownLight> thrown{};  ///< caustics by point of the frame, where pixels are exposed; or empty
    core::Plane<core::SurfaceAddress>
        imaged{};                          ///< what flat mirrors show; no surface: none, or no mirror; may be empty
    core::Plane<std::uint16_t> samples{};  ///< eye samples of each pixel; empty where all have SeeSettings::samples
    std::vector<SeenAir> air{};            ///< by tile; empty: it is clear
    std::vector<std::vector<SeenMatte>> mattes{};  ///< by tile; empty: nobody wants them
    /// Light of the air: a part of `emitted`, and what exposed pixels show of it. Empty without.
    core::Plane<glm::vec3> airlight{}, air_of_exposed{};
    std::vector<FibreTile> fibres{};  ///< by tile, until they are lit; empty: the plan knows of none
    /// Light of fibres and below surfaces: a part of `emitted`, and what exposed pixels show of it. Empty without.
    core::Plane<glm::vec3> hair{}, hair_of_exposed{};
    std::shared_ptr<const Exposure> exposure{};  ///< null: no pixel is blurred
    int tiles_across() const { return (visible.width() + tile_size - 1) / tile_size; }
};

}  // namespace render2mpeg::renderer
