#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/farm/farm_plan.h"
#include "farm/farm_film.h"

/// A film that many machines make has the bytes of a film that one machine makes.
namespace render2mpeg {
namespace {

using nlohmann::json;
using support::contents;
using support::run;
using test::FarmFilm;

std::vector<app::Chunk> chunks(int count) {
    return app::chunks_of({0, 60 * count - 1}, 15);
}

std::vector<double> alike(int count) {
    return std::vector<double>(static_cast<std::size_t>(count), 1.0);
}

TEST(FilmParts, AreWholeChunksThatCoverTheFilm) {
    for (const auto& [count, asked, made] : {std::tuple{8, 8, 8}, {8, 3, 3}, {8, 100, 8}, {1, 5, 1}, {7, 2, 2}}) {
        const auto parts = app::parts_of(chunks(count), alike(count), asked, {});
        ASSERT_EQ(parts.size(), static_cast<std::size_t>(made));
        std::size_t next = 0, least = 100, most = 0;
        for (const app::FilmPart& part : parts) {
            EXPECT_EQ(part.chunks.first, next);
            EXPECT_EQ(part.frames.first, static_cast<std::int64_t>(60 * next));
            EXPECT_EQ(part.frames.last, static_cast<std::int64_t>(60 * part.chunks.last + 59));
            next = part.chunks.last + 1;
            least = std::min(least, part.chunks.count());
            most = std::max(most, part.chunks.count());
        }
        EXPECT_EQ(next, static_cast<std::size_t>(count));
        EXPECT_LE(most - least, 1u);
    }
    EXPECT_EQ(app::parts_of(chunks(8), alike(8), {}, 120).size(), 4u);
    EXPECT_EQ(app::parts_of(chunks(8), alike(8), {}, 10).size(), 8u) << "a chunk is the least";
    EXPECT_EQ(app::parts_of(chunks(8), alike(8), {}, {}).size(), 8u);
}

/// The longest part over the mean one.
double longest_over_mean(const app::FarmPlan& plan) {
    double longest = 0, all = 0;
    for (const app::FilmPart& part : plan.parts) {
        longest = std::max(longest, plan.share_of(part));
        all += plan.share_of(part);
    }
    return longest * static_cast<double>(plan.parts.size()) / all;
}

TEST(FilmParts, AreNearlyAsLongAsEachOther) {
    // Forty chunks, of which the ten of the second shot are five times as dear.
    app::FarmPlan plan;
    plan.shares = alike(40);
    std::fill_n(plan.shares.begin() + 13, 10, 5.0);
    plan.parts = app::parts_of(chunks(40), plan.shares, 8, {});
    ASSERT_EQ(plan.parts.size(), 8u);
    EXPECT_LE(longest_over_mean(plan), 1.15);
    plan.parts = app::parts_of(chunks(40), alike(40), 8, {});
    EXPECT_GT(longest_over_mean(plan), 2) << "what equally many chunks would be";
}

/// The dearest of `count` runs of chunks, as cheap as can be, by trying each cut.
double least_dearest(std::span<const double> costs, std::size_t count) {
    if (count == 1) return std::reduce(costs.begin(), costs.end());
    double least = std::numeric_limits<double>::max();
    for (std::size_t first = 1; first + count - 1 <= costs.size(); ++first)
        least = std::min(least, std::max(std::reduce(costs.begin(), costs.begin() + static_cast<std::ptrdiff_t>(first)),
                                         least_dearest(costs.subspan(first), count - 1)));
    return least;
}

TEST(FilmParts, HaveTheCheapestLongestOneAndAreNumberedByLength) {
    std::mt19937 random(1);
    for (int trial = 0; trial < 300; ++trial) {
        const int n = 1 + static_cast<int>(random() % 9),
                  count = 1 + static_cast<int>(random() % static_cast<unsigned>(n));
        app::FarmPlan plan;
        for (int i = 0; i < n; ++i) plan.shares.push_back(1 + static_cast<double>(random() % 9));
        plan.parts = app::parts_of(chunks(n), plan.shares, count, {});
        ASSERT_EQ(plan.parts.size(), static_cast<std::size_t>(count));
        const std::vector<app::FilmPart> sorted = plan.longest_first();
        EXPECT_NEAR(plan.share_of(sorted.front()), least_dearest(plan.shares, static_cast<std::size_t>(count)), 1e-9);
        std::size_t next = 0;
        for (const app::FilmPart& part : plan.parts)
            EXPECT_EQ(part.chunks.first, std::exchange(next, part.chunks.last + 1));
        EXPECT_EQ(next, static_cast<std::size_t>(n));
        for (int i = 0; i < count; ++i) {
            EXPECT_EQ(sorted[static_cast<std::size_t>(i)].number, i + 1);
            if (i > 0) {
                EXPECT_LE(plan.share_of(sorted[static_cast<std::size_t>(i)]),
                          plan.share_of(sorted[static_cast<std::size_t>(i) - 1]));
            }
        }
    }
}

TEST(FilmParts, AreListedAsSchedulersReadThem) {
    EXPECT_EQ(app::part_list({}), "");
    EXPECT_EQ(app::part_list({3}), "3");
    EXPECT_EQ(app::part_list({9, 4, 3, 1, 5, 10}), "1,3-5,9-10");
}

TEST(FarmOptions, KeepWhatMakesTheFilm) {
    EXPECT_EQ(
        app::render_words({"render2mpeg", "farm", "a.glb", "-o", "f.mpg", "--to=slurm", "--parts", "8", "--pack",
                           "--gop", "12", "--submit", "-j", "4", "--quantiser", "6"}),
        (std::vector<std::string>{"render2mpeg", "render", "a.glb", "-o", "f.mpg", "--gop", "12", "--quantiser", "6"}));
}

/// Statistics, report, layers and a heatmap beside a film.
std::string all_of(const FarmFilm& film, const std::string& name) {
    return "-o " + film.path(name + ".mpg") + " --stats " + film.path(name + ".json") + " --report " +
           film.path(name + ".html") + " --aov " + film.path(name + "_layers") + " --heatmap quantiser " +
           film.path(name + "_q.mpg");
}

TEST(Farm, MakesAllThatOneRunMakesSlow) {
    const FarmFilm film("--audit 1", 122);
    ASSERT_EQ(film.render(all_of(film, "one")).status, 0);
    const auto planned = film.farm(all_of(film, "film"), "--to parallel --parts 3");
    ASSERT_EQ(planned.status, 0) << planned.output;
    for (const int part : {3, 1}) ASSERT_EQ(run(film.part("film.mpg.farm", part)).status, 0);
    const auto early = film.join("film.mpg.farm");
    EXPECT_EQ(early.status, 1);
    EXPECT_NE(early.output.find("1 of 3 parts are not whole: 2;"), std::string::npos) << early.output;
    EXPECT_EQ(run(support::program() + " farm-status --left " + film.path("film.mpg.farm")).output, "2\n");

    ASSERT_EQ(run(film.part("film.mpg.farm", 2)).status, 0);
    const auto joined = film.join("film.mpg.farm");
    ASSERT_EQ(joined.status, 0) << joined.output;
    EXPECT_TRUE(film.same("one.mpg", "film.mpg"));
    EXPECT_TRUE(film.same("one_q.mpg", "film_q.mpg"));
    EXPECT_EQ(run("diff -r " + film.path("one_layers") + " " + film.path("film_layers")).output, "");
    EXPECT_EQ(test::lasting_statistics(film / "film.json"), test::lasting_statistics(film / "one.json"));
    EXPECT_NE(contents(film / "film.html").find("as it was lit"), std::string::npos) << "the sample frame";
    EXPECT_FALSE(std::filesystem::exists(film / "film.mpg.farm/part_00001")) << "parts go";
    EXPECT_EQ(film.join("film.mpg.farm").status, 0) << "nothing is left to be done";
    EXPECT_EQ(run(film.part("film.mpg.farm", 1)).status, 0);
    EXPECT_FALSE(std::filesystem::exists(film / "film.mpg.farm/part_00001"));

    const auto elsewhere = film.join("film.mpg.farm", "--into " + film.path("b"));
    EXPECT_EQ(elsewhere.status, 1);
    EXPECT_NE(elsewhere.output.find("film.mpg.farm: it was joined already, as " + film.path("film.mpg")),
              std::string::npos)
        << elsewhere.output;
    std::filesystem::remove(film / "film.mpg");
    const auto gone = film.join("film.mpg.farm");
    EXPECT_EQ(gone.status, 1);
    EXPECT_NE(gone.output.find("film.mpg, which is gone"), std::string::npos) << gone.output;
}

TEST(Farm, MakesFilmsOfEveryKindAsOneRunDoesSlow) {
    const std::pair<const char*, const char*> kinds[] = {{"f.mkv", "--bitrate 300k --passes 2"},
                                                         {"f.mp4", ""},
                                                         {"eyes.mkv", "--stereo side-by-side"},
                                                         {"f.ts", "--bitrate 400k --cbr"},
                                                         {"f.y4m", ""}};
    for (const auto& [name, options] : kinds) {
        const FarmFilm film(options, 120);
        const std::string farm = std::string(name) + ".farm";
        ASSERT_EQ(film.render("-o " + film.path("one_" + std::string(name))).status, 0);
        ASSERT_EQ(film.farm("-o " + film.path(name), "--to parallel").status, 0);
        for (const int part : {1, 2}) {
            const auto made = run(film.part(farm, part));
            ASSERT_EQ(made.status, 0) << name << ": " << made.output;
        }
        const auto joined = film.join(farm);
        ASSERT_EQ(joined.status, 0) << joined.output;
        EXPECT_TRUE(film.same("one_" + std::string(name), name)) << name;
    }
    const FarmFilm film("", 62);
    ASSERT_EQ(film.render("-o " + film.path("one.%04d.png")).status, 0);
    ASSERT_EQ(film.farm("-o " + film.path("f.%04d.png"), "--to parallel").status, 0);
    for (const int part : {1, 2}) ASSERT_EQ(run(film.part("f.%04d.png.farm", part)).status, 0);
    ASSERT_EQ(film.join("f.%04d.png.farm").status, 0);
    for (const char* number : {"0000", "0061"})
        EXPECT_TRUE(film.same(std::string("one.") + number + ".png", std::string("f.") + number + ".png"));
}

TEST(Farm, BeginsWithTheDearShotSlow) {
    const FarmFilm film("", 240, "96x16", test::dear_shot_scene());
    ASSERT_EQ(film.render("-o " + film.path("one.mpg")).status, 0);
    const auto planned = film.farm("-o " + film.path("f.mpg"), "--to parallel --parts 3");
    ASSERT_EQ(planned.status, 0) << planned.output;
    const app::FarmPlan plan = app::read_plan(film / "f.mpg.farm");
    ASSERT_EQ(plan.shares.size(), 4u);
    for (const std::size_t cheap : {0u, 1u, 3u}) EXPECT_GT(plan.shares[2], 2 * plan.shares[cheap]);
    // It is a part of its own, and the first.
    EXPECT_EQ(plan.parts[1].chunks.first, 2u);
    EXPECT_EQ(plan.parts[1].chunks.last, 2u);
    EXPECT_EQ(plan.parts[1].number, 1);
    ASSERT_EQ(film.farm("-o " + film.path("f.mpg"), "--to parallel --parts 3").status, 0);
    EXPECT_EQ(app::read_plan(film / "f.mpg.farm").shares, plan.shares) << "a plan that is kept is not measured anew";
    for (const int part : {1, 2, 3}) ASSERT_EQ(run(film.part("f.mpg.farm", part)).status, 0);
    const auto joined = film.join("f.mpg.farm");
    ASSERT_EQ(joined.status, 0) << joined.output;
    EXPECT_TRUE(film.same("one.mpg", "f.mpg"));
}

TEST(Farm, SamplesFilmsOfCodecsWithoutSmallPicturesSlow) {
    struct Film {
        std::string codec, size, name;
    };
    for (const auto& [codec, size, name] : {Film{"av1", "320x180", "f.mp4"}, Film{"dnxhr", "1280x720", "f.mov"}}) {
        const FarmFilm film("--codec " + codec, 120, size);
        const auto planned = film.farm("-o " + film.path(name), "--to parallel --parts 2");
        EXPECT_EQ(planned.status, 0) << planned.output;
        const auto told = run(support::program() + " plan " + film.path("scene.json") +
                              " --hold --frames 0:119 --samples 1 --within 1 --codec " + codec + " --size " + size);
        EXPECT_EQ(told.status, 0) << told.output;
    }
}

TEST(Farm, RefusesByNameWhatIsNotThePlansSlow) {
    const FarmFilm film("", 120);
    ASSERT_EQ(film.farm("-o " + film.path("f.mpg"), "--to parallel").status, 0);
    const auto refused = [&](const std::string& words) {
        for (const std::string& command :
             {film.part("f.mpg.farm", 1), support::program() + " join " + film.path("f.mpg.farm")}) {
            const auto outcome = run(command);
            EXPECT_EQ(outcome.status, 3) << outcome.output;
            EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
        }
    };
    const std::filesystem::path plan = film / "f.mpg.farm/plan.json", scene = film / "scene.json";
    const std::string before = contents(plan);
    const auto change = [&](const char* name, const char* value) {
        json other = json::parse(before);
        other["identity"][name] = value;
        std::ofstream(plan, std::ios::trunc) << other;
    };
    change("render2mpeg", "0.0.9");
    refused("render2mpeg was 0.0.9 and is ");
    change("instruction set", "avx1024");
    refused("instruction set avx1024: ");
    json shorter = json::parse(before);
    shorter.at("parts").erase(1);
    shorter.at("forecast").erase(1);
    std::ofstream(plan, std::ios::trunc) << shorter;
    refused(": the number of chunks has changed since `farm` planned it");
    std::ofstream(plan, std::ios::trunc) << before;
    std::ofstream(scene, std::ios::app) << " ";
    refused("the input " + scene.string() + " has changed since `farm` planned it");
    std::ofstream(scene, std::ios::trunc) << support::travel_scene(80);

    EXPECT_EQ(run(film.part("f.mpg.farm", 3)).status, 2) << "there are two";
    EXPECT_EQ(run(film.part("g.mpg.farm", 1)).status, 1) << "there is no plan";
    EXPECT_EQ(film.farm("-o " + film.path("f.mpg"), "--to sge --submit").output.find("render2mpeg: submitting "), 0u);
    EXPECT_EQ(run(film.part("f.mpg.farm", 1)).status, 0) << "and this is it";
}

TEST(Farm, RefusesDamagedPlansInOneLineOfWordsSlow) {
    const FarmFilm film("", 120);
    ASSERT_EQ(film.farm("-o " + film.path("f.mpg"), "--to parallel --parts 2").status, 0);
    const std::filesystem::path file = film / "f.mpg.farm/plan.json";
    const nlohmann::json plan = nlohmann::json::parse(contents(file));
    std::vector<std::string> damaged{"",
                                     "[",
                                     "[]",
                                     "null",
                                     std::string(100'000, '[') + std::string(100'000, ']'),
                                     contents(file).substr(0, contents(file).size() / 2)};
    // Every value in turn becomes one of another kind, a huge number, or none.
    const nlohmann::json flat = plan.flatten();
    for (const auto& [place, value] : flat.items())
        for (const nlohmann::json& other : {nlohmann::json(), nlohmann::json(1e300), nlohmann::json("--nothing"),
                                            nlohmann::json::array({-1}), nlohmann::json::object()}) {
            nlohmann::json changed = plan;
            changed[nlohmann::json::json_pointer(place)] = other;
            damaged.push_back(changed.dump());
        }
    std::size_t refused = 0, n = 0;
    for (const std::string& text : damaged) {
        std::ofstream(file, std::ios::trunc) << text;
        // Each is looked at in one way: a part that is made takes longest.
        const std::string way = n++ % 8 == 0 ? film.part("f.mpg.farm", 1)
                                : n % 8 == 1 ? support::program() + " join --quiet " + film.path("f.mpg.farm")
                                             : support::program() + " farm-status " + film.path("f.mpg.farm");
        const auto outcome = run("timeout 60 " + way);
        SCOPED_TRACE(way + text.substr(0, 2000));
        if (outcome.status == 0) continue;
        ++refused;
        EXPECT_TRUE(outcome.status == 1 || outcome.status == 3) << outcome.status << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
        EXPECT_EQ(outcome.output.find("[json.exception"), std::string::npos) << outcome.output;
    }
    EXPECT_GT(refused, damaged.size() / 4);
}

TEST(Farm, KeepsWhatIsMadeWhereItIsGivenAgainSlow) {
    const FarmFilm film("", 120);
    const std::string name = "-o " + film.path("f.mpg");
    ASSERT_EQ(film.farm(name, "--to parallel").status, 0);
    ASSERT_EQ(run(film.part("f.mpg.farm", 2)).status, 0);
    const auto left = [&] { return run(support::program() + " farm-status --left " + film.path("f.mpg.farm")).output; };
    ASSERT_EQ(film.farm(name, "--to slurm").status, 0);
    EXPECT_EQ(left(), "1\n");
    ASSERT_EQ(film.farm(name + " --quantiser 9", "--to slurm").status, 0);
    EXPECT_EQ(left(), "1-2\n") << "another film";
}

TEST(Farm, PacksNothingUnderANameThatJobFilesCannotHold) {
    const FarmFilm film("", 60);
    const auto refused = film.farm("-o " + film.path("50%.mpg"), "--to slurm --pack");
    EXPECT_EQ(refused.status, 1);
    EXPECT_NE(refused.output.find("rename it"), std::string::npos) << refused.output;
    EXPECT_TRUE(std::filesystem::is_empty(film / "50%.mpg.farm"));
}

TEST(Farm, PacksItsInputsSlow) {
    const FarmFilm film("", 120);
    ASSERT_EQ(film.render("-o " + film.path("one.mpg")).status, 0);
    ASSERT_EQ(film.farm("-o " + film.path("f.mpg"), "--to kubernetes --pack").status, 0);
    std::filesystem::create_directory(film / "elsewhere");
    std::filesystem::remove(film / "scene.json");
    ASSERT_EQ(run("cd " + film.path("elsewhere") + " && tar xf ../f.mpg.farm.tar").status, 0);
    std::filesystem::remove_all(film / "f.mpg.farm");
    for (const int part : {1, 2}) {
        const auto made = run(film.part("elsewhere/f.mpg.farm", part));
        ASSERT_EQ(made.status, 0) << made.output;
    }
    const auto joined = film.join("elsewhere/f.mpg.farm", "--into " + film.path("elsewhere"));
    ASSERT_EQ(joined.status, 0) << joined.output;
    EXPECT_TRUE(film.same("one.mpg", "elsewhere/f.mpg"));
}

TEST(Farm, TellsOpenJdHowFarAPartIsSlow) {
    const FarmFilm film("", 240);
    ASSERT_EQ(film.render("-o " + film.path("one.mpg")).status, 0);
    ASSERT_EQ(film.farm("-o " + film.path("f.mpg"), "--to openjd --parts 4").status, 0);
    for (const char* part : {"1", "2", "3", "4"}) {
        const auto made = run(support::program() + " part --progress openjd " + film.path("f.mpg.farm") + " " + part);
        ASSERT_EQ(made.status, 0) << made.output;
        EXPECT_NE(made.output.find("openjd_progress: 100.0\nopenjd_status: "), std::string::npos) << made.output;
    }
    ASSERT_EQ(film.join("f.mpg.farm").status, 0);
    EXPECT_TRUE(film.same("one.mpg", "f.mpg"));
}

TEST(Farm, SurvivesKillsAndAFullDiskSlow) {
    const FarmFilm plain("", 240);
    ASSERT_EQ(plain.render("-o " + plain.path("one.mpg")).status, 0);
    ASSERT_EQ(plain.farm("-o " + plain.path("f.mpg"), "--to parallel --parts 2").status, 0);
    const std::string first = plain.part("f.mpg.farm", 1), record = plain.path("f.mpg.farm/part_00001/f.mpg.partial/");
    // Kill it behind its first chunk.
    run(first + " & job=$!; while [ ! -s " + record +
        "chunk_00000.json ] && kill -0 $job; do sleep 0.01; done; kill -KILL $job");
    ASSERT_TRUE(std::filesystem::exists(record + "chunk_00000.json"));
    const auto written = std::filesystem::last_write_time(record + "chunk_00000.json");
    // Twice at once: both end well, and what was whole stays.
    const auto twice = run(first + " & one=$!; " + first + " & two=$!; wait $one && wait $two");
    EXPECT_EQ(twice.status, 0) << twice.output;
    EXPECT_EQ(std::filesystem::last_write_time(record + "chunk_00000.json"), written);
    // No room: the part says so, and another try makes it.
    const auto full = run("ulimit -f 1; " + plain.part("f.mpg.farm", 2));
    EXPECT_EQ(full.status, 1) << full.output;
    EXPECT_NE(full.output.find("render2mpeg: writing "), std::string::npos) << full.output;
    ASSERT_EQ(run(plain.part("f.mpg.farm", 2)).status, 0);
    // The join, killed again and again.
    const std::string join = support::program() + " join --quiet " + plain.path("f.mpg.farm");
    for (const char* seconds : {"0.02", "0.1", "0.2", "0.3"})
        run(join + " & job=$!; sleep " + seconds + "; kill -KILL $job; wait $job");
    EXPECT_EQ(run(join).status, 0);
    EXPECT_TRUE(plain.same("one.mpg", "f.mpg"));
}

}  // namespace
}  // namespace render2mpeg
