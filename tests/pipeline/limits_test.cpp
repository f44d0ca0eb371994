#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "app/estimate/forecast.h"
#include "app/system/memory_limit.h"
#include "core/error.h"
#include "pipeline/fixture.h"

/// What a run may take, and whom it must not disturb.
namespace render2mpeg::test {
namespace {

using support::program_at_terminal;

bool has(const support::Outcome& outcome, const std::string& words) {
    return outcome.output.find(words) != std::string::npos;
}

TEST(Memory, ThatAFilmWouldTakeBeyondItsLimitIsToldBeforeItIsBegun) {
    const Folder folder;
    const std::string start =
        program() + " render -y --hold " + plain_film() + " --exposure 0 --quiet -o " + path(folder, "f.mpg");
    const auto large = run(start + " --size 1920x1080 --memory 500M");
    EXPECT_EQ(large.status, 1);
    EXPECT_TRUE(has(large, "it takes about ") && has(large, "--memory allows 500 MiB: ")) << large.output;
    EXPECT_EQ(std::count(large.output.begin(), large.output.end(), '\n'), 1) << large.output;
    EXPECT_EQ(folder.entries(), 0u);
    const auto small = run(start + " --size 32x32 --samples 1 --frames 0:1 --tolerance fixed=10% --memory 500M");
    EXPECT_EQ(small.status, 0) << small.output;
    const auto nonsense = run(start + " --memory 8");
    EXPECT_TRUE(has(nonsense, "expected a size such as 8G")) << nonsense.output;
}

TEST(Memory, ThatAFilmIsReckonedToTakeIsEnoughSlow) {
    const Folder folder;
    for (const char* threads : {"1", "4"}) {
        const std::string start = program() + " render -y --hold " + plain_film() +
                                  " --size 32x32 --samples 1 --frames 0:1 --quiet --threads " + threads + " -o " +
                                  path(folder, "f.m2v") + " --memory ";
        const auto little = run(start + "16M");
        ASSERT_EQ(little.status, 1) << little.output;
        const std::string words = "it takes about ";
        const int need = std::stoi(little.output.substr(little.output.find(words) + words.size()));
        const auto enough = run(start + std::to_string(need + 4) + "M");
        EXPECT_EQ(enough.status, 0) << threads << ": " << enough.output;
    }
}

TEST(Memory, OfVolumesIsReckonedWithSlow) {
    const Folder folder;
    json scene = json::parse(support::travel_scene(1));
    scene["volumes"] = json::parse(R"([{ "size": 1.5, "density": 2 }])");
    std::ofstream(folder / "scene.json") << scene;
    const std::string start = program() + " render -y --hold " + path(folder, "scene.json") +
                              " --size 32x32 --samples 1 --quiet --threads 1 --tolerance fixed=10% -o " +
                              path(folder, "f.m2v");
    const auto little = run(start + " --memory 16M");
    ASSERT_EQ(little.status, 1) << little.output;
    const auto after = [&](const std::string& words) {
        return std::stod(little.output.substr(little.output.find(words) + words.size()));
    };
    ASSERT_TRUE(has(little, " to read the largest of them, ") && has(little, " MiB for volumes, ")) << little.output;
    EXPECT_GT(after(" to read the largest of them, "), 100) << little.output;
    ASSERT_EQ(run(start + " --stats " + path(folder, "s.json")).status, 0);
    const double peak = json::parse(support::contents(folder / "s.json")).at("peak_rss_mib");
    EXPECT_GT(after("it takes about "), peak);
}

TEST(Memory, OfRaysInStillLightIsReckonedWithSlow) {
    const Folder folder;
    const std::string start = program() + " render -y --hold " + film("colonnade") +
                              " --size 160x90 --frames 0:0 --exposure 0 --quiet --threads 2 -o " +
                              path(folder, "f.m2v");
    const auto little = run(start + " --memory 16M");
    const std::string words = "it takes about ";
    ASSERT_TRUE(has(little, words)) << little.output;
    const double told = std::stod(little.output.substr(little.output.find(words) + words.size()));
    ASSERT_EQ(run(start + " --stats " + path(folder, "s.json")).status, 0);
    const double peak = json::parse(support::contents(folder / "s.json")).at("peak_rss_mib");
    EXPECT_GT(told, peak);
    EXPECT_LT(told, 2.5 * peak);
}

TEST(Memory, InDoubtIsToldByASampleSlow) {
    const Folder folder;
    const std::string shape = film("character") + " --size 160x90 --frames 0:1 --exposure 0 --quiet --threads 2 ",
                      start = program() + " render -y --hold " + shape + "-o " + path(folder, "f.m2v");
    const auto number_in = [](const support::Outcome& outcome, const std::string& words) {
        const std::size_t at = outcome.output.find(words);
        return at == std::string::npos ? 0.0 : std::stod(outcome.output.substr(at + words.size()));
    };
    ASSERT_EQ(run(start + " --stats " + path(folder, "s.json")).status, 0);
    const double peak = json::parse(support::contents(folder / "s.json")).at("peak_rss_mib"),
                 most = number_in(run(start + " --memory 16M"), "it takes about ");
    const auto planned = run(program() + " plan --within 1 " + shape.substr(0, shape.find("--quiet")));
    const double told = number_in(planned, "Memory: about ");
    // Of films at large: an open field takes less.
    EXPECT_GT(told, peak) << planned.output;
    EXPECT_LT(told, 1.6 * peak) << planned.output;
    EXPECT_LT(1.4 * peak, most);
    const auto enough = run(start + " --memory " + std::to_string(static_cast<int>(1.4 * peak)) + "M");
    EXPECT_EQ(enough.status, 0) << enough.output;
    const auto little = run(start + " --memory " + std::to_string(static_cast<int>(0.9 * peak)) + "M");
    EXPECT_EQ(little.status, 1) << little.output;
}

TEST(Memory, IsSaidInPowersOf1024) {
    EXPECT_EQ(app::memory_from("8G"), std::uint64_t{8} << 30);
    EXPECT_EQ(app::memory_from("1.5G"), std::uint64_t{3} << 29);
    EXPECT_EQ(app::memory_from("900M"), std::uint64_t{900} << 20);
    EXPECT_EQ(app::memory_from("65536K"), std::uint64_t{64} << 20);
    for (const char* text : {"", "8", "G", "-1G", "1e30G", "nanG", "8GB", "8 G", "1M"})
        EXPECT_THROW(app::memory_from(text), core::Error) << text;
}

TEST(Memory, LetsImagesBeReadInTurnBeforeItRefuses) {
    app::RenderJob job;
    scene::Animation scene;
    scene.source = "scene.glb";
    job.animation = std::make_shared<const scene::Animation>(scene);
    app::MemoryNeed need;
    need.held = 100;
    need.textures = 50;
    need.decoding = 30;
    EXPECT_EQ(need.total(), 180u);
    EXPECT_TRUE(app::may_decode_at_once(job, need, 270, 4));
    EXPECT_FALSE(app::may_decode_at_once(job, need, 269, 4));
    EXPECT_FALSE(app::may_decode_at_once(job, need, 180, 4));
    EXPECT_TRUE(app::may_decode_at_once(job, need, 180, 1));
    EXPECT_THROW(app::may_decode_at_once(job, need, 179, 1), core::Error);
}

TEST(Inputs, OfInputsAreNoOutputs) {
    const Folder folder;
    std::filesystem::copy(film("character"), folder / "scene", std::filesystem::copy_options::recursive);
    const std::string model = support::contents(folder / "scene" / "figure.bin");
    ASSERT_FALSE(model.empty());
    for (const char* taken : {"film.json", "figure.gltf", "figure.bin"}) {
        const auto outcome = run("cd " + path(folder, "scene") + " && " + program() +
                                 " render . -o film.mpg --size 32x32 --frames 0:0 --quiet --stats " + taken);
        EXPECT_EQ(outcome.status, 1) << taken;
        EXPECT_TRUE(has(outcome, "it is an input")) << outcome.output;
    }
    EXPECT_EQ(support::contents(folder / "scene" / "figure.bin"), model);
}

TEST(Interruption, EndsAFrameThatTakesMinutes) {
    const Folder folder;
    // Only a run that does not finish its first frame ends here.
    const auto outcome =
        run(program_at_terminal() + " render -y --hold " + plain_film() +
            " --size 1280x960 --samples 1 --exposure 0 --tolerance reference --frames 0:1 -o " + path(folder, "f.mpg") +
            " & job=$!; while [ ! -e " + path(folder, "f.mpg.partial/chunk_00000.m2v") +
            " ]; do kill -0 $job || exit 99; sleep 0.05; done; sleep 0.1; kill -TERM $job; wait $job");
    EXPECT_EQ(outcome.status, 143) << outcome.output;
    EXPECT_TRUE(has(outcome, "interrupt again to stop at once")) << outcome.output;
    EXPECT_TRUE(has(outcome, "interrupted after 0 of 2 frames")) << outcome.output;
    EXPECT_FALSE(std::filesystem::exists(folder / "f.mpg.partial/film.mpg")) << "nothing was put together";
}

TEST(Heatmap, OfTwoRunsIsTheFirstOnes) {
    const Folder folder;
    const std::string start =
        program_at_terminal() + " render -y --hold " + plain_film() + " --size 64x64 --exposure 0 --quiet ";
    const std::string heat = " --heatmap cut " + path(folder, "heat.mpg");
    const std::string second = start + "--frames 0:1 -o " + path(folder, "b.mpg") + heat;
    const auto outcome =
        run(start + "--hold --frames 0:9999 -o " + path(folder, "a.mpg") + heat + " & job=$!; while [ ! -e " +
            path(folder, "a.mpg.partial/chunk_00000.cut-*.m2v") + " ]; do kill -0 $job || exit 99; sleep 0.05; done; " +
            second + "; echo second $?; kill -INT $job; wait $job");
    EXPECT_EQ(outcome.status, 130) << outcome.output;
    EXPECT_TRUE(has(outcome, "heat.mpg: another run is writing it")) << outcome.output;
    EXPECT_TRUE(has(outcome, "second 1")) << outcome.output;
    EXPECT_FALSE(std::filesystem::exists(folder / "b.mpg"));
    EXPECT_FALSE(std::filesystem::exists(folder / "b.mpg.partial")) << "it left no trace";
}

}  // namespace
}  // namespace render2mpeg::test
