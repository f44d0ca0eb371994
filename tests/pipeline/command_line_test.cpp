#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <thread>

#include "app/options/options.h"
#include "pipeline/fixture.h"

/// What a user meets at the door: help, refusals, interruptions.
namespace render2mpeg::test {
namespace {

std::filesystem::path write(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
    return file;
}

/// Refused as the house wants it: one line, exit status 1, nothing written, `words` said.
void expect_refusal(const Folder& folder, const std::string& arguments, const std::string& words) {
    const std::size_t before = folder.entries();
    const auto outcome = run(program() + " " + arguments);
    EXPECT_EQ(outcome.status, 1) << arguments << "\n" << outcome.output;
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
    EXPECT_EQ(folder.entries(), before) << arguments;
}

TEST(Help, ShowsEveryOptionWithItsDefault) {
    const auto help = run(program() + " render --help");
    EXPECT_EQ(help.status, 0);
    for (const char* words :
         {"--size",    "--fps",       "--frames",  "--quantiser", "=4",        "--gop",   "=60",      "--samples",
          "--vpls",    "--tolerance", "coupled=K", "--exposure",  "=auto",     "--sky",   "--camera", "--animation",
          "--threads", "--isa",       "--stats",   "--aov",       "--dry-run", "--quiet", ".mpg",     "%04d"})
        EXPECT_NE(help.output.find(words), std::string::npos) << words;
    EXPECT_EQ(run(program() + " plan --help").status, 0);
    EXPECT_EQ(run(program() + " --version").output.substr(0, 12), "render2mpeg ");
}

TEST(Help, ShowsTheDefaultsThatMembersHave) {
    const auto shown = [](const std::string& command, const std::string& option) {
        const std::string help = support::run(support::program() + " " + command + " --help").output;
        const std::size_t begin = help.find('=', help.find(option + " ")) + 1;
        return help.substr(begin, help.find_first_of(" \n]", begin) - begin);
    };
    const std::string within = shown("plan", "--within"), tried = shown("cost", "--within"),
                      tolerances = shown("cost", "--tolerances");
    EXPECT_EQ(app::parse({"render2mpeg", "plan", "s.glb", "--within", within}).render.within,
              app::RenderOptions().within);
    const app::CommandLine cost =
        app::parse({"render2mpeg", "cost", "s.glb", "--within", tried, "--tolerances", tolerances});
    EXPECT_EQ(cost.trial.within, app::TrialOptions().within);
    EXPECT_EQ(cost.trial.tolerances, app::TrialOptions().tolerances);
}

TEST(Help, TheProgramItselfLoadsNoHeavyLibrary) {
    const auto libraries = run("ldd " + program());
    for (const char* heavy : {"libavformat", "libavcodec", "libOpenImageIO", "libOpenEXR"})
        EXPECT_EQ(libraries.output.find(heavy), std::string::npos) << heavy;
}

TEST(Refusal, NamesTheFileAndTheCause) {
    const Folder folder;
    const std::string out = " -o " + (folder / "x.mpg").string();
    const auto gltf = [&](const std::string& name, const std::string& text) {
        return "render " + write(folder / name, text).string() + out;
    };

    expect_refusal(folder, "render " + (folder / "absent.glb").string() + out, "absent.glb");
    const std::string truncated = gltf("truncated.gltf", R"({"asset":{"version":"2.0"},"nodes":[)");
    expect_refusal(folder, truncated, "truncated.gltf");
    const std::string cycle = gltf(
        "cycle.gltf",
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]})");
    expect_refusal(folder, cycle, "cycle.gltf");
    const std::string count =
        gltf("count.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":1000000000,"type":"VEC3"}]})");
    expect_refusal(folder, count, "count.gltf");
    const std::string outside =
        gltf("outside.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"../../etc/hostname"}]})");
    expect_refusal(folder, outside, "outside.gltf");
    const std::string required = gltf(
        "required.gltf",
        R"({"asset":{"version":"2.0"},"extensionsRequired":["EXT_unheard_of"],"extensionsUsed":["EXT_unheard_of"]})");
    expect_refusal(folder, required, "EXT_unheard_of");
    const std::string key = gltf("key.json", R"({"camra":{}})");
    expect_refusal(folder, key, "camra");
}

TEST(Refusal, NamesTheOptionAndWhatWouldBeRight) {
    const Folder folder;
    const std::string start = "render " + plain_film();
    const std::string out = " -o " + (folder / "x.mpg").string();
    const auto refused = [&](const std::string& arguments, const std::string& words) {
        const auto outcome = run(program() + " " + arguments);
        EXPECT_EQ(outcome.status, 2) << outcome.output;
        EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
        EXPECT_EQ(folder.entries(), 0u);
    };
    refused(start + out + " --fps 31", "frame rate 31: MPEG-2 has 23.976, 24, 25, 29.97, 30, 50, 59.94, 60");
    refused(start + out + " --size 640", "WIDTHxHEIGHT");
    refused(start + out + " --frames 9:3", "FIRST:LAST");
    refused(start + out + " --quantiser 32", "quantiser");
    refused(start + out + " --tolerance 2", "fixed=P%");
    refused(start + out + " --tolerance fixed=1", "fixed=P%");
    refused(start + out + " --tolerance coupled=1e-60", "coupled=K");
    refused(start + out + " --exposure bright", "auto");
    refused(start + out + " --isa mmx", "sse2, sse4.2, avx, avx2, avx512");
    refused(start + " -o " + (folder / "x.xyz").string(), ".mpg, .vob, .ts, .m2v, .mkv, .webm, .gif, .mp4");
    refused(start + " -o " + (folder / "x.png").string(), "%04d");
    refused(start + out + " --size 4096x2304", "1920");
}

TEST(Refusal, IsOneLineOfTheProgramsOwnFormWhateverIsWrong) {
    const Folder folder;
    const std::string start = plain_film() + " -o " + (folder / "x.mpg").string();
    for (const std::string& arguments :
         {std::string(), std::string("rendr x"), std::string("render"), "render " + start + " --bogus",
          "render " + start + " --quantiser 77", "render " + start + " --size", "render " + start + " --size 640",
          "render " + start + " --display-aspect 4:3 --pixel-aspect 1:1", "render " + start + " --motion m.%d.exr",
          "render " + start + " --heatmap cut", std::string("plan --bitrate abc ") + plain_film(),
          std::string("info")}) {
        const auto outcome = run(program() + " " + arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_TRUE(outcome.output.starts_with("render2mpeg: ")) << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    }
    EXPECT_NE(run(program() + " rendr x").output.find("render, encode, plan, info, cost, tune, compare"),
              std::string::npos);
    EXPECT_NE(run(program() + " render").output.find("render2mpeg render --help"), std::string::npos);
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(Notes, TellWhichOptionsDoNothing) {
    const Folder folder;
    const std::string start = program() + " render " + plain_film() + " --dry-run --within 0 ";
    const std::string film_out = "-o " + (folder / "x.mpg").string(), frames = "-o " + (folder / "f.%d.exr").string();
    const auto noted = [](const std::string& command, const char* words) {
        const auto outcome = run(command);
        EXPECT_EQ(outcome.status, 0) << outcome.output;
        EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
    };
    noted(start + frames + " --gop 5 --tune perceptual", "--gop, --tune do nothing here: f.%d.exr is not coded");
    noted(start + frames + " --exposure 1 --tolerance reference", "--exposure does nothing here");
    noted(start + film_out + " --tolerance fixed=2% --masking quantised", "--masking does nothing here");
    noted(start + film_out + " --tolerance fixed=2% --loss 0.1", "--loss does nothing here");
    noted(start + film_out + " --frames 0:9 --keyframes 3,12,40", "2 of 3 are no frames of the film, which has 0 to 9");
    noted(start + film_out + " --frames 3", "--frames 3 is one frame, number 3 from 0; the first 3 are --frames 0:2");
    // Silent where all count, and where nobody wants to know.
    EXPECT_EQ(run(start + film_out + " --gop 5 --masking quantised --keyframes 3").output.find("nothing here"),
              std::string::npos);
    EXPECT_EQ(run(start + frames + " --gop 5 --quiet").output, "");
}

TEST(Refusal, NoOutputTakesThePlaceOfAnInputOrOfAnotherOutput) {
    const Folder folder;
    const std::string start = "render " + plain_film() + " --dry-run --within 0", o = (folder / "x.mpg").string(),
                      out = " -o " + o;
    expect_refusal(folder, start + out + " --stats " + o, "x.mpg");
    expect_refusal(folder, start + out + " --heatmap cut " + o, "x.mpg");
    const std::string heat = (folder / "h.mpg").string();
    expect_refusal(folder, start + out + " --heatmap cut " + heat + " --heatmap error " + heat, "two outputs");
    const std::string y4m = write(folder / "y.y4m", "YUV4MPEG2 W16 H16 F25:1\n").string();
    expect_refusal(folder, "encode " + y4m + out + " --stats " + (folder / "." / "y.y4m").string(), "an input");
}

TEST(DryRun, SeesThatOutputsCannotBeMade) {
    const Folder folder;
    write(folder / "file", "");
    std::filesystem::create_directory(folder / "f.mpg");
    const std::string start = "render " + plain_film() + " --dry-run --within 0 -o ";
    const auto name = [&](const char* file) { return (folder / file).string(); };
    expect_refusal(folder, start + name("file/deep/x.mpg"), "file is not a folder");
    expect_refusal(folder, start + name("f.mpg"), "it is a folder");
    expect_refusal(folder, start + name("x.mpg") + " --stats " + name("file/s.json"), "file is not a folder");
    expect_refusal(folder, start + name("x.mpg") + " --aov " + name("file/layers"), "file is not a folder");
    EXPECT_EQ(run(program() + " " + start + name("new/folder/x.mpg") + " --quiet").status, 0);
    EXPECT_EQ(folder.entries(), 2u);
}

TEST(DryRun, ChecksAllAndWritesNothing) {
    const Folder folder;
    const auto outcome = run(program() + " render " + plain_film() + " --dry-run --within 0 --hold --frames 0:99 -o " +
                             (folder / "x.mpg").string());
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("2 chunks"), std::string::npos) << outcome.output;
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(PlanCommand, GivesAReasonForEveryPass) {
    const auto still = run(program() + " plan --within 0 " + film("still_room"));
    EXPECT_EQ(still.status, 0);
    for (const char* row :
         {"yes load ", "yes exposure ", "no  first pass ", "yes preview ", "yes tolerate ", "no  audit ", "no cause"})
        EXPECT_NE(still.output.find(row), std::string::npos) << row << "\n" << still.output;
    // Rows follow what the render would be asked for.
    const auto other = run(program() + " plan --within 0 " + film("still_room") +
                           " --tolerance fixed=2% --bitrate 2M --exposure 1 --audit 5");
    for (const char* row : {"no  exposure ", "yes first pass ", "no  preview ", "no  tolerate ", "yes audit "})
        EXPECT_NE(other.output.find(row), std::string::npos) << row << "\n" << other.output;
    EXPECT_NE(run(program() + " plan --within 0 " + film("still_room") + " -o f.%d.png").output.find("no  encode"),
              std::string::npos);
}

TEST(Statistics, HaveEveryDocumentedKey) {
    const Folder folder;
    const auto file = folder / "s.json";
    ASSERT_EQ(run(program() + " render " + plain_film() +
                  " --size 16x16 --samples 1 --tolerance coupled=8 --frames 0:1 --quiet -o " +
                  (folder / "x.mpg").string() + " --stats " + file.string())
                  .status,
              0);
    const auto statistics = nlohmann::json::parse(contents(file));
    for (const char* key : {"version", "command", "input", "output", "width", "height", "fps", "frames", "bytes",
                            "seconds", "counts", "mean_cut", "peak_rss_mib", "psnr_y", "ssim_y", "per_frame"})
        EXPECT_TRUE(statistics.contains(key)) << key;
    for (const char* key : {"load", "see", "shade", "develop", "encode", "wall", "cpu"})
        EXPECT_TRUE(statistics.at("seconds").contains(key)) << key;
    for (const char* key : {"primary_rays", "shadow_rays", "gather_rays"})
        EXPECT_GT(statistics.at("counts").at(key).get<double>(), 0) << key;
    // The guide names each count and each member of a frame.
    const std::string document = contents(support::source_folder() / "docs/json.md");
    for (const auto* object : {&statistics.at("counts"), &statistics.at("per_frame")[0]})
        for (const auto& [key, value] : object->items())
            EXPECT_NE(document.find("`" + key + "`"), std::string::npos) << key;
    EXPECT_EQ(statistics.at("per_frame").size(), 2u);
    EXPECT_EQ(statistics.at("bytes"), std::filesystem::file_size(folder / "x.mpg"));
    EXPECT_EQ(statistics.at("per_frame")[0].at("type"), "I");
    EXPECT_EQ(statistics.at("quantiser"), 4);
    EXPECT_EQ(statistics.at("quantisers").at("min"), 4);
    EXPECT_EQ(statistics.at("tolerance").at("mode"), "coupled");
    EXPECT_EQ(statistics.at("tolerance").at("masking"), "warped");
}

TEST(Statistics, TellTheRealQuantisersWhereNoneWasAskedFor) {
    const Folder folder;
    const auto file = folder / "s.json";
    ASSERT_EQ(run(program() + " render " + plain_film() +
                  " --size 32x32 --samples 1 --frames 0:5 --exposure 0 --quiet "
                  "--quality 40 --tolerance "
                  "fixed=5% -o " +
                  (folder / "x.mpg").string() + " --stats " + file.string())
                  .status,
              0);
    const auto statistics = nlohmann::json::parse(contents(file));
    EXPECT_EQ(statistics.at("quantiser"), nullptr);
    int min = 99, max = 0;
    double mean = 0;
    for (const auto& frame : statistics.at("per_frame")) {
        min = std::min(min, frame.at("quantiser").get<int>());
        max = std::max(max, frame.at("quantiser").get<int>());
        mean += frame.at("mean_quantiser").get<double>() / 6;
    }
    EXPECT_EQ(statistics.at("quantisers").at("min"), min);
    EXPECT_EQ(statistics.at("quantisers").at("max"), max);
    EXPECT_GT(max, min) << "B pictures are coarser";
    EXPECT_NEAR(statistics.at("quantisers").at("mean").get<double>(), mean, 1e-9);
    EXPECT_EQ(statistics.at("tolerance").at("mode"), "fixed");
    EXPECT_NEAR(statistics.at("tolerance").at("relative").get<double>(), 0.05, 1e-6);
}

TEST(Interruption, LeavesAPlayablePartialFilmAndNoFinalOneSlow) {
    const Folder folder;
    const auto output = folder / "film.mpg";
    const auto outcome =
        run(support::program_at_terminal() + " render " + plain_film() +
            " --size 32x32 --samples 1 --vpls 0 --tolerance fixed=90% --hold --frames 0:9999 --exposure 0 --quiet -o " +
            output.string() + " & job=$!; while [ ! -s " + (folder / "film.mpg.partial").string() +
            "/chunk_00000.m2v ]; do sleep 0.05; done; sleep 0.3; " + "kill -INT $job; wait $job");
    EXPECT_EQ(outcome.status, 130) << outcome.output;
    EXPECT_FALSE(std::filesystem::exists(output));
    const auto partial = folder / "film.mpg.partial/film.mpg";
    ASSERT_TRUE(std::filesystem::exists(partial));
    const auto decoded = run("ffmpeg -v error -xerror -err_detect explode -i " + partial.string() + " -f null -");
    EXPECT_EQ(decoded.status, 0);
    EXPECT_EQ(decoded.output, "");
}

}  // namespace
}  // namespace render2mpeg::test
