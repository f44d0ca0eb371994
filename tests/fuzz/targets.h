#pragma once

#include <cstdint>
#include <span>
#include <vector>

/// Doors that bytes of strangers come in by. Whatever they hold, each ends well or is refused by core::Error; crashes,
/// hangs, other exceptions and results that are not sound are findings.
namespace render2mpeg::fuzz {

using Bytes = std::vector<std::uint8_t>;
using Input = std::span<const std::uint8_t>;

/// Runs one input. Throws std::logic_error where what comes of it is not sound. A refusal is no failure: it returns
/// false.
using Target = bool (*)(Input);

struct NamedTarget {
    const char* name;  ///< of its folder in corpus/
    Target run;
    int mutations;  ///< in an ordinary test: about a second's worth
};

std::span<const NamedTarget> targets();

bool gltf(Input);       ///< a .gltf or .glb file
bool animation(Input);  ///< an animation file
bool model(Input);      ///< any format of Assimp: a line with its ending, then the file
bool volume(Input);     ///< a file of OpenVDB's
bool tracks(Input);     ///< keys of every kind on a film of ours
bool image(Input);      ///< a texture
bool sky(Input);        ///< an image as a sky
bool layers(Input);     ///< motion in an OpenEXR file
bool y4m(Input);        ///< an uncompressed film
bool motion(Input);     ///< a motion stream beside pictures on standard input
bool hints(Input);      ///< settings, pictures, motion and hints for the encoder
bool plan(Input);       ///< a farm's plan, and any JSON of ours
bool light(Input);      ///< a light file behind a line with the identity that is looked for
bool film(Input);       ///< a film for `info`
bool sound(Input);      ///< a film's sound
bool chunk(Input);      ///< a line with the record of a finished chunk, whose sum is right, then its stream
bool state(Input);      ///< changes to what light so far left for the next frame, whose sum is right

}  // namespace render2mpeg::fuzz
