#pragma once
// Has another process of this program read a file first, with limits of memory and time.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"

/// Outside parsers may crash, loop or take all memory on hostile files. Such a file is first read by another process of
/// this program (`--probe`) with limits of memory and time.
namespace render2mpeg::scene {

/// Lets limits begin anew: once the code that is limited begins, and for each of several files.
using BeginLimits = std::function<void()>;

/// A probe ran out of memory.
class OutOfMemory : public core::Error {
  public:
    using core::Error::Error;
};

/// Limits of reading, below this process's own.
struct ProbeLimits {
    std::uintmax_t memory = 0;   ///< bytes more than the probe's process holds at the beginning
    unsigned seconds = 0;        ///< of processor time; 0: any
    unsigned clock_seconds = 0;  ///< for what waits, since a busy machine makes others wait, too; 0: any
};

ProbeLimits limits_for(std::uintmax_t file_size);
ProbeLimits limits_for(const std::filesystem::path& file);

struct ProbeEnd {
    enum class How { read, refused, out_of_memory, out_of_time, killed, crashed, given_up, not_begun };
    How how = How::crashed;
    std::string text;  ///< messages until then; refused: the reason; not begun: why
};

/// A process that reads a file, in a group of its own with what it starts. It ignores interrupts, and ends with its
/// parent thread.
class Probe {
  public:
    /// Whether there is a program: $RENDER2MPEG_PROGRAM, else this one if it is called render2mpeg, else one beside it
    /// or one folder above. Without it files are read unprobed.
    static bool is_possible();

    /// `words`: kind of reading, and arguments; `input`: standard input, a file in memory that the probe may also write
    /// to. Throws core::Error without a process.
    Probe(const ProbeLimits& limits, const std::vector<std::string>& words, std::span<const std::byte> input = {});
    ~Probe();
    Probe(const Probe&) = delete;
    Probe& operator=(const Probe&) = delete;

    /// Waits for its end, or until `give_up` says so. Once only.
    ProbeEnd end(const std::function<bool()>& give_up = {});

    /// The file of its standard input, which the caller closes. Once only, after end().
    int take_input();

  private:
    int child_ = -1, text_ = -1, input_ = -1;
};

/// Reads as `words` say in a probe, until `give_up` says so. Returns and throws as text_of() does.
std::string read_in_probe(const std::vector<std::string>& words, const std::string& name, const ProbeLimits& limits,
                          const std::function<bool()>& give_up = {});

/// Output of the probe of `name`. Throws core::Error for refusals and crashes, and OutOfMemory where it lacked
/// memory.
std::string text_of(ProbeEnd end, const std::string& name, const ProbeLimits& limits);

/// Reads as `words` say, with the Probe's input as standard input, and returns the output.
using ProbedReading =
    std::function<std::string(const std::vector<std::string>& words, const BeginLimits& begin_limits)>;

/// Raises this probe's limit of memory by so many bytes, up to that of its parent: for what was checked to be no fault.
void allow_more_memory(std::uintmax_t bytes);

bool is_probe(int argc, char** argv);

/// Writes a part of the output at once.
void write_from_probe(const std::string& text);

/// Runs the reading that the command line asks for.
[[noreturn]] void live_as_probe(int argc, char** argv, const std::map<std::string, ProbedReading>& readings);

/// Exit statuses; libraries and sanitizers exit with small ones.
constexpr int probe_refused = 61, probe_out_of_memory = 62, probe_crashed = 63;

}  // namespace render2mpeg::scene
