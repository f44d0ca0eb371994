#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "perceptual/metrics.h"
#include "pipeline/fixture.h"
#include "tests/support/written_page.h"

/// Frames do not depend on the suite that the program was built on, but for roundings of the libraries there.
namespace render2mpeg {
namespace {

using support::Folder;
using support::program;
using support::run;

/// Textures, edges and shadows in light that takes no random path.
constexpr const char* frame =
    " --size 96x54 --frames 12:12 --vpls 0 --tolerance fixed=1% --samples 4 --exposure 0 --isa sse4.2 --quiet -y ";

double psnr_of(const std::string& one, const std::string& two) {
    const std::string a = test::codes_of(one), b = test::codes_of(two);
    EXPECT_EQ(a.size(), b.size());
    if (a.size() != b.size() || a.empty()) return 0;
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const int error = static_cast<unsigned char>(a[i]) - static_cast<unsigned char>(b[i]);
        sum += error * error;
    }
    return perceptual::psnr(sum / static_cast<double>(a.size()));
}

TEST(Suites, ShowTheSameFrameTo50DecibelsSlow) {
    const Folder folder;
    const auto made = folder / "frame.0012.png";
    const auto committed = support::source_folder() / "tests/pipeline/colonnade.png";
    const auto rendered =
        run(program() + " render " + support::film("colonnade") + frame + "-o " + test::path(folder, "frame.%04d.png"));
    ASSERT_EQ(rendered.status, 0) << rendered.output;
    if (support::writes_pages()) {
        std::filesystem::copy_file(made, committed, std::filesystem::copy_options::overwrite_existing);
        return;
    }
    EXPECT_GE(psnr_of(made.string(), committed.string()), 50)
        << "Where direct light was to change, run this test with RENDER2MPEG_WRITE_PAGES=1.";
}

}  // namespace
}  // namespace render2mpeg
