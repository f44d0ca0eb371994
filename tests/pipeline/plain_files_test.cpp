#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "pipeline/fixture.h"

/// Devices and pipes in files' places, of which the first never end and the others never begin.
namespace render2mpeg::test {
namespace {

class InPlaceOfAFile : public testing::Test {
  protected:
    InPlaceOfAFile() { EXPECT_EQ(run("mkfifo " + path(folder_, "pipe")).status, 0); }
    /// What is said of a scene with this text.
    std::string said(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
        const auto outcome = run("timeout 60 " + program() + " plan --within 0 " + path(folder_, name));
        EXPECT_NE(outcome.status, 124) << name << " is waited for";
        return outcome.output;
    }
    static void expect_in(const std::string& said, const std::string& words) {
        EXPECT_NE(said.find(words), std::string::npos) << said;
    }

    const Folder folder_;
    const std::string pipe_ = "it is a pipe; plain files alone are read";
};

TEST_F(InPlaceOfAFile, ScenesTexturesVolumesAndSoundAreNotRead) {
    const std::string end = R"("objects": [{ "name": "floor", "shape": "plane" }], "frames": 1 })";
    expect_in(said("a.json", R"({ "scene": "pipe", )" + end), "\"pipe\": " + pipe_);
    expect_in(said("b.json", R"({ "sound": "pipe", )" + end), "\"pipe\": " + pipe_);
    expect_in(said("c.json", R"({ "volumes": [{ "file": "pipe" }], )" + end), "\"pipe\": " + pipe_);
    expect_in(said("d.json", R"({ "sky": { "image": "pipe" }, )" + end), "\"pipe\": " + pipe_);
    const auto outcome = run("timeout 60 " + program() + " plan --within 0 --sky /dev/zero " + plain_film());
    expect_in(outcome.output, "it is a device; plain files alone are read");
}

TEST_F(InPlaceOfAFile, WhatModelsNameIsNotRead) {
    expect_in(said("a.gltf", R"({ "asset": { "version": "2.0" }, "buffers": [{ "uri": "pipe", "byteLength": 4 }] })"),
              pipe_);
    expect_in(said("a.obj", "mtllib pipe\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), pipe_);
}

}  // namespace
}  // namespace render2mpeg::test
