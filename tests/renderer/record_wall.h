#pragma once

#include <gtest/gtest.h>

#include "renderer/cache/cache_query.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {

/// Pixels of the picture, each way.
constexpr int wall_side = 24;

/// A wall that fills the picture, seen head on.
inline test::SceneBuilder wall() {
    test::SceneBuilder b;
    b.add_quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, b.add_material({0.5f, 0.4f, 0.3f}));
    b.add_camera({0, 0, 2}, {0, 0, 0});
    return b;
}

/// The wall with records here and there, whose irradiance is a function of their place on the picture.
class Wall : public ::testing::Test {
  protected:
    Wall() : stage_(wall(), wall_side, wall_side), seen_(stage_.see()), map_(wall_side, wall_side) {}

    template <class Light>
    void strew(int step, Light&& light) {
        for (const GatherTile& tile : seen_.tiles) {
            for (const GatherPoint& p : tile) {
                const auto at = stage_.world().camera.project(p.point.position);
                if (static_cast<int>(at->position.x) % step != 0 || static_cast<int>(at->position.y) % step != 0)
                    continue;
                IrradianceRecord r;
                r.address = p.point.address;
                r.position = p.point.position;
                r.geometric_normal = p.point.geometric_normal;
                r.shading_normal = p.point.shading_normal;
                r.indirect = glm::vec3(light(at->position));
                records_.insert(r);
            }
        }
        map_.build(records_.all(), stage_.world().camera);
    }

    const GatherPoint& point_at(int x, int y) const {
        const int across = seen_.tiles_across();
        const GatherTile& tile = seen_.tiles[static_cast<std::size_t>(y / tile_size * across + x / tile_size)];
        for (const GatherPoint& p : tile)
            if (p.pixel == y % tile_size * tile_size + x % tile_size) return p;
        ADD_FAILURE();
        return tile.front();
    }

    std::optional<PointLight> estimate_at(const GatherPoint& p, float relative, bool priced = false) {
        const auto at = stage_.world().camera.project(p.point.position);
        CacheQuery query{p, {0, relative, 0}, at->position, stage_.world().camera.pixel_size() * at->depth, 0.4f};
        query.priced = priced;
        return query_cache(query, map_, records_, {}, 1.0f, 0);
    }
    std::optional<PointLight> estimate_at(int x, int y, float relative, bool priced = false) {
        return estimate_at(point_at(x, y), relative, priced);
    }

    /// The records' light is what a lobe of white metal sends to an eye, which may be elsewhere than the camera.
    void polish(glm::vec3 eye) {
        for (std::uint32_t i = 0; i < records_.size(); ++i) {
            IrradianceRecord& r = records_.change(i);
            r.lobe = {lobe_width, glm::normalize(eye - r.position), r.indirect, glm::vec3(0)};
            r.indirect = glm::vec3(0);
        }
    }
    std::optional<PointLight> estimate_polished(GatherPoint p, float relative, float matt = 0) {
        const glm::vec3 eye = stage_.world().camera.position();
        p.point.bsdf = {glm::vec3(matt), glm::vec3(1), lobe_width};
        p.point.outgoing = glm::normalize(eye - p.point.position);
        const auto at = stage_.world().camera.project(p.point.position);
        const float extent = stage_.world().camera.pixel_size() * at->depth;
        return query_cache({p, {0, relative, 0}, at->position, extent, 1.0f, eye}, map_, records_, {}, 1.0f, 0);
    }
    static constexpr float lobe_width = 0.25f;

    test::Stage stage_;
    Frame seen_;
    RecordStore records_;
    RecordGrid map_;
};

}  // namespace render2mpeg::renderer
