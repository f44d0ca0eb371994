#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>

#include "pipeline/fixture.h"

/// Films that go through pipes instead of files.
namespace render2mpeg::test {
namespace {

std::string small_render() {
    static const Folder folder;
    std::ofstream(folder / "travel.json") << support::travel_scene(60);
    return program() + " render " + path(folder, "travel.json") +
           " --hold --size 96x80 --samples 1 --exposure 0.5 --tolerance fixed=10% "
           "--quiet ";
}

std::string named(const Folder& folder, const std::string& name) {
    return (folder / name).string();
}

TEST(Stream, HasTheBytesOfTheFileSlow) {
    const Folder folder;
    ASSERT_EQ(run(small_render() + "--frames 0:6 -y -o " + named(folder, "file.m2v")).status, 0);
    const auto piped = run(small_render() + "--frames 0:6 -o - --as m2v > " + named(folder, "pipe.m2v"));
    EXPECT_EQ(piped.status, 0) << piped.output;
    EXPECT_TRUE(contents(folder / "pipe.m2v") == contents(folder / "file.m2v"));
    ASSERT_EQ(run(small_render() + "--frames 0:1 -y -o " + named(folder, "file.y4m")).status, 0);
    ASSERT_EQ(run(small_render() + "--frames 0:1 -o - --as y4m > " + named(folder, "pipe.y4m")).status, 0);
    EXPECT_TRUE(contents(folder / "pipe.y4m") == contents(folder / "file.y4m"));
}

TEST(Stream, OfTransportPacketsDecodesWithRisingTimes) {
    const Folder folder;
    ASSERT_EQ(run(small_render() + "--frames 0:6 -o - > " + named(folder, "pipe.ts")).status, 0);
    const auto strict =
        run("ffmpeg -v error -xerror -err_detect explode -i " + named(folder, "pipe.ts") + " -f null -");
    EXPECT_EQ(strict.output, "");
    const auto times =
        run("ffprobe -v error -select_streams v -show_entries frame=pts -of csv=p=0 " + named(folder, "pipe.ts"));
    std::istringstream lines(times.output);
    long before = -1, count = 0;
    for (std::string line; std::getline(lines, line);) {
        if (line.empty()) continue;
        ++count;
        EXPECT_GT(std::atol(line.c_str()), before);
        before = std::atol(line.c_str());
    }
    EXPECT_EQ(count, 7);
}

TEST(Stream, EndsInOneLineWhereItsReaderGoes) {
    const Folder folder;
    // More than a pipe holds.
    const auto gone =
        run("{ " + small_render() + "--frames 0:200 -o - --as y4m; echo status $? >&2; } | head -c 1000 > " +
            named(folder, "head"));
    EXPECT_EQ(gone.output, "render2mpeg: writing standard output: its reader has gone\nstatus 1\n");
}

TEST(Stream, WaitsForASlowReader) {
    const Folder folder;
    const auto slow =
        run(small_render() + "--frames 0:6 -o - --as y4m | { sleep 1; cat; } > " + named(folder, "slow.y4m"));
    EXPECT_EQ(slow.output, "");
    ASSERT_EQ(run(small_render() + "--frames 0:6 -o - --as y4m > " + named(folder, "quick.y4m")).status, 0);
    EXPECT_TRUE(contents(folder / "slow.y4m") == contents(folder / "quick.y4m"));
}

TEST(Stream, RefusesWhatItCannotHave) {
    const Folder folder;
    EXPECT_EQ(run(small_render() + "-o " + named(folder, "a.mpg") + " --as ts").status, 2);
    EXPECT_EQ(run(small_render() + "-o - --as mkv | cat; exit ${PIPESTATUS:-0}")
                      .output.find("--as mkv: expected ts, m2v, y4m") != std::string::npos,
              true);
    const auto resumed = run(small_render() + "-o - --resume > /dev/null");
    EXPECT_EQ(resumed.status, 2);
    EXPECT_EQ(resumed.output, "render2mpeg: --resume: with -o - nothing is left that a later run could go on with\n");
}

/// A pattern that moves `dx` pixels to the right with each frame, as Y4M, and its motion as a stream.
constexpr int width = 112, height = 80, dx = 7;

std::string pan_y4m(int frames) {
    std::string text = "YUV4MPEG2 W112 H80 F25:1 Ip A1:1 C420mpeg2\n";
    for (int n = 0; n < frames; ++n) {
        text += "FRAME\n";
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const unsigned hash =
                    (static_cast<unsigned>(x - dx * n + 4096) * 2654435761u) ^ (static_cast<unsigned>(y) * 2246822519u);
                text += static_cast<char>(40 + (hash >> 16) % 160);
            }
        text += std::string(std::size_t{2} * (width / 2) * (height / 2), static_cast<char>(128));
    }
    return text;
}

std::string word(std::uint32_t value) {
    std::string bytes(4, '\0');
    std::memcpy(bytes.data(), &value, 4);
    return bytes;
}

std::string motion_header(std::uint32_t fields) {
    return "R2MV" + word(1) + word(width) + word(height) + word(fields) + word(0) + word(0) + word(0);
}

std::string pan_motion(int frames) {
    std::string text = motion_header(1);
    const float vector[2] = {-dx, 0};
    std::string pair(sizeof vector, '\0');
    std::memcpy(pair.data(), vector, sizeof vector);
    for (int n = 0; n < frames; ++n) {
        for (int i = 0; i < width * height; ++i) text += pair;
        text += std::string(std::size_t{width} * height, '\1');
    }
    return text;
}

void write(const Folder& folder, const std::string& name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
}

std::string encode_pipe(const Folder& folder, const std::string& options) {
    return program() + " encode - -y --quiet -q 6 " + options + " < " + named(folder, "pan.y4m");
}

TEST(EncodePipe, GivesTheFilmOfTheFileSlow) {
    const Folder folder;
    for (const int frames : {1, 7, 60, 61}) {  // within a chunk, at its end, and one frame behind it
        write(folder, "pan.y4m", pan_y4m(frames));
        const auto piped = run(encode_pipe(folder, "-o " + named(folder, "pipe.m2v")));
        ASSERT_EQ(piped.status, 0) << piped.output;
        ASSERT_EQ(
            run(program() + " encode " + named(folder, "pan.y4m") + " -y --quiet -q 6 -o " + named(folder, "file.m2v"))
                .status,
            0);
        EXPECT_TRUE(contents(folder / "pipe.m2v") == contents(folder / "file.m2v")) << frames;
        ASSERT_EQ(run(encode_pipe(folder, "-o - --as m2v > " + named(folder, "both.m2v"))).status, 0);
        EXPECT_TRUE(contents(folder / "both.m2v") == contents(folder / "file.m2v")) << frames;
    }
}

TEST(EncodePipe, TakesMotionFromASecondPipe) {
    const Folder folder;
    write(folder, "pan.y4m", pan_y4m(20));
    write(folder, "pan.motion", pan_motion(20));
    const auto known = run(
        "( " +
        encode_pipe(folder, "-o " + named(folder, "known.m2v") + " --motion fd:3 --stats " + named(folder, "s.json")) +
        " ) 3< " + named(folder, "pan.motion"));
    ASSERT_EQ(known.status, 0) << known.output;
    EXPECT_NE(contents(folder / "s.json").find("\"motion\": true"), std::string::npos);
    ASSERT_EQ(run(encode_pipe(folder, "-o " + named(folder, "named.m2v") + " --motion " + named(folder, "pan.motion")))
                  .status,
              0);
    EXPECT_TRUE(contents(folder / "named.m2v") == contents(folder / "known.m2v"));
    ASSERT_EQ(run(encode_pipe(folder, "-o " + named(folder, "found.m2v"))).status, 0);
    // Noise that moves on: exact vectors leave next to nothing of all but what comes in.
    EXPECT_LE(contents(folder / "known.m2v").size(), contents(folder / "found.m2v").size() * 101 / 100);
}

TEST(EncodePipe, AllocatesNoBitsByMotionThatIsReadOnce) {
    const Folder folder;
    write(folder, "pan.y4m", pan_y4m(70));
    write(folder, "pan.motion", pan_motion(70));
    const std::string film = "timeout 60 " + program() + " encode " + named(folder, "pan.y4m") + " -y --quiet -o " +
                             named(folder, "pan.m2v") + " --bitrate 900k --motion " + named(folder, "pan.motion");
    EXPECT_EQ(run(film).status, 0);
    EXPECT_EQ(run(film + " --passes 1").status, 0);
    const auto twice = run(film + " --passes 2");
    EXPECT_EQ(twice.status, 2);
    EXPECT_NE(twice.output.find("pan.motion is read once; choose --passes 1"), std::string::npos) << twice.output;
}

TEST(EncodePipe, RunsBesideAProgramThatWritesBothInTurn) {
    const Folder folder;
    write(folder, "turns.py", R"(import os, sys
pictures, motion = open(sys.argv[1], 'rb').read(), open(sys.argv[2], 'rb').read()
head = pictures.index(b'\n') + 1
frame, field = 112 * 80 * 3 // 2 + 6, 112 * 80 * 9
os.write(1, pictures[:head]); os.write(3, motion[:32])
for n in range(40):
    for fd, data, at, size in ((3, motion, 32, field), (1, pictures, head, frame)):
        part = data[at + n * size:at + (n + 1) * size]
        while part: part = part[os.write(fd, part):]
)");
    write(folder, "pan.y4m", pan_y4m(40));
    write(folder, "pan.motion", pan_motion(40));
    const std::string fifo = named(folder, "live.motion");
    const auto both =
        run("mkfifo " + fifo + "; timeout 60 sh -c '( exec 3> " + fifo + "; exec python3 " + named(folder, "turns.py") +
            " " + named(folder, "pan.y4m") + " " + named(folder, "pan.motion") + " ) | " + program() +
            " encode - -y --quiet -q 6 -o " + named(folder, "live.m2v") + " --motion " + fifo + "'");
    EXPECT_EQ(both.status, 0) << both.output;
    ASSERT_EQ(
        run(encode_pipe(folder, "-o " + named(folder, "file.m2v") + " --motion " + named(folder, "pan.motion"))).status,
        0);
    EXPECT_TRUE(contents(folder / "live.m2v") == contents(folder / "file.m2v"));
}

TEST(EncodePipe, RefusesGarbageWithItsPlace) {
    const Folder folder;
    write(folder, "pan.y4m", pan_y4m(4));
    const std::string film = "-o " + named(folder, "x.m2v") + " --motion " + named(folder, "bad.motion");
    const auto told = [&](const std::string& motion) {
        write(folder, "bad.motion", motion);
        const auto outcome = run(encode_pipe(folder, film));
        EXPECT_EQ(outcome.status, 1);
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
        return outcome.output;
    };
    EXPECT_NE(told("").find("byte 0: it is empty"), std::string::npos);
    EXPECT_NE(told(std::string(32, 'x')).find("byte 0: no motion stream begins here"), std::string::npos);
    EXPECT_NE(told(motion_header(3)).find("3 fields per frame: expected 1 or 2"), std::string::npos);
    EXPECT_NE(told(motion_header(1)).find("it ends before frame"), std::string::npos);
    std::string bad = pan_motion(4);
    EXPECT_NE(told(bad.substr(0, bad.size() - 5)).find("it is cut off"), std::string::npos);
    bad[32 + std::size_t{8} * width * height + 3] = 9;
    EXPECT_NE(told(bad).find("byte " + std::to_string(32 + 8 * width * height + 3) + ": class 9 of a pixel of frame 0"),
              std::string::npos);
    write(folder, "pan.y4m", pan_y4m(2).substr(0, 20000));
    const auto cut = run(encode_pipe(folder, "-o " + named(folder, "x.m2v")));
    EXPECT_EQ(cut.output, "render2mpeg: reading standard input: frame 1: it is cut off\n");
    EXPECT_EQ(run(program() + " encode - -o " + named(folder, "x.m2v")).output,
              "render2mpeg: reading standard input: not a Y4M file: it does not begin with a YUV4MPEG2 header\n");
}

}  // namespace
}  // namespace render2mpeg::test
