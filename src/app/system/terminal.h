#pragma once
// Terminal output while the program runs, and the descriptors it goes through.

#include <string_view>

namespace render2mpeg::app {

/// Opens /dev/null for closed standard descriptors, so that no file takes their numbers; writing still fails. First of
/// all calls.
void hold_standard_descriptors();

/// Writes one safe line (core::printable) to standard error.
void print_line(std::string_view text);

void print_lines(std::string_view text);

/// "render2mpeg: TEXT".
void print_error(std::string_view text);

bool can_rewrite_errors();

/// Columns behind standard error or output now; 80 without a terminal.
int columns_of_errors();
int columns_of_output();

}  // namespace render2mpeg::app
