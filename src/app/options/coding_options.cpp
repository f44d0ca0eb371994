#include "app/options/coding_options.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "app/options/film.h"
#include "app/options/option_text.h"
#include "app/options/output_kind.h"
#include "app/options/rate_options.h"
#include "app/options/shape.h"
#include "core/isa.h"
#include "core/rational.h"
#include "core/text.h"

namespace render2mpeg::app {

Values one_of(const std::vector<std::string>& words) {
    const auto check = [words](std::string& text) {
        if (std::find(words.begin(), words.end(), text) != words.end()) return std::string();
        return fmt::format("{}: expected {}{}", text, fmt::join(words, ", "), core::did_you_mean(text, words));
    };
    return {fmt::format("{}", fmt::join(words, "|")), CLI::Validator(check, "")};
}

void add_coding_options(CLI::App& command, CodingOptions& options) {
    const std::string coding = "Coding";
    add_option(command, coding, "--for", options.preset,
               "Where the film goes: dvd-ntsc, dvd-pal or atsc. Sets size, rate, shape, GOPs, rates and buffer "
               "(docs/coding.md); options that contradict are refused",
               "WORLD", one_of(preset_names()));
    add_option(command, coding, "-q,--quantiser", options.quantiser,
               "quantiser_scale_code of P pictures: 1 is the finest, 31 the coarsest; what many pictures follow from\n"
               "is a little finer, B pictures are coarser. Other codecs code to about the same quality",
               range(1, 31))
        ->default_str("4");
    add_option(command, coding, "--codec", options.codec,
               "`mpeg2`, `h264`, `hevc` or `av1` (default: h264 in .mp4, .mov and .mkv, else mpeg2)",
               Values{"CODEC", one_of({"mpeg2", "h264", "hevc", "av1", "h265"}).check});
    add_option(command, coding, "--crf", options.crf,
               "Instead of --quantiser: QP of P pictures in the codec's own scale, 1 to 51 in H.264 and HEVC, to 63 in "
               "AV1; 26, 26 and 33 are like quantiser 4",
               range(1, 63), "QP");
    add_rate_options(command, options);
    add_option(command, coding, "--gop", options.gop,
               "Pictures per closed group of pictures; with --for, its world's where not given", range(1, 1000))
        ->default_str(std::to_string(usual_gop));
    add_option(command, coding, "--b-pictures", options.b_pictures,
               "Most B pictures in a row, fewer where motion is uneven; with --for, its world's where not given",
               range(0, 3))
        ->default_str("3");
    add_option(command, coding, "--tune", options.tune,
               "What is kept: `psnr`, all detail alike; `perceptual`, more of what the eye sees",
               one_of({"psnr", "perceptual"}), shown);
    add_option(command, coding, "--encoder", options.encoder, "How much is tried: `fast`, or `quality` for fewer bits",
               one_of({"fast", "quality"}), shown);
    add_option(command, coding, "--keyframes", options.keyframes,
               "Frames that begin a group of pictures whatever is seen: 0,48,96, or a file with their numbers",
               "LIST|FILE", keyframes_from);
}

void add_as_option(CLI::App& command, std::optional<std::string>& as, const std::vector<std::string>& kinds) {
    const Values values = one_of(kinds);
    command
        .add_option("--as", as,
                    "With -o -: what goes to standard output, picture by picture as it is made: a transport stream, "
                    "bare MPEG-2" +
                        std::string(kinds.back() == "y4m" ? ", or uncompressed pictures" : "") + " (default: ts)")
        ->type_name(values.names)
        ->check(values.check);
}

void add_sound_options(CLI::App& command, CodingOptions& options) {
    const std::string sound = "Sound";
    add_option(command, sound, "--audio", options.audio,
               "Sound of the film: whatever FFmpeg reads, or `none` (default: the scene's). MPEG audio layer II in "
               ".mpg, .vob and .ts, AC-3 with --for, AAC in .mkv, .mp4 and .mov; it ends with the film",
               "FILE|none");
    add_option(command, sound, "--audio-offset", options.audio_offset,
               "Seconds after frame 0 at which the sound begins; below 0 its beginning is cut off", "SECONDS",
               range(-1e5, 1e5), shown);
}

void add_threads_option(CLI::App& command, int& threads) {
    add_option(command, "Run", "-j,--threads", threads,
               "Threads; 0: one per core. The film's bytes do not depend on it", range(0, 1024), shown);
}

void add_isa_option(CLI::App& command, std::optional<std::string>& isa) {
    add_option(command, "Run", "--isa", isa,
               "Instruction set (default: the best there is). Films differ in a few roundings between them",
               "sse2|sse4.2|avx|avx2|avx512", core::isa_from);
}

void add_consent_option(CLI::App& command, bool& overwrite) {
    add_flag(command, "Run", "-y,--overwrite", overwrite,
             "Replace a film that is there, and make folders that are missing; without it both are refused");
}

void add_within_option(CLI::App& command, std::string& within, const std::string& group) {
    add_option(command, group, "--within", within,
               "Light a few frames for so long, about, to tell what the film will take; 0: light none", "TIME",
               within_from, shown);
}

void add_shape_options(CLI::App& command, CodingOptions& options) {
    const std::string picture = "Picture and time";
    CLI::Option* display =
        add_option(command, picture, "--display-aspect", options.display_aspect,
                   "Shape of the whole picture as shown, e.g. 16:9 (default: as the animation file or the frames "
                   "say, else of square pixels)",
                   "W:H", core::ratio_from);
    add_option(command, picture, "--pixel-aspect", options.pixel_aspect, "Shape of a pixel instead, e.g. 16:15", "W:H",
               core::ratio_from)
        ->excludes(display);
}

}  // namespace render2mpeg::app
