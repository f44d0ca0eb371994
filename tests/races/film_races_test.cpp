#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>

#include "parallel/loops.h"
#include "support/program.h"

/// Built with the thread sanitizer, which ends a program with status 66 if it found a race.
namespace render2mpeg::test {
namespace {

constexpr const char* scene_text = R"({ "frames": 46, "camera": { "position": [0, 1.5, 4], "look_at": [0, 0.5, 0] },
  "lights": [{ "kind": "point", "position": [1, 2, 1], "intensity": 9 },
             { "kind": "point", "position": [-2, 2, 1], "intensity": 3, "keys": [{ "at": 0, "power": 1 }, { "at": 2, "power": 6 }] }],
  "objects": [{ "name": "floor", "shape": "plane", "size": [6, 6] },
              { "name": "box", "shape": "box", "keys": [{ "at": 0, "position": [-1, 0, 0] }, { "at": 2, "position": [1, 0, 0], "rotate": 200 }] }] })";

/// Renders 46 frames in chunks of 41, two at once.
support::Outcome rendered(const support::Folder& folder, const std::string& more) {
    std::ofstream(folder / "scene.json") << scene_text;
    const std::string to = folder.path().string() + "/";
    return support::run("cd " + to + " && " + (support::binary_folder() / "race_render").string() +
                        " render -y --quiet scene.json --size 16x16 --samples 1 --gop 41 --threads 3 "
                        "--chunks-at-once 2 " +
                        more);
}

TEST(FilmRaces, ThereAreNoneWhereChunksAreMadeBesideEachOther) {
    const support::Folder folder;
    const auto outcome = rendered(folder, "-o film.mpg --stats film.json");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_EQ(outcome.output, "");
}

TEST(FilmRaces, ThereAreNoneWhereImagesAndLayersAreWritten) {
    const support::Folder folder;
    const auto outcome = rendered(folder, "--vpls 0 -o f.%03d.png --aov layers --last-frame last.png");
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_EQ(outcome.output, "");
}

/// What the order that loops tell of (parallel/fork.h) may not hide.
TEST(FilmRaces, OfBodiesOfALoopAreFound) {
    testing::FLAGS_gtest_death_test_style = "threadsafe";
    const auto race = [] {
        const parallel::ThreadLimit limit(4);
        int sum = 0;
        parallel::for_each(200, [&](std::size_t) {
            for (const std::clock_t end = std::clock() + CLOCKS_PER_SEC / 2000; std::clock() < end;) {
            }
            ++sum;
        });
        std::exit(sum > 0 ? 0 : 1);
    };
    EXPECT_EXIT(race(), testing::ExitedWithCode(66), "data race");
}

}  // namespace
}  // namespace render2mpeg::test
