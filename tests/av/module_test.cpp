#include "core/module.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "av/coded_film.h"
#include "core/error.h"

namespace render2mpeg::test {
namespace {

fs::path executable() {
    return fs::read_symlink("/proc/self/exe");
}

/// Sets RENDER2MPEG_MODULES for one test.
class ModulesVariable {
  public:
    explicit ModulesVariable(const std::string& value) { setenv("RENDER2MPEG_MODULES", value.c_str(), 1); }
    ~ModulesVariable() { unsetenv("RENDER2MPEG_MODULES"); }
};

TEST(ModuleFolders, AreThoseOfTheBuildAndOfTheInstallation) {
    unsetenv("RENDER2MPEG_MODULES");
    const auto folders = core::module_folders();
    ASSERT_EQ(folders.size(), 3u);
    EXPECT_EQ(folders[0], executable().parent_path() / "modules");
    for (std::size_t i = 1; i < 3; ++i) {
        EXPECT_EQ(folders[i].filename(), "render2mpeg");
        EXPECT_NE(folders[i].string().find("lib"), std::string::npos);
        EXPECT_TRUE(folders[i].is_absolute());
    }
    // The first two move with the executable.
    EXPECT_TRUE(folders[1].string().starts_with(executable().parent_path().parent_path().string()));
}

TEST(ModuleFolders, BeginWithTheOneThatTheUserNames) {
    const ModulesVariable variable("/somewhere/else");
    EXPECT_EQ(core::module_folders().at(0), "/somewhere/else");
    EXPECT_EQ(core::module_folders().size(), 4u);
}

std::string opening_error(const std::string& part, const std::string& symbol) {
    try {
        core::module_symbol(part, symbol);
    } catch (const core::Error& error) {
        return error.what();
    }
    return {};
}

TEST(Module, ThatIsMissingIsNamedWithThePlacesThatWereSearched) {
    const std::string message = opening_error("teapot", "door");
    EXPECT_NE(message.find("render2mpeg_teapot_module.so"), std::string::npos) << message;
    EXPECT_NE(message.find((executable().parent_path() / "modules").string()), std::string::npos);
    EXPECT_NE(message.find("RENDER2MPEG_MODULES"), std::string::npos);
}

TEST(Module, ThatIsBrokenIsAnErrorAndNotPassedOver) {
    const Folder folder;
    write_bytes(folder / "render2mpeg_broken_module.so", {'n', 'o', 't', ' ', 'E', 'L', 'F'});
    const ModulesVariable variable(folder.path().string());
    const std::string message = opening_error("broken", "door");
    EXPECT_NE(message.find((folder / "render2mpeg_broken_module.so").string()), std::string::npos) << message;
    EXPECT_EQ(message.find("searched"), std::string::npos);
}

TEST(Module, OfAnotherVersionIsToldByItsMissingFunction) {
    EXPECT_NE(opening_error("av", "no_such_function").find("no_such_function"), std::string::npos);
}

TEST(Module, IsOpenedOnce) {
    EXPECT_NE(core::module_symbol("av", "render2mpeg_av_backend"), nullptr);
    EXPECT_EQ(core::module_symbol("av", "render2mpeg_av_backend"), core::module_symbol("av", "render2mpeg_av_backend"));
}

/// What the module is for: who links the light library does not start with FFmpeg's libraries, who muxes has them.
TEST(Module, KeepsFfmpegOutOfTheProgram) {
    const std::string program = support::run("ldd " + executable().string()).output;
    EXPECT_NE(program.find("libc.so"), std::string::npos);
    EXPECT_EQ(program.find("libav"), std::string::npos) << program;
    EXPECT_NE(support::run("ldd " + (executable().parent_path() / "modules/render2mpeg_av_module.so").string())
                  .output.find("libavformat"),
              std::string::npos);
}

TEST(Module, ExceptionsPassThroughUnharmed) {
    EXPECT_THROW(av::decode("/no/such/film.mpg", [](const core::Picture&) {}), core::Error);
}

}  // namespace
}  // namespace render2mpeg::test
