#pragma once
// Runs other programs.
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace render2mpeg::app {

struct Finished {
    int status = 0;      ///< 127: there is no such program
    double seconds = 0;  ///< CPU
    std::string text;    ///< its output, where caught
};

bool is_installed(const std::string& program);

enum class Output { passed_on, errors_passed_on, caught };

/// Runs a program without a shell, in a folder (empty: the current one). `caught`: both outputs together, and no
/// interrupts of the terminal. `errors_passed_on`: standard output goes nowhere, and an interrupt (InterruptGuard) ends
/// it and all that it started. Throws core::Error without a process.
Finished run_program(std::vector<std::string> words, Output output, const std::filesystem::path& folder = {});

class Player {
  public:
    /// Throws core::Error where there is no such program.
    static void check(const std::string& program);
    /// Starts `program`, or the first of ffplay and mpv. Throws core::Error where there is none.
    Player(const std::string& program, const std::string& title, const std::string& frame_rate);
    /// Closes the pipe and ends the player.
    ~Player();
    Player(const Player&) = delete;
    Player& operator=(const Player&) = delete;

    /// The film's pipe.
    int descriptor() const { return pipe_; }
    const std::string& name() const { return name_; }

  private:
    std::string name_;
    pid_t process_ = -1;
    int pipe_ = -1;
};

}  // namespace render2mpeg::app
