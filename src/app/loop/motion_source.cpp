#include "app/loop/motion_source.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <vector>

#include "app/options/output_kind.h"
#include "core/error.h"
#include "core/text.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// Extends a trajectory by `step`, the field of the frame where it ends.
void extend(core::MotionField& trajectory, const core::MotionField& step) {
    const int width = trajectory.vector.width(), height = trajectory.vector.height();
    const core::PixelClass* kinds_there = step.kind.row(0);
    const glm::vec2* vectors_there = step.vector.row(0);
    parallel::for_each(static_cast<std::size_t>(height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        core::PixelClass* kinds = trajectory.kind.row(y);
        glm::vec2* vectors = trajectory.vector.row(y);
        const bool looked_at = y % 2 == 0 || y + 1 == height;
        for (int x = 0; x < width; ++x) {
            if (kinds[x] == core::PixelClass::none) continue;
            if (!looked_at || (x % 2 != 0 && x + 1 < width)) {
                kinds[x] = core::PixelClass::none;
                continue;
            }
            const float at_x = static_cast<float>(x) + vectors[x].x + 0.5f,
                        at_y = static_cast<float>(y) + vectors[x].y + 0.5f;
            const bool inside =
                at_x >= 0 && at_y >= 0 && at_x < static_cast<float>(width) && at_y < static_cast<float>(height);
            // Truncation rounds down, since the values are not negative.
            const std::ptrdiff_t there =
                inside ? std::ptrdiff_t{static_cast<int>(at_y)} * width + static_cast<int>(at_x) : 0;
            if (inside && kinds_there[there] == kinds[x])
                vectors[x] += vectors_there[there];
            else
                kinds[x] = core::PixelClass::none;
        }
    });
}

/// Frames behind the one asked for that may be asked for again: references lie four back at most.
constexpr std::int64_t kept_behind = 8;

/// Frames that are read ahead: look-ahead, and two more being read (frame_source.cpp).
constexpr std::int64_t kept_ahead = encoder::LookAhead::depth + 3;

std::optional<int> descriptor_in(const std::string& name) {
    int number = -1;
    if (!name.starts_with("fd:")) return {};
    const auto [end, failure] = std::from_chars(name.data() + 3, name.data() + name.size(), number);
    if (failure != std::errc{} || end != name.data() + name.size() || number < 0) return {};
    return number;
}

int open_motion(const std::string& name) {
    if (const auto number = descriptor_in(name)) {
        if (fcntl(*number, F_GETFD) < 0) throw core::Error("reading", name, "this descriptor is not open");
        return *number;
    }
    // The writer may open it before its first picture, and may not wait for us.
    const int descriptor = open(name.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) throw core::Error("reading", name, std::strerror(errno));
    return descriptor;
}

}  // namespace

VectorLayers::VectorLayers(std::filesystem::path pattern, MotionConvention convention, int width, int height,
                           std::shared_ptr<SharedChannels> shared)
    : pattern_(std::move(pattern)),
      convention_(convention),
      width_(width),
      height_(height),
      shared_(std::move(shared)) {
    EXPECTS(is_numbered(pattern_));
}

void VectorLayers::check(std::int64_t first, std::int64_t last) {
    for (std::int64_t n = first; n <= last; ++n)
        if (!std::filesystem::exists(numbered(pattern_, n)))
            throw core::Error("reading", numbered(pattern_, n).string(), "no such file");
    last_ = last;
    if (first <= last) frame(first);
}

core::MotionField MotionSource::between(std::int64_t picture, std::int64_t reference) {
    EXPECTS(picture != reference);
    const std::int64_t direction = reference > picture ? 1 : -1;
    const auto step = [&](std::int64_t n) -> const core::MotionField& {
        return direction > 0 ? frame(n).to_next : frame(n).to_previous;
    };
    core::MotionField trajectory = step(picture);
    for (std::int64_t n = picture + direction; n != reference; n += direction) extend(trajectory, step(n));
    trajectory.reference = reference;
    return trajectory;
}

image::FrameMotion VectorLayers::read(std::int64_t number) const {
    const std::filesystem::path file = numbered(pattern_, number);
    if (core::ending_of(file) == ".motion") return image::read_motion_file(file, number, width_, height_);
    std::optional<image::ExrChannels> channels = shared_ ? shared_->take(number, reach) : std::nullopt;
    if (!channels) return image::read_motion(file, number, width_, height_, convention_);
    return image::motion_of(file, std::move(*channels), number, width_, height_, convention_);
}

const image::FrameMotion& VectorLayers::frame(std::int64_t number) {
    const auto known = read_.find(number);
    if (known != read_.end()) return known->second;
    const auto is_far = [&](const auto& entry) { return std::abs(entry.first - number) > reach; };
    std::erase_if(read_, is_far);
    std::erase_if(reading_, is_far);
    auto ahead = reading_.extract(number);
    image::FrameMotion motion = ahead.empty() ? read(number) : ahead.mapped().get();
    // chosen: 2: as many as frames.
    for (std::int64_t n = number + 1; n <= std::min(number + 2, last_) && !shared_; ++n)
        if (!read_.contains(n) && !reading_.contains(n))
            reading_.emplace(n, std::async(std::launch::async, [this, n] { return read(n); }));
    return read_.emplace(number, std::move(motion)).first->second;
}

bool MotionPipe::is_one(const std::filesystem::path& name) {
    return descriptor_in(name.string()).has_value() || (core::ending_of(name) == ".motion" && !is_numbered(name));
}

MotionPipe::MotionPipe(const std::filesystem::path& name)
    : name_(name.string()), descriptor_(open_motion(name_)), own_(!descriptor_in(name_)), bytes_(descriptor_, name_) {}

void MotionPipe::start(int width, int height) {
    header_ = bytes_.header(width, height);
    reader_ = std::thread([this] { read_ahead(); });
}

MotionPipe::~MotionPipe() {
    {
        const std::lock_guard lock(mutex_);
        stopped_ = true;
    }
    bytes_.stop();
    changed_.notify_all();
    if (reader_.joinable()) reader_.join();
    if (own_) close(descriptor_);
}

void MotionPipe::read_ahead() {
    std::unique_lock lock(mutex_);
    while (!stopped_ && !ended_ && failure_.empty()) {
        if (next_ > asked_ + kept_ahead) {
            changed_.wait(lock);
            continue;
        }
        const std::int64_t number = next_;
        lock.unlock();
        image::FrameMotion motion;
        bool there = false;
        std::string failure;
        try {
            there = bytes_.frame(header_, number, motion);
        } catch (const core::Error& error) {
            failure = error.what();
        }
        lock.lock();
        failure_ = std::move(failure);
        if (!failure_.empty()) continue;
        ended_ = !there;
        if (there) read_.emplace(next_++, std::move(motion));
        changed_.notify_all();
    }
    changed_.notify_all();
}

const image::FrameMotion& MotionPipe::frame(std::int64_t number) {
    std::unique_lock lock(mutex_);
    asked_ = std::max(asked_, number);
    std::erase_if(read_, [&](const auto& entry) { return entry.first < asked_ - kept_behind - kept_ahead; });
    changed_.notify_all();
    changed_.wait(lock, [&] { return read_.contains(number) || ended_ || !failure_.empty(); });
    if (const auto found = read_.find(number); found != read_.end()) return found->second;
    if (!failure_.empty()) throw core::Error(failure_);
    throw core::Error("reading", name_, fmt::format("it ends before frame {}, of which there is a picture", number));
}

}  // namespace render2mpeg::app
