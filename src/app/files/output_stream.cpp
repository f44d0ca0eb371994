#include "app/files/output_stream.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <cstring>
#include <istream>
#include <memory>
#include <utility>

#include "app/system/interrupt.h"
#include "core/error.h"

namespace render2mpeg::app {
namespace {

/// Bytes that may wait for a reader. chosen: 8 MiB, some GOPs of a film or ten uncompressed pictures of 1280x720: a
/// player that fills its own buffer first stops nobody, and memory is not the disk.
constexpr std::size_t most_waiting = 8 << 20;

/// How often it is looked whether the reader, or the user, has gone. chosen: 100 ms, which nobody notices.
constexpr std::chrono::milliseconds beat{100};

/// Beats without a byte taken after which an interrupted stream is given up.
constexpr int patience = 10;

bool is_abandoned(int descriptor) {
    pollfd state{descriptor, 0, 0};
    return poll(&state, 1, 0) > 0 && (state.revents & (POLLERR | POLLNVAL)) != 0;
}

}  // namespace

OutputStream::OutputStream(int descriptor, std::string name) : descriptor_(descriptor), name_(std::move(name)) {
    struct sigaction ignored {};
    ignored.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &ignored, &before_);
    writer_ = std::thread([this] { write_all(); });
}

OutputStream::~OutputStream() {
    {
        const std::lock_guard lock(mutex_);
        ended_ = true;
    }
    changed_.notify_all();
    writer_.join();
    sigaction(SIGPIPE, &before_, nullptr);
}

void OutputStream::write_all() {
    std::unique_lock lock(mutex_);
    while (!ended_ && failure_ == 0) {
        if (queue_.empty()) {
            if (is_abandoned(descriptor_)) failure_ = EPIPE;
            changed_.notify_all();
            changed_.wait_for(lock, beat);
            continue;
        }
        const std::vector<std::uint8_t> piece = std::move(queue_.front());
        queue_.pop_front();
        for (std::size_t at = 0; at < piece.size() && !ended_ && failure_ == 0;) {
            lock.unlock();
            // A pipe that can be written to takes so many bytes without waiting.
            pollfd state{descriptor_, POLLOUT, 0};
            const int ready = poll(&state, 1, static_cast<int>(beat.count()));
            const std::size_t part = std::min<std::size_t>(piece.size() - at, PIPE_BUF);
            const ssize_t count = ready > 0 ? write(descriptor_, piece.data() + at, part) : 0;
            const int error = count < 0 ? errno : 0;
            lock.lock();
            if (error != 0 && error != EAGAIN && error != EINTR) failure_ = error;
            if (count > 0) {
                at += static_cast<std::size_t>(count);
                written_ += static_cast<std::uint64_t>(count);
            }
        }
        changed_.notify_all();
    }
    changed_.notify_all();
}

bool OutputStream::wait_for_less_than(std::size_t waiting, std::unique_lock<std::mutex>& lock) {
    std::uint64_t written = written_;
    for (int beats = 0; failure_ == 0 && taken_ - written_ >= waiting;) {
        changed_.wait_for(lock, beat);
        beats = written == written_ && InterruptGuard::requested() ? beats + 1 : 0;
        written = written_;
        if (beats >= patience) return false;
    }
    return failure_ == 0;
}

bool OutputStream::put(std::span<const std::uint8_t> bytes) {
    std::unique_lock lock(mutex_);
    if (!wait_for_less_than(most_waiting, lock)) return false;
    queue_.emplace_back(bytes.begin(), bytes.end());
    taken_ += bytes.size();
    changed_.notify_all();
    return true;
}

bool OutputStream::has_lost_reader() {
    const std::lock_guard lock(mutex_);
    return failure_ == EPIPE;
}

void OutputStream::check() {
    const std::lock_guard lock(mutex_);
    if (failure_ == EPIPE) throw core::Error("writing", name_, "its reader has gone");
    if (failure_ != 0) throw core::Error("writing", name_, std::strerror(failure_));
}

void OutputStream::finish() {
    {
        std::unique_lock lock(mutex_);
        // Taken bytes are written all the same.
        wait_for_less_than(1, lock);
        if (failure_ == EPIPE && taken_ == written_) return;
    }
    check();
}

void write_into(const std::filesystem::path& file, std::istream& from) {
    // Without O_NONBLOCK a signal would not end the wait for a reader.
    int descriptor = -1;
    while ((descriptor = open(file.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC)) < 0) {
        const bool waits = errno == ENXIO && std::filesystem::is_fifo(file);
        if (!waits && errno != EINTR) throw core::Error("writing", file.string(), std::strerror(errno));
        if (InterruptGuard::requested()) throw Interrupted("writing", file.string(), "interrupted; nobody read it");
        std::this_thread::sleep_for(beat);
    }
    const std::unique_ptr<int, void (*)(int*)> closed(&descriptor, [](int* open) { close(*open); });
    OutputStream out(descriptor, file.string());
    std::vector<char> piece(1 << 20);
    while (from.read(piece.data(), static_cast<std::streamsize>(piece.size())), from.gcount() > 0) {
        const auto bytes = std::as_bytes(std::span(piece).first(static_cast<std::size_t>(from.gcount())));
        if (!out.put({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()})) break;
    }
    out.finish();
    if (!out.has_written_all()) throw Interrupted("writing", file.string(), "interrupted; its reader takes no more");
    if (from.bad() || !from.eof()) throw core::Error("writing", file.string(), "what goes there cannot be read");
}

}  // namespace render2mpeg::app
