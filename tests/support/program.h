#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/support/places.h"

/// Runs programs as a user does, and gives each test a folder of its own.
namespace render2mpeg::support {

struct Outcome {
    int status = -1;     ///< exit status; 128 + signal for a program that a signal ended
    std::string output;  ///< standard output and standard error together
};

inline Outcome run(const std::string& command) {
    Outcome outcome;
    std::FILE* pipe = popen(("( " + command + " ) 2>&1 </dev/null").c_str(), "r");
    if (pipe == nullptr) return outcome;
    std::array<char, 4096> buffer;
    while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
        outcome.output.append(buffer.data(), n);
    const int status = pclose(pipe);
    outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return outcome;
}

/// A new, empty folder that goes with the object.
class Folder {
  public:
    Folder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "render2mpeg.XXXXXX").string();
        if (mkdtemp(pattern.data()) != nullptr) path_ = pattern;
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }
    std::size_t entries() const {
        return static_cast<std::size_t>(
            std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator{}));
    }

  private:
    std::filesystem::path path_;
};

inline std::string contents(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

/// The Blender that ctest names, which serves all tests, or the user's, also a Python whose module `bpy` it is.
inline std::string blender_words() {
    const char* named = std::getenv("RENDER2MPEG_BLENDER");
    std::string program = named != nullptr ? named : "blender";
    if (std::filesystem::path(program).filename().string().starts_with("python"))
        program += " " + (source_folder() / "blender/bpy_program.py").string();
    return program;
}
/// Blender with these words, which name files by absolute paths. Its working directory goes with it: its simulations
/// write there.
inline Outcome blender(const std::string& words) {
    const Folder scratch;
    return run("cd " + scratch.path().string() + " && " + blender_words() +
               " -b --factory-startup --disable-autoexec -noaudio --python-exit-code 1 " + words);
}
/// Starts a Blender of its own, whatever ctest names: for what depends on how it is started.
inline std::string with_own_blender(const std::string& command) {
    return "env -u RENDER2MPEG_BLENDER -u RENDER2MPEG_TEST_BLENDER " + command;
}
/// The installed Blender, by the one that serves all tests where there is one.
inline std::string installed_blender() {
    return std::getenv("RENDER2MPEG_TEST_BLENDER") != nullptr ? blender_words() : with_own_blender("blender");
}
/// A program in Blender's place that runs this Python first.
inline std::string blender_after(const Folder& folder, const std::string& python) {
    const auto file = folder / "blender";
    std::ofstream(file) << "#!/bin/sh\nexec " << installed_blender() << " --python-expr '" << python << "' \"$@\"\n";
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    return file.string();
}
/// A Blender of a user who has nothing else installed.
inline Outcome users_blender(const Folder& folder, const std::string& words,
                             const std::string& blender = installed_blender()) {
    std::string user;
    for (const char* place : {"SCRIPTS", "CONFIG", "EXTENSIONS"})
        user += std::string("BLENDER_USER_") + place + "=" + (folder / "user").string() + " ";
    return run("cd " + folder.path().string() + " && " + user + blender +
               " -b --factory-startup -noaudio --python-exit-code 1 " + words);
}
inline bool blender_is_there() {
    static const bool there = run("command -v blender").status == 0;
    return there;
}
/// A script of tests/blender.
inline std::string blender_script(const std::string& name) {
    return (source_folder() / "tests/blender" / name).string();
}

inline std::string program() {
    return (binary_folder() / "render2mpeg").string();
}
/// The same as at a terminal: what a script begins in the background ignores SIGINT, and so would the program.
inline std::string program_at_terminal() {
    return "env --default-signal=INT " + program();
}
inline std::string film(const std::string& name) {
    return (source_folder() / "animations" / name).string();
}
/// Boxes on a floor below one lamp, colour and motion but neither walls nor textures: for tests that need some film,
/// this one is lit by rays in a tenth of the time.
inline std::string plain_film() {
    return (source_folder() / "tests/support/plain_box").string();
}
/// Such boxes in a room, below a panel of a thousand light points, which direct light's cuts choose among.
inline std::string panel_film() {
    return (source_folder() / "tests/support/panel_box").string();
}

/// An animation file: the camera travels past a box below two lamps. Chunks of it differ, and light that rays have
/// found stays for later frames, which take milliseconds.
inline std::string travel_scene(int frames) {
    return R"({ "camera": { "look_at": [0, 0.5, 0],
      "keys": [{ "at": 0, "position": [0, 1.5, 4] }, { "at": 6, "position": [3, 1.5, 3] }] },
  "lights": [{ "kind": "point", "position": [1, 2, 1], "intensity": 9 },
             { "kind": "point", "position": [-2, 2, 1], "intensity": 3 }],
  "objects": [{ "name": "floor", "shape": "plane", "size": [6, 6] }, { "name": "box", "shape": "box" }],
  "frames": )" +
           std::to_string(frames) + " }";
}

}  // namespace render2mpeg::support
