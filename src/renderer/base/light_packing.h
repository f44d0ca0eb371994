#pragma once
// How a light tree keeps its nodes and lights in memory.
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/packed_normal.h"
#include "renderer/base/isa_clones.h"

/// How a light tree keeps its nodes and lights: 48 and 32 bytes. What bounds light is rounded outwards.
namespace render2mpeg::renderer {

/// A colour of light in 64 bits: 16 of each channel and one exponent; rounded up, by 2^-15 of its largest channel at
/// most. Twice the light has twice the value.
class PackedLight {
  public:
    PackedLight() = default;
    /// Of light >= 0; what is more than 65535 2^112, as sums of the brightest finite lights may be, is that much.
    explicit PackedLight(const glm::vec3& given);
    RENDER2MPEG_ALWAYS_INLINED void unpack(float& red, float& green, float& blue) const {
        const float unit = __builtin_bit_cast(float, std::uint32_t{exponent_} << 23);
        red = static_cast<float>(channel_[0]) * unit;
        green = static_cast<float>(channel_[1]) * unit;
        blue = static_cast<float>(channel_[2]) * unit;
    }

  private:
    std::uint16_t channel_[3] = {0, 0, 0};
    std::uint16_t exponent_ = 1;  ///< of a float that is one step
};

/// Half the way from the lowest to the highest corner of a box, and that far to each side.
struct MiddleBox {
    glm::vec3 middle{0}, half{0};
};

/// The steps in which the boxes of one tree are kept: 2^21 along each axis of what holds all of it.
class BoxGrid {
  public:
    static constexpr std::uint32_t last = (1u << 21) - 1;

    BoxGrid() = default;
    /// All that is to be kept lies between these.
    BoxGrid(const glm::vec3& low, const glm::vec3& high);

    /// Of the steps `low` and `high` along an axis.
    RENDER2MPEG_ALWAYS_INLINED void unpack(int axis, std::uint32_t low, std::uint32_t high, float& middle,
                                           float& half) const {
        // Sums of two such numbers have at most 22 bits, so that nothing is rounded before it is multiplied.
        middle = low_[axis] + step_[axis] * (0.5f * static_cast<float>(low + high));
        half = step_[axis] * (0.5f * static_cast<float>(high - low));
    }

    /// The least steps about [low, high], as it is unpacked; wholly within the grid.
    std::array<std::uint32_t, 2> pack(int axis, float low, float high) const;

  private:
    float low_[3] = {0, 0, 0}, step_[3] = {0, 0, 0};
};

/// A box in 128 bits.
class PackedBox {
  public:
    PackedBox() = default;
    PackedBox(const BoxGrid& grid, const glm::vec3& low, const glm::vec3& high);
    RENDER2MPEG_ALWAYS_INLINED void unpack(const BoxGrid& grid, float& mx, float& my, float& mz, float& hx, float& hy,
                                           float& hz) const {
        grid.unpack(0, step(low_, 0), step(high_, 0), mx, hx);
        grid.unpack(1, step(low_, 1), step(high_, 1), my, hy);
        grid.unpack(2, step(low_, 2), step(high_, 2), mz, hz);
    }

  private:
    RENDER2MPEG_ALWAYS_INLINED static std::uint32_t step(std::uint64_t corner, int axis) {
        return static_cast<std::uint32_t>(corner >> 21 * axis) & BoxGrid::last;
    }
    std::uint64_t low_ = 0, high_ = 0;
};

/// core::PackedNormal::unpack, inlined into the caller's instruction set, with fewer divisions.
RENDER2MPEG_ALWAYS_INLINED void unpack_normal(const core::PackedNormal& normal, float& nx, float& ny, float& nz) {
    std::int16_t packed[2];
    static_assert(sizeof(packed) == sizeof(normal));
    __builtin_memcpy(packed, &normal, sizeof(packed));
    const float px = packed[0] * (1.0f / 32767.0f), py = packed[1] * (1.0f / 32767.0f);
    const float z = 1.0f - inlined::abs(px) - inlined::abs(py), fold = inlined::max(-z, 0.0f);
    const float x = px < 0.0f ? px + fold : px - fold, y = py < 0.0f ? py + fold : py - fold;
    const float inverse = 1.0f / inlined::sqrt(x * x + y * y + z * z);
    nx = x * inverse;
    ny = y * inverse;
    nz = z * inverse;
}

}  // namespace render2mpeg::renderer
