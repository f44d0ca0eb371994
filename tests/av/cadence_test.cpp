#include "encoder/cadence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <string>
#include <tuple>

#include "av/coded_film.h"
#include "av/program_stream.h"
#include "core/sampling.h"
#include "encoder/encoder.h"

/// Pictures shown as fields, in containers: when they are shown, and what foreign tools take them for.
namespace render2mpeg::test {
namespace {

/// A grating that moves, encoded with its motion and B pictures, in chunks of two GOPs as a render makes them.
///
/// `grain`: code values of noise that moves with the grating, and as much that does not: what no vector predicts.
CodedFilm moving_film(int width, int height, const std::string& rate, encoder::Cadence cadence, int pictures,
                      int quantiser = 8, int grain = 0) {
    CodedFilm film;
    encoder::Settings& s = film.settings;
    s.width = width;
    s.height = height;
    s.rate = core::frame_rate_from(rate);
    s.cadence = cadence;
    s.first_number = 5;  // a film may begin anywhere
    s.gop = 12;
    s.aspect_ratio_code = 3;
    s.matrix_coefficients = 6;
    s.quantiser = quantiser;
    s.rate_control.max_rate = 9'000'000;
    s.rate_control.buffer_bits = 1'835'008;
    const int chunk = 2 * s.gop;
    for (int begin = 0; begin < pictures; begin += chunk) {
        encoder::Encoder encoder(s);
        const int end = std::min(pictures, begin + chunk);
        const auto keep = [&](const std::vector<encoder::CodedPicture>& coded) {
            for (const encoder::CodedPicture& c : coded)
                film.pictures.push_back({c.bytes, c.plan.number - s.first_number, c.plan.starts_gop});
        };
        for (int i = begin; i < end; ++i) {
            core::Picture p;
            p.number = s.first_number + i;
            p.y = core::Plane<std::uint8_t>(width, height);
            p.cb = p.cr = core::Plane<std::uint8_t>(width / 2, height / 2, 128);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x)
                    p.y.at(x, y) = static_cast<std::uint8_t>(std::lround(
                        120 + 60 * std::sin(0.2 * (x - 2 * i) + 0.1 * y) +
                        grain * (core::uniform(1, static_cast<std::uint64_t>(x - 2 * i + 4096),
                                               static_cast<std::uint64_t>(y)) -
                                 0.5) +
                        grain * (core::uniform(2, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y),
                                               static_cast<std::uint64_t>(i)) -
                                 0.5)));
            encoder::PictureFacts facts;
            facts.frames_left = end - 1 - i;
            const encoder::PicturePlan plan = encoder.plan(p.number, facts, i == begin);
            std::vector<core::MotionField> motion;
            for (const std::int64_t reference : plan.references) {
                core::MotionField field;
                field.picture = p.number;
                field.reference = reference;
                field.vector =
                    core::Plane<glm::vec2>(width, height, {2.0f * static_cast<float>(reference - p.number), 0});
                field.kind = core::Plane<core::PixelClass>(width, height, core::PixelClass::surface);
                motion.push_back(std::move(field));
            }
            keep(encoder.push(p, plan, motion));
        }
        keep(encoder.flush());
    }
    const auto end = encoder::sequence_end();
    film.pictures.back().bytes.insert(film.pictures.back().bytes.end(), end.begin(), end.end());
    for (const CodedPicture& p : film.pictures) film.largest = std::max(film.largest, p.bytes.size());
    return film;
}

fs::path mux_for_dvd(const CodedFilm& film, const fs::path& file) {
    av::Muxer muxer(file, file, film.settings, film.largest, av::ProgramStream::dvd);
    std::int64_t order = 0;
    for (const CodedPicture& p : film.pictures) muxer.write(p.bytes, p.display_number, order++, p.starts_gop);
    muxer.finish();
    return file;
}

/// Values of one field of ffprobe's, a line each.
std::vector<std::string> probed_lines(const std::string& what, const fs::path& file) {
    const support::Outcome outcome =
        support::run("ffprobe -v error -of default=nw=1:nk=1 " + what + " " + file.string());
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    std::vector<std::string> lines;
    std::istringstream stream(outcome.output);
    for (std::string line; std::getline(stream, line);)
        if (!line.empty()) lines.push_back(line);
    return lines;
}

TEST(Cadence, TimeStampsAdvanceByThreeAndTwoFieldsInDisplayOrder) {
    const Folder folder;
    const CodedFilm film = moving_film(96, 64, "23.976", encoder::Cadence::pulldown, 41);
    // Fields of 1001/60000 s in ticks of 90 kHz.
    const double field = 1501.5;
    const fs::path file = film.mux(folder / "a.ts");
    std::vector<double> pts, dts;
    for (const std::string& line : probed_lines("-show_entries packet=pts", file)) pts.push_back(std::stod(line));
    for (const std::string& line : probed_lines("-show_entries packet=dts", file)) dts.push_back(std::stod(line));
    ASSERT_EQ(pts.size(), 41u);
    ASSERT_EQ(dts.size(), 41u);
    for (std::size_t i = 0; i < 41; ++i) {
        EXPECT_LE(dts[i], pts[i]);
        if (i == 0) continue;
        EXPECT_GT(dts[i], dts[i - 1]);
        // Coding order i is decoded when display number i - 1 is shown.
        EXPECT_NEAR(
            (dts[i] - dts[1]) / field,
            static_cast<double>(encoder::fields_before(film.settings.cadence, static_cast<std::int64_t>(i) - 1)), 0.01);
    }
    std::sort(pts.begin(), pts.end());
    for (std::size_t i = 0; i < 41; ++i)
        EXPECT_NEAR((pts[i] - pts[0]) / field,
                    static_cast<double>(encoder::fields_before(film.settings.cadence, static_cast<std::int64_t>(i))),
                    0.01);
    // 41 pictures at 23.976 Hz, whatever the flags say.
    EXPECT_NEAR((pts[40] - pts[0]) / 90000, 40 * 1001.0 / 24000, 0.02);
}

TEST(Cadence, AllFramesOfTheFilmComeOutAndNoneTwice) {
    const Folder folder;
    for (const auto cadence : {encoder::Cadence::pulldown, encoder::Cadence::fields}) {
        const CodedFilm film = moving_film(96, 64, "23.976", cadence, 30);
        const fs::path file = film.mux(folder / "a.mpg");
        std::set<std::string> different;
        std::size_t n = 0;
        av::decode(file, [&](const core::Picture& p) {
            different.emplace(p.y.values().begin(), p.y.values().end());
            ++n;
        });
        EXPECT_EQ(n, 30u);
        EXPECT_GE(different.size(), 28u);

        // With fields woven as a player weaves them: five frames for four pictures.
        const support::Outcome woven =
            support::run("ffmpeg -v error -i " + file.string() + " -vf repeatfields -f framemd5 - | grep -vc '^#'");
        EXPECT_NEAR(std::stod(woven.output), cadence == encoder::Cadence::pulldown ? 37.5 : 30, 1.1) << woven.output;
    }
}

/// A program stream's sectors, each with the identifiers of what follows its pack header.
struct Sector {
    bool pack = false, system_header = false, navigation = false;
};
std::vector<Sector> sectors_of(const std::vector<std::uint8_t>& file) {
    std::vector<Sector> sectors;
    const auto code = [&](std::size_t at, std::uint8_t id) {
        return file[at] == 0 && file[at + 1] == 0 && file[at + 2] == 1 && file[at + 3] == id;
    };
    for (std::size_t at = 0; at + 2048 <= file.size(); at += 2048) {
        const bool system = code(at + 14, 0xbb);
        // A navigation pack: system header, then two packets of private stream 2 of 980 and 1018 bytes.
        const bool navigation = system && code(at + 38, 0xbf) && file[at + 42] == 0x03 && file[at + 43] == 0xd4 &&
                                code(at + 1024, 0xbf) && file[at + 1028] == 0x03 && file[at + 1029] == 0xfa;
        sectors.push_back({code(at, 0xba), system, navigation});
    }
    return sectors;
}

TEST(DvdStream, IsOfWholeSectorsWithANavigationPackAtEachGop) {
    const Folder folder;
    const CodedFilm film = moving_film(352, 288, "25", encoder::Cadence::fields, 50);
    const std::vector<std::uint8_t> bytes = bytes_of(mux_for_dvd(film, folder / "a.vob"));
    EXPECT_EQ(bytes.size() % 2048, 0u);
    const std::vector<Sector> sectors = sectors_of(bytes);
    EXPECT_TRUE(std::all_of(sectors.begin(), sectors.end(), [](const Sector& s) { return s.pack; }));
    EXPECT_TRUE(sectors.at(0).navigation);
    const auto units = std::count_if(sectors.begin(), sectors.end(), [](const Sector& s) { return s.navigation; });
    EXPECT_EQ(units, 5);  // GOPs of 12 of 50 pictures

    const std::vector<std::uint8_t> plain = bytes_of(film.mux(folder / "b.vob"));
    const std::vector<Sector> others = sectors_of(plain);
    EXPECT_TRUE(std::none_of(others.begin(), others.end(), [](const Sector& s) { return s.navigation; }));
}

TEST(DvdStreamSlow, PlaysOnTheStandardsDecoder) {
    // Fine enough that the highest rate and the buffer bind.
    for (const auto& [rate, height, cadence] :
         {std::tuple{"23.976", 480, encoder::Cadence::pulldown}, {"25", 576, encoder::Cadence::fields}}) {
        SCOPED_TRACE(rate);
        const Folder folder;
        const CodedFilm film = moving_film(720, height, rate, cadence, 40, 2, 40);
        const std::vector<std::uint8_t> bytes = bytes_of(mux_for_dvd(film, folder / "a.vob"));
        const ProgramStream stream = ProgramStreamReader(bytes).read();
        // The stream's own buffer, and what a DVD player adds to it for packets under way: 232 KiB in all.
        EXPECT_GE(stream.buffer_bytes, 1'835'008u / 8);
        EXPECT_LE(stream.buffer_bytes, 232u * 1024);
        std::size_t total = 0, received = 0, decoded = 0, picture = 0, fullest = 0, first = 0;
        std::vector<std::size_t> ends;
        for (const CodedPicture& p : film.pictures) ends.push_back(total += p.bytes.size());
        const double seconds = 40 / core::frame_rate_from(rate).hertz.value();
        EXPECT_GT(static_cast<double>(total) * 8 / seconds, 7e6) << "the limits are not tried";
        while (first < stream.packs.size() && !stream.packs[first].dts) ++first;
        ASSERT_LT(first, stream.packs.size());

        // Picture c is decoded when number c - 1 is shown; until then it must have come, and nothing runs over.
        const double field = 0.5 / encoder::declared_rate(film.settings).hertz.value();
        const auto due = [&](std::size_t c) {
            const auto before = [&](std::int64_t n) { return encoder::fields_before(film.settings.cadence, n); };
            return *stream.packs[first].dts +
                   field * static_cast<double>(before(static_cast<std::int64_t>(c) - 1) - before(-1));
        };
        for (const Pack& pack : stream.packs) {
            const double whole = pack.scr + static_cast<double>(pack.bytes) / pack.rate;
            EXPECT_NEAR(pack.rate * 8, 10'080'000, 1);
            while (picture < ends.size() && due(picture) < whole - 1e-4) {
                EXPECT_LE(ends[picture], received) << "picture " << picture << " is not there in time";
                decoded = ends[picture++];
            }
            received += pack.payload;
            fullest = std::max(fullest, received - std::min(decoded, received));
        }
        EXPECT_EQ(received, total);
        EXPECT_LE(fullest, stream.buffer_bytes);
        EXPECT_GT(fullest, stream.buffer_bytes / 2);
    }
}

/// Other worlds' tools take these films for what they are.
TEST(DvdStreamSlow, DvdauthorMakesADiscOfIt) {
    struct Case {
        const char *format, *rate;
        int height;
        encoder::Cadence cadence;
    };
    for (const Case& c :
         {Case{"PAL", "25", 576, encoder::Cadence::fields}, Case{"NTSC", "23.976", 480, encoder::Cadence::pulldown},
          Case{"NTSC", "29.97", 480, encoder::Cadence::fields}}) {
        SCOPED_TRACE(std::string(c.format) + " " + c.rate);
        const Folder folder;
        const CodedFilm film = moving_film(720, c.height, c.rate, c.cadence, 30);
        const fs::path file = mux_for_dvd(film, folder / "a.mpg");
        const std::string author = "HOME=" + folder.path().string() + " VIDEO_FORMAT=" + c.format + " dvdauthor -o " +
                                   (folder / "disc").string();
        const support::Outcome title = support::run(author + " -t " + file.string()),
                               toc = support::run(author + " -T");
        EXPECT_EQ(title.status, 0) << title.output;
        EXPECT_EQ(toc.status, 0) << toc.output;
        EXPECT_EQ(title.output.find("WARN"), std::string::npos) << title.output;
        EXPECT_EQ(title.output.find("ERR"), std::string::npos) << title.output;
        EXPECT_NE(title.output.find("TV standard: " + std::string(c.height == 576 ? "pal" : "ntsc")),
                  std::string::npos);
        EXPECT_NE(title.output.find("Aspect ratio: 16:9"), std::string::npos) << title.output;
        EXPECT_GT(fs::file_size(folder / "disc/VIDEO_TS/VTS_01_1.VOB"), fs::file_size(file) / 2);

        // Multiplexed anew with the model of a disc's buffer, the stream never runs dry.
        const fs::path stream = film.mux(folder / "a.m2v");
        const support::Outcome mplex =
            support::run("mplex -f 8 -o " + (folder / "b.mpg").string() + " " + stream.string());
        EXPECT_NE(mplex.output.find("no under-runs detected"), std::string::npos) << mplex.output;
    }
}

}  // namespace
}  // namespace render2mpeg::test
