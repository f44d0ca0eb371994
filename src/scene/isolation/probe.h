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

/// Outside parsers can be made to crash, loop or take all memory by hostile files. So such a file is first read by a
/// process of its own, with limits of memory and time: this program started anew with `--probe` (probed.h). What goes
/// well there will go well here, too.
namespace render2mpeg::scene {

/// Whose code runs.
enum class Turn { parser, ours };

/// Called where other code begins to run: its limits begin anew.
using TakeTurns = std::function<void(Turn)>;

/// Memory ran out in a probe, before that of the whole machine did if its limit was well chosen.
class OutOfMemory : public core::Error {
  public:
    using core::Error::Error;
};

/// What outside code may take, in each turn; never more than this process may.
struct ProbeLimits {
    std::uintmax_t memory = 0;   ///< bytes more than the probe's process holds at the turn's beginning
    unsigned seconds = 0;        ///< of processor time; 0: any
    unsigned clock_seconds = 0;  ///< for what waits, since a busy machine makes others wait, too; 0: any
};

/// What a parser may take for a file of this size.
ProbeLimits limits_for(std::uintmax_t file_size);
/// The same for a file that is there, or not.
ProbeLimits limits_for(const std::filesystem::path& file);

/// How a probe ended.
struct ProbeEnd {
    enum class How { read, refused, out_of_memory, out_of_time, killed, crashed, given_up };
    How how = How::crashed;
    Turn turn = Turn::parser;  ///< whose code ran at last
    std::string text;          ///< what was said until then; refused: why
};

/// A process that reads something. It does not heed interrupts, and ends with the thread that began it.
class Probe {
  public:
    /// Whether there is a program to be started; else files are read unprobed. It is the one that $RENDER2MPEG_PROGRAM
    /// names, else the one that runs, if it is called render2mpeg, else a render2mpeg beside it or one folder above.
    static bool is_possible();

    /// Begins. `words`: the kind of reading and what it is told (probed.h); `input` is what the probe has as its
    /// standard input. Throws core::Error where the system gives no process.
    Probe(const ProbeLimits& limits, const std::vector<std::string>& words, std::span<const std::byte> input = {});
    /// Ends it, whatever becomes of it.
    ~Probe();
    Probe(const Probe&) = delete;
    Probe& operator=(const Probe&) = delete;

    /// Waits for its end, but not where `give_up`, which is asked now and then, says so. To be called once.
    ProbeEnd end(const std::function<bool()>& give_up = {});

  private:
    int child_ = -1, text_ = -1, turns_ = -1;
};

/// What the probe of `name` said. Throws core::Error for what was refused and for a death in the parser's turn;
/// OutOfMemory also where the parser refused its file for want of memory (it was to take limits.memory). A death in our
/// own code's turn is no file's fault: std::logic_error.
std::string text_of(ProbeEnd end, const std::string& name, const ProbeLimits& limits);

}  // namespace render2mpeg::scene
