#pragma once
// What a user reads while the program runs, and the descriptors it goes through.

#include <string_view>

namespace render2mpeg::app {

/// Opens /dev/null in place of standard input, output and error where they are closed, so that no file that is opened
/// later takes their numbers and is written to by messages. Writing to such an output fails, as it would while it is
/// closed. To be called before anything is opened.
void hold_standard_descriptors();

/// Writes one line to standard error. Whatever it holds, it stays one line and does nothing to a terminal
/// (core::printable).
void print_line(std::string_view text);

/// The same for each line of a text.
void print_lines(std::string_view text);

/// The same for what went wrong: "render2mpeg: TEXT".
void print_error(std::string_view text);

/// Whether standard error is a terminal that can rewrite its last line.
bool can_rewrite_errors();

/// Columns of the terminal behind standard error or standard output; 80 where there is none or it does not say. They
/// may change while the program runs.
int columns_of_errors();
int columns_of_output();

}  // namespace render2mpeg::app
