#pragma once
// Runs other programs to their end.
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace render2mpeg::app {

/// A program that has ended.
struct Finished {
    int status = 0;      ///< 127: there is no such program
    double seconds = 0;  ///< CPU
    std::string text;    ///< what it printed, where that is caught
};

/// Whether a program can be started by this name.
bool is_installed(const std::string& program);

enum class Output { passed_on, caught };

/// Runs a program without a shell. Caught output is both of its outputs together; such a program gets no interrupts of
/// the terminal. Throws core::Error where the system gives no process.
Finished run_program(std::vector<std::string> words, Output output);

/// A player that shows bare MPEG-2 from a pipe.
class Player {
  public:
    /// Throws core::Error where the constructor would find no program.
    static void check(const std::string& program);
    /// Starts the first of ffplay and mpv that is installed, or `program`. `title` is its window's. Throws core::Error
    /// where there is none.
    Player(const std::string& program, const std::string& title, const std::string& frame_rate);
    /// Closes its pipe and waits until it has ended; it is told to end.
    ~Player();
    Player(const Player&) = delete;
    Player& operator=(const Player&) = delete;

    /// Where its film goes.
    int descriptor() const { return pipe_; }
    const std::string& name() const { return name_; }

  private:
    std::string name_;
    pid_t process_ = -1;
    int pipe_ = -1;
};

}  // namespace render2mpeg::app
