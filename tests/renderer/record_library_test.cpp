// Records of earlier runs.
#include "renderer/cache/record_library.h"

#include <gtest/gtest.h>

namespace render2mpeg::renderer {
namespace {

IrradianceRecord record(float u, std::uint32_t rays) {
    IrradianceRecord r;
    r.address = {2, 7, u, 0.25f};
    r.position = {1, u, 3};
    r.geometric_normal = r.shading_normal = {0, 0, 1};
    r.direct = {0.5f, 0.25f, 0.125f};
    r.by_rays = {glm::vec3{3e4f, 1, 0.001f}, glm::vec3(0), glm::vec3(0)};
    r.batch_variance = 0.3f;
    r.error = {0.01f};
    r.numbers = Stream(Purpose::hemisphere_rays, {.index = 5});
    r.ray_count = r.next_ray = rays;
    r.set = 3;
    return r;
}

SurfacePoint point(float u) {
    SurfacePoint p;
    p.address = {2, 7, u, 0.25f};
    return p;
}

/// What a run leaves that notes these.
std::vector<StoredRecord> left_by(RecordLibrary& run, const std::vector<IrradianceRecord>& records) {
    run.start_chunk();
    std::vector<StoredRecord> noted;
    run.note(records, 5, noted);
    return noted;
}

TEST(RecordLibrary, GivesARecordToThePointInItsPlaceOnce) {
    RecordLibrary first, later;
    EXPECT_TRUE(left_by(first, {record(0.5f, 16)}).empty()) << "nobody wants it";
    first.know({});
    later.know(left_by(first, {record(0.5f, 16), record(0.125f, 48)}));
    EXPECT_FALSE(later.take(point(0.25f), 5, 9));
    EXPECT_FALSE(later.take(point(0.5f), 6, 9)) << "of another near field";
    const auto taken = later.take(point(0.5f), 5, 9);
    ASSERT_TRUE(taken);
    const IrradianceRecord was = record(0.5f, 16);
    EXPECT_EQ(taken->position, was.position);
    EXPECT_EQ(taken->numbers, was.numbers);
    EXPECT_EQ(taken->set, was.set);
    EXPECT_EQ(taken->ray_count, 16u);
    EXPECT_EQ(taken->next_ray, 16u);
    EXPECT_EQ(taken->born, 9);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(taken->direct[c], was.direct[c], 1e-4f);
        EXPECT_NEAR(taken->by_rays[0][c], was.by_rays[0][c], 2.0f) << "to 2^-15 of the largest";
    }
    EXPECT_FALSE(later.take(point(0.5f), 5, 10)) << "it is in the cache";
    later.start_chunk();
    EXPECT_TRUE(later.take(point(0.5f), 5, 11)) << "a chunk begins with none";
}

TEST(RecordLibrary, KeepsLobesToTheBit) {
    RecordLibrary first, later;
    first.know({});
    IrradianceRecord glossy = record(0.5f, 16);
    glossy.lobe = {0.3f, glm::normalize(glm::vec3(0.3f, -0.2f, 0.9f)), {1, 2, 3}, {0.5f, 0, 0}};
    later.know(left_by(first, {glossy}));
    EXPECT_FALSE(later.take(point(0.5f), 5, 0)) << "the point has no lobe";
    SurfacePoint p = point(0.5f);
    p.bsdf.f0 = glm::vec3(0.04f);
    p.bsdf.alpha = 0.3f;
    const auto taken = later.take(p, 5, 0);
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->lobe.outgoing, glossy.lobe.outgoing) << "by which the point in its place finds it";
    EXPECT_NEAR(taken->lobe.f0.z, 3.0f, 1e-3f);
}

TEST(RecordLibrary, NotesOnlyWhatIsBetterThanKnownAndGivesTheBest) {
    RecordLibrary first, second;
    first.know({});
    std::vector<StoredRecord> all = left_by(first, {record(0.5f, 16), record(0.125f, 48)});
    second.know(all);
    IrradianceRecord same = *second.take(point(0.125f), 5, 0), better = *second.take(point(0.5f), 5, 0);
    better.ray_count = better.next_ray = 64;
    const std::vector<StoredRecord> added = left_by(second, {same, better});
    ASSERT_EQ(added.size(), 1u);
    all.insert(all.begin(), added.begin(), added.end());
    RecordLibrary third;
    third.know(all);
    EXPECT_EQ(third.take(point(0.5f), 5, 0)->ray_count, 64u);
    EXPECT_EQ(third.take(point(0.125f), 5, 0)->ray_count, 48u);
}

}  // namespace
}  // namespace render2mpeg::renderer
