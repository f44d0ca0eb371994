#include "scene/blender/export.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <system_error>

#include "core/checksum.h"
#include "core/error.h"
#include "core/module.h"
#include "core/text.h"
#include "scene/isolation/probe.h"

namespace render2mpeg::scene {
namespace {

namespace fs = std::filesystem;

// chosen: most pixels along a side of a baked texture; a screen shows few objects wider (256 blurs floors, 4096 takes a
// minute a material).
constexpr int texture_size = 1024;
/// Exports kept of one .blend: the current one, and the last, which may be being read.
constexpr std::size_t kept_exports = 2;
constexpr const char *result_name = "export.json", *film_name = "film.json", *log_name = "blender.log",
                     *step_name = "step";

bool is_program(const fs::path& file) {
    std::error_code failure;
    return fs::is_regular_file(file, failure) && access(file.c_str(), X_OK) == 0;
}

/// A Python, whose module bpy is Blender.
bool is_python(const fs::path& program) {
    return program.filename().string().starts_with("python");
}

/// State as the script writes it; null without a file.
nlohmann::json state_of(const fs::path& file) {
    struct stat state {};
    if (stat(file.c_str(), &state) != 0) return nullptr;
    return {file.string(), state.st_size, std::int64_t{state.st_mtim.tv_sec} * 1'000'000'000 + state.st_mtim.tv_nsec};
}

/// Tells one Blender from another.
nlohmann::json state_of_blender(const fs::path& program) {
    if (!is_python(program)) return state_of(fs::canonical(program));
    nlohmann::json states{fs::absolute(program).string()};
    std::error_code failure;
    for (const fs::directory_entry& version :
         fs::directory_iterator(program.parent_path().parent_path() / "lib", failure))
        states.push_back(state_of(version.path() / "site-packages" / "bpy"));
    return states;
}

/// Key of an export's inputs.
std::string name_of(const fs::path& blend, const fs::path& script, const fs::path& blender, const ExportWish& wish) {
    core::Checksum sum;
    sum.add_file(blend);
    std::vector<fs::path> parts{script};
    for (const fs::directory_entry& entry : fs::directory_iterator(script.parent_path() / "film_export"))
        if (entry.path().extension() == ".py") parts.push_back(entry.path());
    std::sort(parts.begin(), parts.end());
    for (const fs::path& part : parts) sum.add_file(part);
    sum.add(state_of_blender(blender).dump() + std::to_string(texture_size) + "," + std::to_string(wish.lines) +
            (wish.last_frame ? "," + std::to_string(*wish.last_frame) : ""));
    return core::checksum_text(sum.value());
}

/// Folder of a .blend's exports: beside it, else in the user's cache.
fs::path cache_of(const fs::path& blend) {
    std::error_code failure;
    const fs::path beside = blend.string() + ".export";
    fs::create_directory(beside, failure);
    if (fs::is_directory(beside, failure) && access(beside.c_str(), W_OK | X_OK) == 0) return beside;
    const char* cache = std::getenv("XDG_CACHE_HOME");
    const char* home = std::getenv("HOME");
    fs::path folder = cache != nullptr && *cache != '\0' ? fs::path(cache)
                      : home != nullptr                  ? fs::path(home) / ".cache"
                                                         : fs::path("/tmp");
    core::Checksum sum;
    sum.add(fs::absolute(blend).string());
    folder = folder / "render2mpeg" / (blend.filename().string() + "-" + core::checksum_text(sum.value()));
    fs::create_directories(folder, failure);
    if (failure) throw core::Error("writing", folder.string(), failure.message());
    return folder;
}

nlohmann::json read_json(const fs::path& file) {
    std::ifstream stream(file);
    return nlohmann::json::parse(stream, nullptr, false);
}

std::string last_line(const fs::path& file) {
    std::ifstream stream(file);
    std::string last;
    for (std::string line; std::getline(stream, line);)
        if (!line.empty()) last = line;
    return last;
}

/// Frames of an exported film; 0 where it does not say.
std::int64_t frames_in(const fs::path& film) {
    const nlohmann::json said = read_json(film);
    const auto frames = said.is_object() ? said.find("frames") : said.end();
    return frames != said.end() && frames->is_number_integer() ? frames->get<std::int64_t>() : 0;
}

/// First file that an export was made of and that is another now; empty where there is none. Throws
/// nlohmann::json::exception.
std::string changed_since(const nlohmann::json& result) {
    for (const nlohmann::json& used : result.at("uses"))
        if (const auto name = used.at(0).get<std::string>(); state_of(name) != used) return name;
    return {};
}

/// Why an export that was just made cannot be used.
std::string why_not_finished(const fs::path& folder) try {
    const std::string changed = changed_since(read_json(folder / result_name));
    return "it uses " + (changed.empty() ? "a file" : changed) + ", which changes while it is exported";
} catch (const nlohmann::json::exception&) {
    return "its export by Blender is damaged";
}

/// A finished export with unchanged inputs.
std::optional<BlenderExport> finished(const fs::path& folder) {
    const nlohmann::json result = read_json(folder / result_name);
    try {
        if (!changed_since(result).empty()) return std::nullopt;
        BlenderExport found{folder / film_name, {}};
        for (const nlohmann::json& line : result.at("lost"))
            found.notes.push_back("not kept: " + line.get<std::string>());
        return found;
    } catch (const nlohmann::json::exception&) {
        return std::nullopt;  // damaged, or none
    }
}

/// Keeps the newest exports, and what other runs are making, which no export takes a day for.
void remove_old(const fs::path& cache) {
    std::error_code failure;
    std::vector<std::pair<fs::file_time_type, fs::path>> all;
    const auto dead = fs::file_time_type::clock::now() - std::chrono::hours(24);
    for (const fs::directory_entry& entry : fs::directory_iterator(cache, failure))
        if (fs::is_regular_file(entry.path() / result_name, failure))
            all.emplace_back(fs::last_write_time(entry.path() / result_name, failure), entry.path());
        else if (entry.is_directory(failure) && entry.path().has_extension() &&
                 fs::last_write_time(entry.path(), failure) < dead)
            fs::remove_all(entry.path(), failure);
    std::sort(all.rbegin(), all.rend());
    for (std::size_t k = kept_exports; k < all.size(); ++k) fs::remove_all(all[k].second, failure);
}

ProbeLimits blender_limits() {
    // chosen: three quarters of the machine, for what evaluates a film's scene; an hour of one processor's time is
    // longer than the exports of large films take, two by the clock for who shares it.
    const auto machine =
        static_cast<std::uintmax_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uintmax_t>(sysconf(_SC_PAGESIZE));
    return {std::max(machine / 4 * 3, std::uintmax_t{4} << 30), 3600, 7200};
}

/// Keeps Blender's log beside the exports, since its folder goes. Says where, and its last lines.
std::string kept_log(const fs::path& folder) {
    constexpr std::size_t most_lines = 3, most_letters = 200;
    std::vector<std::string> last;
    std::ifstream log(folder / log_name);
    for (std::string line; std::getline(log, line);) {
        if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
        last.push_back(line.substr(0, most_letters));
        if (last.size() > most_lines) last.erase(last.begin());
    }
    const fs::path kept = folder.parent_path() / log_name;
    std::error_code failure;
    fs::rename(folder / log_name, kept, failure);
    if (last.empty()) return "; it said nothing";
    std::string text = "; its last words" + (failure ? std::string() : ", of " + kept.string()) + ": ";
    for (const std::string& line : last) text += (&line == last.data() ? "" : " / ") + line;
    return text;
}

[[noreturn]] void refuse(const fs::path& blend, const fs::path& folder, const ProbeEnd& end) {
    using How = ProbeEnd::How;
    const bool began = end.how != How::not_begun && end.how != How::refused;
    const std::string why = !began                        ? end.text
                            : end.how == How::out_of_time ? "Blender took more than an hour to export it"
                            : end.how == How::killed      ? "Blender was killed while it exported it (out of memory?)"
                                                          : "Blender crashed while it exported it";
    throw core::Error("reading", blend.string(), why + (began ? kept_log(folder) : ""));
}

/// A temporary folder; its parent goes with it where that holds nothing else.
class NewFolder {
  public:
    explicit NewFolder(fs::path path) : path_(std::move(path)) { fs::create_directories(path_); }
    ~NewFolder() {
        std::error_code failure;
        fs::remove_all(path_, failure);
        rmdir(path_.parent_path().c_str());  // no link to a folder, nor a full one
    }
    NewFolder(const NewFolder&) = delete;
    NewFolder& operator=(const NewFolder&) = delete;
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

void run_blender(const fs::path& blend, const fs::path& blender, const fs::path& script, const fs::path& folder,
                 const ExportWish& wish, const ExportWatch& watch) {
    if (!Probe::is_possible()) throw core::Error("reading", blend.string(), "the program that runs Blender is missing");
    const std::vector<std::string> words{"blend",
                                         // A virtual environment is found by its link to a Python.
                                         (is_python(blender) ? fs::absolute(blender) : fs::canonical(blender)).string(),
                                         fs::absolute(script).string(), fs::absolute(blend).string(),
                                         fs::absolute(folder).string(), std::to_string(texture_size),
                                         std::to_string(wish.lines), std::to_string(wish.last_frame.value_or(-1))};
    const ProbeEnd end = Probe(blender_limits(), words).end([&, step = std::string()]() mutable {
        if (watch.tells)
            if (std::string now = last_line(folder / step_name); !now.empty() && now != step) watch.tells(step = now);
        return watch.stops && watch.stops();
    });
    if (end.how == ProbeEnd::How::given_up) throw core::Error("reading", blend.string(), "interrupted");
    const nlohmann::json result = read_json(folder / result_name);
    // A Python may lack the module; whatever else ends it is a crash.
    if (!result.is_object() && is_python(blender) && end.how != ProbeEnd::How::killed &&
        end.how != ProbeEnd::How::out_of_time)
        if (const std::string said = last_line(folder / "blender.log"); !said.empty())
            throw core::Error("reading", blend.string(), said);
    if (!result.is_object()) refuse(blend, folder, end);
    if (result.contains("error")) throw core::Error("reading", blend.string(), result.value("error", ""));
}

}  // namespace

fs::path blender_program() {
    const char* named = std::getenv("RENDER2MPEG_BLENDER");
    const std::string name = named != nullptr && *named != '\0' ? named : "blender";
    if (name.find('/') != std::string::npos) return is_program(name) ? fs::path(name) : fs::path();
    const char* path = std::getenv("PATH");
    std::string_view folders = path != nullptr ? path : "";
    while (!folders.empty()) {
        const std::size_t end = std::min(folders.find(':'), folders.size());
        const fs::path file = fs::path(folders.substr(0, end)) / name;
        if (end > 0 && is_program(file)) return file;
        folders.remove_prefix(std::min(end + 1, folders.size()));
    }
    return {};
}

std::vector<std::string> words_of_blender(const fs::path& program) {
    std::vector<std::string> words{fs::absolute(program).string()};
    if (is_python(program)) words.push_back(core::installed_file("blender/bpy_program.py").string());
    return words;
}

BlenderExport export_by_blender(const fs::path& file, const ExportWish& wish, const ExportWatch& watch) {
    const fs::path blender = blender_program();
    if (blender.empty())
        throw core::Error("reading", file.string(),
                          core::ending_of(file) +
                              " needs Blender, and there is no `blender` on the PATH: install it, or name it in "
                              "RENDER2MPEG_BLENDER, or export the scene as glTF with cameras and punctual lights");
    const fs::path script = core::installed_file("blender/export_film.py");
    const fs::path cache = cache_of(file);
    const fs::path whole = cache / name_of(file, script, blender, {wish.lines, {}});
    fs::path folder = cache / name_of(file, script, blender, wish);
    for (const fs::path& made : {whole, folder})
        if (std::optional<BlenderExport> known = finished(made)) return *known;

    const NewFolder made(folder.string() + "." + std::to_string(getpid()));
    run_blender(file, blender, script, made.path(), wish, watch);
    std::error_code failure;
    fs::remove(made.path() / step_name, failure);
    if (wish.last_frame && *wish.last_frame + 1 >= frames_in(made.path() / film_name)) folder = whole;
    fs::remove_all(folder, failure);
    fs::rename(made.path(), folder, failure);
    std::optional<BlenderExport> known = finished(folder);
    if (!known) throw core::Error("reading", file.string(), why_not_finished(folder));
    fs::remove(cache / log_name, failure);  // of a crash before
    remove_old(cache);
    return *known;
}

void become_blender(const std::vector<std::string>& words) {
    const std::string &program = words.at(0), &script = words.at(1), &blend = words.at(2), &folder = words.at(3),
                      &size = words.at(4), &lines = words.at(5), &last = words.at(6);
    // Blender's messages go to a log file; the parent's pipe stays unused.
    const int log = open((fs::path(folder) / log_name).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (log >= 0) {
        dup2(log, STDOUT_FILENO);
        dup2(log, STDERR_FILENO);
    }
    // No user settings, add-ons or scripts, and nothing in the .blend is executed.
    for (const char* name : {"BLENDER_USER_CONFIG", "BLENDER_USER_SCRIPTS", "BLENDER_USER_DATAFILES"})
        setenv(name, folder.c_str(), 1);
    // Its simulations write to the working directory.
    std::error_code ignored;
    fs::current_path(folder, ignored);
    // A virtual environment's Python would be taken for Blender's own, and lacks its packages.
    setenv("PATH", "/usr/local/bin:/usr/bin:/bin", 1);
    unsetenv("PYTHONHOME");
    std::vector<std::string> command = words_of_blender(program);
    command.insert(command.end(), {"--background", "--factory-startup", "--disable-autoexec", "-noaudio", "--python",
                                   script, "--", blend, folder, size, lines, last});
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execv(program.c_str(), arguments.data());
}

}  // namespace render2mpeg::scene
