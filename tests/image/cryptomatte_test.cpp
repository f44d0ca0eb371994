#include "image/cryptomatte.h"

#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <map>

#include "image/layers.h"

/// Mattes as compositors read them.
namespace render2mpeg::image {
namespace {

namespace fs = std::filesystem;

struct File {
    fs::path path = fs::temp_directory_path() / ("render2mpeg_mattes_" + std::to_string(::getpid()) + ".file");
    ~File() { fs::remove(path); }
};

/// Two pixels: one half a ball and a quarter a box of two materials, one open.
core::Mattes two_pixels() {
    core::Mattes mattes{2, 1, {0, 4, 5}, {}};
    mattes.parts = {{0, 0, 0.5f}, {1, 1, 0.0625f}, {1, 0, 0.1875f}, {core::no_id, core::no_id, 0.25f}};
    mattes.parts.push_back({core::no_id, core::no_id, 1.0f});
    return mattes;
}

std::string text_in(const Imf::Header& header, const std::string& name) {
    const auto* text = header.findTypedAttribute<Imf::StringAttribute>(name);
    return text == nullptr ? "" : text->value();
}

TEST(Cryptomatte, HashesNamesAsItsSpecificationSays) {
    // [Cryptomatte]'s own examples.
    EXPECT_EQ(matte_hash("hello"), 0x248bfa47u);
    EXPECT_FLOAT_EQ(matte_id("cube"), -4.08461912519e+15f);
    EXPECT_FLOAT_EQ(matte_id("sphere"), 2.79018604383e+15f);
    EXPECT_FLOAT_EQ(matte_id("plane"), 3.66557617593e-11f);
    // Exponents of infinity and 0 lose a bit or get one.
    for (int k = 0; k < 5000; ++k) {
        const auto exponent = std::bit_cast<std::uint32_t>(matte_id("name" + std::to_string(k))) >> 23 & 255u;
        ASSERT_TRUE(exponent > 0 && exponent < 255) << k;
    }
}

TEST(Cryptomatte, HasRanksByShareAndAManifest) {
    std::vector<Channel> channels;
    FrameFacts facts;
    add_cryptomatte(two_pixels(), {{"ball", "a \"box\""}, {"red", "blue"}}, channels, facts);
    std::map<std::string, std::vector<float>> by_name;
    for (const Channel& channel : channels) by_name[channel.name] = channel.values;
    EXPECT_EQ(by_name.size(), 24u);
    EXPECT_EQ(by_name["ViewLayer.CryptoObject00.R"], std::vector<float>({matte_id("ball"), 0}));
    EXPECT_EQ(by_name["ViewLayer.CryptoObject00.G"], std::vector<float>({0.5f, 0}));
    EXPECT_EQ(by_name["ViewLayer.CryptoObject00.B"], std::vector<float>({matte_id("a \"box\""), 0}));
    EXPECT_EQ(by_name["ViewLayer.CryptoObject00.A"], std::vector<float>({0.25f, 0})) << "of both materials";
    EXPECT_EQ(by_name["ViewLayer.CryptoObject01.G"], std::vector<float>({0, 0}));
    EXPECT_EQ(by_name["ViewLayer.CryptoMaterial00.R"], std::vector<float>({matte_id("red"), 0}));
    EXPECT_EQ(by_name["ViewLayer.CryptoMaterial00.G"], std::vector<float>({0.6875f, 0})) << "of both objects";
    EXPECT_EQ(by_name["ViewLayer.CryptoMaterial00.A"], std::vector<float>({0.0625f, 0}));
    EXPECT_EQ(facts.texts.size(), 8u);
    const auto manifest = std::find_if(facts.texts.begin(), facts.texts.end(),
                                       [](const auto& t) { return t.first.ends_with("manifest"); });
    ASSERT_NE(manifest, facts.texts.end());
    EXPECT_NE(manifest->second.find("\"a \\\"box\\\"\":\""), std::string::npos) << manifest->second;
}

TEST(Cryptomatte, IsInTheFileWithAlpha) {
    const File file;
    core::Visible visible(0, 2, 1);
    core::Radiance radiance;
    radiance.combined = core::Plane<glm::vec3>(2, 1, glm::vec3(0.5f));
    write_layers(file.path, visible, radiance, nullptr, nullptr, {}, nullptr, two_pixels(),
                 {{"ball", "box"}, {"a", "b"}});
    const ExrChannels read = read_exr(file.path, [](const std::string& name) { return name == "A"; });
    ASSERT_EQ(read.channels.size(), 1u);
    EXPECT_EQ(read.channels[0].values, std::vector<float>({0.75f, 0}));
    const Imf::InputFile opened(file.path.c_str());
    // The layer's key is the first seven digits of the hash of its name.
    EXPECT_EQ(text_in(opened.header(), "cryptomatte/542cafa/name"), "ViewLayer.CryptoObject");
    EXPECT_EQ(text_in(opened.header(), "cryptomatte/542cafa/hash"), "MurmurHash3_32");
    EXPECT_EQ(text_in(opened.header(), "cryptomatte/542cafa/conversion"), "uint32_to_float32");
}

TEST(Alpha, OfPngIsAsItWasWritten) {
    const File file;
    const std::vector<unsigned char> codes{200, 100, 50, 128, 10, 20, 30, 0};
    write_png(file.path, 2, 1, codes);
    const Image read = read_image(file.path, {}, "a.png");
    ASSERT_TRUE(read.has_alpha);
    EXPECT_NEAR(read.pixels.at(0, 0).x, 200 / 255.0f, 1e-3);
    EXPECT_NEAR(read.pixels.at(0, 0).w, 128 / 255.0f, 1e-3);
    EXPECT_EQ(read.pixels.at(1, 0).w, 0);
}

}  // namespace
}  // namespace render2mpeg::image
