// Renders as the program's `render` does: the program without its other commands, which would only take long to build.
#include <cstdio>
#include <exception>

#include "app/commands/commands.h"
#include "app/options/options.h"

int main(int argc, char** argv) {
    using namespace render2mpeg::app;
    try {
        const CommandLine line = parse({argv, argv + argc});
        if (line.exit_code) return *line.exit_code;
        if (line.command == "render") return render(line.render, line.text);
        std::fputs("this renders only\n", stderr);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
    }
    return 1;
}
