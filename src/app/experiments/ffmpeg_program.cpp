#include "app/experiments/ffmpeg_program.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <sstream>

#include "app/system/program.h"
#include "core/error.h"
#include "encoder/av/av.h"
#include "encoder/av/inspect.h"
#include "encoder/av/y4m.h"

namespace render2mpeg::app {
namespace {

std::vector<std::string> words_of(const std::string& text) {
    std::istringstream split(text);
    return {std::istream_iterator<std::string>(split), {}};
}

std::string first_line(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

double seconds_of(const std::vector<std::string>& words) {
    const Finished finished = run_program(words, Output::caught);
    if (finished.status != 0)
        throw core::Error("running", "ffmpeg",
                          finished.text.empty() ? "it failed without a word" : first_line(finished.text));
    return finished.seconds;
}

/// A temporary folder, removed with the object.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "render2mpeg-XXXXXX").string();
        if (mkdtemp(pattern.data()) == nullptr) throw core::Error("making", pattern, std::strerror(errno));
        path_ = pattern;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::string file(const char* name) const { return (path_ / name).string(); }

  private:
    std::filesystem::path path_;
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
        text.replace(at, what.size(), by);
    return text;
}

constexpr const char* strongest =
    "-b:v 400M -lmin {L} -lmax {L} -qmin 1 -qmax 31 -qcomp 0.6 -i_qfactor 0.8 -i_qoffset 0 -b_qfactor 1.5 "
    "-b_qoffset 0 -mbd rd -trellis 2 -mpv_flags +skip_rd+mv0 -mbcmp rd -subcmp satd -dia_size 770 -pre_dia_size 4 "
    "-mepre 2 -last_pred 3 -g {g} -bf 3 -b_strategy 2";

std::string library_of(encoder::Codec codec) {
    if (codec == encoder::Codec::h264) return "libx264";
    return codec == encoder::Codec::hevc ? "libx265" : "libsvtav1";
}

std::string by_crf(encoder::Codec codec, bool strongest) {
    if (codec == encoder::Codec::av1) return std::string("-preset ") + (strongest ? "3" : "8") + " -crf {q}";
    return std::string("-preset ") + (strongest ? "slower -tune psnr" : "medium") +
           " -crf {q} -bsf:v filter_units=remove_types=" + (codec == encoder::Codec::h264 ? "6" : "39");
}

/// ffmpeg's number of about the same quality.
int number_for(const FfmpegWay& way, int quantiser) {
    // Theirs are means, ours of P pictures that nothing follows from: 3 coarser, about (docs/measurements.md#codecs).
    const bool by_crf = way.encoder == "libx264" || way.encoder == "libx265";
    return by_crf ? std::max(1, quantiser - 3) : quantiser;
}

}  // namespace

std::string ffmpeg_version() {
    const Finished finished = run_program({"ffmpeg", "-version"}, Output::caught);
    if (finished.status != 0)
        throw core::Error("running", "ffmpeg", "there is no such program; its package is called ffmpeg");
    return first_line(finished.text);
}

FfmpegWay usual_ffmpeg(encoder::Codec codec) {
    if (codec != encoder::Codec::mpeg2) return {"ffmpeg", by_crf(codec, false) + " -g {g}", library_of(codec)};
    return {"ffmpeg", "-qscale:v {q} -g {g} -bf 2"};
}

FfmpegWay strongest_ffmpeg(encoder::Codec codec) {
    if (codec != encoder::Codec::mpeg2)
        return {"ffmpeg, strongest", by_crf(codec, true) + " -g {g}", library_of(codec)};
    return {"ffmpeg, strongest", strongest};
}

std::string options_of(const FfmpegWay& way, int quantiser, int gop) {
    return replaced(replaced(replaced(way.options, "{q}", std::to_string(number_for(way, quantiser))), "{L}",
                             std::to_string(118 * quantiser)),
                    "{g}", std::to_string(gop));
}

Trials::Codec ffmpeg_codec(const FfmpegWay& way, int quantiser, int gop, const core::FrameRate& rate) {
    const std::string options = options_of(way, quantiser, gop);
    const std::string encoder = way.encoder;
    return [options, encoder, rate](const Chunk& window, const std::vector<const core::Picture*>& pictures,
                                    const std::function<void(const core::Picture&)>& decoded) {
        const TemporaryFolder folder;
        const std::string frames = folder.file("frames.y4m"),
                          stream = folder.file(encoder == "mpeg2video" ? "coded.m2v" : "coded.mkv");
        av::Y4mWriter writer(frames, pictures.front()->width(), pictures.front()->height(), rate);
        for (const core::Picture* picture : pictures) writer.write(*picture);
        writer.finish();

        // Code, and time reading alone.
        std::vector<std::string> reading = words_of("ffmpeg -v error -nostdin -y -threads 1 -filter_threads 1 -i");
        reading.push_back(frames);
        std::vector<std::string> coding = reading, nothing = reading;
        for (const std::string& word : words_of("-c:v " + encoder + " -threads 1 " + options)) coding.push_back(word);
        coding.push_back(stream);
        for (const char* word : {"-f", "null", "-"}) nothing.emplace_back(word);
        Trials::Coded coded;
        coded.seconds = std::max(0.0, seconds_of(coding) - seconds_of(nothing));
        for (const av::PictureFacts& picture : av::inspect(stream).pictures)
            coded.bytes += static_cast<double>(picture.bytes);

        std::int64_t count = 0;
        av::decode(stream, [&](const core::Picture& picture) {
            ++count;
            if (picture.number < window.frames()) decoded(picture);
        });
        if (count != window.frames())
            throw core::Error("decoding", "what ffmpeg coded",
                              std::to_string(count) + " pictures of " + std::to_string(window.frames()));
        return coded;
    };
}

}  // namespace render2mpeg::app
