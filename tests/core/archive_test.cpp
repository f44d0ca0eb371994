#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/archive.h"
#include "core/error.h"
#include "support/program.h"

/// Files that only the program which wrote them reads.
namespace render2mpeg::core {
namespace {

struct Part {
    std::vector<int> many;
    std::shared_ptr<const double> shared;
};
template <class A>
void archive(A& a, Part& part) {
    a(part.many, part.shared);
}

/// All kinds of values; longer than a block.
struct Whole {
    std::map<int, Part> parts;
    std::optional<float> there, absent;
    Plane<std::uint8_t> plane;
    std::vector<std::vector<int>> lists;
};
template <class A>
void archive(A& a, Whole& whole) {
    a(whole.parts, whole.there, whole.absent, whole.plane, whole.lists);
}

Whole example() {
    Whole whole;
    whole.parts[3] = {{1, 2, 3}, std::make_shared<const double>(0.5)};
    whole.parts[-7] = {std::vector<int>(50'000, 9), nullptr};
    whole.there = 2.0f;
    whole.plane = Plane<std::uint8_t>(3, 2, 8);
    whole.lists = {{}, {4, 5}};
    return whole;
}

void write(const std::filesystem::path& file, std::uint64_t mark) {
    Whole whole = example();
    ArchiveWriter writer(file, mark);
    writer(whole);
    EXPECT_FALSE(std::filesystem::exists(file)) << "it has no name before it is whole";
    writer.finish();
}

TEST(Archive, GivesBackWhatItWasGiven) {
    const support::Folder folder;
    write(folder / "a", 5);
    const auto reader = ArchiveReader::open(folder / "a", 5);
    ASSERT_NE(reader, nullptr);
    Whole now;
    (*reader)(now);
    const Whole was = example();
    ASSERT_EQ(now.parts.size(), 2u);
    EXPECT_EQ(now.parts.at(3).many, was.parts.at(3).many);
    EXPECT_EQ(*now.parts.at(3).shared, 0.5);
    EXPECT_EQ(now.parts.at(-7).many, was.parts.at(-7).many);
    EXPECT_EQ(now.parts.at(-7).shared, nullptr);
    EXPECT_EQ(now.there, was.there);
    EXPECT_EQ(now.absent, was.absent);
    EXPECT_EQ(now.plane, was.plane);
    EXPECT_EQ(now.lists, was.lists);
    int more = 0;
    EXPECT_THROW((*reader)(more), Error);
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(Archive, IsNotBelievedWhereItIsTornChangedOrAnothers) {
    const support::Folder folder;
    write(folder / "a", 5);
    EXPECT_EQ(ArchiveReader::open(folder / "a", 6), nullptr);
    EXPECT_EQ(ArchiveReader::open(folder / "b", 5), nullptr);
    const std::string whole = support::contents(folder / "a");
    const auto is_taken = [&](const std::string& text) {
        std::ofstream(folder / "a", std::ios::binary | std::ios::trunc) << text;
        return ArchiveReader::open(folder / "a", 5) != nullptr;
    };
    EXPECT_TRUE(is_taken(whole));
    for (const std::size_t length : {std::size_t{0}, std::size_t{23}, std::size_t{24}, whole.size() - 1})
        EXPECT_FALSE(is_taken(whole.substr(0, length))) << length;
    EXPECT_FALSE(is_taken(whole + "x"));
    for (std::size_t i = 0; i < whole.size(); i += i < 64 ? 1 : 997) {
        std::string changed = whole;
        changed[i] = static_cast<char>(changed[i] ^ 0x80);
        EXPECT_FALSE(is_taken(changed)) << i;
    }
}

TEST(Archive, HoldsNoMoreThanItsBytes) {
    const support::Folder folder;
    {
        ArchiveWriter writer(folder / "a", 5);
        int side = 1 << 20;
        writer(side, side, side);
        writer.finish();
    }
    const auto read = [&](auto value) { (*ArchiveReader::open(folder / "a", 5))(value); };
    EXPECT_THROW(read(Plane<float>()), Error);
    EXPECT_THROW(read(std::vector<double>()), Error);
    EXPECT_THROW(read(std::vector<std::vector<int>>()), Error);
}

TEST(Archive, ThatIsNotFinishedLeavesNothing) {
    const support::Folder folder;
    {
        ArchiveWriter writer(folder / "a", 5);
        int value = 1;
        writer(value);
    }
    EXPECT_EQ(folder.entries(), 0u);
    ArchiveWriter nowhere(folder / "none/a", 5);
    EXPECT_THROW(nowhere.finish(), Error);
}

}  // namespace
}  // namespace render2mpeg::core
