#include "app/loop/motion_pipe.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/numeric.h"
#include "core/text.h"
#include "encoder/look_ahead.h"

namespace render2mpeg::app {
namespace {

static_assert(std::endian::native == std::endian::little, "motion streams are little endian, and read as they are");

/// Frames behind the one asked for that may be asked for again: references lie four back at most.
constexpr std::int64_t kept_behind = 8;

/// Frames that are read ahead: pictures are looked at so far, and two more are being read (frames_ahead.cpp).
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
    // Who writes may open it before a picture is written, and may not wait for us then.
    const int descriptor = open(name.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) throw core::Error("reading", name, std::strerror(errno));
    return descriptor;
}

/// Makes what is no number `none`, and a field of the vectors of a frame.
void settle_field(core::MotionField& field, const core::Plane<core::PixelClass>& kinds, std::int64_t number, int step) {
    field.picture = number;
    field.reference = number + step;
    field.kind = kinds;
    for (std::size_t i = 0; i < kinds.size(); ++i)
        if (!core::is_finite(field.vector.values()[i])) {
            field.vector.values()[i] = glm::vec2(0);
            field.kind.values()[i] = core::PixelClass::none;
        }
}

}  // namespace

void MotionBytes::refuse(const std::string& cause) const {
    throw core::Error("reading", name_, fmt::format("byte {}", at_), cause);
}

bool MotionBytes::read(void* into, std::size_t size) {
    auto* to = static_cast<std::uint8_t*>(into);
    for (std::size_t done = 0; done < size;) {
        pollfd state{descriptor_, POLLIN, 0};
        if (poll(&state, 1, 100) <= 0) {
            if (stopped_) refuse("nobody wants it any more");
            continue;
        }
        const ssize_t count = ::read(descriptor_, to + done, size - done);
        if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (count < 0) refuse(std::strerror(errno));
        if (count == 0 && done == 0) return false;
        if (count == 0) refuse("it is cut off");
        done += static_cast<std::size_t>(count);
        at_ += static_cast<std::uint64_t>(count);
    }
    return true;
}

MotionHeader MotionBytes::header(int width, int height) {
    std::array<std::uint32_t, 8> words{};
    if (!read(words.data(), sizeof words)) refuse("it is empty");
    at_ = 0;
    if (words[0] != 0x564d3252u)  // "R2MV"
        refuse("no motion stream begins here: expected R2MV");
    if (words[1] != 1) refuse(fmt::format("version {} is not known, only 1", words[1]));
    if (words[2] != static_cast<std::uint32_t>(width) || words[3] != static_cast<std::uint32_t>(height))
        refuse(fmt::format("its motion is {}x{} pixels, the pictures are {}x{}", words[2], words[3], width, height));
    if (words[4] < 1 || words[4] > 2) refuse(fmt::format("{} fields per frame: expected 1 or 2", words[4]));
    if (words[5] != 0 || words[6] != 0 || words[7] != 0) refuse("the header's last 12 bytes are not 0");
    at_ = sizeof words;
    return {width, height, static_cast<int>(words[4])};
}

bool MotionBytes::frame(const MotionHeader& header, std::int64_t number, FrameMotion& motion) {
    core::Plane<glm::vec2>& back = motion.to_previous.vector;
    core::Plane<glm::vec2>& on = motion.to_next.vector;
    back = on = core::Plane<glm::vec2>(header.width, header.height);
    if (!read(back.values().data(), back.size() * sizeof(glm::vec2))) return false;
    if (header.fields == 1) {
        // What moves evenly goes on as it came.
        for (std::size_t i = 0; i < on.size(); ++i) on.values()[i] = -back.values()[i];
    } else if (!read(on.values().data(), on.size() * sizeof(glm::vec2))) {
        refuse("it is cut off");
    }
    core::Plane<std::uint8_t> codes(header.width, header.height);
    const std::uint64_t begin = at_;
    if (!read(codes.values().data(), codes.size())) refuse("it is cut off");
    core::Plane<core::PixelClass> kinds(header.width, header.height);
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const std::uint8_t code = codes.values()[i];
        if (code > 3) {
            at_ = begin + i;
            refuse(fmt::format("class {} of a pixel of frame {}: expected 0 to 3", code, number));
        }
        kinds.values()[i] = static_cast<core::PixelClass>(code);
    }
    settle_field(motion.to_previous, kinds, number, -1);
    settle_field(motion.to_next, kinds, number, 1);
    return true;
}

bool MotionPipe::is_one(const std::filesystem::path& name) {
    return descriptor_in(name.string()).has_value() || core::ending_of(name) == ".motion";
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
        FrameMotion motion;
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

const FrameMotion& MotionPipe::frame(std::int64_t number) {
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
