#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <iterator>
#include <memory>
#include <new>
#include <vector>

#include "scene/isolation/probe.h"

/// A program whose readings behave as outside parsers may: what tests start instead of render2mpeg.
namespace render2mpeg::scene {
namespace {

using Words = std::vector<std::string>;

/// What goes wrong, by name.
void misbehave(const std::string& how) {
    if (how == "abort") std::abort();
    if (how == "throw") throw 3;
    if (how == "exit") _exit(1);  // as sanitizers and libraries end a process
    if (how == "contract") EXPECTS(how == "kept");
    if (how == "bad_alloc") throw std::bad_alloc();
    if (how == "refuse") throw core::Error("reading", "a.obj", "no such mesh");
    if (how == "kill") std::raise(SIGKILL);
    if (how == "too_long") std::raise(SIGXCPU);
    // As a terminal sends them to all processes of a command.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP})
        if (how == "interrupts") std::raise(signal);
    for (volatile bool on = how == "loop"; on;) continue;
    while (how == "sleep") pause();
    if (how == "hoard") {
        // Room alone, which costs nothing until it is written to.
        std::vector<std::unique_ptr<char[]>> blocks;
        for (int i = 0; i < 64; ++i) blocks.emplace_back(new char[std::size_t{1} << 28]);
    }
    // As libraries in C do, each with words of its own.
    if (how == "malloc" && std::malloc(std::size_t{1} << 34) == nullptr)
        throw core::Error("reading", "scene.xyz", "bad header");
    if (how == "half_a_gibibyte") {
        const std::unique_ptr<char[]> block(new char[std::size_t{1} << 29]);
        static_cast<volatile char*>(block.get())[0] = 1;
    }
}

/// HOW
std::string behave(const Words& words, const BeginLimits& begin_limits) {
    begin_limits();
    misbehave(words.at(0));
    return words.at(0) == "long" ? std::string(300'000, 'x') : "read";
}

std::string echo(const Words& words, const BeginLimits& begin_limits) {
    begin_limits();
    std::cout << "what libraries print is not told";
    write_from_probe(words.at(0));
    return {std::istreambuf_iterator<char>(std::cin), std::istreambuf_iterator<char>()};
}

}  // namespace
}  // namespace render2mpeg::scene

int main(int argc, char** argv) {
    using namespace render2mpeg::scene;
    if (is_probe(argc, argv)) live_as_probe(argc, argv, {{"read", behave}, {"echo", echo}});
    // A program that begins an endless probe and ends without a destructor, as where it is killed.
    const Probe endless({std::uintmax_t{1} << 30, 0, 0}, {"read", "sleep"});
    std::cout << getpid() << std::endl;
    sleep(1);
    _exit(0);
}
