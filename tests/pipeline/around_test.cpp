#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <string>

#include "pipeline/browser.h"

/// Panoramas in the report's page, as a browser shows them.
namespace render2mpeg::test {
namespace {

/// A red wall ahead, a blue one to the right.
const std::string walls =
    R"({ "exposure": 0, "sky": [0.9, 0.9, 0.9], "frames": 2, "objects": [
      { "shape": "box", "size": [8, 8, 0.1], "position": [0, -4, -4], "material": { "base_color": [0.7, 0.1, 0.1] } },
      { "shape": "box", "size": [0.1, 8, 8], "position": [4, -4, 0], "material": { "base_color": [0.1, 0.1, 0.7] } }],
      "camera": { "position": [0, 0, 0], )";

/// Mean colour of a picture's middle as the browser has it; one eye's, or the right half where both are shown.
constexpr const char* probe = R"(<script>
addEventListener('load', async () => {
  const canvas = document.querySelector('#around canvas');
  const drawn = () => new Promise((done) => canvas.addEventListener('drawn', done, {once: true}));
  const seen = (x) => {
    const gl = canvas.getContext('webgl'), all = new Uint8Array(4 * 16 * 16);
    gl.readPixels(Math.round(x * canvas.width) - 8, canvas.height / 2 - 8, 16, 16, gl.RGBA, gl.UNSIGNED_BYTE, all);
    return [0, 1, 2].map((c) => all.filter((_, i) => i % 4 === c).reduce((a, b) => a + b) / 256);
  };
  await drawn();
  const ahead = (canvas.look(0, 0), seen(0.5)), right = (canvas.look(90, 0), seen(0.5));
  const back = (canvas.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft', bubbles: true})), seen(0.5));
  document.querySelector('#around .both input').click();
  canvas.look(0, 0);
  console.log('FOUND ' + JSON.stringify({ahead, right, back, left_eye: seen(0.25), right_eye: seen(0.75)}) + ' END');
});
</script>)";

std::array<double, 3> middle_of(const Folder& folder, const std::string& rotate) {
    std::ofstream(folder / "flat.json") << walls << "\"fov\": 10, \"rotate\": " << rotate << " } }";
    EXPECT_EQ(run(program() + " render " + path(folder, "flat.json") +
                  " --size 16x16 --frames 0:0 --quiet --overwrite -o " + path(folder, "flat%d.png"))
                  .status,
              0);
    const std::string codes = codes_of(path(folder, "flat0.png"));
    std::array<double, 3> mean{};
    for (std::size_t i = 0; i < codes.size(); ++i)
        mean[i % 3] += static_cast<unsigned char>(codes[i]) / (static_cast<double>(codes.size()) / 3);
    return mean;
}

TEST(PanoramaInABrowser, ShowsWhatACameraThatIsTurnedShowsSlow) {
    if (browser().empty()) GTEST_SKIP() << "no chromium or google-chrome is installed";
    const Folder folder;
    std::ofstream(folder / "film.json") << walls << R"("projection": "equirectangular" }, "stereo": "top-bottom" })";
    const std::string film = path(folder, "film #1.mp4");
    ASSERT_EQ(run(program() + " render " + path(folder, "film.json") + " --size 256x128 --quiet --codec h264 -o '" +
                  film + "' --report " + path(folder, "film.html"))
                  .status,
              0);
    std::string page = contents(folder / "film.html");
    const std::string name = "\"name\":\"film%20%231.mp4\"";
    ASSERT_NE(page.find(name), std::string::npos) << "it looks for the film beside it";
    EXPECT_NE(page.find("\"stereo\":\"top-bottom\""), std::string::npos);
    // Pages of a folder may not read its files; a film within the page may be read.
    page.replace(page.find(name), name.size(), "\"name\":told");
    const std::size_t section = page.find("<section id=\"around\">");
    ASSERT_NE(section, std::string::npos);
    std::ofstream(folder / "page.html") << page.substr(0, section);
    run("{ printf '<script>const told = \"data:video/mp4;base64,'; base64 -w 0 '" + film +
        "'; printf '\"</script>'; } >> " + path(folder, "page.html"));
    std::ofstream(folder / "page.html", std::ios::app) << page.substr(section) << probe;
    const json found = said_by_page(folder, path(folder, "page.html"));
    ASSERT_FALSE(found.is_null());
    const std::array<double, 3> ahead = middle_of(folder, "0"), right = middle_of(folder, "[0, -90, 0]");
    EXPECT_GT(std::abs(ahead[0] - right[0]), 60) << "the walls differ";
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(found.at("ahead")[c].get<double>(), ahead[c], 8) << c;
        EXPECT_NEAR(found.at("right")[c].get<double>(), right[c], 8) << c;
        EXPECT_NEAR(found.at("back")[c].get<double>(), right[c], 8) << c;
        EXPECT_NEAR(found.at("left_eye")[c].get<double>(), ahead[c], 8) << c;
        EXPECT_NEAR(found.at("right_eye")[c].get<double>(), ahead[c], 8) << c;
    }
}

TEST(PanoramaInABrowser, HasNoPlaceInReportsOfFlatFilms) {
    const Folder folder;
    std::ofstream(folder / "flat.json") << walls << "\"fov\": 40 } }";
    ASSERT_EQ(run(program() + " render " + path(folder, "flat.json") + " --size 64x48 --samples 1 --quiet -o " +
                  path(folder, "film.mp4") + " --report " + path(folder, "film.html"))
                  .status,
              0);
    EXPECT_EQ(contents(folder / "film.html").find("id=\"around\""), std::string::npos);
}

}  // namespace
}  // namespace render2mpeg::test
