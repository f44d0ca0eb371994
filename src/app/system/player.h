#pragma once
// A player in a process of its own.
#include <sys/types.h>

#include <filesystem>
#include <string>

namespace render2mpeg::app {

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
