#include "app/commands/live.h"

#include <fmt/format.h>

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <glm/gtc/packing.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "app/commands/live_lines.h"
#include "app/files/output_stream.h"
#include "app/loop/live_view.h"
#include "app/loop/run_statistics.h"
#include "app/production/production.h"
#include "app/system/interrupt.h"
#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

const char* name_of(LiveLevel level) {
    switch (level) {
        case LiveLevel::quick:
            return "quick";
        case LiveLevel::draft:
            return "draft";
        case LiveLevel::lit:
            break;
    }
    return "lit";
}

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Red, green, blue and 1 of each pixel in half precision, row by row from the top.
std::vector<std::uint8_t> halves_of(const core::Plane<glm::vec3>& light) {
    constexpr float largest = 65504;  // half precision's
    std::vector<std::uint8_t> bytes;
    bytes.reserve(light.size() * 8);
    for (const glm::vec3& pixel : light.values()) {
        const glm::vec3 shown = glm::min(pixel, glm::vec3(largest));
        for (const std::uint16_t half : {glm::packHalf1x16(shown.r), glm::packHalf1x16(shown.g),
                                         glm::packHalf1x16(shown.b), std::uint16_t{0x3c00}}) {
            bytes.push_back(static_cast<std::uint8_t>(half & 0xff));
            bytes.push_back(static_cast<std::uint8_t>(half >> 8));
        }
    }
    return bytes;
}

/// Answers on standard output: a line of JSON each, behind some of them bytes of a picture.
class Answers {
  public:
    void tell(const json& line) {
        const std::string text = line.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
        out_.put({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    }
    void tell_error(const std::string& what, std::uint64_t line) { tell({{"error", what}, {"line", line}}); }
    void show(const std::vector<std::uint8_t>& picture) { out_.put(picture); }
    bool has_lost_reader() { return out_.has_lost_reader(); }
    void finish() {
        if (!has_lost_reader()) out_.finish();
    }

  private:
    OutputStream out_{STDOUT_FILENO, "standard output"};
};

/// Follows the lines, and draws while none waits.
class LiveSession {
  public:
    explicit LiveSession(const RenderOptions& options) : options_(options) {
        // Pictures are sent as light: as for images, nothing is coded.
        options_.preview = false;
        options_.output = "live.%04d.exr";
    }

    int run() {
        open(options_.input, 0);
        while (!ends_ && !InterruptGuard::requested() && !answers_.has_lost_reader()) {
            if (lines_.any()) take_lines();
            if (ends_) break;
            if (view_ && view_->can_improve())
                draw();
            else
                std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        answers_.finish();
        return InterruptGuard::requested() ? InterruptGuard::status() : 0;
    }

  private:
    void take_lines() {
        const bool are_last = lines_.has_ended();
        for (const LiveLine& line : lines_.take()) {
            came_ = line.came;
            line_ = line.number;
            try {
                follow(live_command_from(line.text), line.number);
            } catch (const core::Error& error) {
                answers_.tell_error(error.what(), line.number);
            }
        }
        ends_ = ends_ || are_last;
        if (!std::exchange(changed_, false)) return;
        if (view_)
            view_->show(wish_);
        else
            answers_.tell_error("no scene is shown", line_);
    }

    void follow(const LiveCommand& command, std::uint64_t line) {
        ends_ = ends_ || command.quit;
        if (ends_) return;
        if (command.scene) open(*command.scene, line);
        if (command.camera) wish_.from = *command.camera;
        if (command.size) wish_.size = *command.size;
        if (command.frame) wish_.frame = *command.frame;
        changed_ = changed_ || command.camera || command.size || command.frame;
    }

    /// A scene that cannot be read is told; the one before stays.
    void open(const std::filesystem::path& scene, std::uint64_t line) {
        const Clock::time_point start = Clock::now();
        const double cpu = cpu_seconds();
        options_.input = scene;
        try {
            RenderJob film = prepare_within_memory(options_);
            if (!options_.memory) film.images->read_ahead(image_probes(false));
            if (wish_.size.width == 0) wish_.size = {film.rendering.format.width, film.rendering.format.height};
            if (!view_) wish_.frame = film.frames.first;
            auto next = std::make_unique<LiveView>(std::move(film));
            view_ = std::move(next);
        } catch (const core::Error& error) {
            answers_.tell_error(error.what(), line);
            return;
        }
        changed_ = false;
        view_->show(wish_);
        const RenderJob& film = view_->film();
        answers_.tell({{"scene", scene.string()},
                       {"line", line},
                       {"frames", {film.frames.first, film.frames.last}},
                       {"size", {film.rendering.format.width, film.rendering.format.height}},
                       {"exposure", film.exposure ? json(*film.exposure) : json(nullptr)},
                       {"notes", film.animation->notes},
                       {"seconds", seconds_since(start)},
                       {"cpu", cpu_seconds() - cpu}});
    }

    void draw() {
        const double cpu = cpu_seconds();
        std::optional<LivePicture> picture;
        try {
            picture = view_->next([&] { return lines_.any() || InterruptGuard::requested(); });
        } catch (const core::Error& error) {
            answers_.tell_error(error.what(), line_);
            view_.reset();
        }
        if (!picture) return;
        const std::vector<std::uint8_t> bytes = halves_of(picture->radiance);
        answers_.tell({{"picture", ++pictures_},
                       {"line", line_},
                       {"size", {picture->radiance.width(), picture->radiance.height()}},
                       {"level", name_of(picture->level)},
                       {"pass", picture->pass},
                       {"best", !view_->can_improve()},
                       {"seconds", seconds_since(came_)},
                       {"cpu", cpu_seconds() - cpu},
                       {"bytes", bytes.size()}});
        answers_.show(bytes);
    }

    RenderOptions options_;
    LiveLines lines_{STDIN_FILENO};
    Answers answers_;
    std::unique_ptr<LiveView> view_;
    LiveWish wish_{};
    bool changed_ = false, ends_ = false;
    std::uint64_t line_ = 0, pictures_ = 0;  ///< the last line that was followed; pictures sent
    Clock::time_point came_ = Clock::now();  ///< that line
};

}  // namespace

int watch_live(const RenderOptions& options) {
    const parallel::ThreadLimit threads(options.threads);
    const InterruptGuard guard(true);
    return LiveSession(options).run();
}

}  // namespace render2mpeg::app
