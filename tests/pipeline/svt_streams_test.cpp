#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <sstream>
#include <string>

#include "encoder/av/svt_layers.h"
#include "encoder/codec.h"
#include "pipeline/fixture.h"

namespace render2mpeg::test {
namespace {

/// Quantiser indices of pictures, by their place, as headers say them.
std::map<int, int> indices_of(const std::string& film) {
    const support::Outcome traced =
        run("ffmpeg -v trace -i '" + film + "' -c copy -bsf:v trace_headers -f null - 2>&1");
    std::map<int, int> found;
    std::istringstream lines(traced.output);
    int place = 0;
    for (std::string line; std::getline(lines, line);) {
        const int value = std::atoi(line.substr(line.find_last_of(' ') + 1).c_str());
        if (line.find(" order_hint ") != std::string::npos) place = value;
        if (line.find(" base_q_idx ") != std::string::npos) found[place] = value;
    }
    return found;
}

TEST(SvtStreams, HaveTheLayersThatLightIsPlannedForSlow) {
    const Folder folder;
    for (const auto& [count, quantiser] : {std::pair{40, 4}, {12, 8}, {31, 2}}) {
        const std::string frames = (folder.path() / "a.y4m").string(), film = (folder.path() / "a.mp4").string();
        ASSERT_EQ(run("ffmpeg -v error -y -f lavfi -i testsrc2=s=96x64:r=24 -frames:v " + std::to_string(count) +
                      " -pix_fmt yuv420p " + frames)
                      .status,
                  0);
        const support::Outcome coded = run(program() + " encode " + frames + " -y -o " + film +
                                           " --codec av1 --quantiser " + std::to_string(quantiser) + " --quiet");
        ASSERT_EQ(coded.status, 0) << coded.output;
        const std::map<int, int> indices = indices_of(film);
        ASSERT_EQ(indices.size(), static_cast<std::size_t>(count));
        // All that nothing refers to have the film's.
        const double whole = encoder::step_of(encoder::Codec::av1, 0.25 * indices.at(3));
        for (const auto& [place, index] : indices)
            EXPECT_NEAR(
                encoder::step_of(encoder::Codec::av1, 0.25 * index) / whole / av::svt_step_ratio(place, count - 1), 1.0,
                0.25)
                << place << " of " << count << ", quantiser " << quantiser;
    }
}

}  // namespace
}  // namespace render2mpeg::test
