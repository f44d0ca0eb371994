#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "pipeline/browser.h"
#include "pipeline/fixture.h"

/// Films of all codecs, by whole runs of the program.
namespace render2mpeg::test {
namespace {

/// The codec that `info` sees, or what it says instead.
std::string codec_in(const std::string& file) {
    const auto outcome = run(program() + " info --summary --json " + file);
    return outcome.status == 0 ? json::parse(outcome.output).at("codec").get<std::string>() : outcome.output;
}

std::string usual_ending(const std::string& codec) {
    return codec == "vp9" ? ".webm" : ".mp4";
}

/// Whether this machine codes so.
bool codes(const std::string& codec) {
    const Folder folder;
    write_frames(path(folder, "f.y4m"), 64, 64, "25:1", "", 1);
    return run(program() + " encode " + path(folder, "f.y4m") + " --quiet --codec " + codec + " -o " +
               path(folder, "f" + usual_ending(codec)))
               .status == 0;
}

TEST(Codecs, AreChosenByTheEndingOrByNameSlow) {
    const Folder folder;
    const std::string frames = path(folder, "f.y4m");
    write_frames(frames, 64, 64, "25:1", "", 3);
    const auto encoded = [&](const std::string& name, const std::string& more = "") {
        const auto outcome = run(program() + " encode " + frames + " -y --quiet -o " + path(folder, name) + " " + more);
        return outcome.status == 0 ? codec_in(path(folder, name)) : outcome.output;
    };
    EXPECT_EQ(encoded("f.mpg"), "mpeg2");
    EXPECT_EQ(encoded("f.ts"), "mpeg2");
    EXPECT_EQ(encoded("f.m2v"), "mpeg2");
    EXPECT_EQ(encoded("f.mp4"), "h264");
    EXPECT_EQ(encoded("f.mov"), "h264");
    EXPECT_EQ(encoded("f.mkv"), "h264");
    EXPECT_EQ(encoded("f.webm"), "vp9");
    EXPECT_EQ(encoded("g.ts", "--codec h264 --crf 30"), "h264");
    EXPECT_EQ(encoded("g.mp4", "--codec mpeg2"), "mpeg2");
    for (const char* codec : {"hevc", "av1"})
        EXPECT_TRUE(!codes(codec) || encoded("g.mp4", std::string("--codec ") + codec) == codec) << codec;
}

TEST(Codecs, RefuseInOneLineWhatTheyDoNotHave) {
    const Folder folder;
    const std::string frames = path(folder, "f.y4m");
    write_frames(frames, 64, 64, "25:1", "", 3);
    const auto refused = [&](const std::string& options, const std::string& words) {
        const auto outcome = run(program() + " encode " + frames + " --quiet " + options);
        EXPECT_NE(outcome.status, 0) << options;
        EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    };
    const std::string mpg = "-o " + path(folder, "f.mpg "), mp4 = "-o " + path(folder, "f.mp4 ");
    refused(mpg + "--crf 23", "--crf 23: MPEG-2's scale is that of --quantiser");
    refused(mpg + "--codec h264", "f.mpg: such files have no H.264; .mp4 and .mkv have");
    refused(mp4 + "--crf 60", "--crf 60: H.264 has 1 to 51");
    refused(mp4 + "--codec av1 --tune perceptual", "--tune perceptual: AV1 takes no quantisers of blocks");
    refused(mp4 + "--crf 23 -q 4", "--crf and --quantiser");
    refused(mp4 + "--bitrate 1M --cbr", "--cbr is MPEG-2's");
    refused(mp4 + "--bitrate 1M --passes 1", "--passes 1: a rate of H.264 needs two passes");
    refused("-o " + path(folder, "f.mov") + " --codec av1", "f.mov: such files have no AV1");
    const auto watched = run(program() + " watch " + plain_film() + " --codec h264");
    EXPECT_NE(watched.output.find("--codec h264: a player is sent bare MPEG-2"), std::string::npos) << watched.output;
    const auto disc = run(program() + " render --hold " + plain_film() + " --for dvd-pal --codec h264 " + mpg);
    EXPECT_NE(disc.output.find("--codec h264: --for dvd-pal is MPEG-2's world"), std::string::npos) << disc.output;
    EXPECT_EQ(folder.entries(), 1u) << "nothing was written";
}

TEST(Codecs, OfGifAreTheSameForAnyThreadsAndHaveTheirFastestRateSlow) {
    const Folder folder;
    const auto render = [&](const std::string& name, const std::string& more) {
        return run(program() + " render --hold " + plain_film() +
                   " --size 48x32 --frames 0:2 --samples 1 --exposure 0 --quiet -o " + path(folder, name) + more);
    };
    for (const char* threads : {"1", "3"})
        ASSERT_EQ(render(std::string(threads) + ".gif", std::string(" --threads ") + threads).status, 0);
    EXPECT_EQ(codec_in(path(folder, "1.gif")), "gif");
    EXPECT_TRUE(contents(folder / "1.gif") == contents(folder / "3.gif"));
    const auto fast = render("fast.gif", " --fps 60");
    EXPECT_NE(fast.status, 0);
    EXPECT_NE(fast.output.find("players show 50 pictures per second at most"), std::string::npos) << fast.output;
    EXPECT_EQ(std::count(fast.output.begin(), fast.output.end(), '\n'), 1) << fast.output;
    EXPECT_EQ(folder.entries(), 2u) << "nothing was written";
}

/// What is told of a film, coded with these options.
json told_of(const Folder& folder, const std::string& frames, const std::string& options) {
    const auto outcome = run(program() + " encode " + frames + " -y --quiet --encoder fast " + options + " -o " +
                             path(folder, "f.mp4") + " --stats " + path(folder, "f.json"));
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return json::parse(contents(folder / "f.json"));
}

/// Bits per second of a film, coded with these options.
double rate_of(const Folder& folder, const std::string& frames, const std::string& options) {
    return told_of(folder, frames, options).at("rate").at("average").get<double>();
}

TEST(Codecs, ReachARateInTwoPassesSlow) {
    const Folder folder;
    const std::string frames = path(folder, "f.y4m");
    write_frames(frames, 96, 80, "25:1", "", 80);
    for (const std::string codec : {"h264", "hevc"}) {
        if (!codes(codec)) continue;
        for (const double wanted : {60e3, 200e3})
            EXPECT_NEAR(
                rate_of(folder, frames, "--codec " + codec + " --bitrate " + std::to_string(std::lround(wanted))),
                wanted, 0.02 * wanted)
                << codec;
    }
}

/// Soft waves, before which a square moves: all but it can be predicted.
void write_waves(const std::string& file, int frames) {
    constexpr int width = 96, height = 80;
    std::ofstream stream(file, std::ios::binary);
    stream << "YUV4MPEG2 W" << width << " H" << height << " F25:1 Ip C420mpeg2\n";
    for (int n = 0; n < frames; ++n) {
        stream << "FRAME\n";
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const bool is_square = std::abs(x - 20 - n) < 6 && std::abs(y - 40) < 6;
                const double wave = 60 * std::sin(0.11 * x) * std::cos(0.09 * y);
                stream.put(static_cast<char>(128 + std::lround(wave) + (is_square ? 40 : 0)));
            }
        stream << std::string(static_cast<std::size_t>(width * height / 2), '\x80');
    }
}

TEST(Codecs, LoseNothingByARateFarFromTheUsualQuantiserSlow) {
    const Folder folder;
    const std::string frames = path(folder, "f.y4m");
    write_waves(frames, 40);
    for (const std::string codec : {"h264", "hevc"}) {
        if (!codes(codec)) continue;
        const json by_quantiser = told_of(folder, frames, "--codec " + codec + " --crf 44");
        const auto rate = std::lround(by_quantiser.at("rate").at("average").get<double>());
        const json by_rate = told_of(folder, frames, "--codec " + codec + " --bitrate " + std::to_string(rate));
        // Quantisers are whole: a step of one is 0.5 dB.
        EXPECT_GT(by_rate.at("psnr_y").get<double>(), by_quantiser.at("psnr_y").get<double>() - 1) << codec;
    }
}

TEST(Codecs, SpendARateThatMpeg2sFinestQuantiserDoesNotNeed) {
    const Folder folder;
    const std::string frames = path(folder, "f.y4m");
    write_frames(frames, 96, 80, "25:1", "", 40);
    const double wanted = 1.5 * rate_of(folder, frames, "-q 1");
    EXPECT_NEAR(rate_of(folder, frames, "--bitrate " + std::to_string(std::lround(wanted))), wanted, 0.02 * wanted);
}

TEST(Codecs, OfMp4PutTheirTablesFirstAndSayTheirColours) {
    const Folder folder;
    const std::string frames = path(folder, "f.y4m"), film = path(folder, "f.mp4");
    write_frames(frames, 1280, 720, "25:1", "", 2);
    ASSERT_EQ(run(program() + " encode " + frames + " --quiet --encoder fast -o " + film).status, 0);
    const std::string bytes = contents(film);
    EXPECT_LT(bytes.find("moov"), bytes.find("mdat"));
    const json stream = ffprobe(film);
    for (const char* name : {"color_primaries", "color_space"}) EXPECT_EQ(stream.value(name, ""), "bt709") << name;
    EXPECT_EQ(stream.value("color_transfer", ""), "iec61966-2-1");
    EXPECT_EQ(stream.value("color_range", ""), "tv");
    EXPECT_EQ(stream.value("codec_tag_string", ""), "avc1");
}

/// Renders of a coupled film of two chunks, the first of two groups of pictures.
class CoupledSlow : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        if (!codes(GetParam())) GTEST_SKIP() << "this machine has no encoder of " << GetParam();
    }
    support::Outcome render(const std::string& name, const std::string& more) const {
        return run(program() + " render -y --hold " + plain_film() +
                   " --size 64x64 --gop 25 --frames 0:52 --samples 1 --exposure 0 "
                   "--quiet --codec " +
                   GetParam() + " -o " + film(name) + " " + more);
    }
    std::string film(const std::string& name) const { return path(folder_, name + usual_ending(GetParam())); }
    const Folder folder_;
};

TEST_P(CoupledSlow, FilmsAreTheSameForAnyThreadsAndAfterAKill) {
    ASSERT_EQ(render("a", "--threads 1").status, 0);
    const std::string record = film("c") + ".partial/chunk_00000.json";
    const auto killed = render("c", "--threads 3 --chunks-at-once 1 & job=$!; while [ ! -s " + record +
                                        " ]; do kill -0 $job || exit 99; sleep 0.01; done; kill -KILL $job; wait");
    const bool is_whole = std::filesystem::exists(film("c"));
    if (!is_whole) {
        ASSERT_EQ(render("c", "--resume --threads 2").status, 0);
    }
    EXPECT_TRUE(contents(film("a")) == contents(film("c"))) << killed.output;
    if (is_whole) GTEST_SKIP() << "it was whole before the signal came";
}

INSTANTIATE_TEST_SUITE_P(Codecs, CoupledSlow, testing::Values("h264", "hevc", "av1", "vp9"));

constexpr int browser_frames = 25, white_frame = 10;

/// Pictures that get lighter one by one; the right half of one is white, as a click sounds.
void write_flash(const Folder& folder) {
    constexpr int width = 96, height = 64;
    std::ofstream frames(folder / "f.y4m", std::ios::binary);
    frames << "YUV4MPEG2 W96 H64 F25:1 Ip A1:1 C420mpeg2\n";
    for (int n = 0; n < browser_frames; ++n) {
        frames << "FRAME\n";
        for (int y = 0; y < height; ++y)
            frames << std::string(width / 2, static_cast<char>(40 + 6 * n))
                   << std::string(width / 2, static_cast<char>(n == white_frame ? 235 : 60));
        frames << std::string(width * height / 4, '\x64') << std::string(width * height / 4, static_cast<char>(170));
    }
    constexpr std::uint32_t rate = 48000;
    std::vector<std::int16_t> sound(rate, 0);
    for (std::size_t i = 0; i < 480; ++i)
        sound[rate * white_frame / 25 + i] = static_cast<std::int16_t>(20000 * std::sin(0.3 * static_cast<double>(i)));
    std::ofstream file(folder / "f.raw", std::ios::binary);
    file.write(reinterpret_cast<const char*>(sound.data()), static_cast<std::streamsize>(2 * sound.size()));
    ASSERT_EQ(run("ffmpeg -v error -f s16le -ar 48000 -ac 1 -i " + path(folder, "f.raw") + " " + path(folder, "f.wav"))
                  .status,
              0);
}

/// A page that plays a film, and says what it saw and heard.
constexpr const char* player_page = R"(<!DOCTYPE html><html><body><script>
const until = (target, event) => new Promise((done) => target.addEventListener(event, done, {once: true}));
async function look(bytes, frames) {
  const video = document.createElement('video');
  video.muted = true;
  video.src = URL.createObjectURL(new Blob([bytes], {type: 'video/mp4'}));
  await until(video, 'loadeddata');
  const canvas = document.createElement('canvas');
  const pen = canvas.getContext('2d', {willReadFrequently: true});
  const left = [], right = [];
  for (let n = 0; n < frames; ++n) {
    video.currentTime = (n + 0.5) / 25;
    await until(video, 'seeked');
    pen.drawImage(video, 0, 0);
    left.push([...pen.getImageData(20, 30, 1, 1).data.slice(0, 3)]);
    right.push(pen.getImageData(70, 30, 1, 1).data[0]);
  }
  video.currentTime = 0;
  await until(video, 'seeked');
  video.play();
  await until(video, 'ended');
  const sound = await new OfflineAudioContext(1, 48000, 48000).decodeAudioData(bytes.buffer.slice(0));
  const heard = sound.getChannelData(0).findIndex((s) => Math.abs(s) > 0.1) / sound.sampleRate;
  return {duration: video.duration, end: video.currentTime, left, right, heard};
}
const say = (found) => console.log('FOUND ' + JSON.stringify(found) + ' END');
look(Uint8Array.from(atob(film), (c) => c.charCodeAt(0)), frames).then(say, (e) => say({failed: String(e)}));
</script></body></html>)";

/// What the browser saw of a film.
json seen_by_browser(const Folder& folder, const std::string& film) {
    const std::string page = path(folder, "page.html");
    std::ofstream(page) << "<script>const frames = " << browser_frames << ";</script>";
    put_film(page, "film", film);
    std::ofstream(page, std::ios::app) << player_page;
    return said_by_page(folder, page);
}

TEST(Codecs, OfMp4PlayInABrowserWithSoundInStepSlow) {
    if (browser().empty()) GTEST_SKIP() << "no chromium or google-chrome is installed";
    const Folder folder;
    write_flash(folder);
    const auto made = run(program() + " encode " + path(folder, "f.y4m") + " --quiet --crf 20 --audio " +
                          path(folder, "f.wav") + " -o " + path(folder, "f.mp4"));
    ASSERT_EQ(made.status, 0) << made.output;
    const json seen = seen_by_browser(folder, path(folder, "f.mp4"));
    ASSERT_FALSE(seen.contains("failed")) << seen;
    EXPECT_NEAR(seen.at("duration").get<double>(), 1.0, 0.02);
    EXPECT_EQ(seen.at("end"), seen.at("duration")) << "it played to its end";
    ASSERT_EQ(seen.at("left").size(), static_cast<std::size_t>(browser_frames));
    for (int n = 0; n < browser_frames; ++n) {
        // [BT601]: R' of Y' = 40 + 6 n and Cr = 170.
        const double red = 255 * ((24 + 6.0 * n) / 219 + 1.402 * 42 / 224);
        EXPECT_NEAR(seen.at("left").at(static_cast<std::size_t>(n)).at(0).get<double>(), std::min(red, 255.0), 3) << n;
        const bool is_white = seen.at("right").at(static_cast<std::size_t>(n)).get<int>() > 200;
        EXPECT_EQ(is_white, n == white_frame) << n;
    }
    EXPECT_NEAR(seen.at("heard").get<double>(), white_frame / 25.0, 0.005) << "within an eighth of a frame";
}

}  // namespace
}  // namespace render2mpeg::test
