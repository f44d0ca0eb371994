#include "app/options/mistakes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <map>
#include <system_error>

#include "app/options/usage_error.h"
#include "core/scene_formats.h"
#include "core/text.h"

namespace render2mpeg::app {
namespace {

bool is_option_word(const std::string& word) {
    return word.size() > 1 && word[0] == '-' && word != "--" &&
           std::isdigit(static_cast<unsigned char>(word[1])) == 0 && word[1] != '.';
}

std::vector<const CLI::App*> commands_in(const CLI::App& program) {
    return program.get_subcommands([](const CLI::App*) { return true; });
}

/// "--size" and "-s" of all options of a command.
std::vector<std::string> names_of(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
    return names;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
}

/// Options of other programs, by what is said here instead; no word of ours is near in meaning.
struct Elsewhere {
    std::string_view names;  ///< between spaces
    const char* advice;
};
constexpr Elsewhere elsewhere[]{
    {"denoise denoiser noise-threshold", "no picture has noise to be removed: --tolerance says how exact light is"},
    {"gpu device cuda optix hip devices", "light is found by processors alone; --threads says by how many"},
    {"fov lens focal-length", "a lens is its camera's: --camera chooses one, and an animation file says its `fov`"},
    {"start end first last frame-start frame-end from to", "which frames is said by --frames A:B"},
    {"width height resolution res", "the size is said by --size WxH"},
    {"spp passes-per-pixel", "--samples is for edges and textures, --tolerance for light"},
    {"target-size file-size size-limit", "the file's size is --max-size of `tune`"},
    {"crop region border", "the whole picture is rendered"}};

std::string advice_from_elsewhere(const std::string& bare) {
    for (const Elsewhere& known : elsewhere)
        for (const std::string_view name : core::words_in(known.names))
            if (name == bare) return std::string("; ") + known.advice;
    return {};
}

/// Explains an unknown option.
std::string advice_for(const CLI::App& program, const CLI::App& command, const std::string& name) {
    const std::string here = ": `" + command.get_name() + "` has no such option";
    const std::vector<std::string> names = names_of(command);
    // One hyphen too few: "-size".
    if (name.size() > 2 && name[1] != '-' && has(names, "-" + name)) return here + "; did you mean -" + name + "?";
    std::vector<std::string> others;
    for (const CLI::App* other : commands_in(program))
        if (other != &command && has(names_of(*other), name)) others.push_back(other->get_name());
    // Compare without hyphens.
    std::vector<std::string> long_names;
    for (const std::string& other : names)
        if (other.starts_with("--")) long_names.push_back(other.substr(2));
    const std::string bare =
        name.substr(name.find_first_not_of('-') == std::string::npos ? name.size() : name.find_first_not_of('-'));
    const std::string known = advice_from_elsewhere(bare),
                      meant = known.empty() ? core::did_you_mean(bare, long_names, "--") : known;
    if (others.empty()) return here + meant;
    return fmt::format("{}, `{}`", here, fmt::join(others, "`, `")) + (others.size() == 1 ? " has" : " have") + meant;
}

std::string help_of(const std::string& command) {
    return " (see render2mpeg " + (command.empty() ? "" : command + " ") + "--help)";
}

/// Message of a check, its noun replaced by the option's name.
std::string checked_text(const std::string& name, const std::string& value, const std::string& said) {
    const std::size_t at = value.empty() ? std::string::npos : said.find(value);
    if (at == std::string::npos) return name + ": " + said;
    return name + " " + said.substr(at);
}

const CLI::Option* option_named(const CLI::App& command, const std::string& name) {
    for (const CLI::Option* option : command.get_options())
        if (option->check_name(name)) return option;
    return nullptr;
}

/// Explains a missing positional or required option.
std::string missing_text(const CLI::App& app, const std::string& name) {
    const std::string& command = app.get_name();
    if (name == "INPUT")
        return "INPUT is missing: which scene? For example: render2mpeg " + command + " scene.glb" +
               (command == "render" ? " -o film.mpg"
                : command == "tune" ? " --target-psnr 40 -o film.mpg"
                                    : "");
    if (name == "FRAMES")
        return "FRAMES is missing: which frames? For example: render2mpeg encode frames.%04d.png -o film.mpg";
    if (name == "FILE") return "FILE is missing: which film? For example: render2mpeg info film.mpg";
    if (name == "PLAN")
        return "PLAN is missing: the folder that `farm` wrote. For example: render2mpeg " + command + " film.mpg.farm" +
               (command == "part" ? " 1" : "");
    if (name == "I") return "I is missing: which part, from 1? For example: render2mpeg part film.mpg.farm 1";
    if (name == "--output" || name == "-o") return "-o is missing: which film is to be made? For example: -o film.mpg";
    const CLI::Option* option = option_named(app, name);
    return name + " is missing" +
           (option == nullptr || option->get_type_name().empty() ? "" : "; give one of " + option->get_type_name());
}

/// A case in which options are idle, and its reason.
struct IdleCase {
    Idle idle;
    bool is_here;
    std::string reason;
};

std::vector<std::string> notes(const std::map<std::string, std::string>& said, const std::vector<IdleCase>& cases) {
    std::vector<std::string> lines;
    for (const IdleCase& one : cases)
        if (const auto found = said_and(one.idle, said); one.is_here && !found.empty())
            lines.push_back(fmt::format("{} {} nothing here: {}", fmt::join(found, ", "),
                                        found.size() == 1 ? "does" : "do", one.reason));
    return lines;
}

constexpr std::array films{".mpg", ".mpeg", ".vob", ".ts",   ".m2v", ".mkv", ".mp4", ".mov",
                           ".avi", ".webm", ".wmv", ".m2ts", ".gif", ".y4m", ".ogv", ".flv"};
constexpr std::array pictures{".png",  ".exr", ".jpg", ".jpeg", ".tif", ".tiff",
                              ".webp", ".bmp", ".tga", ".hdr",  ".psd"};
constexpr std::array sounds{".wav", ".mp3", ".flac", ".ogg", ".aac", ".m4a"};
constexpr const char* kinds =
    "scenes are .blend, .glb, .gltf, .usd, .abc, .fbx, .obj and others, or animation files (.json)";

template <class Endings>
bool is_one_of(const Endings& endings, const std::filesystem::path& file) {
    return std::ranges::find(endings, core::ending_of(file)) != endings.end();
}

/// Whether it is a scene by its ending; not an animation file.
bool is_scene(const std::filesystem::path& file) {
    const std::string ending = core::ending_of(file);
    return std::ranges::any_of(core::scene_formats,
                               [&](const auto& format) { return ending == format.ending && ending != ".json"; });
}

std::string of_folder(const std::filesystem::path& folder) {
    std::error_code error;
    if (std::filesystem::exists(folder / "film.json", error)) return {};
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
        if (is_scene(entry.path())) found.push_back(entry.path().filename().string());
    std::ranges::sort(found);
    if (found.empty()) return std::string("this folder holds neither a film.json nor a scene; ") + kinds;
    return "this folder holds no film.json; give one of its scenes, such as " + (folder / found.front()).string();
}

}  // namespace

void refuse_unknown_options(const CLI::App& program, const CLI::App& command, const std::vector<std::string>& words) {
    const std::vector<std::string> names = names_of(command);
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i] == "--") return;
        if (words[i].empty()) throw UsageError("a word of the command is empty; is a variable of the shell unset?");
        if (!is_option_word(words[i])) continue;
        const std::string name = words[i].substr(0, words[i].find('='));
        // "-q4": the value behind a short name.
        const bool attached = name[1] != '-' && has(names, name.substr(0, 2)) && !has(names, "-" + name);
        if (!has(names, name) && !attached)
            throw UsageError(name + advice_for(program, command, name) + help_of(command.get_name()));
        if (name != words[i])
            for (const CLI::Option* option : command.get_options())
                if (option->check_name(name) && option->get_expected_max() == 0)
                    throw UsageError(words[i] + ": " + name + " takes no value" + help_of(command.get_name()));
        if ((name == "--heatmap" || name == "--also") &&
            (i + 2 >= words.size() || is_option_word(words[i + 1]) || is_option_word(words[i + 2])))
            throw UsageError(name + (i + 1 < words.size() && !is_option_word(words[i + 1]) ? " " + words[i + 1] : "") +
                             ": expected what to show and a file, e.g. " +
                             (name == "--also" ? "--also pq film_hdr.mp4" : "--heatmap tolerance heat.mpg") +
                             help_of(command.get_name()));
    }
}

void refuse_unknown_command(const CLI::App& program, const std::vector<std::string>& words) {
    std::vector<std::string> names;
    std::string all;
    for (const CLI::App* command : commands_in(program)) {
        names.push_back(command->get_name());
        all += (all.empty() ? "" : ", ") + command->get_name();
    }
    if (words.empty()) throw UsageError("which command? There are " + all + help_of(""));
    const std::string& word = words.front();
    if (has(names, word) || word == "-h" || word == "--help" || word == "--version") return;
    if (is_option_word(word)) throw UsageError(word + ": the command comes first; there are " + all + help_of(""));
    std::error_code error;
    if (std::filesystem::exists(word, error))
        throw UsageError(word + " is no command; to render it: render2mpeg render " + word + " -o film.mpg");
    const std::string meant = core::did_you_mean(word, names);
    throw UsageError(word + " is no command" + (meant.empty() ? "; there are " : meant + " There are ") + all +
                     help_of(""));
}

std::string mistake_text(const CLI::App& command, const CLI::Error& error) {
    const std::string kind = error.get_name(), help = help_of(command.get_name());
    std::string text = error.what();
    std::ranges::replace(text, '\n', ' ');
    const std::string first = text.substr(0, text.find(' ')), last = text.substr(text.rfind(' ') + 1);
    const bool is_extra = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
    if (is_extra || kind == "RequiredError") {
        std::string extra;
        for (const std::string& word : command.remaining(true)) extra += (extra.empty() ? "" : " ") + word;
        if (command.get_name() == "encode" && !extra.empty() && (is_extra || first == "--output"))
            return extra + ": frames go by one name with a number in it, e.g. frames.%04d.png, and the film by -o" +
                   help;
        if (!is_extra) return missing_text(command, first) + help;
        std::error_code failure;
        if (command.get_name() == "render" && command.remaining(true).size() == 1 &&
            !std::filesystem::exists(extra, failure))
            return extra + ": a scene goes without an option, and the film by -o: -o " + extra + help;
        return extra + ": what is this for? Only one name goes without an option" + help;
    }
    if (kind == "ExcludesError") return first + " and " + last + " contradict each other: give one" + help;
    // "Could not convert: --name = value"
    if (kind == "ConversionError" && text.starts_with("Could not convert: ")) {
        const std::size_t equals = text.find(" = ");
        const std::string given = text.substr(text.find("--"), equals - text.find("--"));
        return given + " " + text.substr(std::min(equals + 3, text.size())) + ": expected a number" + help;
    }
    const std::size_t colon = text.find(": ");
    const std::string name = text.substr(0, colon);
    const CLI::Option* option = option_named(command, name);
    if (option == nullptr) return text + help;
    const std::string said = text.substr(colon + 2), value = CLI::detail::join(option->results(), " ");
    if (said.ends_with(" missing"))
        return name + ": its value is missing" +
               (option->get_type_name().empty() ? "" : ", " + option->get_type_name()) + help;
    if (said.starts_with("At Most")) return name + " is said more than once: " + value + "; give one" + help;
    return checked_text(name, value, said) + help;
}

std::vector<std::string> unused_options(const RenderOptions& options, OutputKind kind,
                                        const ToleranceRequest& tolerance, bool preview) {
    const std::string output = options.output.filename().string(), own = output + " holds the scene's own light";
    const bool exr = kind == OutputKind::exr;
    return notes(
        options.said,
        {{Idle::uncoded, kind != OutputKind::film, output + " is not coded"},
         // With a tolerance, the exposure tells which pixels are too dark to matter.
         {Idle::unexposed, exr && (tolerance.reference || tolerance.relative == 0),
          own + ", and no light is too dark for this tolerance"},
         {Idle::undeveloped, exr, own},
         {Idle::traced, tolerance.truth.has_value(), "paths over the whole pixel bring its light"},
         {Idle::without_points, options.vpls > 0 && !preview && (options.indirect == "rays" || tolerance.truth),
          std::string(tolerance.truth ? "paths" : "rays") + " bring bounced light"},
         {Idle::uncoupled, !tolerance.coupled, "the tolerance is not coupled to the film's coding"}});
}

std::vector<std::string> unused_options(const EncodeOptions& options) {
    return notes(options.said, {{Idle::without_vectors, !options.motion, "there is no --motion"}});
}

std::string unused_keyframes(const Keyframes& keyframes, const FrameRange& frames) {
    const auto outside = std::ranges::count_if(
        keyframes.frames, [&](std::int64_t frame) { return frame < frames.first || frame > frames.last; });
    if (outside == 0) return {};
    return fmt::format("--keyframes: {} of {} {} no frame{} of the film, which has {} to {}", outside,
                       keyframes.frames.size(), outside == 1 ? "is" : "are", outside == 1 ? "" : "s", frames.first,
                       frames.last);
}

std::string keyframes_without_chapter(const Film& film) {
    if (!film.disc) return {};
    // libavformat begins a unit with a GOP this many seconds after the one before (docs/coding.md).
    const double apart = 0.4 * film.coding.rate.hertz.value();
    std::vector<std::int64_t> lost;
    std::int64_t unit = film.frames.first, gop = film.frames.first;
    for (const Chunk& chunk : chunks_of(film.frames, film.coding.gop))
        for (std::int64_t n = chunk.first; n <= chunk.last; ++n) {
            const bool keyframe = film.keyframes.begins_at(n);
            if (n != chunk.first && !keyframe && n - gop < film.coding.gop) continue;
            gop = n;
            if (n == film.frames.first) continue;
            const bool begins_unit = static_cast<double>(n - unit) >= apart;
            if (begins_unit) unit = n;
            if (keyframe && !begins_unit) lost.push_back(n);
        }
    if (lost.empty()) return {};
    return fmt::format("--keyframes: no chapter can begin at {}: a group of pictures begins less than 0.4 s before",
                       fmt::join(lost, ", "));
}

std::string not_a_scene(const std::filesystem::path& file) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) return of_folder(file);
    if (!std::filesystem::is_regular_file(file, error)) return "it is a pipe or a device; scenes are read from files";
    if (is_one_of(films, file)) return std::string("it is a film already; ") + kinds;
    if (is_one_of(pictures, file))
        return "it is a picture, not a scene; `encode frames.%04d.png -o film.mpg` makes a film of pictures";
    if (is_one_of(sounds, file)) return "it is sound, not a scene; --audio adds it to a film";
    if (core::ending_of(file) == ".blend1") return "it is Blender's backup; rename it to .blend";
    constexpr std::array others{".txt", ".md", ".py", ".sh", ".html", ".csv", ".pdf", ".zip", ".gz", ".tar", ".mtl"};
    if (is_one_of(others, file)) return std::string("it is no scene; ") + kinds;
    return {};
}

std::string not_frames(const std::filesystem::path& file) {
    if (!is_one_of(films, file))
        return "frames are a .y4m file, or numbered images such as frames.%04d.exr, .png, .tif or .jpg";
    return "it is coded; its pictures come by `ffmpeg -i " + quoted(file.string()) +
           " -f yuv4mpegpipe - | render2mpeg encode - -o new.mpg`";
}

std::string not_a_film(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::exists(file, error)) return "there is no such file";
    if (std::filesystem::is_directory(file, error)) return "it is a folder; give the film in it";
    if (is_scene(file) || core::ending_of(file) == ".json")
        return "it is a scene, not a film; `plan` tells about scenes";
    if (is_one_of(pictures, file)) return "it is a picture, not a film";
    if (core::ending_of(file) == ".y4m") return "its pictures are not coded; `encode` makes a film of them";
    return {};
}

std::string instead_of(const std::filesystem::path& output) {
    const std::string ending = core::ending_of(output);
    if (ending.empty()) return "its name needs an ending, such as " + output.filename().string() + ".mpg";
    if (is_one_of(pictures, output)) return ending + " is not written; of pictures only .png and .exr are";
    if (is_scene(output)) return "it would be a scene; which film is to be made of it? For example -o film.mpg";
    if (is_one_of(sounds, output)) return "it would be sound; --audio adds sound to a film";
    if (is_one_of(films, output)) return ending + " is not written; take .mp4 or .mkv, or .mpg";
    return {};
}

}  // namespace render2mpeg::app
