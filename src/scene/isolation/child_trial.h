#pragma once
// Tries in a child process whether a library survives a file.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "core/error.h"

namespace render2mpeg::scene {

/// Whose code runs from now on.
enum class Turn { parser, ours };
using TakeTurns = std::function<void(Turn)>;

/// Memory ran out in a trial, before that of the whole machine did if its limit was well chosen.
class OutOfMemory : public core::Error {
  public:
    using core::Error::Error;
};

/// What outside code may take, in each turn; never more than this process may.
struct TrialLimits {
    std::uintmax_t memory = 0;   ///< bytes more than this process holds now
    unsigned seconds = 0;        ///< of processor time; 0: any
    unsigned clock_seconds = 0;  ///< for what waits, since a busy machine makes others wait, too; 0: any
};

/// What a parser may take for a file of this size.
TrialLimits limits_for(std::uintmax_t file_size);

/// Something read in a child process first, with limits of memory and time: for outside parsers, which hostile files
/// can make crash, loop or take all memory. Nothing the child does or prints is seen but what `reading` returns. It
/// does not heed interrupts, and ends with the thread that began it.
class ChildTrial {
  public:
    using Reading = std::function<std::string(const TakeTurns&)>;
    struct Told {
        bool refused = false;
        std::string text;  ///< what `reading` returned; refused: what it threw as core::Error
    };

    /// Begins when all other threads of this process sleep, or after two seconds. `name`, for messages, is what is
    /// read.
    ChildTrial(std::string name, const TrialLimits& limits, const Reading& reading);
    /// Ends it, whatever becomes of it.
    ~ChildTrial();
    ChildTrial(const ChildTrial&) = delete;
    ChildTrial& operator=(const ChildTrial&) = delete;

    /// Waits for its end. Where it refused nothing, doing the same in this process will go well, too. Throws
    /// core::Error if the child died in the parser's turn, with which it begins; OutOfMemory also where the parser
    /// refused its file for want of memory. A death in our own code's turn is no file's fault: std::logic_error. To be
    /// called once.
    Told told();

  private:
    class SharedTurn;
    std::string name_;
    std::uintmax_t memory_;
    std::unique_ptr<SharedTurn> turn_;
    int child_ = -1, pipe_ = -1;
};

/// One trial of a file, with the limits for its size. Throws as ChildTrial::told() does, and what was refused.
void try_in_child(const std::filesystem::path& file, const std::function<void(const TakeTurns&)>& reading);

}  // namespace render2mpeg::scene
