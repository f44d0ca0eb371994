#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace render2mpeg::app {

/// Frames at which a GOP begins whatever is seen (`--keyframes`), ascending.
struct Keyframes {
    std::vector<std::int64_t> frames;

    bool begins_at(std::int64_t frame) const;
    /// How many frames follow `frame` before the next one begins a GOP; at most `left`.
    std::int64_t frames_left(std::int64_t frame, std::int64_t left) const;
};

/// Reads "0,48,96", or the name of a file with frame numbers between spaces, commas and line ends, where `#` begins a
/// comment. Frames that a film does not have are allowed: a part of a film is cut as the whole. Throws core::Error,
/// also where there is no number at all.
Keyframes keyframes_from(const std::string& text);

}  // namespace render2mpeg::app
