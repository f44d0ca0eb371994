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

std::string name_of(const std::string& codec, PatchSize size) {
    return codec + std::to_string(size.height);
}

std::string film_of_patches(const Folder& folder, const std::string& codec, PatchSize size) {
    const std::string film = path(folder, name_of(codec, size) + (codec == "mpeg2" ? ".mkv" : ".mp4"));
    const auto made = run(program() + " encode " + path(folder, "p" + std::to_string(size.height) + ".%02d.png") +
                          " --quiet --encoder fast -q 1 --codec " + codec + " -o " + film);
    EXPECT_EQ(made.status, 0) << made.output;
    return film;
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
            const std::string film = film_of_patches(folder, codec, size);
            SCOPED_TRACE(film);
            const json stream = ffprobe(film);
            EXPECT_EQ(stream.value("color_transfer", ""), std::string(codec) == "mpeg2" ? "bt709" : "iec61966-2-1");
            EXPECT_EQ(stream.value("color_primaries", ""), "bt709");
            EXPECT_EQ(stream.value("color_space", ""), size.height < 720 ? "smpte170m" : "bt709");
            const auto decoded = run("ffmpeg -v error -err_detect explode -i " + film +
                                     " -frames:v 1 -f rawvideo -pix_fmt rgb24 "
                                     "-sws_flags accurate_rnd+full_chroma_int -");
            ASSERT_EQ(decoded.output.size(), static_cast<std::size_t>(3 * size.width * size.height));
            for (std::size_t i = 0; i < patches.size(); ++i)
                for (std::size_t c = 0; c < 3; ++c) {
                    const std::size_t x = (2 * i + 1) * static_cast<std::size_t>(size.width) / 16;
                    EXPECT_NEAR(static_cast<unsigned char>(decoded.output[3 * x + c]), patches[i][c], 2)
                        << "patch " << i << " channel " << c;
                }
        }
    }
}

/// A page that looks at the first pictures of many films, and says the mean colours of their cells: 8 columns and
/// `rows` rows, without a quarter of each at each side.
constexpr const char* cells_page = R"(<!DOCTYPE html><html><body><script>
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
  const cell = (i) => {
    const wide = canvas.width / 8, high = canvas.height / rows;
    const {data} = pen.getImageData(Math.floor((i % 8 + 0.25) * wide), Math.floor((Math.floor(i / 8) + 0.25) * high),
                                    Math.floor(wide / 2), Math.floor(high / 2));
    return [0, 1, 2].map((c) => data.filter((_, k) => k % 4 === c).reduce((a, b) => a + b, 0) / (data.length / 4));
  };
  return [...Array(8 * rows).keys()].map(cell);
}
(async () => {
  const found = {};
  for (const [name, film] of Object.entries(films)) found[name] = await colours(film).catch(String);
  console.log('FOUND ' + JSON.stringify(found) + ' END');
})();
</script></body></html>)";

using Cells = std::vector<std::array<double, 3>>;

/// The same cells of a picture of RGB code values.
Cells cells_of(const std::string& codes, PatchSize size, int rows) {
    Cells cells;
    const int wide = size.width / 8, high = size.height / rows;
    for (int i = 0; i < 8 * rows; ++i) {
        std::array<double, 3> sum{};
        for (int y = i / 8 * high + high / 4; y < i / 8 * high + high / 4 + high / 2; ++y)
            for (int x = i % 8 * wide + wide / 4; x < i % 8 * wide + wide / 4 + wide / 2; ++x)
                for (std::size_t c = 0; c < 3; ++c)
                    sum[c] += static_cast<unsigned char>(codes[3 * static_cast<std::size_t>(y * size.width + x) + c]);
        for (double& value : sum) value /= (wide / 2) * (high / 2);
        cells.push_back(sum);
    }
    return cells;
}

/// Films that a browser is to show as `shown`.
class ShownFilms {
  public:
    explicit ShownFilms(const Folder& folder, int rows)
        : folder_(folder), rows_(rows), page_(path(folder, "page.html")) {
        std::ofstream(page_) << "<script>const films = {}, rows = " << rows << ";</script>";
    }
    void add(const std::string& name, const std::string& film, PatchSize size, const std::string& codes) {
        put_film(page_, "film_" + name, film);
        std::ofstream(page_, std::ios::app) << "<script>films." << name << " = film_" << name << ";</script>";
        films_.push_back({name, size, cells_of(codes, size, rows_), name.find("av1") != std::string::npos});
    }
    void expect_within(double codes) const {
        std::ofstream(page_, std::ios::app) << cells_page;
        const json seen = said_by_page(folder_, page_);
        for (const Film& film : films_) {
            SCOPED_TRACE(film.name);
            ASSERT_TRUE(seen.at(film.name).is_array()) << seen.at(film.name);
            for (std::size_t i = 0; i < film.cells.size(); ++i)
                for (std::size_t c = 0; c < 3; ++c)
                    EXPECT_NEAR(seen.at(film.name).at(i).at(c).get<double>(),
                                film.cells[i][c] - lost(film, film.cells[i], c), codes)
                        << "cell " << i << ", " << c;
        }
    }

  private:
    struct Film {
        std::string name;
        PatchSize size;
        Cells cells;
        bool has_10_bits = false;
    };
    /// What Chromium without a graphics card takes from a channel, whatever a film says. It multiplies Cb by 2 where
    /// BT.709 says 2.112 and BT.601 2.018, its constants being of 8 bits; and of chroma's 10 bits it drops two.
    double lost(const Film& film, const std::array<double, 3>& color, std::size_t channel) const {
        if (channel == 1) return 0;
        const bool is_high = film.size.height >= 720;
        const double red = is_high ? 0.2126 : 0.299, blue = is_high ? 0.0722 : 0.114,
                     luma = red * color[0] + (1 - red - blue) * color[1] + blue * color[2],
                     full = 2 * (1 - (channel == 2 ? blue : red)) * 255 / 224,  // of a step of chroma
            chroma = (color[channel] - luma) / full;
        double dropped = 0;
        // A patch has one chroma, a rendered cell many.
        if (film.has_10_bits) dropped = rows_ == 1 ? chroma - std::floor(std::round(4 * chroma) / 4) : 0.375;
        return channel == 2 ? (1 - 2 / full) * (color[2] - luma) + 2 * dropped : full * dropped;
    }

    const Folder& folder_;
    int rows_;
    std::string page_;
    std::vector<Film> films_;
};

TEST(Colours, ComeBackInABrowserSlow) {
    if (browser().empty()) GTEST_SKIP() << "no chromium or google-chrome is installed";
    const Folder folder;
    ShownFilms films(folder, 1);
    for (const PatchSize size : {PatchSize{176, 144}, PatchSize{480, 480}, PatchSize{256, 720}, PatchSize{1920, 1080},
                                 PatchSize{3840, 2160}}) {
        write_patches(folder, size);
        const std::string codes = codes_of(path(folder, "p" + std::to_string(size.height) + ".00.png"));
        for (const std::string codec : {"h264", "av1"})
            if (can_code(codec)) films.add(name_of(codec, size), film_of_patches(folder, codec, size), size, codes);
    }
    films.expect_within(2.01);
}

TEST(Colours, OfARenderedFilmAreThoseOfItsStillInABrowserSlow) {
    if (browser().empty()) GTEST_SKIP() << "no chromium or google-chrome is installed";
    const Folder folder;
    ShownFilms films(folder, 4);
    for (const PatchSize size : {PatchSize{176, 144}, PatchSize{256, 720}}) {
        const std::string name = "r" + std::to_string(size.height),
                          render = program() + " render " + support::plain_film() + " --size " +
                                   std::to_string(size.width) + "x" + std::to_string(size.height) +
                                   " --samples 1 --exposure 0 --tolerance fixed=10% --quiet --frames 0:1 -q 1 -o ";
        ASSERT_EQ(run(render + path(folder, name + ".%04d.png")).status, 0);
        for (const std::string codec : {"h264", "av1"}) {
            if (!can_code(codec)) continue;
            const std::string film = path(folder, name + codec + ".mp4");
            ASSERT_EQ(run(render + film + " --encoder fast --codec " + codec).status, 0);
            films.add(name + codec, film, size, codes_of(path(folder, name + ".0001.png")));
        }
    }
    films.expect_within(2.01);
}

/// Logs colour and alpha of a film's corner and middle.
constexpr const char* open_page = R"(<!doctype html><html><body><script>
(async () => {
  const video = document.createElement('video');
  video.muted = true;
  video.src = 'data:video/webm;base64,' + film;
  await new Promise((done, fail) => { video.onloadeddata = done; video.onerror = fail; });
  video.currentTime = 0.06;
  await new Promise((done) => { video.onseeked = done; });
  const pen = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
  const at = (x, y) => [...pen.getImageData(x, y, 1, 1).data];
  // On a busy machine a decoder has nothing to show at first.
  for (let i = 0; i < 200 && at(32, 32)[3] === 0; ++i) {
    pen.drawImage(video, 0, 0);
    await new Promise((done) => setTimeout(done, 20));
  }
  console.log('FOUND ' + JSON.stringify({corner: at(0, 0), middle: at(32, 32)}) + ' END');
})();
</script></body></html>)";

TEST(Colours, OfAnOpenFilmLetABrowsersPageThroughSlow) {
    if (browser().empty()) GTEST_SKIP() << "no chromium or google-chrome is installed";
    if (!can_code("vp9")) GTEST_SKIP() << "this FFmpeg has no libvpx";
    const Folder folder;
    std::ofstream(folder / "box.json") << R"({"objects": [{"shape": "box"}], "transparent": true})";
    const auto made = run(program() + " render " + path(folder, "box.json") +
                          " --size 64x64 --frames 0:1 --quiet -q 2 -o " + path(folder, "box.webm"));
    ASSERT_EQ(made.status, 0) << made.output;
    const std::string page = path(folder, "page.html");
    put_film(page, "film", path(folder, "box.webm"));
    std::ofstream(page, std::ios::app) << open_page;
    const json seen = said_by_page(folder, page);
    EXPECT_EQ(seen.at("corner").at(3), 0);
    EXPECT_EQ(seen.at("middle").at(3), 255);
    EXPECT_GT(seen.at("middle").at(1).get<int>(), 40);
}

/// Largest difference of a lossless film's first picture from a still.
int farthest(const std::string& film, const std::string& still) {
    const std::string a = codes_of(film), b = codes_of(still);
    EXPECT_EQ(a.size(), b.size());
    EXPECT_FALSE(a.empty());
    int most = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        most = std::max(most, std::abs(static_cast<unsigned char>(a[i]) - static_cast<unsigned char>(b[i])));
    return most;
}

TEST(Colours, AreThoseOfStillsInEveryViewAndByEveryWaySlow) {
    const Folder folder;
    const std::string render = program() + " render " + support::plain_film() +
                               " --size 64x48 --samples 1 --exposure 1 --tolerance fixed=10% --quiet --frames 0:1 ";
    for (const std::string view : {"neutral", "standard", "filmic", "agx"}) {
        SCOPED_TRACE(view);
        const std::string still = path(folder, view + ".%04d.png"), first = path(folder, view + ".0000.png"),
                          master = " --view " + view + " --codec ffv1 -o " + path(folder, view);
        ASSERT_EQ(run(render + "--view " + view + " -o " + still).status, 0);
        // Sampling follows the view: light is its own in each.
        const std::string light = path(folder, view + ".%04d.exr");
        ASSERT_EQ(run(render + "--view " + view + " -o " + light).status, 0);
        ASSERT_EQ(run(render + master + "_rendered.mkv").status, 0);
        ASSERT_EQ(run(program() + " encode " + still + " --quiet" + master + "_of_png.mkv").status, 0);
        ASSERT_EQ(run(program() + " encode " + light + " --exposure 1 --quiet" + master + "_of_exr.mkv").status, 0);
        for (const std::string way : {"_rendered", "_of_png", "_of_exr"}) {
            const std::string film = path(folder, view + way + ".mkv");
            EXPECT_LE(farthest(film, first), 1) << way;
            EXPECT_EQ(ffprobe(film).value("color_transfer", ""), "iec61966-2-1") << way;
        }
    }
}

}  // namespace
}  // namespace render2mpeg::test
