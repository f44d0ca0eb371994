#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/error.h"
#include "scene/gltf_file.h"
#include "scene/load.h"
#include "support/program.h"

// Every way in which a file can be wrong ends in one line that names file, object and cause.
namespace render2mpeg::scene {

using test::GltfFile;

class GltfRefused : public ::testing::Test {
  protected:
    /// What loading the file says; empty where it does not throw.
    std::string message(const std::filesystem::path& file) {
        try {
            load(file);
            return "";
        } catch (const core::Error& error) {
            return error.what();
        }
    }
    std::string message(const GltfFile& file) { return message(file.write(folder_ / "film.gltf")); }

    /// Breaks a good file and expects one line with the file's name and each of the words.
    void expect_refused(const std::function<void(GltfFile&)>& breaking, const std::vector<std::string>& words) {
        GltfFile file = GltfFile::triangle();
        breaking(file);
        expect_words(message(file), words);
    }
    static void expect_words(const std::string& line, const std::vector<std::string>& words) {
        EXPECT_EQ(line.find('\n'), std::string::npos) << line;
        EXPECT_NE(line.find("film.gl"), std::string::npos) << line;
        EXPECT_LT(line.size(), 500u) << line;
        for (const std::string& word : words)
            EXPECT_NE(line.find(word), std::string::npos) << line << "\nlacks: " << word;
    }
    static void add_animation(GltfFile& file, const std::vector<float>& times, const std::vector<float>& values,
                              const char* path = "translation", const char* type = "VEC3") {
        const int input = file.add_floats(times, "SCALAR"), output = file.add_floats(values, type);
        file.json["animations"] = {{{"samplers", {{{"input", input}, {"output", output}}}},
                                    {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}}};
    }

    support::Folder folder_;
    static constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    static constexpr float inf = std::numeric_limits<float>::infinity();
};

}  // namespace render2mpeg::scene
