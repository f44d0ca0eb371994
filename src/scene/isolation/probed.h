#pragma once
// What the program does that was started as a probe.
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "scene/isolation/probe.h"

/// The other side of a Probe: what the started program does.
namespace render2mpeg::scene {

/// Reads what `words` say and returns what is to be told. Standard input is what the Probe was given. Limits hold from
/// the first time that a turn is taken.
using ProbedReading = std::function<std::string(const std::vector<std::string>& words, const TakeTurns& take_turns)>;

/// Whether a command line asks for a probe.
bool is_probe(int argc, char** argv);

/// Tells a part of the text at once, so that it is known whatever becomes of the probe.
void write_from_probe(const std::string& text);

/// The program's whole life then: calls the reading of the kind that is asked for, and never returns.
[[noreturn]] void live_as_probe(int argc, char** argv, const std::map<std::string, ProbedReading>& readings);

/// How such a life ends if not well, as exit status. Not 1 and the like, with which libraries and sanitizers end a
/// process themselves.
constexpr int probe_refused = 61, probe_out_of_memory = 62, probe_crashed = 63;
/// The descriptor on which turns are told, one character each.
constexpr int probe_turns = 3;
constexpr char turn_mark(Turn turn) {
    return turn == Turn::ours ? 'o' : 'p';
}

/// The first words of a probe's command line.
std::vector<std::string> probe_words(const ProbeLimits& limits);

/// Bytes of address space that this process holds; 0 where the system does not tell.
std::uintmax_t address_space_now();

}  // namespace render2mpeg::scene
