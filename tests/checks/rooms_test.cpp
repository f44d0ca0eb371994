#include "checks/rooms.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/places.h"

namespace render2mpeg::checks {
namespace {

std::vector<Finding> rooms_broken_by(const std::string& path, const std::string& header) {
    return room_breaches({make_file(path, "#pragma once\n#include \"" + header + "\"\n")});
}

TEST(Rooms, HaveArrowsOfOneWay) {
    const auto findings = room_breaches(read_tree(support::source_folder()));
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(Rooms, HaveAReadmeOfAtMostTenLines) {
    const auto findings = rooms_without_readme(read_tree(support::source_folder()));
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(Rooms, HaveReadmesThatAreTrue) {
    const auto findings = untrue_readmes(read_tree(support::source_folder()));
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(RoomCheck, FindsArrowsThatPointTheWrongWay) {
    const std::pair<const char*, const char*> arrows[] = {
        {"src/renderer/geometry/a.cpp", "renderer/cut/gatherer.h"},
        {"src/renderer/lights/a.cpp", "renderer/tree/light_tree.h"},
        {"src/renderer/tree/a.h", "renderer/lights/virtual_lights.h"},
        {"src/scene/gltf/a.cpp", "scene/assimp/parts.h"},
        {"encoder/mpeg2/bitstream/a.cpp", "encoder/mpeg2/rate/rate_model.h"},
        {"encoder/mpeg2/rate/a.cpp", "encoder/look_ahead.h"},
        {"encoder/mpeg2/a.cpp", "encoder/av/av.h"},
        {"encoder/look_ahead.cpp", "encoder/av/av.h"},
        {"encoder/types.h", "encoder/mpeg2/bitstream/levels.h"},
        {"encoder/cadence.cpp", "encoder/codec.h"},
        {"src/app/files/a.cpp", "app/loop/pipeline.h"},
    };
    for (const auto& [path, header] : arrows) {
        const auto findings = rooms_broken_by(path, header);
        ASSERT_EQ(findings.size(), 1u) << path << " " << header;
        EXPECT_EQ(findings[0].line, 2);
    }
}

TEST(RoomCheck, FindsPartsThatARoomMayNotKnow) {
    EXPECT_EQ(rooms_broken_by("src/app/options/a.cpp", "renderer/renderer.h").size(), 1u);
    EXPECT_EQ(rooms_broken_by("src/app/files/a.cpp", "perceptual/display.h").size(), 1u);
    EXPECT_TRUE(rooms_broken_by("src/app/loop/a.cpp", "renderer/renderer.h").empty());
}

TEST(RoomCheck, FindsARoomThatIncludesWhatIsBuiltOnIt) {
    EXPECT_EQ(rooms_broken_by("src/renderer/cut/a.cpp", "renderer/renderer.h").size(), 1u);
    EXPECT_TRUE(rooms_broken_by("src/renderer/renderer.cpp", "renderer/cut/gatherer.h").empty());
}

TEST(RoomCheck, LetsRoomsIncludeTheValuesOfTheirPartAndPartsTheirRooms) {
    EXPECT_TRUE(rooms_broken_by("encoder/mpeg2/rate/a.cpp", "encoder/types.h").empty());
    EXPECT_TRUE(rooms_broken_by("encoder/cadence.h", "encoder/types.h").empty());
    EXPECT_TRUE(rooms_broken_by("encoder/encoder.cpp", "encoder/mpeg2/rate/rate_model.h").empty());
    EXPECT_TRUE(rooms_broken_by("encoder/av/a.cpp", "encoder/codec.h").empty());
}

TEST(RoomCheck, FindsSourcesThatLieInNoRoom) {
    EXPECT_EQ(room_breaches({make_file("src/renderer/attic/a.cpp", "")}).size(), 1u);
}

TEST(RoomCheck, FindsMissingAndLongReadmes) {
    const std::string room = "src/renderer/cut/README.md";
    const auto is_of_room = [&](const Finding& f) { return f.path == room; };
    const auto count = [&](const std::vector<File>& files) {
        const auto findings = rooms_without_readme(files);
        return std::count_if(findings.begin(), findings.end(), is_of_room);
    };
    EXPECT_EQ(count({}), 1);
    EXPECT_EQ(count({make_file(room, "# Cut\n")}), 0);
    EXPECT_EQ(count({make_file(room, "1\n2\n3\n4\n5\n6\n7\n8\n9\n10\n11\n")}), 1);
}

TEST(RoomCheck, FindsReadmesThatNameOtherRoomsThanTheTable) {
    const std::string room = "src/renderer/caustics/README.md";
    const auto said_of = [&](const std::string& text) {
        std::string said;
        for (const Finding& finding : untrue_readmes({make_file(room, text)}))
            if (finding.path == room) said += finding.message + "\n";
        return said;
    };
    const std::string true_one = "# caustics\n\n- May touch `lights`, `surface`, `geometry`\n  and `base`";
    EXPECT_EQ(said_of(true_one + "; knows neither the light tree nor the eye.\n"), "");
    EXPECT_EQ(said_of(true_one + ". The view comes later.\n"), "");
    EXPECT_EQ(said_of(true_one + " and `gather`.\n"), "says that it may touch gather\n");
    EXPECT_EQ(said_of("May touch `lights`, `surface` and `base`.\n"), "does not say that it may touch geometry\n");
}

TEST(RoomCheck, FindsFilesThatReadmesOfLargeRoomsLeaveOut) {
    const auto count = [](const std::string& text) {
        const std::string readme = "src/app/loop/README.md";
        const auto findings =
            untrue_readmes({make_file(readme, "May touch job, coupling, files, options and system.\n" + text),
                            make_file("src/app/loop/sink.h", ""), make_file("src/app/loop/sink.cpp", "")});
        return std::count_if(findings.begin(), findings.end(), [&](const Finding& f) { return f.path == readme; });
    };
    EXPECT_EQ(count("`sink` takes frames."), 0);
    EXPECT_EQ(count("`kept` takes frames."), 2) << "its header and its source";
}

}  // namespace
}  // namespace render2mpeg::checks
