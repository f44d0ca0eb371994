#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "pipeline/fixture.h"

/// .blend files, exported by Blender where it is installed (tests/blender/make_blends.py makes them).
namespace render2mpeg::test {
namespace {

using support::blender;
using support::blender_is_there;
using support::Outcome;
using support::with_own_blender;

namespace fs = std::filesystem;

#define NEEDS_BLENDER() \
    if (!blender_is_there()) GTEST_SKIP() << "Blender is not installed"

std::string script(const std::string& name) {
    return support::blender_script(name);
}

void make(const Folder& folder, const std::string& film) {
    const Outcome made = blender("-P " + script("make_blends.py") + " -- " + folder.path().string() + " " + film);
    ASSERT_EQ(made.status, 0) << made.output;
}

std::size_t lines_in(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// Rendered by Cycles, and held against ours in the same Blender.
Outcome held_against_cycles(const std::string& blend, const Folder& folder, const std::string& words) {
    return blender(blend + " -P " + script("cycles.py") + " -P " + script("compare.py") + " -- " +
                   folder.path().string() + " " + words);
}

/// The only export of a .blend.
fs::path export_of(const fs::path& blend) {
    for (const fs::directory_entry& entry : fs::directory_iterator(blend.string() + ".export")) return entry.path();
    return {};
}

TEST(BlendFileSlow, WithoutBlenderIsRefusedInALineThatSaysWhatToDo) {
    const Folder folder;
    std::ofstream(folder / "film.blend") << "BLENDER";
    const Outcome said =
        run("RENDER2MPEG_BLENDER=/nowhere " + program() + " plan --within 0 " + path(folder, "film.blend"));
    EXPECT_EQ(said.status, 1);
    EXPECT_EQ(lines_in(said.output), 1u) << said.output;
    EXPECT_NE(said.output.find("needs Blender"), std::string::npos) << said.output;
    EXPECT_NE(said.output.find("RENDER2MPEG_BLENDER"), std::string::npos) << said.output;
}

TEST(BlendFileSlow, ThatIsBrokenIsRefusedInALine) {
    NEEDS_BLENDER();
    const Folder folder;
    make(folder, "markers");
    const std::string whole = contents(folder / "markers.blend");
    std::ofstream(folder / "text.blend") << "no .blend at all";
    std::ofstream(folder / "short.blend", std::ios::binary) << whole.substr(0, whole.size() / 2);
    for (const char* name : {"text.blend", "short.blend"}) {
        const Outcome said = run(program() + " plan --quiet --within 0 " + path(folder, name));
        EXPECT_EQ(said.status, 1);
        EXPECT_EQ(lines_in(said.output), 1u) << said.output;
        EXPECT_NE(said.output.find(name), std::string::npos) << said.output;
        EXPECT_FALSE(fs::exists((folder / name).string() + ".export")) << "nothing is left of it";
    }
}

TEST(BlendFileSlow, UsdIsReadWhereThatBlenderCanAndElseRefusedInALine) {
    NEEDS_BLENDER();
    const Folder folder;
    std::ofstream(folder / "stage.usda") << R"usd(#usda 1.0
(
    endTimeCode = 4
    startTimeCode = 1
    upAxis = "Y"
)
def Mesh "Floor" {
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)]
}
def Camera "Eye" {
    double3 xformOp:translate = (0, 0.5, 3)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
)usd";
    const bool reads =
        blender("--python-expr 'import bpy; print(\"HAS\", bpy.app.build_options.usd)'").output.find("HAS True") !=
        std::string::npos;
    const Outcome said = run(program() + " plan --within 0 " + path(folder, "stage.usda"));
    EXPECT_EQ(said.status, reads ? 0 : 1) << said.output;
    if (reads) {
        EXPECT_NE(said.output.find("4 frames"), std::string::npos) << said.output;
        EXPECT_NE(said.output.find("Eye"), std::string::npos) << said.output;
        return;
    }
    EXPECT_EQ(lines_in(said.output), 1u) << said.output;
    for (const char* words : {"stage.usda", "built without USD", "RENDER2MPEG_BLENDER"})
        EXPECT_NE(said.output.find(words), std::string::npos) << said.output;
}

void expect_nothing_executed(const fs::path& folder, const std::string& said) {
    std::size_t executed = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
        executed += entry.path().filename() == "EXECUTED";
    EXPECT_EQ(executed, 0u);
    for (const char* line : {"Cube: driver of location: its Python expression is not executed",
                             "bomb.py: text that registers itself: not executed"})
        EXPECT_NE(said.find(line), std::string::npos) << said;
}

TEST(BlendFileSlow, IsExportedOnceUntilItChangesExecutesNothingAndThatCountsAsLoading) {
    NEEDS_BLENDER();
    const Folder folder;
    make(folder, "hostile");
    const fs::path blend = folder / "hostile.blend";
    // Another Python on the PATH, as virtual environments have it, is none of Blender's business.
    fs::create_directories(folder / "bin");
    std::ofstream(folder / "bin/python3") << "#!/bin/sh\n";
    fs::permissions(folder / "bin/python3", fs::perms::owner_all);
    for (const char* version : {"3.10", "3.11", "3.12", "3.13"}) {
        fs::create_directories(folder / "lib" / ("python" + std::string(version)) / "lib-dynload");
        std::ofstream(folder / "lib" / ("python" + std::string(version)) / "os.py") << "";
    }
    const std::string command = program() + " render -y --hold --frames 0:0 --size 16x16 --stats " +
                                path(folder, "s.json") + " -o " + path(folder, "a.%04d.png") + " hostile.blend",
                      here = "cd " + folder.path().string() + " && ",
                      alone = here + "PATH=" + path(folder, "bin") + ":$PATH " + with_own_blender(command);
    const auto seconds = [&] { return nlohmann::json::parse(contents(folder / "s.json")).at("seconds"); };
    const Outcome said = run(alone);
    ASSERT_EQ(said.status, 0) << said.output;
    expect_nothing_executed(folder.path(), said.output);
    const nlohmann::json exporting = seconds();
    const fs::path first = export_of(blend);
    const auto written = fs::last_write_time(first / "film.json");
    ASSERT_EQ(run(alone).status, 0);
    EXPECT_EQ(export_of(blend), first);
    EXPECT_EQ(fs::last_write_time(first / "film.json"), written);
    // The export counts as loading, and Blender's time as the film's.
    EXPECT_GT(exporting.at("load").get<double>(), seconds().at("load").get<double>() + 0.3);
    EXPECT_LE(exporting.at("load").get<double>(), exporting.at("cpu").get<double>());

    std::ofstream(blend, std::ios::binary | std::ios::app) << '\0';
    ASSERT_EQ(run(here + command).status, 0);
    EXPECT_NE(std::distance(fs::directory_iterator(blend.string() + ".export"), fs::directory_iterator{}), 1);
}

TEST(BlendFileSlow, BecomesAFilmWithItsRateSizeShotsAndInstances) {
    NEEDS_BLENDER();
    const Folder folder;
    make(folder, "markers instances");
    ASSERT_EQ(run(program() + " plan --within 0 " + path(folder, "markers.blend")).status, 0);
    json film = json::parse(contents(export_of(folder / "markers.blend") / "film.json"));
    EXPECT_EQ(film["frame_rate"], "24");
    EXPECT_EQ(film["frames"], 12);
    EXPECT_EQ(film["size"], json({160, 90}));
    EXPECT_EQ(film["view"], "standard");
    ASSERT_EQ(film["shots"].size(), 3u);
    EXPECT_EQ(film["shots"][1]["camera"], "Shot 5");
    EXPECT_NEAR(film["shots"][1]["at"].get<double>(), 4.0 / 24, 1e-6);
    EXPECT_TRUE(film["cameras"]["Shot 9"].contains("height")) << "it is parallel";
    ASSERT_EQ(film["chapters"].size(), 2u) << "of markers without cameras those within the film";
    EXPECT_EQ(film["chapters"][0], json({{"at", 0}, {"title", "Dawn"}}));
    EXPECT_EQ(film["chapters"][1]["title"], "Noon");
    EXPECT_NEAR(film["chapters"][1]["at"].get<double>(), 6.0 / 24, 1e-6);

    ASSERT_EQ(run(program() + " plan --within 0 " + path(folder, "instances.blend")).status, 0);
    film = json::parse(contents(export_of(folder / "instances.blend") / "film.json"));
    const json keys = film["change"]["Late"]["keys"];
    ASSERT_EQ(keys.size(), 2u) << "it comes at the fifth frame";
    EXPECT_EQ(keys[1]["visible"], true);
    const std::string glb = contents(export_of(folder / "instances.blend") / "scene.glb");
    for (const char* node :
         {"\"Tree 0/Cone\"", "\"Tree 3/Cone\"", "\"Source/Grain\"", "\"Source/Grain 30\"", "\"Row\""})
        EXPECT_NE(glb.find(node), std::string::npos) << node;
}

TEST(BlendFileSlow, BakesATexelForAPixelOfTheFilm) {
    NEEDS_BLENDER();
    const Folder folder;
    make(folder, "odds_and_ends");
    std::set<fs::path> seen;
    std::vector<int> widths;
    for (const char* size : {"64x36", "640x360"}) {
        const Outcome said =
            run(program() + " plan --within 0 --size " + size + " " + path(folder, "odds_and_ends.blend"));
        ASSERT_EQ(said.status, 0) << said.output;
        for (const fs::directory_entry& entry : fs::directory_iterator(path(folder, "odds_and_ends.blend.export")))
            if (seen.insert(entry.path()).second) {
                const std::string png = contents(entry.path() / "Noisy-colour.png");
                ASSERT_GT(png.size(), 24u) << entry.path();
                widths.push_back(static_cast<unsigned char>(png[18]) * 256 + static_cast<unsigned char>(png[19]));
            }
    }
    ASSERT_EQ(widths.size(), 2u) << "each size has an export of its own";
    EXPECT_EQ(widths[0], 64) << "the smallest";
    EXPECT_GT(widths[1], 64);
}

TEST(BlendFileSlow, TellsWhatIsNotKeptByObjectAndReason) {
    NEEDS_BLENDER();
    const Folder folder;
    make(folder, "odds_and_ends");
    const Outcome said = run(program() + " plan --within 0 " + path(folder, "odds_and_ends.blend"));
    ASSERT_EQ(said.status, 0) << said.output;
    for (const char* line :
         {"not kept: Growing: its shape has other corners", "not kept: Scene: 12 frames per second; the film has 24"})
        EXPECT_NE(said.output.find(line), std::string::npos) << line << " is not in\n" << said.output;
    const fs::path exported = export_of(folder / "odds_and_ends.blend");
    EXPECT_TRUE(fs::exists(exported / "Noisy-colour.png")) << "a text's texture is baked";
    const json film = json::parse(contents(exported / "film.json"));
    EXPECT_EQ(film["frames"], 6);
    // The shutter is open for half of the .blend's frame, which is all of one of the film's; the lens is Blender's:
    // f/2.8 of 50 mm on 36 mm, by its focus.
    EXPECT_NEAR(film["shutter"].get<double>(), 360, 1e-3);
    const json camera = film["cameras"].front();
    EXPECT_NEAR(camera["f_stop"].get<double>(), 2.8, 1e-4);
    EXPECT_GT(camera["focus"].get<double>(), 0.1);
    EXPECT_LT(camera["sensor_height"].get<double>(), 36);
    const std::string glb = contents(exported / "scene.glb");
    for (const char* node : {"\"Sheared (shape)\"", "\"Text\"", "\"Fur Fur\"", "_RADIUS", "\"Scattered/Scattered"})
        EXPECT_NE(glb.find(node), std::string::npos) << node;
}

TEST(BlendFileSlow, HidesItsWorldAndCutsHolesAsBlenderDoes) {
    NEEDS_BLENDER();
    const Folder folder;
    make(folder, "holes");
    const std::string blend = path(folder, "holes.blend");
    const Outcome ours = run(program() + " render " + blend + " -o " + path(folder, "ours%04d.exr") +
                             " --frames 0:0 --exposure 0 --tolerance fixed=8% --edge-samples 64 --vpls 1024 --quiet");
    ASSERT_EQ(ours.status, 0) << ours.output;
    EXPECT_EQ(ours.output.find("roughness"), std::string::npos) << ours.output;
    const Outcome compared = held_against_cycles(blend, folder, "0 --samples 64 --alpha");
    ASSERT_EQ(compared.status, 0) << compared.output;
    const std::size_t at = compared.output.find("ALPHA ");
    ASSERT_NE(at, std::string::npos) << compared.output;
    std::istringstream figures(compared.output.substr(at + 6));
    double mean = 0, cycles_mean = 0, off = 1;
    figures >> mean >> cycles_mean >> off;
    EXPECT_GT(cycles_mean, 0.05);
    EXPECT_NEAR(mean, cycles_mean, 0.002);
    EXPECT_LT(off, 0.01) << "mean absolute difference";
}

TEST(BlendFileSlow, HasAnIntraPictureAtEachCut) {
    NEEDS_BLENDER();
    const Folder folder;
    make(folder, "markers");
    const Outcome made =
        run(program() + " render -y --hold " + path(folder, "markers.blend") + " -o " + path(folder, "f.mpg") +
            " --size 64x48 --samples 1 --exposure 0 --tolerance fixed=10% --quiet --stats " + path(folder, "f.json"));
    ASSERT_EQ(made.status, 0) << made.output;
    const std::string types = test::types_in(folder / "f.json");
    ASSERT_EQ(types.size(), 12u);
    EXPECT_EQ(types[0], 'I');
    EXPECT_EQ(types[4], 'I') << types;
    EXPECT_EQ(types[8], 'I') << types;
    // The sequencer's sound goes along.
    const Outcome told =
        run("ffprobe -v error -select_streams a -show_entries stream=codec_name -of csv=p=0 " + path(folder, "f.mpg"));
    EXPECT_NE(told.output.find("mp2"), std::string::npos) << told.output;
}

TEST(CyclesFramesSlow, BecomeAFilmWithTheirMotion) {
    NEEDS_BLENDER();
    const Folder folder;
    make(folder, "tracked_camera");
    const Outcome rendered = blender(path(folder, "tracked_camera.blend") + " -P " +
                                     (support::source_folder() / "blender/cycles_frames.py").string() + " -- " +
                                     path(folder, "frames") + " --frames 0:2 --samples 1");
    ASSERT_EQ(rendered.status, 0) << rendered.output;
    const std::size_t begin = rendered.output.find("render2mpeg encode");
    ASSERT_NE(begin, std::string::npos) << rendered.output;
    std::string command = rendered.output.substr(begin + 11);
    command.resize(command.find('\n'));
    const Outcome coded =
        run("cd " + folder.path().string() + " && " + program() + command + " --stats s.json --quiet");
    EXPECT_EQ(coded.status, 0) << coded.output;
    EXPECT_EQ(test::types_in(folder / "s.json").size(), 3u);
}

TEST(BlendFileSlow, WithoutNumpyNamesThePackageThatIsMissing) {
    NEEDS_BLENDER();
    const Folder folder;
    const std::string without = support::blender_after(folder, "import sys; sys.modules[\"numpy\"] = None");
    make(folder, "markers");
    const Outcome refused =
        run("RENDER2MPEG_BLENDER=" + without + " " + program() + " plan --within 0 " + path(folder, "markers.blend"));
    EXPECT_EQ(refused.status, 1);
    EXPECT_NE(refused.output.find("markers.blend: Blender's Python lacks numpy: install it"), std::string::npos)
        << refused.output;
}

TEST(BlendOfANewerBlender, IsToldWithBothVersions) {
    NEEDS_BLENDER();
    const Folder folder;
    make(folder, "markers");
    const auto planned = [&] { return run(program() + " plan --within 0 " + path(folder, "markers.blend")); };
    std::string file = contents(folder / "markers.blend");
    ASSERT_EQ(file.substr(0, 7), "BLENDER");
    // Its version is three digits behind pointers' size and byte order.
    file.replace(9, 3, "909");
    std::ofstream(folder / "markers.blend", std::ios::binary) << file;
    const Outcome read = planned();
    EXPECT_EQ(read.status, 0) << read.output;
    EXPECT_NE(read.output.find("what Blender 9.9, which saved it, has and this one, "), std::string::npos)
        << read.output;
    std::ofstream(folder / "markers.blend", std::ios::binary) << "BLENDER17-01v0900" << std::string(64, ' ');
    const Outcome refused = planned();
    EXPECT_EQ(refused.status, 1);
    EXPECT_NE(refused.output.find("markers.blend: it is of Blender 9.0, which this Blender "), std::string::npos)
        << refused.output;
}

TEST(BlenderAimSlow, HasACarShowASign) {
    NEEDS_BLENDER();
    const Folder folder;
    const Outcome made = support::users_blender(folder, "-P " + script("aim.py") + " -- " +
                                                            (support::binary_folder() / "extension").string() + " " +
                                                            folder.path().string());
    EXPECT_NE(made.output.find("AIM WORKS"), std::string::npos) << made.output;
    const Outcome planned = run(program() + " plan --within 0 " + path(folder, "aimed.blend"));
    ASSERT_EQ(planned.status, 0) << planned.output;
    EXPECT_NE(planned.output.find("mirrors are told what to show"), std::string::npos) << planned.output;
    const json film = json::parse(contents(export_of(folder / "aimed.blend") / "film.json"));
    const json& car = film["change"]["Body"];
    ASSERT_EQ(car["reflections"].size(), 2u);
    EXPECT_NEAR(car["reflections"][1]["radius"].get<double>(), 0.15, 1e-6) << "which stays";
    EXPECT_NEAR(car["keys"].front()["reflections"][0]["radius"].get<double>(), 0.1, 1e-6);
    EXPECT_NEAR(car["keys"].back()["reflections"][0]["radius"].get<double>(), 0.22, 1e-6);
    EXPECT_EQ(car["keys"].back()["reflections"][1].count("at"), 0u) << "it goes along with the car";
    EXPECT_NEAR(car["keys"].back()["reflections"][0]["see"][0].get<double>(), 1.4, 1e-5);
    // Frame 0 of drafts, at the point of the door.
    std::istringstream place(made.output.substr(made.output.find("AIM WORKS") + 9));
    double x = 0, y = 0;
    place >> x >> y;
    const auto shows_the_sign = [&](const char* name) {
        const Outcome drawn =
            run(program() + " render -y --preview --frames 0:0 --size 320x144 --quiet " + path(folder, name) + " -o " +
                path(folder, "f%04d.png") + " && ffmpeg -v error -y -i " + path(folder, "f0000.png") +
                " -f rawvideo -pix_fmt rgb24 " + path(folder, "f.rgb"));
        EXPECT_EQ(drawn.status, 0) << drawn.output;
        const std::string pixels = contents(folder / "f.rgb");
        // A draft may be smaller than its film.
        const auto width =
            static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(pixels.size()) / 3 * 640 / 288)));
        const std::size_t height = pixels.size() / 3 / width;
        const std::size_t at = 3 * (static_cast<std::size_t>(y * static_cast<double>(height)) * width +
                                    static_cast<std::size_t>(x * static_cast<double>(width)));
        const auto value = [&](std::size_t c) { return static_cast<unsigned char>(pixels.at(at + c)); };
        return value(0) > 200;  // the paint alone has 100
    };
    EXPECT_TRUE(shows_the_sign("aimed.blend"));
    EXPECT_FALSE(shows_the_sign("plain.blend"));
}

/// How ours is held against Cycles: tests/blender/compare.py.
struct Row {
    double mean = 0, psnr = 0, right = 9, up = 9;
};

struct Film {
    const char* name;
    const char* frames;
    double mean;  ///< how far the mean luminance may be from Cycles'
    double psnr;  ///< dB at least
};

std::vector<Row> rows_in(const std::string& text) {
    std::istringstream lines(text);
    std::vector<Row> rows;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string begin, frame;
        Row row;
        if (words >> begin >> frame >> row.mean >> row.psnr >> row.right >> row.up && begin == "ROW")
            rows.push_back(row);
    }
    return rows;
}

TEST(BlendFileSlow, ShowsPanoramasAsCyclesDoes) {
    NEEDS_BLENDER();
    for (const std::string name : {"panorama", "panorama_window"}) {
        const Folder folder;
        make(folder, name);
        const std::string blend = path(folder, name + ".blend");
        const Outcome ours = run(program() + " render " + blend + " -o " + path(folder, "ours%04d.exr") +
                                 " --frames 0:0 --exposure 0 --tolerance fixed=2% --samples 16 --edge-samples 64");
        ASSERT_EQ(ours.status, 0) << ours.output;
        EXPECT_EQ(ours.output.find("not kept"), std::string::npos) << ours.output;
        EXPECT_EQ(ours.output.find("stretched"), std::string::npos) << ours.output;
        const Outcome compared = held_against_cycles(blend, folder, "0 --samples 128");
        ASSERT_EQ(compared.status, 0) << compared.output;
        const std::vector<Row> rows = rows_in(compared.output);
        ASSERT_EQ(rows.size(), 1u) << compared.output;
        EXPECT_NEAR(rows[0].mean, 1, 0.01) << compared.output;
        EXPECT_GE(rows[0].psnr, 33) << compared.output;
        EXPECT_LT(std::hypot(rows[0].right, rows[0].up), 0.1) << compared.output;
    }
}

TEST(BlendViewsSlow, AreShownAsBlenderShowsThem) {
    NEEDS_BLENDER();
    const Folder folder;
    make(folder, "looks");
    const std::string blend = path(folder, "looks.blend");
    const Outcome planned = run(program() + " plan --within 0 " + blend);
    EXPECT_EQ(planned.output.find("not kept"), std::string::npos) << planned.output;
    EXPECT_NE(planned.output.find("view filmic-high-contrast, gamma 1.1"), std::string::npos) << planned.output;
    const json film = json::parse(contents(export_of(blend) / "film.json"));
    EXPECT_EQ(film["view"], json({{"name", "filmic-high-contrast"}, {"gamma", 1.1}}));
    EXPECT_EQ(film["exposure"], 0.5);

    const Outcome ours = run(program() + " render " + blend + " -o " + path(folder, "ours%04d.png") +
                             " --frames 0:0 --size 80x45 --tolerance fixed=2% --samples 16 --edge-samples 64 --quiet");
    ASSERT_EQ(ours.status, 0) << ours.output;
    const Outcome compared = held_against_cycles(blend, folder, "0 --samples 128 --shown --half");
    ASSERT_EQ(compared.status, 0) << compared.output;
    const std::vector<Row> rows = rows_in(compared.output);
    ASSERT_EQ(rows.size(), 1u) << compared.output;
    EXPECT_NEAR(rows[0].mean, 1, 0.02) << "of code values";
    EXPECT_GE(rows[0].psnr, 30) << "of Blender's own picture";
    // Another view than the one that is asked for would be far off.
    EXPECT_EQ(run(program() + " render " + blend + " -o " + path(folder, "ours%04d.png") + " --view standard -y" +
                  " --frames 0:0 --size 80x45 --tolerance fixed=5% --quiet")
                  .status,
              0);
    const std::vector<Row> other =
        rows_in(blender("-P " + script("compare.py") + " -- " + folder.path().string() + " 0 --shown").output);
    ASSERT_EQ(other.size(), 1u);
    EXPECT_LT(other[0].psnr, rows[0].psnr - 4);
}

class BlendBesideCyclesSlow : public testing::TestWithParam<Film> {};

TEST_P(BlendBesideCyclesSlow, IsFramedAndLitAlike) {
    NEEDS_BLENDER();
    const Film& film = GetParam();
    const Folder folder;
    make(folder, film.name);
    const std::string blend = path(folder, std::string(film.name) + ".blend");
    std::istringstream frames(film.frames);
    for (std::string frame; frames >> frame;) {
        const Outcome ours = run(
            program() + " render -y --hold " + blend + " -o " + path(folder, "ours%04d.exr") + " --frames " + frame +
            ":" + frame + " --size 80x45 --exposure 0 --tolerance fixed=2% --samples 16 --edge-samples 64 --quiet");
        ASSERT_EQ(ours.status, 0) << ours.output;
    }
    const Outcome compared = held_against_cycles(blend, folder, std::string(film.frames) + " --samples 128 --half");
    ASSERT_EQ(compared.status, 0) << compared.output;
    const std::vector<Row> rows = rows_in(compared.output);
    for (const Row& row : rows) {
        EXPECT_NEAR(row.mean, 1, film.mean) << compared.output;
        EXPECT_GE(row.psnr, film.psnr) << compared.output;
        EXPECT_LT(std::hypot(row.right, row.up), 0.25) << compared.output;
    }
    EXPECT_GE(rows.size(), 1u) << compared.output;
}

INSTANTIATE_TEST_SUITE_P(Films, BlendBesideCyclesSlow,
                         testing::Values(Film{"tracked_camera", "0 7", 0.03, 30}, Film{"markers", "0 7 10", 0.03, 30},
                                         Film{"lamps_and_sky", "0 5", 0.03, 30},
                                         Film{"armature_and_shapes", "0 7", 0.03, 30},
                                         Film{"instances", "0 7", 0.03, 30}, Film{"fur", "2", 0.03, 32},
                                         Film{"groomed_head", "0", 0.03, 32}, Film{"curves", "0", 0.03, 32},
                                         Film{"glass_and_emission", "5", 0.03, 30}, Film{"procedural", "0", 0.03, 30},
                                         Film{"cloud", "0 5", 0.02, 30}, Film{"open_shutter", "1 2", 0.01, 38},
                                         Film{"shallow_focus", "0", 0.01, 37}),
                         [](const auto& film) { return film.param.name; });

}  // namespace
}  // namespace render2mpeg::test
