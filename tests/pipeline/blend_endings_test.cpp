#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <string>

#include "pipeline/fixture.h"

/// Exports of .blend files that end early, by stand-ins for Blender.
namespace render2mpeg::test {
namespace {

using support::Outcome;

namespace fs = std::filesystem;

/// A .blend, and a program in Blender's place that does as `script` says in its folder.
class BlenderStandIn {
  public:
    explicit BlenderStandIn(const std::string& script) {
        std::ofstream(folder_ / "film.blend") << "BLENDER";
        std::ofstream(folder_ / "blender") << "#!/bin/sh\ncd " << folder_.path().string() << "\n" << script << "\n";
        fs::permissions(folder_ / "blender", fs::perms::owner_all);
    }
    Outcome run_with(const std::string& program, const std::string& more) const {
        return run("export RENDER2MPEG_BLENDER=" + path(folder_, "blender") + "; cd " + folder_.path().string() + "; " +
                   program + " plan --quiet --within 0 " + path(folder_, "film.blend") + more);
    }
    fs::path operator/(const std::string& name) const { return folder_ / name; }

  private:
    Folder folder_;
};

class BlendExportsAtSignals : public testing::TestWithParam<const char*> {};

TEST_P(BlendExportsAtSignals, EndWithAllThatTheyStarted) {
    const BlenderStandIn film("sleep 60 & echo $! > new; mv new child; wait; touch waited");
    const std::string signal = GetParam();
    const Outcome said =
        film.run_with(support::program_at_terminal(),
                      " > said 2>&1 & p=$!; while [ ! -e child ]; do sleep 0.1; done; kill -" + signal +
                          " $p; wait $p; echo status $?; timeout 30 sh -c 'while grep -q sleep "
                          "/proc/$(cat child)/cmdline; do sleep 0.1; done' || echo it sleeps");
    const std::map<std::string, std::string> statuses{{"INT", "130"}, {"TERM", "143"}, {"HUP", "129"}};
    EXPECT_EQ(said.output.substr(0, 11), "status " + statuses.at(signal) + "\n") << said.output;
    EXPECT_EQ(said.output.find("it sleeps"), std::string::npos) << said.output;
    EXPECT_FALSE(fs::exists(film / "waited"));
    EXPECT_FALSE(fs::exists(film / "film.blend.export"));
    EXPECT_NE(contents(film / "said").find("film.blend: interrupted"), std::string::npos) << contents(film / "said");
}

INSTANTIATE_TEST_SUITE_P(Signals, BlendExportsAtSignals, testing::Values("INT", "TERM", "HUP"),
                         [](const auto& signal) { return signal.param; });

}  // namespace
}  // namespace render2mpeg::test
