#pragma once
// Runs other programs to their end.
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

}  // namespace render2mpeg::app
