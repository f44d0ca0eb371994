#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "pipeline/fixture.h"

/// Sound in films, as foreign players hear it.
namespace render2mpeg::test {
namespace {

using support::Outcome;

/// Mono at 44.1 kHz: clicks of 10 ms at these seconds.
void write_clicks(const std::filesystem::path& file, const std::vector<double>& at, double seconds) {
    constexpr int rate = 44100;
    std::vector<std::int16_t> samples(static_cast<std::size_t>(seconds * rate));
    for (const double begin : at)
        for (int k = 0; k < rate / 100; ++k)
            samples[static_cast<std::size_t>(begin * rate) + static_cast<std::size_t>(k)] =
                static_cast<std::int16_t>(30000 * std::sin(0.14 * k));
    const auto bytes = static_cast<std::uint32_t>(2 * samples.size());
    const std::uint32_t header[11] = {0x46464952, 36 + bytes, 0x45564157, 0x20746d66, 16,   0x00010001,
                                      rate,       2 * rate,   0x00100002, 0x61746164, bytes};
    std::ofstream stream(file, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(header), sizeof header);
    stream.write(reinterpret_cast<const char*>(samples.data()), static_cast<std::streamsize>(bytes));
}

std::string render_words(const std::string& more) {
    return program() + " render -y --hold " + plain_film() +
           " --size 32x32 --samples 1 --vpls 0 --exposure 0 --tolerance fixed=10% --quiet " + more;
}

double first_time(const std::string& film, const char* stream) {
    const Outcome told =
        run("ffprobe -v error -select_streams " + std::string(stream) + " -show_entries packet=pts_time -of csv=p=0 '" +
            film + "' | grep -v N/A | sort -n | head -1");
    return std::atof(told.output.c_str());
}

/// Seconds of the film at which something begins to sound.
std::vector<double> heard(const std::string& film, const Folder& folder) {
    const std::string raw = path(folder, "heard.raw");
    const Outcome decoded = run("ffmpeg -v error -y -i '" + film + "' -map 0:a -f s16le -ac 1 -ar 48000 '" + raw + "'");
    EXPECT_EQ(decoded.status, 0) << decoded.output;
    const std::string bytes = contents(raw);
    // Containers with edit lists leave out what the encoder began with; others play it before the film.
    const bool cut = film.ends_with(".mp4");
    const double begin = cut ? 0 : first_time(film, "a") - first_time(film, "v");
    std::vector<double> times;
    std::size_t last = 0;
    for (std::size_t k = 0; k + 1 < bytes.size(); k += 2) {
        std::int16_t sample = 0;
        std::memcpy(&sample, bytes.data() + k, sizeof sample);
        if (std::abs(static_cast<int>(sample)) < 3000) continue;
        if (times.empty() || k - last > 20000) times.push_back(begin + static_cast<double>(k / 2) / 48000);
        last = k;
    }
    return times;
}

class SoundOf : public testing::TestWithParam<const char*> {};

TEST_P(SoundOf, FilmsOfEveryKindIsInTimeWithThePictures) {
    const Folder folder;
    write_clicks(folder / "clicks.wav", {0.2, 0.6, 1.4}, 2);
    const std::string film = path(folder, std::string("film") + GetParam());
    // 1.6 s from frame 5 on: what sounds before is cut off.
    const Outcome made =
        run(render_words("--frames 10:34 --audio-offset 0.1 --audio " + path(folder, "clicks.wav") + " -o " + film));
    ASSERT_EQ(made.status, 0) << made.output;
    const std::vector<double> times = heard(film, folder);
    ASSERT_EQ(times.size(), 1u) << "0.3 is before the film, and 1.5 after its end at 1.4";
    EXPECT_NEAR(times[0], 0.7 - 0.4, 0.02) << "within half a frame";
    EXPECT_EQ(run(render_words("--frames 10:34 --audio-offset 0.1 --audio " + path(folder, "clicks.wav") + " -o " +
                               path(folder, std::string("again") + GetParam())))
                  .status,
              0);
    EXPECT_TRUE(contents(film) == contents(folder / (std::string("again") + GetParam()))) << "the same bytes";
}

constexpr auto ending_of = [](const auto& kind) { return std::string(kind.param).substr(1); };
INSTANTIATE_TEST_SUITE_P(Sound, SoundOf, testing::Values(".mpg"), ending_of);
INSTANTIATE_TEST_SUITE_P(SoundSlow, SoundOf, testing::Values(".ts", ".vob", ".mkv", ".mp4"), ending_of);

TEST(Sound, OfADvdIsAc3Slow) {
    const Folder folder;
    write_clicks(folder / "clicks.wav", {0.2}, 1);
    const std::string film = path(folder, "film.vob");
    ASSERT_EQ(run(program() + " render -y --hold " + plain_film() +
                  " --for dvd-pal --frames 0:2 --samples 1 --edge-samples 1 --vpls 0 --exposure 0" +
                  " --tolerance fixed=10% --quiet --audio " + path(folder, "clicks.wav") + " -o " + film)
                  .status,
              0);
    const Outcome told = run("ffprobe -v error -select_streams a -show_entries stream=codec_name -of csv=p=0 " + film);
    EXPECT_NE(told.output.find("ac3"), std::string::npos) << told.output;
}

TEST(Sound, ThatCannotBeIsRefusedInALineBeforeAnythingIsRendered) {
    const Folder folder;
    write_clicks(folder / "clicks.wav", {0.2}, 1);
    std::ofstream(folder / "text.wav") << "no sound";
    const std::pair<std::string, std::string> wrong[] = {
        {"--audio " + path(folder, "none.wav") + " -o " + path(folder, "f.mpg"), "there is no such file"},
        {"--audio " + path(folder, "text.wav") + " -o " + path(folder, "f.mpg"), "text.wav"},
        {"--audio " + path(folder, "clicks.wav") + " -o " + path(folder, "f.m2v"), "has no sound"}};
    for (const auto& [words, reason] : wrong) {
        const Outcome said = run(render_words(words));
        EXPECT_EQ(said.status, 1) << words;
        EXPECT_NE(said.output.find(reason), std::string::npos) << said.output;
        EXPECT_EQ(std::count(said.output.begin(), said.output.end(), '\n'), 1) << said.output;
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "f.mpg"));
}

}  // namespace
}  // namespace render2mpeg::test
