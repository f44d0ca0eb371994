#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "farm/farm_film.h"

/// Parts need nothing that the plan does not name or hold.
namespace render2mpeg {
namespace {

using support::run;

TEST(FarmInputs, NeedBlenderOnlyWhereAFilmIsPlannedSlow) {
    if (!support::blender_is_there()) GTEST_SKIP() << "Blender is not installed";
    const support::Folder folder;
    const auto path = [&](const std::string& name) { return (folder / name).string(); };
    const auto made = support::blender("-P " + support::blender_script("make_blends.py") + " -- " +
                                       folder.path().string() + " glass_and_emission");
    ASSERT_EQ(made.status, 0) << made.output;
    const std::string options = " " + path("glass_and_emission.blend") +
                                " --hold --frames 0:1 --size 32x18 --samples 1 --threads 1 --quiet -y -o ";
    ASSERT_EQ(run(support::program() + " render" + options + path("one.mpg")).status, 0);
    for (const char* how : {"", "--pack "}) {
        SCOPED_TRACE(how);
        const auto planned = run(support::program() + " farm " + how + "--to parallel" + options + path("film.mpg"));
        ASSERT_EQ(planned.status, 0) << planned.output;
        // The nodes have neither the .blend nor its export, nor Blender.
        std::filesystem::rename(folder / "glass_and_emission.blend", folder / "hidden");
        std::filesystem::rename(folder / "glass_and_emission.blend.export", folder / "hidden.export");
        std::filesystem::create_directory(folder / "none");
        const std::string alone = "env PATH=" + path("none") + " HOME=" + path("none") + " " + support::program();
        const auto part = run(alone + " part --threads 1 --quiet " + path("film.mpg.farm") + " 1");
        EXPECT_EQ(part.status, 0) << part.output;
        const auto joined = run(alone + " join --threads 1 --quiet " + path("film.mpg.farm"));
        EXPECT_EQ(joined.status, 0) << joined.output;
        EXPECT_TRUE(support::contents(folder / "one.mpg") == support::contents(folder / "film.mpg"))
            << "as of the .blend itself";
        std::filesystem::rename(folder / "hidden", folder / "glass_and_emission.blend");
        std::filesystem::rename(folder / "hidden.export", folder / "glass_and_emission.blend.export");
        std::filesystem::remove_all(folder / "film.mpg.farm");
    }
}

TEST(FarmInputs, ArePackedWithTheSoundAndTheVolumesThatAnAnimationNamesSlow) {
    test::FarmFilm film("", 60);
    std::ofstream(film / "scene.json")
        << R"({ "sound": "beep.wav", "frames": 60, "volumes": [{ "file": "v%d.vdb", "frames": [1, 2] }], "camera": { "position": [0, 1, 4] },
        "objects": [{ "name": "box", "shape": "box" }], "lights": [{ "kind": "point", "position": [1, 2, 1], "intensity": 9 }] })";
    std::string wave = "RIFF....WAVEfmt ";
    const auto add = [&](std::uint32_t value, int bytes) {
        for (int i = 0; i < bytes; ++i) wave += static_cast<char>(value >> (8 * i));
    };
    add(16, 4), add(1, 2), add(1, 2), add(8000, 4), add(16000, 4), add(2, 2), add(16, 2);
    wave += "data";
    add(32000, 4);
    for (int i = 0; i < 16000; ++i) add(i % 40 < 20 ? 8000 : 57536, 2);
    std::ofstream(film / "beep.wav", std::ios::binary) << wave;
    for (const char* const volume : {"v1.vdb", "v2.vdb"})
        std::filesystem::copy_file(support::source_folder() / "tests/fuzz/corpus/volume/even.vdb", film / volume);
    const auto planned = film.farm("-o " + film.path("f.mpg"), "--to parallel --pack");
    ASSERT_EQ(planned.status, 0) << planned.output;
    for (const char* const input : {"beep.wav", "scene.json", "v1.vdb", "v2.vdb"}) {
        EXPECT_TRUE(std::filesystem::exists(film / ("f.mpg.farm/inputs/scene/" + std::string(input)))) << input;
        std::filesystem::remove(film / input);
    }
    EXPECT_EQ(run(film.part("f.mpg.farm", 1)).status, 0);
    const auto joined = film.join("f.mpg.farm");
    EXPECT_EQ(joined.status, 0) << joined.output;
}

}  // namespace
}  // namespace render2mpeg
