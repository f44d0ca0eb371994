#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/program.h"

/// What the tests of whole runs share: the program, folders, frames of other renderers, what foreign tools say of
/// films.
namespace render2mpeg::test {

using nlohmann::json;
using support::contents;
using support::film;
using support::Folder;
using support::plain_film;
using support::program;
using support::run;

inline std::string path(const Folder& folder, const std::string& name) {
    return (folder / name).string();
}

/// Frames as another renderer might hand them over: a texture that slides, with some noise in it, so that they cost
/// bits. `shape`: the header's A, or nothing.
inline void write_frames(const std::string& file, int width, int height, const std::string& rate,
                         const std::string& shape, int frames) {
    std::ofstream stream(file, std::ios::binary);
    stream << "YUV4MPEG2 W" << width << " H" << height << " F" << rate << " Ip" << (shape.empty() ? "" : " A") << shape
           << " C420mpeg2\n";
    std::vector<double> across(static_cast<std::size_t>(width)), down;
    for (int y = 0; y < height; ++y) down.push_back(std::sin(0.11 * y));
    for (int n = 0; n < frames; ++n) {
        stream << "FRAME\n";
        for (int x = 0; x < width; ++x) across[static_cast<std::size_t>(x)] = 60 * std::sin(0.13 * (x + 3 * n));
        std::string plane(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), '\0');
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const unsigned mixed = (static_cast<unsigned>(x * 7919 + y * 104729 + n * 31) * 2654435761u) >> 28;
                plane[static_cast<std::size_t>(y * width + x)] = static_cast<char>(
                    110 + std::lround(across[static_cast<std::size_t>(x)] * down[static_cast<std::size_t>(y)]) +
                    static_cast<long>(mixed));
            }
        stream << plane << std::string(static_cast<std::size_t>((width + 1) / 2 * ((height + 1) / 2) * 2), '\x80');
    }
}

/// Types of a film's pictures in display order, from the statistics of its making.
inline std::string types_in(const std::filesystem::path& file) {
    const json statistics = json::parse(contents(file));
    std::string all;
    for (const json& frame : statistics.at("per_frame")) all += frame.at("type").get<std::string>();
    return all;
}

/// RGB code values of a film's first picture, or of a still.
inline std::string codes_of(const std::string& file) {
    return run("ffmpeg -v error -i " + file + " -frames:v 1 -f rawvideo -pix_fmt rgb24 -sws_flags accurate_rnd -")
        .output;
}

/// What mediainfo says of the film's picture track.
inline json mediainfo(const std::string& file) {
    const auto outcome = run("mediainfo --Output=JSON " + file);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    const json said = json::parse(outcome.output);
    for (const json& track : said.at("media").at("track"))
        if (track.at("@type") == "Video") return track;
    ADD_FAILURE() << outcome.output;
    return {};
}

/// Expects a page to need nothing but itself: no network, no script of its own file; pictures are in it.
inline void expect_alone(const std::string& page) {
    for (const char* outside : {"http:", "https:", "@import", "url(", "<script src", "<link", "innerHTML"})
        EXPECT_EQ(page.find(outside), std::string::npos) << outside;
}

/// What the scripts of a report's page are given.
inline json page_data(const std::string& page) {
    const std::string begin = "id=\"data\">";
    const std::size_t from = page.find(begin) + begin.size();
    return json::parse(page.substr(from, page.find("</script>", from) - from));
}

inline json ffprobe(const std::string& file) {
    const auto outcome = run("ffprobe -v error -of json -show_streams -count_frames -select_streams v " + file);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return json::parse(outcome.output).at("streams").at(0);
}

}  // namespace render2mpeg::test
