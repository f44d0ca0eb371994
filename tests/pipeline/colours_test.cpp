#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "pipeline/browser.h"
#include "pipeline/fixture.h"

/// Colours of films as players show them.
namespace render2mpeg::test {
namespace {

using Colour = std::array<int, 3>;

/// Patches in a row.
constexpr std::array<Colour, 8> patches{{{200, 30, 30},
                                         {30, 180, 40},
                                         {40, 50, 200},
                                         {128, 128, 128},
                                         {33, 33, 33},
                                         {235, 200, 60},
                                         {20, 160, 170},
                                         {250, 250, 250}}};

struct PatchSize {
    int width, height;
};

/// Two frames of the patches as PNG.
std::string write_patches(const Folder& folder, PatchSize size) {
    const std::string base = path(folder, "p" + std::to_string(size.height));
    std::string row;
    for (int x = 0; x < size.width; ++x)
        for (const int value : patches[static_cast<std::size_t>(8 * x / size.width)])
            row.push_back(static_cast<char>(value));
    std::ofstream raw(base + ".raw", std::ios::binary);
    for (int y = 0; y < 2 * size.height; ++y) raw << row;
    raw.close();
    const auto made = run("ffmpeg -v error -f rawvideo -pix_fmt rgb24 -s " + std::to_string(size.width) + "x" +
                          std::to_string(size.height) + " -i " + base + ".raw -start_number 0 " + base + ".%02d.png");
    EXPECT_EQ(made.status, 0) << made.output;
    return base + ".%02d.png";
}

/// A film of them with sRGB's or with BT.709's curve.
std::string film_of_patches(const Folder& folder, const std::string& codec, PatchSize size, bool srgb) {
    const std::string film =
        path(folder, codec + std::to_string(size.height) + (srgb ? "s" : "n") + (codec == "mpeg2" ? ".mkv" : ".mp4"));
    const auto made =
        run(program() + " encode " + path(folder, "p" + std::to_string(size.height) + ".%02d.png") +
            (srgb ? " --view standard" : "") + " --quiet --encoder fast -q 1 --codec " + codec + " -o " + film);
    EXPECT_EQ(made.status, 0) << made.output;
    return film;
}

/// What BT.709's curve makes of an sRGB code value.
int as_bt709(int code) {
    const double v = code / 255.0, light = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    const double signal = light < 0.018 ? 4.5 * light : 1.099 * std::pow(light, 0.45) - 0.099;
    return static_cast<int>(std::lround(255 * signal));
}

int wanted(const Colour& patch, std::size_t channel, bool srgb) {
    return srgb ? patch[channel] : as_bt709(patch[channel]);
}

/// Whether this machine codes with it.
bool can_code(const std::string& codec) {
    const Folder folder;
    write_frames(path(folder, "f.y4m"), 64, 64, "25:1", "", 1);
    return run(program() + " encode " + path(folder, "f.y4m") + " --quiet --codec " + codec + " -o " +
               path(folder, "f.mkv"))
               .status == 0;
}

TEST(Colours, AreTaggedAndComeBackWithinTwoCodesInFfmpegSlow) {
    const Folder folder;
    for (const PatchSize size : {PatchSize{176, 144}, PatchSize{256, 720}}) {
        write_patches(folder, size);
        for (const char* codec : {"mpeg2", "h264", "hevc", "av1"}) {
            if (!can_code(codec)) continue;
            for (const bool srgb : {true, false}) {
                const std::string film = film_of_patches(folder, codec, size, srgb);
                SCOPED_TRACE(film);
                const json stream = ffprobe(film);
                const bool has_srgb = srgb && std::string(codec) != "mpeg2";
                EXPECT_EQ(stream.value("color_transfer", ""), has_srgb ? "iec61966-2-1" : "bt709");
                EXPECT_EQ(stream.value("color_primaries", ""), "bt709");
                EXPECT_EQ(stream.value("color_space", ""), size.height < 720 ? "smpte170m" : "bt709");
                const auto decoded = run("ffmpeg -v error -err_detect explode -i " + film +
                                         " -frames:v 1 -f rawvideo -pix_fmt rgb24 "
                                         "-sws_flags accurate_rnd+full_chroma_int -");
                ASSERT_EQ(decoded.output.size(), static_cast<std::size_t>(3 * size.width * size.height));
                for (std::size_t i = 0; i < patches.size(); ++i)
                    for (std::size_t c = 0; c < 3; ++c) {
                        const std::size_t x = (2 * i + 1) * static_cast<std::size_t>(size.width) / 16;
                        EXPECT_NEAR(static_cast<unsigned char>(decoded.output[3 * x + c]), wanted(patches[i], c, srgb),
                                    2)
                            << "patch " << i << " channel " << c;
                    }
            }
        }
    }
}

/// A page that looks at the first pictures of many films, and says the colours in their middle row.
constexpr const char* patch_page = R"(<!DOCTYPE html><html><body><script>
const until = (target, event) => new Promise((done, fail) => {
  target.addEventListener(event, done, {once: true});
  target.addEventListener('error', () => fail(event), {once: true});
});
async function colours(film) {
  const video = document.createElement('video');
  video.muted = true;
  video.src = URL.createObjectURL(new Blob([Uint8Array.from(atob(film), (c) => c.charCodeAt(0))], {type: 'video/mp4'}));
  await until(video, 'loadeddata');
  video.currentTime = 0.06;
  await until(video, 'seeked');
  const canvas = document.createElement('canvas');
  canvas.width = video.videoWidth;
  canvas.height = video.videoHeight;
  const pen = canvas.getContext('2d', {willReadFrequently: true});
  // On a busy machine a decoder has nothing to show at first.
  for (let i = 0; i < 200 && pen.getImageData(0, 0, 1, 1).data[3] === 0; ++i) {
    pen.drawImage(video, 0, 0);
    await new Promise((done) => setTimeout(done, 20));
  }
  return [...Array(8).keys()].map((i) => [...pen.getImageData(
      Math.floor((2 * i + 1) * canvas.width / 16), Math.floor(canvas.height / 2), 1, 1).data.slice(0, 3)]);
}
(async () => {
  const found = {};
  for (const [name, film] of Object.entries(films)) found[name] = await colours(film).catch(String);
  console.log('FOUND ' + JSON.stringify(found) + ' END');
})();
</script></body></html>)";

TEST(Colours, ComeBackInABrowserSlow) {
    if (browser().empty()) GTEST_SKIP() << "no chromium or google-chrome is installed";
    const Folder folder;
    const std::string page = path(folder, "page.html");
    std::ofstream(page) << "<script>const films = {};</script>";
    std::vector<std::pair<PatchSize, std::string>> films;
    for (const PatchSize size : {PatchSize{176, 144}, PatchSize{480, 480}, PatchSize{256, 720}, PatchSize{1920, 1080},
                                 PatchSize{3840, 2160}}) {
        write_patches(folder, size);
        for (const std::string codec : {"h264", "av1"})
            for (const bool srgb : {true, false}) {
                if (!can_code(codec)) continue;
                const std::string name = codec + std::to_string(size.height) + (srgb ? "s" : "n");
                put_film(page, "film_" + name, film_of_patches(folder, codec, size, srgb));
                std::ofstream(page, std::ios::app) << "<script>films." << name << " = film_" << name << ";</script>";
                films.emplace_back(size, name);
            }
    }
    std::ofstream(page, std::ios::app) << patch_page;
    const json seen = said_by_page(folder, page);
    for (const auto& [size, name] : films) {
        SCOPED_TRACE(name);
        ASSERT_TRUE(seen.at(name).is_array()) << seen.at(name);
        for (std::size_t i = 0; i < patches.size(); ++i) {
            const auto at = [&](std::size_t c) {
                return static_cast<double>(wanted(patches[i], c, name.back() == 's'));
            };
            const double blue = size.height >= 720 ? at(2) - (0.2126 * at(0) + 0.7152 * at(1) + 0.0722 * at(2))
                                                   : at(2) - (0.299 * at(0) + 0.587 * at(1) + 0.114 * at(2));
            for (std::size_t c = 0; c < 3; ++c) {
                // Without a graphics card Chromium multiplies Cb by 2 where BT.709 says 2.112 and BT.601 2.018, its
                // constants being of 8 bits: of blue, so much of the colour difference is missing, whatever a film
                // says.
                const double lost = c == 2 ? (size.height >= 720 ? 0.053 : 0.009) * blue : 0;
                EXPECT_NEAR(seen.at(name).at(i).at(c).get<double>(), at(c) - lost, 2.01) << "patch " << i << ", " << c;
            }
        }
    }
}

}  // namespace
}  // namespace render2mpeg::test
