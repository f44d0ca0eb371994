#include "app/options/keyframes.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

#include "app/options/usage_error.h"

namespace render2mpeg::app {
namespace {

// chosen: as for --frames, 2^31 frames are 2.7 years at 25 Hz.
constexpr std::int64_t frame_limit = std::int64_t{1} << 31;

/// What separates the numbers; all else must be digits.
constexpr const char* separators = ", \t\r\n";

bool is_list(const std::string& text) {
    return !text.empty() && text.find_first_not_of("0123456789,") == std::string::npos;
}

/// The file's text without comments.
std::string read_file(const std::string& name) {
    std::ifstream stream(name);
    if (!stream)
        throw UsageError("keyframes " + name + ": expected frame numbers such as 0,48,96, or a file with them");
    std::string text, line;
    while (std::getline(stream, line)) text += line.substr(0, line.find('#')) + "\n";
    // Folders can be opened, but not read.
    if (stream.bad()) throw UsageError("keyframes " + name + ": cannot be read");
    return text;
}

}  // namespace

bool Keyframes::begins_at(std::int64_t frame) const {
    return std::binary_search(frames.begin(), frames.end(), frame);
}

std::int64_t Keyframes::frames_left(std::int64_t frame, std::int64_t left) const {
    const auto next = std::upper_bound(frames.begin(), frames.end(), frame);
    return next == frames.end() ? left : std::min(left, *next - frame - 1);
}

Keyframes keyframes_from(const std::string& text) {
    const std::string list = is_list(text) ? text : read_file(text);
    Keyframes keyframes;
    for (std::size_t at = list.find_first_not_of(separators); at != std::string::npos;) {
        const std::size_t end = std::min(list.find_first_of(separators, at), list.size());
        std::int64_t frame = 0;
        const auto [last, error] = std::from_chars(list.data() + at, list.data() + end, frame);
        if (error != std::errc{} || last != list.data() + end || frame < 0 || frame >= frame_limit)
            throw UsageError("keyframes " + text + ": \"" + list.substr(at, end - at) + "\" is no frame number");
        keyframes.frames.push_back(frame);
        at = list.find_first_not_of(separators, end);
    }
    if (keyframes.frames.empty()) throw UsageError("keyframes " + text + ": no frame numbers");
    std::sort(keyframes.frames.begin(), keyframes.frames.end());
    keyframes.frames.erase(std::unique(keyframes.frames.begin(), keyframes.frames.end()), keyframes.frames.end());
    return keyframes;
}

}  // namespace render2mpeg::app
