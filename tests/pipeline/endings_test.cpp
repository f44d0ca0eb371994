#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>

#include "encoder/av/file_size.h"
#include "pipeline/fixture.h"

/// Endings say what a file holds, whatever their case; what a film is, its contents say.
namespace render2mpeg::test {
namespace {

support::Outcome render_kind(const Folder& folder, const std::string& output, const std::string& frames,
                             const std::string& more = "") {
    return run(program() + " render -y --hold " + plain_film() +
               " --size 16x16 --samples 1 --vpls 0 --exposure 0 --tolerance fixed=10% --quiet --frames " + frames +
               " -o " + path(folder, output) + more);
}

TEST(Endings, OfOutputsMayBeInCapitalsSlow) {
    const Folder folder;
    for (const char* name : {"f.TS", "f.M2V", "f.Mkv", "f.Y4M", "f.%d.EXR", "f.%d.PNG"}) {
        const auto outcome = render_kind(folder, name, "0:1");
        EXPECT_EQ(outcome.status, 0) << name << ": " << outcome.output;
    }
    EXPECT_EQ(folder.entries(), 8u);
    const auto outcome = render_kind(folder, "g.m2v", "0:1", " --report " + path(folder, "g.HTML"));
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_TRUE(std::filesystem::exists(folder / "g.HTML"));
}

TEST(Endings, OfFramesMayBeInCapitalsSlow) {
    const Folder folder;
    for (const char* name : {"f.%d.EXR", "f.%d.PNG", "f.Y4M"}) {
        ASSERT_EQ(render_kind(folder, name, "0:1").status, 0) << name;
        const auto outcome = run(program() + " encode -y " + path(folder, name) + " --quiet -o " +
                                 path(folder, std::string(name) + ".mpg"));
        EXPECT_EQ(outcome.status, 0) << name << ": " << outcome.output;
    }
}

TEST(Endings, InCapitalsOrOfTheSameKindHaveTheSameContainer) {
    for (const auto& [small, large] : {std::pair("a.ts", "a.TS"), {"a.m2v", "a.M2V"}, {"a.mkv", "a.MKV"}})
        EXPECT_EQ(av::pictures_in_file(1e6, 100, small, false), av::pictures_in_file(1e6, 100, large, false)) << large;
    for (const auto& [other, same] : {std::pair("a.webm", "a.mkv"), {"a.gif", "a.m2v"}}) {
        EXPECT_EQ(av::pictures_in_file(1e6, 100, other, false), av::pictures_in_file(1e6, 100, same, false)) << other;
        EXPECT_EQ(av::file_of_pictures(1e6, 100, other, false), av::file_of_pictures(1e6, 100, same, false)) << other;
        EXPECT_EQ(av::likely_file(1e6, 0, 100, other, false), av::likely_file(1e6, 0, 100, same, false)) << other;
    }
    EXPECT_LT(av::pictures_in_file(1e6, 100, "a.TS", false), av::pictures_in_file(1e6, 100, "a.MPG", false));
}

TEST(Containers, AddWhatWasMeasured) {
    struct Film {
        const char* name;
        int frames;
        double pictures, sound, file;
    };
    for (const Film& f : {Film{"godot.mpg", 12, 1772, 0, 2052},
                          {"cornell.mpg", 16, 6085, 0, 8196},
                          {"dear_cut.mpg", 42, 13876, 0, 14340},
                          {"vc.mpg", 24, 46641, 0, 49156},
                          {"sound.mpg", 24, 14674, 30720, 49156},
                          {"engine.mp4", 24, 2373, 0, 3471},
                          {"brainstem.mp4", 24, 10660, 0, 11758},
                          {"lamps.mp4", 6, 1550, 0, 2413},
                          {"box.gif", 3, 2562, 0, 2563}}) {
        // The last pack of a stream is full or not.
        const double off = std::string_view(f.name).ends_with(".mpg") ? (f.sound > 0 ? 2 : 1) * 1100 : 0.01 * f.file;
        EXPECT_NEAR(av::likely_file(f.pictures, f.sound, f.frames, f.name, false), f.file, off) << f.name;
    }
}

TEST(TransportStreams, OfAPictureOrTwoAreKnownByTheirContents) {
    const Folder folder;
    for (const char* frames : {"0:0", "0:1"}) {
        ASSERT_EQ(render_kind(folder, "f.ts", frames).status, 0);
        std::filesystem::rename(folder / "f.ts", folder / "f");
        const auto outcome = run(program() + " info --json " + path(folder, "f"));
        ASSERT_EQ(outcome.status, 0) << outcome.output;
        const json told = json::parse(outcome.output);
        EXPECT_EQ(told.at("container"), "MPEG-TS (MPEG-2 Transport Stream)");
        EXPECT_EQ(told.at("pictures"), frames == std::string("0:0") ? 1 : 2);
        EXPECT_EQ(told.at("groups").at("count"), 1);
    }
}

}  // namespace
}  // namespace render2mpeg::test
