#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.h"
#include "encoder/av/av.h"
#include "encoder/mpeg2/macroblock/weighting_matrices.h"
#include "encoder_rd/codecs.h"
#include "encoder_rd/ffmpeg_process.h"

namespace render2mpeg::bench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// All that the strongest command of the field has in common, but for its GOPs.
constexpr const char* strongest =
    "-b:v 400M -lmin {L} -lmax {L} -qmin 1 -qmax 31 -qcomp 0.6 -i_qfactor 0.8 -i_qoffset 0 -b_qfactor 1.5 -b_qoffset 0 "
    "-mbd rd -trellis 2 -mpv_flags +skip_rd+mv0 -mbcmp rd -subcmp satd -dia_size 770 -pre_dia_size 4 -mepre 2 "
    "-last_pred 3 ";

Finished run(const std::string& command) {
    std::istringstream split(command);
    return run_program({std::istream_iterator<std::string>(split), {}});
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
        text.replace(at, what.size(), by);
    return text;
}

/// All but the output: one thread, so many of the clip's pictures.
std::string reading(const Clip& clip) {
    return fmt::format("ffmpeg -v error -nostdin -y -threads 1 -filter_threads 1 -i {} -frames:v {}", clip.y4m.string(),
                       clip.pictures.size());
}

std::string coding(const FfmpegCodec& codec, int quantiser) {
    return "-c:v mpeg2video -threads 1 " +
           replaced(replaced(codec.options, "{q}", std::to_string(quantiser)), "{L}", std::to_string(118 * quantiser));
}

/// Bits of the pictures by type, and the type of each picture in display order, from the stream's start codes.
std::vector<int> read_types(const fs::path& file, Measured& measured) {
    std::ifstream in(file, std::ios::binary);
    const std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(in), {}};
    std::vector<int> types;
    std::size_t gop = 0, picture = 0;
    int type = -1;
    const auto close_picture = [&](std::size_t end) {
        if (type >= 0) measured.types[static_cast<std::size_t>(type)].bits += 8.0 * static_cast<double>(end - picture);
        picture = end;
        type = -1;
    };
    for (std::size_t i = 0; i + 5 < bytes.size(); ++i) {
        if (bytes[i] != 0 || bytes[i + 1] != 0 || bytes[i + 2] != 1) continue;
        const int code = bytes[i + 3];
        if ((code == 0xb3 || code == 0xb8 || code == 0x00) && type >= 0) close_picture(i);
        if (code == 0xb8) gop = types.size();
        if (code != 0x00) continue;
        type = ((bytes[i + 5] >> 3) & 7) - 1;
        const std::size_t shown = gop + static_cast<std::size_t>(bytes[i + 4] << 2 | bytes[i + 5] >> 6);
        types.resize(std::max(types.size(), shown + 1));
        types[shown] = type;
    }
    close_picture(bytes.size());
    measured.bits = 8.0 * static_cast<double>(bytes.size());
    return types;
}

json to_json(const Measured& m) {
    json types = json::array();
    for (const TypeShare& t : m.types) types.push_back({t.pictures, t.bits, t.error});
    return {{"pictures", m.pictures}, {"bits", m.bits},       {"psnr_y", m.psnr_y}, {"ssim_y", m.ssim_y},
            {"hvs_m", m.psnr_hvs_m},  {"seconds", m.seconds}, {"types", types}};
}

Measured from_json(const json& j) {
    Measured m;
    m.pictures = j.at("pictures");
    m.bits = j.at("bits");
    m.psnr_y = j.at("psnr_y");
    m.ssim_y = j.at("ssim_y");
    m.psnr_hvs_m = j.at("hvs_m");
    m.seconds = j.at("seconds");
    for (std::size_t i = 0; i < 3; ++i) m.types[i] = {j.at("types")[i][0], j.at("types")[i][1], j.at("types")[i][2]};
    return m;
}

/// Takes what a surplus I picture costs more than a mean P picture off the bits; its quality stays, in ffmpeg's favour.
Measured without_surplus_intra(Measured m, int gop) {
    TypeShare &intra = m.types[0], &predicted = m.types[1];
    if (intra.pictures != 2 + (m.pictures - 1) / gop || predicted.pictures == 0) return m;
    m.bits -=
        intra.bits / static_cast<double>(intra.pictures) - predicted.bits / static_cast<double>(predicted.pictures);
    return m;
}

/// A file's name that stands for the clip, the command and the program.
fs::path kept_as(const Clip& clip, const std::string& command, const fs::path& cache) {
    static const std::string version = run("ffmpeg -version").text;
    ContentHash hash;
    hash.add("measured 1");
    hash.add(clip.content);
    hash.add(command);
    hash.add(version.substr(0, version.find('\n')));
    fs::create_directories(cache / "ffmpeg");
    return cache / "ffmpeg" / (clip.name + "-" + hash.text());
}

double number_after(const std::string& text, const std::string& key) {
    const std::size_t at = text.rfind(key);
    if (at == std::string::npos) throw core::Error("reading what ffmpeg says: no `" + key + "`");
    return std::atof(text.c_str() + at + key.size());
}

/// A matrix as ffmpeg takes it: raster order, by commas.
std::string words_of(const encoder::mpeg2::Matrix& matrix) {
    std::string words;
    for (const std::uint8_t entry : matrix) words += (words.empty() ? "" : ",") + std::to_string(entry);
    return words;
}

}  // namespace

std::vector<FfmpegCodec> ffmpeg_codecs() {
    const encoder::mpeg2::Matrices eye = encoder::mpeg2::matrices_for(encoder::Tune::perceptual);
    const std::string matrices =
        "-intra_matrix " + words_of(eye.intra) + " -inter_matrix " + words_of(eye.non_intra) + " ";
    return {{"A", "-qscale:v {q} -g 15 -bf 2", 15},
            {"B", strongest + std::string("-g 15 -bf 2"), 15},
            {"B-eye", strongest + matrices + "-g 15 -bf 2", 15},
            {"C", strongest + std::string("-g 60 -bf 3 -b_strategy 2"), 60}};
}

Measured code_with_ffmpeg(const Clip& clip, const FfmpegCodec& codec, int quantiser, const fs::path& cache) {
    const std::string options = coding(codec, quantiser);
    const fs::path kept = kept_as(clip, options, cache).replace_extension(".json");
    if (std::ifstream in(kept); in) {
        Measured measured = from_json(json::parse(in));
        measured.quantiser = quantiser;
        return without_surplus_intra(measured, codec.gop);
    }

    // Code, and see what reading alone costs.
    const fs::path stream = kept_as(clip, options, cache).replace_extension(".m2v");
    Measured measured;
    measured.quantiser = quantiser;
    measured.seconds = run(reading(clip) + " " + options + " -f mpeg2video " + stream.string()).seconds;
    measured.seconds -= run(reading(clip) + " -f null -").seconds;

    // Decode and compare.
    const std::vector<int> types = read_types(stream, measured);
    Quality quality;
    av::decode(stream, [&](const core::Picture& decoded) {
        const auto n = static_cast<std::size_t>(decoded.number);
        if (n >= clip.pictures.size() || n >= types.size())
            throw core::Error("decoding", stream.string(), "more pictures than were coded");
        TypeShare& type = measured.types[static_cast<std::size_t>(types[n])];
        ++type.pictures;
        type.error += quality.add(decoded, clip.pictures[n]);
        ++measured.pictures;
    });
    if (measured.pictures != static_cast<std::int64_t>(clip.pictures.size()))
        throw core::Error("decoding", stream.string(), fmt::format("{} pictures", measured.pictures));
    quality.write(measured);
    fs::remove(stream);
    std::ofstream(kept) << to_json(measured);
    return without_surplus_intra(measured, codec.gop);
}

double difference_of_metrics(const Clip& clip, const FfmpegCodec& codec, int quantiser, const fs::path& cache) {
    const Measured ours = code_with_ffmpeg(clip, codec, quantiser, cache);
    const fs::path stream = kept_as(clip, "metrics", cache).replace_extension(".m2v");
    run(reading(clip) + " " + coding(codec, quantiser) + " -f mpeg2video " + stream.string());
    double largest = 0;
    for (const std::string filter : {"psnr", "ssim"}) {
        const std::string text = run(fmt::format("ffmpeg -v info -nostdin -threads 1 -idct simple -r 30 -i {} -r 30 -i "
                                                 "{} -frames:v {} -lavfi {} -f null -",
                                                 stream.string(), clip.y4m.string(), clip.pictures.size(), filter))
                                     .text;
        const double theirs = filter == "psnr" ? number_after(text, " y:") : in_db(number_after(text, "SSIM Y:"));
        largest = std::max(largest, std::abs(theirs - (filter == "psnr" ? ours.psnr_y : in_db(ours.ssim_y))));
    }
    fs::remove(stream);
    return largest;
}

}  // namespace render2mpeg::bench
