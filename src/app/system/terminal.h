#pragma once
// Whether standard error is a terminal, and how wide.
namespace render2mpeg::app {

/// Whether standard error is a terminal that can rewrite its last line.
bool can_rewrite_errors();

/// Columns of the terminal behind standard error or standard output; 80 where there is none or it does not say. They
/// may change while the program runs.
int columns_of_errors();
int columns_of_output();

}  // namespace render2mpeg::app
