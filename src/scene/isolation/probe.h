#pragma once
// Has another process of this program read a file first, with limits of memory and time.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"

/// Outside parsers may crash, loop or take all memory on hostile files. Such a file is first read by another process of
/// this program (`--probe`, probed.h) with limits of memory and time.
namespace render2mpeg::scene {

enum class Turn { parser, ours };

/// Called at changes of code, where limits begin anew.
using TakeTurns = std::function<void(Turn)>;

/// A probe ran out of memory.
class OutOfMemory : public core::Error {
  public:
    using core::Error::Error;
};

/// Limits of outside code in each turn, below this process's own.
struct ProbeLimits {
    std::uintmax_t memory = 0;   ///< bytes more than the probe's process holds at the turn's beginning
    unsigned seconds = 0;        ///< of processor time; 0: any
    unsigned clock_seconds = 0;  ///< for what waits, since a busy machine makes others wait, too; 0: any
};

ProbeLimits limits_for(std::uintmax_t file_size);
ProbeLimits limits_for(const std::filesystem::path& file);

struct ProbeEnd {
    enum class How { read, refused, out_of_memory, out_of_time, killed, crashed, given_up };
    How how = How::crashed;
    Turn turn = Turn::parser;  ///< whose code ran at last
    std::string text;          ///< what was said until then; refused: why
};

/// A process that reads a file. It ignores interrupts, and ends with its parent thread.
class Probe {
  public:
    /// Whether there is a program: $RENDER2MPEG_PROGRAM, else this one if it is called render2mpeg, else one beside it
    /// or one folder above. Without it files are read unprobed.
    static bool is_possible();

    /// `words`: kind of reading, and arguments (probed.h); `input`: standard input. Throws core::Error without a
    /// process.
    Probe(const ProbeLimits& limits, const std::vector<std::string>& words, std::span<const std::byte> input = {});
    ~Probe();
    Probe(const Probe&) = delete;
    Probe& operator=(const Probe&) = delete;

    /// Waits for its end, or until `give_up` says so. Once only.
    ProbeEnd end(const std::function<bool()>& give_up = {});

  private:
    int child_ = -1, text_ = -1, turns_ = -1;
};

/// Output of the probe of `name`. Throws core::Error for refusals and crashes of the parser, OutOfMemory where it
/// lacked memory, and std::logic_error for a crash of our own code.
std::string text_of(ProbeEnd end, const std::string& name, const ProbeLimits& limits);

}  // namespace render2mpeg::scene
