#pragma once
// Runs the program: commands, errors and exit statuses.

namespace render2mpeg::app {

/// Everything that goes wrong anywhere ends here as one line and exit status 1, or 2 for a mistake on the command line.
int run(int argc, char** argv);

}  // namespace render2mpeg::app
