#pragma once
// Records of light that stays, kept beyond a chunk: for later runs of the same film.
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "core/error.h"
#include "core/packed_normal.h"
#include "renderer/base/light_packing.h"
#include "renderer/base/stream.h"
#include "renderer/cache/irradiance_record.h"
#include "renderer/surface/surface_point.h"

namespace render2mpeg::renderer {

/// An IrradianceRecord as files keep it.
struct StoredRecord {
    core::SurfaceAddress address;
    std::array<PackedLight, 7> light{};  ///< direct, indirect, the lobe's two parts; by rays, in RayLight's order
    Stream numbers;
    glm::vec3 position{0}, outgoing{0};
    core::PackedNormal geometric_normal, shading_normal;
    std::uint32_t near_field = 0;  ///< NearField::key of the frame that it was gathered for
    float alpha = 0, depth = 0, batch_variance = 0, error = 0, clamped = 0;
    std::uint32_t ray_count = 0, next_ray = 0;
    std::uint8_t back_side = 0, capped = 0, set = 0;
    std::array<std::uint8_t, 5> padding{};
};
static_assert(sizeof(StoredRecord) == 152, "no byte is undefined");
static_assert(std::is_trivially_copyable_v<StoredRecord>);

/// Records of a file that holds whole ones.
std::vector<StoredRecord> stored_records(std::span<const std::byte> bytes);

/// Whether a record of a file is one that `note` may have made: what follows from it is finite, and lies in tables.
bool is_sound(const StoredRecord& record);

/// Records that earlier runs found, and those that this one finds beside them. Light must not change while they hold.
class RecordLibrary {
  public:
    /// Takes these as known; of several in one place the one of most rays. From now on records are noted.
    void know(std::vector<StoredRecord> records);
    bool is_empty() const { return known_.empty(); }

    /// A chunk begins: none is taken.
    void start_chunk();
    /// The known record in the very place of a point, under this near field, the first time that the chunk asks.
    std::optional<IrradianceRecord> take(const SurfacePoint& point, std::uint32_t near_field, std::int64_t frame);
    /// Appends records that leave a chunk, if `know` was called: those which know more than the known ones.
    void note(std::span<const IrradianceRecord> records, std::uint32_t near_field,
              std::vector<StoredRecord>& noted) const;

    /// Which of the known ones the chunk took.
    template <class A>
    friend void archive(A& a, RecordLibrary& library) {
        auto& [known, notes, taken] = library;
        a(taken);
        if (taken.size() != known.size()) throw core::Error("the light file has other records now");
    }

  private:
    std::vector<StoredRecord> known_;
    bool notes_ = false;
    std::vector<std::uint8_t> taken_;  ///< by known one
};

}  // namespace render2mpeg::renderer
