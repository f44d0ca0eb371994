#include "app/commands/live_lines.h"

#include <fmt/format.h>

#include <poll.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

/// Of a line; longer ones are told, and dropped.
constexpr std::size_t most_bytes = 1u << 20;

/// Widest and highest picture: four times what screens have.
constexpr int most_pixels_across = 16384;

[[noreturn]] void refuse(const std::string& key, const char* expected) {
    throw core::Error(fmt::format("\"{}\": expected {}", key, expected));
}

double number_of(const json& value, const std::string& key) {
    const double number = value.is_number() ? value.get<double>() : NAN;
    if (!(std::abs(number) <= 1e9)) refuse(key, "a number up to 1e9");
    return number;
}

std::vector<double> numbers_of(const json& value, const std::string& key, std::size_t count, const char* expected) {
    if (!value.is_array() || value.size() != count) refuse(key, expected);
    std::vector<double> numbers;
    for (const json& element : value) numbers.push_back(number_of(element, key));
    return numbers;
}

Size size_of(const json& value) {
    constexpr const char* expected = "width and height, 16 to 16384 pixels";
    const std::vector<double> numbers = numbers_of(value, "size", 2, expected);
    for (const double number : numbers)
        if (number < 16 || number > most_pixels_across || number != std::floor(number)) refuse("size", expected);
    return {static_cast<int>(numbers[0]), static_cast<int>(numbers[1])};
}

void read_lens(const std::string& key, const json& value, scene::Viewpoint& view) {
    if (key == "fov") {
        const auto angle = static_cast<float>(glm::radians(number_of(value, key)));
        if (!(angle > 1e-6f && angle < 3.1415f)) refuse(key, "degrees of the picture's height, between 0 and 180");
        view.lens.projection = scene::ProjectionKind::perspective;
        view.lens.vertical_fov = angle;
    } else if (key == "height") {
        const auto half = static_cast<float>(number_of(value, key) / 2);
        if (!(half >= 1e-12f)) refuse(key, "the height that is seen, above 0");
        view.lens.projection = scene::ProjectionKind::orthographic;
        view.lens.y_magnification = half;
    } else if (key == "shift") {
        const auto shift = numbers_of(value, key, 2, "two numbers");
        view.lens.shift = {shift[0], shift[1]};
    } else if (key == "clip") {
        const auto clip = numbers_of(value, key, 2, "the nearest and the farthest distance that is seen; 0: any");
        if (!(clip[0] >= 0 && (clip[1] == 0 || clip[1] > clip[0]))) refuse(key, "0 <= near < far");
        view.lens.near = static_cast<float>(clip[0]);
        view.lens.far = static_cast<float>(clip[1]);
    } else {
        throw core::Error(fmt::format("\"camera\" has no \"{}\"; it has matrix, fov, height, shift and clip", key));
    }
}

/// Null: the film's own camera.
std::optional<scene::Viewpoint> camera_of(const json& value) {
    if (value.is_null()) return {};
    if (!value.is_object() || !value.contains("matrix")) refuse("camera", "an object with a \"matrix\", or null");
    scene::Viewpoint view;
    view.lens.name = "live";
    for (const auto& [key, element] : value.items()) {
        if (key != "matrix") {
            read_lens(key, element, view);
            continue;
        }
        const auto numbers = numbers_of(element, key, 16, "16 numbers, row by row");
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column)
                view.to_world[column][row] = numbers[static_cast<std::size_t>(4 * row + column)];
    }
    return view;
}

}  // namespace

LiveLines::LiveLines(int descriptor)
    : descriptor_(descriptor), reader_([this](const std::stop_token& stop) { read(stop); }) {}

LiveLines::~LiveLines() {
    reader_.request_stop();
}

void LiveLines::read(const std::stop_token& stop) {
    std::array<char, 65536> buffer;
    while (!stop.stop_requested()) {
        pollfd waiting{descriptor_, POLLIN, 0};
        const int ready = poll(&waiting, 1, 100);
        if (ready < 0 && errno != EINTR) break;
        if (ready <= 0) continue;
        const ssize_t count = ::read(descriptor_, buffer.data(), buffer.size());
        if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (count <= 0) break;
        add(buffer.data(), static_cast<std::size_t>(count));
    }
    ended_ = true;
}

void LiveLines::add(const char* bytes, std::size_t count) {
    const auto now = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < count; ++i) {
        if (bytes[i] != '\n') {
            if (rest_.size() <= most_bytes) rest_ += bytes[i];
            continue;
        }
        const std::lock_guard lock(mutex_);
        lines_.push_back({std::exchange(rest_, {}), ++count_, now});
        any_ = true;
    }
}

std::vector<LiveLine> LiveLines::take() {
    const std::lock_guard lock(mutex_);
    any_ = false;
    return std::exchange(lines_, {});
}

LiveCommand live_command_from(const std::string& line) {
    if (line.size() > most_bytes) throw core::Error("a line has at most 1 MiB");
    const json object = json::parse(line, nullptr, false);
    if (!object.is_object()) throw core::Error("expected a JSON object on one line");
    LiveCommand command;
    for (const auto& [key, value] : object.items()) {
        if (key == "camera") {
            command.camera = camera_of(value);
        } else if (key == "size") {
            command.size = size_of(value);
        } else if (key == "frame") {
            if (!value.is_number_integer()) refuse(key, "a whole number");
            command.frame = value.get<std::int64_t>();
        } else if (key == "scene") {
            if (!value.is_string()) refuse(key, "the name of a file");
            command.scene = value.get<std::string>();
        } else if (key == "quit") {
            command.quit = true;
        } else {
            throw core::Error(fmt::format("there is no \"{}\"; there are camera, size, frame, scene and quit", key));
        }
    }
    return command;
}

}  // namespace render2mpeg::app
