#pragma once
// What the program does that was started as a probe.
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "scene/isolation/probe.h"

namespace render2mpeg::scene {

/// Reads as `words` say, with the Probe's input as standard input, and returns the output. Limits hold from the first
/// turn.
using ProbedReading = std::function<std::string(const std::vector<std::string>& words, const TakeTurns& take_turns)>;

bool is_probe(int argc, char** argv);

/// Writes a part of the output at once.
void write_from_probe(const std::string& text);

/// Runs the reading that the command line asks for.
[[noreturn]] void live_as_probe(int argc, char** argv, const std::map<std::string, ProbedReading>& readings);

/// Exit statuses; libraries and sanitizers exit with small ones.
constexpr int probe_refused = 61, probe_out_of_memory = 62, probe_crashed = 63;
/// Descriptor of turns, one character each.
constexpr int probe_turns = 3;
constexpr char turn_mark(Turn turn) {
    return turn == Turn::ours ? 'o' : 'p';
}

std::vector<std::string> probe_words(const ProbeLimits& limits);

/// Address space of this process in bytes; 0: unknown.
std::uintmax_t address_space_now();

}  // namespace render2mpeg::scene
