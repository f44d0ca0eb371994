#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/files/light_file.h"
#include "core/error.h"
#include "pipeline/fixture.h"

/// --light-cache: light of earlier runs.
namespace render2mpeg::test {
namespace {

using app::LightExtent;
using app::LightFile;

std::vector<std::byte> bytes_of(const std::string& text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

std::string text_of(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string failure(const auto& does) {
    try {
        does();
    } catch (const core::Error& error) {
        return error.what();
    }
    return "";
}

TEST(LightFile, HoldsWhatManyAddedInTheirOrder) {
    const Folder folder;
    const std::filesystem::path file = folder / "l.light";
    LightFile one(file, {{"scene", "a"}}), other(file, {{"scene", "a"}});
    EXPECT_EQ(one.extent(), LightExtent());
    one.add(bytes_of("first,"));
    const LightExtent before = other.extent();
    other.add(bytes_of("second,"));
    one.add(bytes_of("third"));
    EXPECT_EQ(text_of(one.known(before)), "first,") << "whatever was added since";
    EXPECT_EQ(text_of(one.known(one.extent())), "first,second,third");
}

TEST(LightFile, LosesOnlyTheBlockThatAKilledRunLeft) {
    const Folder folder;
    const std::filesystem::path file = folder / "l.light";
    LightFile(file, {{"scene", "a"}}).add(bytes_of("first,"));
    const auto whole = std::filesystem::file_size(file);
    LightFile(file, {{"scene", "a"}}).add(bytes_of("second,"));
    for (const auto size : {std::filesystem::file_size(file) - 1, whole + 3, whole}) {
        std::filesystem::resize_file(file, size);
        LightFile light(file, {{"scene", "a"}});
        EXPECT_EQ(text_of(light.known(light.extent())), "first,") << size;
    }
    std::filesystem::resize_file(file, whole + 0);
    std::ofstream(file, std::ios::app) << "half a block";
    LightFile light(file, {{"scene", "a"}});
    light.add(bytes_of("third"));
    EXPECT_EQ(text_of(light.known(light.extent())), "first,third");
    // Not even its head was whole.
    std::filesystem::resize_file(file, 30);
    light = LightFile(file, {{"scene", "a"}});
    EXPECT_EQ(light.extent(), LightExtent());
    light.add(bytes_of("anew"));
    EXPECT_EQ(text_of(light.known(light.extent())), "anew");
}

TEST(LightFile, RefusesOtherLightByName) {
    const Folder folder;
    const std::filesystem::path file = folder / "l.light";
    LightFile(file, {{"--vpls", 400}}).add(bytes_of("light"));
    LightFile other(file, {{"--vpls", 800}});
    const std::string reason = "l.light: it has other light: --vpls was 400 and is 800";
    EXPECT_NE(failure([&] { static_cast<void>(other.extent()); }).find(reason), std::string::npos);
    EXPECT_NE(failure([&] { other.add(bytes_of("more")); }).find(reason), std::string::npos);
    LightFile same(file, {{"--vpls", 400}});
    const LightExtent extent = same.extent();
    std::ofstream(file) << "something else";
    EXPECT_NE(failure([&] { static_cast<void>(same.extent()); }).find("it is no light file"), std::string::npos);
    EXPECT_NE(failure([&] { static_cast<void>(same.known(extent)); }).find("another than when the film was begun"),
              std::string::npos);
}

/// A walk through a room with a window, two chunks of 41 frames.
constexpr const char* walk = R"({ "frames": 82, "size": [48, 36],
  "camera": { "fov": 60, "keys": [{ "at": 0, "position": [-0.8, 1.4, 1.5], "look_at": [0, 0.7, -1] }, { "at": 0.3, "position": [-0.7, 1.4, 1.4], "look_at": [0, 0.7, -1] }] },
  "sky": { "zenith": [2, 3, 5], "horizon": [4, 4, 4] },
  "objects": [{ "name": "floor", "shape": "plane", "size": [4, 4] },
              { "name": "ceiling", "shape": "box", "size": [4, 0.1, 4], "position": [0, 2.4, 0] },
              { "name": "back", "shape": "box", "size": [4, 2.4, 0.1], "position": [0, 0, -2] },
              { "name": "left", "shape": "box", "size": [0.1, 2.4, 4], "position": [-2, 0, 0] },
              { "name": "behind", "shape": "box", "size": [4, 2.4, 0.1], "position": [0, 0, 2] },
              { "name": "table", "shape": "box", "size": [0.8, 0.7, 0.8], "position": [0.2, 0, -0.8] }] })";

class Walk {
  public:
    Walk() { std::ofstream(folder_ / "walk.json") << walk; }
    std::string place(const std::string& name) const { return path(folder_, name); }
    /// Renders `name`.mpg with statistics; `more` options.
    support::Outcome render(const std::string& name, const std::string& more) const {
        return run(program() + " render -y " + place("walk.json") + " --gop 41 --samples 1 -o " + place(name + ".mpg") +
                   " --stats " + place(name + ".json") + " " + more);
    }
    json counts(const std::string& name) const {
        return json::parse(contents(folder_ / (name + ".json"))).at("counts");
    }
    std::string film(const std::string& name) const { return contents(folder_ / (name + ".mpg")); }
    std::string with() const { return "--light-cache " + place("l.light"); }

  private:
    Folder folder_;
};

TEST(LightCache, SparesASecondRunMostOfItsRaysSlow) {
    const Walk films;
    const std::string eight = " --frames 0:7 --hold";
    ASSERT_EQ(films.render("plain", "-q 8 --quiet" + eight).status, 0);
    ASSERT_EQ(films.render("first", "-q 8 --quiet " + films.with() + eight).status, 0);
    EXPECT_EQ(films.film("plain"), films.film("first")) << "an empty file changes nothing";
    const std::string light = contents(films.place("l.light"));
    ASSERT_EQ(films.render("again", "-q 8 --quiet " + films.with() + eight).status, 0);
    ASSERT_EQ(films.render("plain16", "-q 16 --quiet" + eight).status, 0);
    ASSERT_EQ(films.render("again16", "-q 16 --quiet " + films.with() + eight).status, 0);
    const auto rays = [&](const char* name) { return films.counts(name).at("gather_rays").get<double>(); };
    EXPECT_EQ(films.counts("first").at("records_known"), 0);
    EXPECT_GT(films.counts("again").at("records_known"), 1000);
    EXPECT_LT(3 * rays("again"), rays("first"));
    EXPECT_LT(3 * rays("again16"), rays("plain16"));
    // The same light, as far as the tolerance asks.
    const std::string one = codes_of(films.place("first.mpg")), other = codes_of(films.place("again.mpg"));
    ASSERT_EQ(one.size(), other.size());
    double off = 0;
    for (std::size_t i = 0; i < one.size(); ++i)
        off += std::abs(static_cast<unsigned char>(one[i]) - static_cast<unsigned char>(other[i]));
    EXPECT_LT(off / static_cast<double>(one.size()), 1.5);
    // Little is left to be found.
    const auto bytes = [&] { return contents(films.place("l.light")).size(); };
    const auto before = bytes();
    ASSERT_EQ(films.render("again8", "-q 8 --quiet " + films.with() + eight).status, 0);
    EXPECT_LT(bytes() - before, light.size() / 4);
    // A film's bytes are decided by what the file held when it was begun.
    std::ofstream(films.place("l.light"), std::ios::binary) << light;
    ASSERT_EQ(films.render("twice", "-q 8 --quiet " + films.with() + eight).status, 0);
    EXPECT_EQ(films.film("twice"), films.film("again"));
}

TEST(LightCache, ChangesNothingAboutResumingNorPartsSlow) {
    const Walk films;
    ASSERT_EQ(films.render("first", "-q 16 --quiet " + films.with()).status, 0);
    const std::string light = contents(films.place("l.light"));
    const auto renew = [&] { std::ofstream(films.place("l.light"), std::ios::binary) << light; };
    ASSERT_EQ(films.render("whole", "-q 8 --quiet " + films.with()).status, 0);
    ASSERT_GT(contents(films.place("l.light")).size(), light.size());
    // Killed after its first chunk, which has added its light.
    renew();
    const auto killed =
        run(program() + " render -y " + films.place("walk.json") + " --gop 41 --samples 1 -q 8 --quiet " +
            films.with() + " -o " + films.place("part.mpg") + " & job=$!; while [ ! -e " +
            films.place("part.mpg.partial/chunk_00001.m2v") +
            " ] && kill -0 $job 2> /dev/null; do sleep 0.02; done; kill -KILL $job 2> /dev/null; wait $job");
    ASSERT_EQ(killed.status, 137) << killed.output;
    const auto resumed =
        run(program() + " render -y " + films.place("walk.json") + " --gop 41 --samples 1 -q 8 --quiet --resume " +
            films.with() + " -o " + films.place("part.mpg"));
    ASSERT_EQ(resumed.status, 0) << resumed.output;
    EXPECT_EQ(films.film("part"), films.film("whole"));
    // By two parts.
    renew();
    const auto farm = run(program() + " farm --to parallel --parts 2 -y " + films.place("walk.json") +
                          " --gop 41 --samples 1 -q 8 --quiet " + films.with() + " -o " + films.place("farm.mpg"));
    ASSERT_EQ(farm.status, 0) << farm.output;
    for (const char* part : {"2", "1"}) {
        const auto made = run(program() + " part " + films.place("farm.mpg.farm") + " " + part + " --quiet");
        ASSERT_EQ(made.status, 0) << made.output;
    }
    ASSERT_EQ(run(program() + " join " + films.place("farm.mpg.farm") + " --quiet").status, 0);
    EXPECT_EQ(films.film("farm"), films.film("whole"));
    EXPECT_GT(contents(films.place("l.light")).size(), light.size());
}

TEST(LightCache, AndFilmsAreTheSameForAnyNumberOfLightPointsSinceRaysBringTheLightSlow) {
    const Walk films;
    const std::string few = "--frames 0:0 --hold --size 16x12 -q 16 ";
    ASSERT_EQ(films.render("usual", few + films.with()).status, 0);
    const std::string light = contents(films.place("l.light"));
    std::filesystem::remove(films.place("l.light"));
    const auto fewer = films.render("fewer", few + "--vpls 100 " + films.with());
    ASSERT_EQ(fewer.status, 0) << fewer.output;
    EXPECT_NE(fewer.output.find("--vpls does nothing here: rays bring bounced light"), std::string::npos)
        << fewer.output;
    EXPECT_EQ(films.film("fewer"), films.film("usual"));
    EXPECT_EQ(contents(films.place("l.light")), light);
    EXPECT_EQ(films.render("points", few + "--indirect lightcuts --vpls 100").output.find("--vpls"), std::string::npos);
    EXPECT_EQ(films.render("none", few + "--vpls 0").output.find("--vpls"), std::string::npos);
    EXPECT_NE(films.film("none"), films.film("usual"));
}

TEST(LightCache, IsRefusedByNameOrToldToHaveNoEffectSlow) {
    const Walk films;
    const std::string few = "--frames 0:0 --hold --size 16x12 -q 16 ";
    ASSERT_EQ(films.render("a", few + films.with()).status, 0);
    const auto other = films.render("b", few + "--caustics off " + films.with());
    EXPECT_EQ(other.status, 1);
    EXPECT_NE(other.output.find("l.light: it has other light: --caustics was on and is off"), std::string::npos)
        << other.output;
    EXPECT_FALSE(std::filesystem::exists(films.place("b.mpg")));
    std::ofstream(films.place("no.light")) << "some text";
    const auto none = films.render("c", few + "--light-cache " + films.place("no.light"));
    EXPECT_EQ(none.status, 1);
    EXPECT_NE(none.output.find("no.light: it is no light file"), std::string::npos) << none.output;
    const auto cuts = films.render("e", few + "--indirect lightcuts " + films.with());
    EXPECT_EQ(cuts.status, 0);
    EXPECT_NE(cuts.output.find("--light-cache has no effect: rays gather no light"), std::string::npos) << cuts.output;
    const auto itself = films.render("f", few + "--light-cache " + films.place("f.mpg"));
    EXPECT_EQ(itself.status, 1);
    EXPECT_NE(itself.output.find("f.mpg"), std::string::npos) << itself.output;
    ASSERT_EQ(films.render("g", few + "--light-cache " + films.place("new/folder/l.light")).status, 0);
    EXPECT_TRUE(std::filesystem::exists(films.place("new/folder/l.light")));
    const auto off = films.render("d", few + "--cache off " + films.with());
    EXPECT_EQ(off.status, 0);
    EXPECT_NE(off.output.find("--light-cache has no effect: no light is kept"), std::string::npos) << off.output;
}

/// A light file of the same identity with one record in it changed: four bytes from `place` on.
void forge(const std::filesystem::path& file, std::size_t place, std::uint32_t bytes) {
    const std::string text = contents(file);
    const std::size_t head = std::string("render2mpeg light\n").size() + 16;
    const json identity = json::parse(text.substr(head, text.find('\n', text.find("\n}", head)) - head + 2));
    LightFile light(file, identity);
    std::vector<std::byte> known = light.known(light.extent());
    for (std::size_t at = place; at + 4 <= known.size(); at += 144) std::memcpy(known.data() + at, &bytes, 4);
    std::filesystem::remove(file);
    LightFile(file, identity).add(known);
}

TEST(LightCache, RefusesLightThatNoRunHasFoundSlow) {
    const Walk films;
    const std::string few = "--frames 0:0 --hold --size 16x12 -q 16 --quiet ";
    ASSERT_EQ(films.render("a", few + films.with()).status, 0);
    const std::string light = contents(films.place("l.light"));
    // A place on its triangle, light, a position, an error, and the set of lights, which is looked up in a table.
    for (const auto& [place, bytes] : {std::pair{8u, 0x7fc00000u},
                                       {22u, 0xffffffffu},
                                       {80u, 0x7fc00000u},
                                       {124u, 0xff800000u},
                                       {140u, 0xffffffffu}}) {
        std::ofstream(films.place("l.light"), std::ios::binary) << light;
        forge(films.place("l.light"), place, bytes);
        const auto refused = films.render("b", few + films.with());
        EXPECT_EQ(refused.status, 1) << place;
        EXPECT_NE(refused.output.find("l.light: it holds light that no run has found"), std::string::npos)
            << place << refused.output;
    }
    std::ofstream(films.place("l.light"), std::ios::binary) << light;
    forge(films.place("l.light"), 1u << 30, 0);
    EXPECT_EQ(films.render("b", few + films.with()).status, 0) << "what is right is taken";
}

}  // namespace
}  // namespace render2mpeg::test
