#pragma once
// The program as a probe of files that strangers made.
namespace render2mpeg::app {

/// The program as a probe (scene/isolation/probe.h): reads a file of a stranger for another process of this program,
/// and ends.
[[noreturn]] void probe(int argc, char** argv);

}  // namespace render2mpeg::app
