#include "scene/gltf/uri.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "support/program.h"

namespace render2mpeg::scene {
namespace {

std::string text_of(const std::string& uri) {
    const auto bytes = bytes_of_data_uri(uri);
    return bytes ? std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()) : "(none)";
}

TEST(DataUri, IsDecodedFromBase64AndFromPercentSigns) {
    EXPECT_EQ(text_of("data:text/plain;base64,TWFu"), "Man");
    EXPECT_EQ(text_of("data:;base64,TWE="), "Ma");
    EXPECT_EQ(text_of("data:;base64,TQ=="), "M");
    EXPECT_EQ(text_of("data:;base64,TQ"), "M");
    EXPECT_EQ(text_of("data:;base64,-_-_"), text_of("data:;base64,+/+/"));
    EXPECT_EQ(text_of("data:;base64,TWFu%54Q%3D%3D"), "ManM");
    EXPECT_EQ(text_of("data:,a%20b%"), "a b%");
    EXPECT_EQ(text_of("data:;base64,"), "");
    EXPECT_EQ(text_of("other.bin"), "(none)");
}

TEST(DataUri, IsRefusedWhenBroken) {
    EXPECT_THROW(bytes_of_data_uri("data:;base64"), std::invalid_argument);
    EXPECT_THROW(bytes_of_data_uri("data:;base64,T*=="), std::invalid_argument);
    EXPECT_THROW(bytes_of_data_uri("data:;base64,TWFuT"), std::invalid_argument);
}

TEST(PathOfUri, IsTheFileInTheFolder) {
    const support::Folder folder;
    EXPECT_EQ(path_of_uri("a/b%20c.png", folder.path()), folder / "a" / "b c.png");
    EXPECT_EQ(path_of_uri("50%.png", folder.path()), folder / "50%.png");
    EXPECT_EQ(path_of_uri("a..b", folder.path()), folder / "a..b");
    EXPECT_EQ(path_of_uri("x.png", ""), std::filesystem::path("./x.png"));
}

TEST(PathOfUri, NeverLeavesTheFolder) {
    const support::Folder folder;
    for (const char* uri : {"", "..", "../x", "a/..", "a/../../x", "%2E%2E/x", "/x", "%2Fx", "\\x", "a\\..\\..\\x",
                            "file:x", "http://x/y", "c:x", "x%00y"})
        EXPECT_THROW(path_of_uri(uri, folder.path()), std::invalid_argument) << uri;
    std::filesystem::create_directory(folder / "in");
    std::filesystem::create_symlink(folder.path().parent_path(), folder / "in" / "out");
    std::filesystem::create_symlink(folder / "in", folder / "inner");
    EXPECT_THROW(path_of_uri("in/out/x", folder.path()), std::invalid_argument);
    EXPECT_NO_THROW(path_of_uri("inner/x", folder.path()));
}

}  // namespace
}  // namespace render2mpeg::scene
