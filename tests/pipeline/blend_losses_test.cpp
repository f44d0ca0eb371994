// What of a .blend a film shows otherwise than Cycles, and tells (tests/blender/make_losses.py).
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/fixture.h"

namespace render2mpeg::test {
namespace {

using nlohmann::json;
using support::Outcome;

/// A scene's export and what `plan` says of it, made once.
class BlendLossesTogetherSlow : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        if (!support::blender_is_there()) return;
        folder_ = std::make_unique<Folder>();
        const Outcome made =
            support::blender("-P " + support::blender_script("make_losses.py") + " -- " + folder_->path().string());
        ASSERT_EQ(made.status, 0) << made.output;
        const Outcome said = run(program() + " plan --within 0 " + path(*folder_, "told.blend"));
        ASSERT_EQ(said.status, 0) << said.output;
        said_ = said.output;
        for (const auto& entry : std::filesystem::directory_iterator(path(*folder_, "told.blend.export")))
            film_ = json::parse(contents(entry.path() / "film.json"));
    }
    static void TearDownTestSuite() { folder_.reset(); }
    void SetUp() override {
        if (!folder_) GTEST_SKIP() << "Blender is not installed";
    }

    static bool tells(const std::string& line) { return said_.find("not kept: " + line) != std::string::npos; }

    static inline std::unique_ptr<Folder> folder_;
    static inline std::string said_;
    static inline json film_;
};

TEST_F(BlendLossesTogetherSlow, PortalsAreNoLamps) {
    ASSERT_EQ(film_["lights"].size(), 1u);
    EXPECT_EQ(film_["lights"][0]["name"], "Sun");
}

TEST_F(BlendLossesTogetherSlow, ExposureAndPlanesOfTheCameraAreKept) {
    EXPECT_EQ(film_["exposure"], 1.0);
    EXPECT_NEAR(film_["cameras"]["Camera"]["near"].get<double>(), 0.5, 1e-6);
    EXPECT_NEAR(film_["cameras"]["Camera"]["far"].get<double>(), 40, 1e-6);
    EXPECT_TRUE(tells("Camera: animated clip start or end")) << said_;
}

TEST_F(BlendLossesTogetherSlow, WhatCamerasLookThroughLightMeets) {
    EXPECT_EQ(film_["change"]["Unseen"], json({{"material", {{"seen", false}}}}));
    EXPECT_EQ(film_["change"]["Nowhere"], json({{"visible", false}}));
    EXPECT_TRUE(tells("Shadowless: ray visibility: hidden from shadow rays")) << said_;
    for (const char* kept : {"Unseen: ", "Nowhere: "}) EXPECT_FALSE(tells(kept)) << said_;
}

TEST_F(BlendLossesTogetherSlow, MissingImagesAreToldByPlanAndByRender) {
    const std::string line = "Gone: " + (folder_->path() / "nowhere/gone.png").string() + " is missing; pink";
    EXPECT_TRUE(tells(line)) << said_;
    const Outcome made = run(program() + " render " + path(*folder_, "told.blend") + " -o " +
                             path(*folder_, "f%04d.png") + " --frames 0:0 --size 16x9");
    EXPECT_EQ(made.status, 0);
    EXPECT_NE(made.output.find("not kept: " + line), std::string::npos) << made.output;
}

TEST_F(BlendLossesTogetherSlow, LinesOtherEyesAndBurntInWordsAreTold) {
    for (const char* what : {"lines of Freestyle", "views by other cameras", "metadata burnt into pictures"})
        EXPECT_TRUE(tells(std::string("Scene: ") + what)) << said_;
}

TEST_F(BlendLossesTogetherSlow, LimitsThatHoldLightBackAreTold) {
    for (const char* what : {"clamp 3 of direct light", "clamp 1 of indirect light", "0 diffuse bounces"})
        EXPECT_TRUE(tells(std::string("Scene: ") + what)) << said_;
    EXPECT_EQ(film_["limits"], json({{"layers", 6}}));
    EXPECT_TRUE(tells("6 transparent bounces")) << said_;
    const Outcome kept = run(program() + " plan --within 0 --limits blender " + path(*folder_, "told.blend"));
    EXPECT_EQ(kept.output.find("transparent bounces"), std::string::npos) << kept.output;
}

}  // namespace
}  // namespace render2mpeg::test
