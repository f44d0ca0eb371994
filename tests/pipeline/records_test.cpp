#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "app/job/scene_settings.h"
#include "pipeline/fixture.h"

/// --cache on, and what it shows of itself.
namespace render2mpeg::test {
namespace {

const std::string render_room = support::program() + " render -y --hold " + plain_film() +
                                " --size 32x24 --samples 1 --exposure 0 --frames 3:5 -o ";

const std::string kept = " --cache on";

TEST(RecordsSlow, ToLookOnAtThemChangesNothing) {
    const Folder folder;
    const auto place = [&](const std::string& name) { return (folder / name).string(); };
    std::string heatmaps;
    for (const std::string subject : {"records", "age", "reuse"})
        heatmaps += " --heatmap " + subject + " " + place(subject + ".m2v");
    const auto watched = run(render_room + place("watched.y4m") + kept + heatmaps + " --aov " + place("aov") +
                             " --stats " + place("s.json"));
    ASSERT_EQ(watched.status, 0) << watched.output;
    EXPECT_NE(watched.output.find("  records    "), std::string::npos) << watched.output;
    ASSERT_EQ(run(render_room + place("plain.y4m") + kept + " --quiet").status, 0);
    EXPECT_EQ(contents(folder / "plain.y4m"), contents(folder / "watched.y4m"));

    // Three of one scale would be one film thrice.
    EXPECT_NE(contents(folder / "records.m2v"), contents(folder / "age.m2v"));
    EXPECT_NE(contents(folder / "reuse.m2v"), contents(folder / "age.m2v"));
    const auto header = run("exrheader " + place("aov") + "/frame_0004.exr");
    for (const char* channel : {"render2mpeg.RecordDensity.X", "render2mpeg.RecordAge.X", "render2mpeg.RecordReuse.X"})
        EXPECT_NE(header.output.find(channel), std::string::npos) << channel << "\n" << header.output;
}

TEST(RecordsSlow, OfFramesAddUpToThoseOfTheFilm) {
    const Folder folder;
    const std::string stats = (folder / "s.json").string();
    ASSERT_EQ(run(render_room + (folder / "f.y4m").string() + kept + " --quiet --stats " + stats).status, 0);
    const auto film = nlohmann::json::parse(contents(stats));
    std::uint64_t created = 0, most = 0;
    for (const auto& frame : film.at("per_frame")) {
        created += frame.at("records_created").get<std::uint64_t>();
        most = std::max(most, frame.at("records_live").get<std::uint64_t>());
        EXPECT_GT(frame.at("records_served").get<double>(), 0.0);
        EXPECT_LT(frame.at("records_served").get<double>(), 1.0);
    }
    EXPECT_EQ(created, film.at("counts").at("records_created").get<std::uint64_t>());
    EXPECT_EQ(most, film.at("counts").at("records_most").get<std::uint64_t>());
}

TEST(RecordsSlow, ThatAreNotThereAreNotShown) {
    const Folder folder;
    const std::string heat = " --heatmap age " + (folder / "h.m2v").string();
    for (const char* option : {" --indirect lightcuts", " --cache on --tolerance reference"}) {
        const auto refused = run(render_room + (folder / "f.y4m").string() + heat + option);
        EXPECT_EQ(refused.status, 1) << option;
        EXPECT_NE(refused.output.find("no records"), std::string::npos) << refused.output;
        EXPECT_EQ(folder.entries(), 0u) << option;
    }
}

constexpr std::int64_t large = 320 * 240;  ///< pixels

TEST(RecordsSlow, AreKeptByThemselvesWhereLightStaysOrRaysFindIt) {
    scene::Traits walk;
    walk.has_diffuse_surfaces = walk.camera_moves = true;
    const auto keeps = [](const scene::Traits& traits, std::int64_t frames = 24, bool reference = false,
                          std::int64_t pixels = large) {
        return app::choose_cache("auto", traits, false, reference, frames, pixels).keeps();
    };
    EXPECT_TRUE(keeps(walk));
    EXPECT_FALSE(keeps(walk, 1)) << "a picture alone";
    EXPECT_FALSE(keeps(walk, 24, false, 96 * 96)) << "small pictures";
    EXPECT_FALSE(keeps(walk, 24, true)) << "--tolerance reference";
    for (bool scene::Traits::*cause :
         {&scene::Traits::lights_change, &scene::Traits::objects_move, &scene::Traits::objects_deform}) {
        scene::Traits changes = walk;
        changes.*cause = true;
        EXPECT_FALSE(keeps(changes));
        const app::CacheChoice asked = app::choose_cache("on", changes, true, false, 24, 1);
        EXPECT_EQ(asked.use, renderer::CacheUse::on) << "who asks gets it";
        for (const std::int64_t frames : {1, 24})
            EXPECT_EQ(app::choose_cache("auto", changes, true, false, frames, 96 * 96).use,
                      renderer::CacheUse::static_light)
                << "rays are shared by pixels";
        EXPECT_FALSE(app::choose_cache("auto", changes, true, true, 24, large).keeps()) << "--tolerance reference";
    }
    scene::Traits still;
    EXPECT_FALSE(keeps(still)) << "nothing dull";
    still.has_diffuse_surfaces = true;
    EXPECT_TRUE(keeps(still));
    EXPECT_FALSE(app::choose_cache("off", walk, true, false, 24, large).keeps());
}

TEST(RecordsSlow, ThePlanSaysWhyTheyAreKept) {
    const auto row = [](const std::string& arguments) {
        const std::string table = run(support::program() + " plan --within 0 " + arguments).output;
        const std::size_t at = table.find(" records ");
        return at == std::string::npos ? "none" : table.substr(at - 3, table.find('\n', at) - at + 3);
    };
    const std::string walk = row(support::film("colonnade") + " --cache auto --indirect lightcuts"),
                      lamps = row(support::film("many_lamps") + " --cache auto --indirect lightcuts"),
                      figure = row(support::film("character") + " --cache auto --indirect lightcuts");
    EXPECT_TRUE(walk.starts_with("yes")) << walk;
    EXPECT_NE(walk.find("only the camera moves"), std::string::npos) << walk;
    EXPECT_TRUE(lamps.starts_with("no ")) << lamps;
    EXPECT_NE(lamps.find("would not pay: lights change"), std::string::npos) << lamps;
    EXPECT_TRUE(figure.starts_with("no ")) << figure;
    EXPECT_NE(figure.find("would not pay: what moves changes light"), std::string::npos) << figure;
    const std::string unwanted = row(plain_film() + " --cache off");
    EXPECT_NE(unwanted.find("not wanted"), std::string::npos) << unwanted;
    EXPECT_EQ(row(support::film("colonnade") + " --indirect lightcuts"), walk) << "auto is the default";
    const std::string rays = row(support::film("character"));
    EXPECT_TRUE(rays.starts_with("yes")) << rays;
    EXPECT_NE(rays.find("share what gather rays found"), std::string::npos) << rays;
    EXPECT_TRUE(row(plain_film() + " --cache on").starts_with("yes")) << row(plain_film() + " --cache on");
}

}  // namespace
}  // namespace render2mpeg::test
