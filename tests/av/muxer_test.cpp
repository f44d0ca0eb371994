#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "av/coded_film.h"
#include "av/program_stream.h"
#include "core/error.h"
#include "encoder/av/inspect.h"

namespace render2mpeg::test {
namespace {

using support::run;

std::vector<core::Picture> decoded(const fs::path& file) {
    std::vector<core::Picture> pictures;
    av::decode(file, [&](const core::Picture& p) { pictures.push_back(p); });
    return pictures;
}

/// What ffprobe says of the film's stream, field by field; "" for fields that it does not know.
std::map<std::string, std::string> probed(const fs::path& file) {
    std::istringstream lines(
        run("ffprobe -v error -count_packets -select_streams v:0 -show_streams -of default=nw=1 " + file.string())
            .output);
    std::map<std::string, std::string> fields;
    for (std::string line; std::getline(lines, line);) {
        const std::size_t equals = line.find('=');
        if (equals != std::string::npos) fields[line.substr(0, equals)] = line.substr(equals + 1);
    }
    return fields;
}

struct Times {
    std::optional<double> pts, dts;
    bool key = false;
};

std::vector<Times> packet_times(const fs::path& file) {
    const std::string text =
        run("ffprobe -v error -select_streams v:0 -show_entries packet=pts_time,dts_time,flags -of csv=p=0 " +
            file.string())
            .output;
    std::vector<Times> all;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream fields(line);
        std::string pts, dts, flags;
        if (!std::getline(fields, pts, ',') || !std::getline(fields, dts, ',') || !std::getline(fields, flags, ','))
            continue;
        Times times;
        if (pts != "N/A") times.pts = std::stod(pts);
        if (dts != "N/A") times.dts = std::stod(dts);
        times.key = flags.find('K') != std::string::npos;
        all.push_back(times);
    }
    return all;
}

class EveryKind : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryKind, HoldsTheFilmsPicturesUnharmed) {
    const Folder folder;
    const CodedFilm film = coded_film(folder, 176, 112, "29.97", 31, "-g 12 -bf 2 -q:v 5");
    ASSERT_EQ(film.pictures.size(), 31u);
    const fs::path file = film.mux(folder / (std::string("film.") + GetParam()));
    const auto pictures = decoded(file), original = decoded(film.source);
    ASSERT_EQ(pictures.size(), 31u);
    ASSERT_EQ(original.size(), 31u);
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        EXPECT_EQ(pictures[i].number, static_cast<std::int64_t>(i));
        EXPECT_TRUE(pictures[i].y == original[i].y && pictures[i].cb == original[i].cb &&
                    pictures[i].cr == original[i].cr)
            << i;
    }
    const support::Outcome strict =
        run("ffmpeg -v error -xerror -err_detect explode -i " + file.string() + " -f null -");
    EXPECT_EQ(strict.status, 0);
    EXPECT_EQ(strict.output, "");
}

TEST_P(EveryKind, TellsPlayersWhatItIs) {
    const Folder folder;
    const CodedFilm film =
        coded_film(folder, 176, 112, "23.976", 25,
                   "-g 12 -q:v 5 -aspect 16:9 -color_primaries bt709 -color_trc bt709 -colorspace smpte170m "
                   "-vf setparams=color_primaries=bt709:color_trc=bt709");
    const fs::path file = film.mux(folder / (std::string("film.") + GetParam()));
    auto stream = probed(file);
    EXPECT_EQ(stream["codec_name"], "mpeg2video");
    EXPECT_EQ(stream["width"], "176");
    EXPECT_EQ(stream["height"], "112");
    EXPECT_EQ(stream["nb_read_packets"], "25");
    EXPECT_EQ(stream["r_frame_rate"], "24000/1001");
    EXPECT_EQ(stream["sample_aspect_ratio"], "112:99");
    EXPECT_EQ(stream["color_range"], "tv");
    EXPECT_EQ(stream["color_space"], "smpte170m");
    EXPECT_EQ(stream["color_primaries"], "bt709");
    EXPECT_EQ(run("ffprobe -v warning " + file.string()).output, "");
}

TEST_P(EveryKind, HasTheSameBytesEveryTime) {
    const Folder folder;
    const CodedFilm film = coded_film(folder, 64, 48, "25", 13, "-g 6 -q:v 8");
    const auto first = bytes_of(film.mux(folder / (std::string("a.") + GetParam())));
    const auto second = bytes_of(film.mux(folder / (std::string("b.") + GetParam())));
    EXPECT_FALSE(first.empty());
    EXPECT_TRUE(first == second);
}

constexpr auto ending_of = [](const auto& parameter) { return std::string(parameter.param); };
INSTANTIATE_TEST_SUITE_P(Muxer, EveryKind, ::testing::Values("mpg", "mp4"), ending_of);
INSTANTIATE_TEST_SUITE_P(MuxerSlow, EveryKind, ::testing::Values("vob", "ts", "m2v", "mkv"), ending_of);

/// Decoding in coding order and showing in display order, both in steps of one picture; the first one is shown at the
/// film's start, whatever offset the container has. mkv counts milliseconds.
void expect_right_times(const CodedFilm& film, const fs::path& file) {
    const auto times = packet_times(file);
    ASSERT_EQ(times.size(), film.pictures.size());
    const double tick = 1 / film.settings.rate.hertz.value(), exact = file.extension() == ".mkv" ? 1.1e-3 : 3e-5;
    ASSERT_TRUE(times[0].pts.has_value() && times[0].dts.has_value());
    for (std::size_t i = 0; i < times.size(); ++i) {
        const double shown = static_cast<double>(film.pictures[i].display_number) * tick;
        if (times[i].pts) {
            EXPECT_NEAR(*times[i].pts - *times[0].pts, shown, exact);
        }
        if (times[i].dts) {
            EXPECT_NEAR(*times[i].dts - *times[0].dts, static_cast<double>(i) * tick, exact);
        }
        if (times[i].pts && times[i].dts) {
            EXPECT_GE(*times[i].pts, *times[i].dts - exact);
        }
        EXPECT_EQ(times[i].key, film.pictures[i].starts_gop) << i;
    }
}

void expect_right_times(const std::string& rate, const std::string& options) {
    const Folder folder;
    const CodedFilm film = coded_film(folder, 96, 80, rate, 28, options + " -q:v 2");
    for (const char* ending : {"mpg", "ts", "mkv", "mp4"}) {
        SCOPED_TRACE(options + " " + ending);
        expect_right_times(film, film.mux(folder / (std::string("film.") + ending)));
    }
}

TEST(Muxer, ShowsEveryPictureAtItsTime) {
    expect_right_times("29.97", "-g 9 -bf 2");
}

TEST(Muxer, ShowsPicturesWithoutBAtTheirTimesSlow) {
    expect_right_times("24", "-g 9 -bf 0");
    expect_right_times("29.97", "-g 12 -bf 0 -flags low_delay");
}

/// Plays the standard's decoder model on a program stream: every picture is in the buffer before it is decoded, the
/// buffer never holds more than the file declares, and bytes come no faster than declared.
void expect_playable(const CodedFilm& film, const fs::path& file) {
    const auto bytes = bytes_of(file);
    const ProgramStream stream = ProgramStreamReader(bytes).read();
    ASSERT_FALSE(stream.packs.empty());
    EXPECT_TRUE(stream.has_system_header);
    EXPECT_TRUE(stream.has_end_code);
    ASSERT_TRUE(stream.packs[0].dts.has_value());

    const double tick = 1 / film.settings.rate.hertz.value();
    std::vector<std::size_t> ends;
    for (const CodedPicture& p : film.pictures) ends.push_back((ends.empty() ? 0 : ends.back()) + p.bytes.size());
    std::size_t received = 0, decoded = 0, picture = 0, fullest = 0;
    for (std::size_t i = 0; i < stream.packs.size(); ++i) {
        const Pack& pack = stream.packs[i];
        const double whole = pack.scr + static_cast<double>(pack.bytes) / pack.rate;
        EXPECT_EQ(pack.bytes, 2048u);
        if (i + 1 < stream.packs.size()) {
            EXPECT_GE(stream.packs[i + 1].scr, whole - 1e-9);
        }
        // Decode what is due before this pack is whole; it must have come.
        while (picture < ends.size() && *stream.packs[0].dts + static_cast<double>(picture) * tick < whole - 2e-5) {
            EXPECT_LE(ends[picture], received) << "picture " << picture << " is not there in time";
            decoded = ends[picture++];
        }
        received += pack.payload;
        fullest = std::max(fullest, received - std::min(decoded, received));
    }
    EXPECT_EQ(received, ends.back());
    EXPECT_LE(fullest, stream.buffer_bytes);
    EXPECT_GT(fullest, stream.buffer_bytes / 100) << "declares far more buffer than it uses";
}

TEST(ProgramStream, PlaysOnTheStandardsDecoderSlow) {
    // Smallest and largest pictures: coarse, fine, noise that is all intra, stills whose I pictures alone are large.
    for (const auto& [options, filter] : {std::pair{"-g 12 -bf 2 -q:v 31", ""},
                                          {"-g 12 -bf 2 -q:v 1 -qmin 1", ""},
                                          {"-g 1 -q:v 1 -qmin 1", "noise=alls=90:allf=t"},
                                          {"-g 15 -bf 0 -q:v 1 -qmin 1", "loop=-1:1,noise=alls=90"},
                                          {"-g 12 -bf 2 -b:v 2M -maxrate 4M -bufsize 1835k", ""}}) {
        const Folder folder;
        const CodedFilm film = coded_film(folder, 352, 288, "25", 40, options, filter);
        SCOPED_TRACE(options);
        expect_playable(film, film.mux(folder / "film.mpg"));
        CodedFilm unknown = film;
        unknown.largest = 0;
        expect_playable(unknown, unknown.mux(folder / "guessed.vob"));
    }
}

TEST(Muxer, SaysWhereOnTheSphereItsPicturesLie) {
    const Folder folder;
    CodedFilm film = coded_film(folder, 64, 32, "25", 4, "-g 12 -bf 0 -q:v 4");
    const auto probe = [](const fs::path& file) {
        return run("ffprobe -v error -select_streams v:0 -show_streams -show_entries stream_side_data " + file.string())
            .output;
    };
    const encoder::SphereBounds whole, half{0.25, 0, 0.25, 0}, some{0.125, 0.0625, 0.375, 0.5};
    for (const char* name : {"film.mp4", "film.mkv"})
        for (const encoder::SphereBounds& bounds : {whole, half, some}) {
            film.settings.sphere = bounds;
            const fs::path file = film.mux(folder / name);
            const std::optional<encoder::SphereBounds> told = av::inspect(file).stream.sphere;
            ASSERT_TRUE(told) << name;
            EXPECT_EQ(*told, bounds) << name;
            const std::string text = probe(file);
            EXPECT_NE(text.find(bounds == whole ? "projection=equirectangular" : "projection=tiled equirectangular"),
                      std::string::npos)
                << text;
            fs::remove(file);
        }
    for (const char* name : {"film.mpg", "film.ts", "film.mov"}) {
        const fs::path file = film.mux(folder / name);
        EXPECT_FALSE(av::inspect(file).stream.sphere) << name;
        EXPECT_FALSE(av::tells_immersive(name));
    }
    film.settings.sphere.reset();
    EXPECT_FALSE(av::inspect(film.mux(folder / "flat.mp4")).stream.sphere);
}

TEST(Muxer, TellsHowPicturesHoldThoseOfTwoEyes) {
    const Folder folder;
    CodedFilm film = coded_film(folder, 64, 48, "25", 3, "-q:v 8");
    using core::FramePacking;
    for (const char* name : {"film.mp4", "film.mkv"})
        for (const bool around : {false, true})
            for (const FramePacking packing : {FramePacking::side_by_side, FramePacking::top_bottom}) {
                film.settings.packing = packing;
                film.settings.sphere = around ? std::optional(encoder::SphereBounds()) : std::nullopt;
                const fs::path file = film.mux(folder / name);
                const av::StreamFacts told = av::inspect(file).stream;
                EXPECT_EQ(told.packing, packing) << name;
                EXPECT_EQ(told.sphere.has_value(), around) << name;
                const std::string text =
                    run("ffprobe -v error -show_streams -show_entries stream_side_data " + file.string()).output;
                EXPECT_NE(text.find(packing == FramePacking::top_bottom ? "type=top and bottom" : "type=side by side"),
                          std::string::npos)
                    << text;
                fs::remove(file);
            }
}

TEST(Muxer, KeepsTitleTimecodeAndChapters) {
    const Folder folder;
    CodedFilm film = coded_film(folder, 64, 48, "29.97", 12, "-g 4 -bf 0 -q:v 8");
    film.settings.labels = {
        "Café, second cut", encoder::Timecode{1, 2, 3, 4, true}, {{0, 3, "Morning"}, {3, 8, "Noon"}, {8, 12, "Night"}}};
    for (const char* name : {"film.mp4", "film.mov", "film.mkv", "film.ts", "film.mpg"}) {
        ASSERT_TRUE(av::can_have_timecode(name, encoder::Codec::mpeg2));
        const fs::path file = film.mux(folder / name);
        const av::StreamFacts told = av::inspect(file).stream;
        const bool has = av::can_have_chapters(name);
        EXPECT_EQ(told.title, av::can_have_title(name) ? "Café, second cut" : "") << name;
        EXPECT_EQ(told.timecode, has ? "01:02:03;04" : "") << name << ": its groups are of another encoder";
        EXPECT_EQ(told.chapters, has ? 3 : 0) << name;
        EXPECT_EQ(decoded(file).size(), 12u) << name;
        const std::string text = run("ffprobe -v error -show_chapters -show_programs " + file.string()).output;
        EXPECT_EQ(text.find("service_name=Café, second cut") != std::string::npos, std::string_view(name) == "film.ts");
        if (!has) continue;
        EXPECT_NE(text.find("title=Noon"), std::string::npos) << text;
        EXPECT_NE(text.find("start_time=0.100"), std::string::npos) << text;
        EXPECT_NE(text.find("end_time=0.40"), std::string::npos) << text;
    }
    EXPECT_FALSE(av::can_have_timecode("film.ts", encoder::Codec::h264));
    EXPECT_FALSE(av::can_have_title("film.gif"));
}

TEST(Muxer, TellsHowLoudTheSoundIs) {
    const Folder folder;
    const CodedFilm film = coded_film(folder, 64, 48, "25", 4, "-bf 0 -q:v 8");
    const auto loudness = [&](const char* name, const std::string& tone, double offset) {
        const fs::path wav = folder / "tone.wav";
        const auto made = run("ffmpeg -v error -y -f lavfi -i \"aevalsrc='" + tone + "|" + tone +
                              "':s=48000:d=3\" -c:a pcm_s24le " + wav.string());
        EXPECT_EQ(made.status, 0) << made.output;
        av::Muxer muxer(folder / name, name, film.settings, film.largest, av::ProgramStream::plain,
                        {wav, offset, 3, false, 2});
        std::int64_t order = 0;
        for (const CodedPicture& p : film.pictures) muxer.write(p.bytes, p.display_number, order++, p.starts_gop);
        return muxer.finish();
    };
    // Case 1 of EBU Tech 3341: both channels a sine of 1 kHz, 23 dB below full scale.
    for (const char* name : {"film.mpg", "film.mp4"}) {  // samples of whole numbers and of floats
        const auto found = loudness(name, "pow(10,-23/20)*sin(2*PI*1000*t)", 0);
        ASSERT_TRUE(found) << name;
        EXPECT_NEAR(found->integrated, -23, 0.1) << name;
        EXPECT_NEAR(found->true_peak, -23, 0.1) << name;
        // Gating leaves out the silence before it.
        EXPECT_NEAR(loudness(name, "pow(10,-23/20)*sin(2*PI*1000*t)", 1)->integrated, -23, 0.3) << name;
    }
    // At a quarter of the rate, an eighth of a turn late, all samples are 3 dB below the peak.
    EXPECT_NEAR(loudness("film.mpg", "0.1*sin(2*PI*12000*t+PI/4)", 0)->true_peak, -20, 0.3);
    EXPECT_FALSE(loudness("film.mpg", "0", 0));
}

TEST(Muxer, KnowsItsKindsByTheirEndings) {
    for (const char* name : {"a.mpg", "b.MPG", "c.mpeg", "d.vob", "dir.x/e.ts", "f.m2v", "g.mkv", "h.Mp4"})
        EXPECT_TRUE(av::is_film(name)) << name;
    for (const char* name : {"", "mpg", ".mpg/x", "a.avi", "a.y4m", "a.mpg.tmp", "frames.%04d.png"})
        EXPECT_FALSE(av::is_film(name)) << name;
}

encoder::Settings small() {
    encoder::Settings settings;
    settings.width = 64;
    settings.height = 48;
    settings.rate = core::frame_rate_from("25");
    return settings;
}

/// The message of the error that `action` throws, or empty.
template <class Action>
std::string error_of(Action action) {
    try {
        action();
    } catch (const core::Error& error) {
        return error.what();
    }
    return {};
}

TEST(Muxer, RefusesWhatItCannotWriteBeforeAnythingIsRendered) {
    const Folder folder;
    EXPECT_NE(error_of([&] { av::Muxer(folder / "film.avi", folder / "film.avi", small()); }).find("mpg, mpeg, vob"),
              std::string::npos);
    const std::string nowhere = error_of([&] { av::Muxer(folder / "no/such/film.mpg", "film.mpg", small()); });
    EXPECT_NE(nowhere.find("no/such/film.mpg"), std::string::npos) << nowhere;
}

TEST(Muxer, TakesTheKindFromTheFinalName) {
    const Folder folder;
    const CodedFilm film = coded_film(folder, 64, 48, "25", 3, "-q:v 8");
    av::Muxer muxer(folder / "film.partial", folder / "film.mkv", film.settings);
    for (std::size_t i = 0; i < film.pictures.size(); ++i)
        muxer.write(film.pictures[i].bytes, film.pictures[i].display_number, static_cast<std::int64_t>(i), i == 0);
    muxer.finish();
    EXPECT_EQ(bytes_of(folder / "film.partial").at(0), 0x1a);  // EBML
}

TEST(Muxer, RefusesAFilmThatIsNone) {
    const Folder folder;
    EXPECT_NE(error_of([&] { av::Muxer(folder / "film.mpg", "film.mpg", small()).finish(); }).find("no pictures"),
              std::string::npos);
    const std::vector<std::uint8_t> rubbish{0, 0, 1, 0, 0, 0xb, 0xff, 0xff};
    av::Muxer muxer(folder / "film.ts", "film.ts", small());
    EXPECT_NE(error_of([&] { muxer.write(rubbish, 0, 0, true); }).find("sequence header"), std::string::npos);
}

TEST(Muxer, SaysThatTheDiskIsFull) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
    const Folder folder;
    const CodedFilm film = coded_film(folder, 64, 48, "25", 50, "-q:v 2");
    for (const char* name : {"film.mpg", "film.ts", "film.m2v", "film.mkv", "film.mp4"}) {
        const std::string message = error_of([&] {
            av::Muxer muxer("/dev/full", name, film.settings);
            for (std::size_t i = 0; i < film.pictures.size(); ++i)
                muxer.write(film.pictures[i].bytes, film.pictures[i].display_number, static_cast<std::int64_t>(i),
                            film.pictures[i].starts_gop);
            muxer.finish();
        });
        EXPECT_NE(message.find("/dev/full"), std::string::npos) << name << ": " << message;
        EXPECT_NE(message.find("No space left"), std::string::npos) << name << ": " << message;
    }
}

TEST(Muxer, AFilmThatIsGivenUpHarmsNothing) {
    const Folder folder;
    const CodedFilm film = coded_film(folder, 64, 48, "25", 5, "-q:v 2");
    for (const char* ending : {"mpg", "ts", "m2v", "mkv", "mp4"}) {
        av::Muxer muxer(folder / "film", std::string("film.") + ending, film.settings);
        muxer.write(film.pictures[0].bytes, 0, 0, true);
    }
}

}  // namespace
}  // namespace render2mpeg::test
