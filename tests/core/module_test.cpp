#include "core/module.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <optional>

#include "core/error.h"
#include "tests/support/places.h"

namespace render2mpeg::core {
namespace {

namespace fs = std::filesystem;

/// Sets RENDER2MPEG_MODULES while it lives.
class ModuleFolder {
  public:
    explicit ModuleFolder(const fs::path& folder) {
        if (const char* before = std::getenv(name)) before_ = before;
        setenv(name, folder.c_str(), 1);
    }
    ~ModuleFolder() { before_ ? setenv(name, before_->c_str(), 1) : unsetenv(name); }

  private:
    static constexpr const char* name = "RENDER2MPEG_MODULES";
    std::optional<std::string> before_;
};

std::string message_of(const std::string& part) {
    try {
        module_symbol(part, "function");
    } catch (const Error& error) {
        return error.what();
    }
    return "nothing was thrown";
}

TEST(Modules, AreSoughtFirstWhereTheUserSaysThenBesideTheProgram) {
    const ModuleFolder folder("/nowhere");
    const auto folders = module_folders();
    ASSERT_GE(folders.size(), 3u);
    EXPECT_EQ(folders[0], "/nowhere");
    EXPECT_EQ(folders[1], support::binary_folder() / "modules");
    for (const fs::path& each : folders) EXPECT_TRUE(each.is_absolute()) << each;
}

TEST(ProgramFile, IsFoundWithoutTheSystemsLink) {
    const fs::path linked = program_file();
    EXPECT_EQ(linked.parent_path(), support::binary_folder());
    EXPECT_EQ(program_file("/nowhere/self/exe"), linked);
}

TEST(Module, ThatIsMissingNamesFileAndEveryFolderSearched) {
    const ModuleFolder folder("/nowhere");
    const std::string message = message_of("no_such_part");
    EXPECT_NE(message.find("render2mpeg_no_such_part_module.so"), std::string::npos) << message;
    for (const fs::path& each : module_folders()) EXPECT_NE(message.find(each.string()), std::string::npos) << message;
}

TEST(Module, ThatIsNoModuleKeepsTheLoadersReason) {
    const fs::path place = fs::path(testing::TempDir()) / "render2mpeg_module_test";
    fs::create_directories(place);
    const fs::path file = place / "render2mpeg_damaged_module.so";
    std::ofstream(file) << "not a shared object";
    const ModuleFolder folder(place);
    const std::string message = message_of("damaged");
    EXPECT_NE(message.find(file.string()), std::string::npos) << message;
    EXPECT_GT(message.size(), file.string().size() + 20) << message;
    fs::remove_all(place);
}

}  // namespace
}  // namespace render2mpeg::core
