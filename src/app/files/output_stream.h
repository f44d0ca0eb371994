#pragma once
// Writes bytes to a pipe whose reader may be slow, or go.
#include <condition_variable>
#include <csignal>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <iosfwd>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace render2mpeg::app {

/// Writes to a descriptor in a thread; fast writers wait. SIGPIPE is ignored meanwhile. One at a time.
class OutputStream {
  public:
    /// `name` is for messages. The descriptor stays open.
    explicit OutputStream(int descriptor, std::string name);
    /// Drops unwritten bytes.
    ~OutputStream();
    OutputStream(const OutputStream&) = delete;
    OutputStream& operator=(const OutputStream&) = delete;

    /// Queues bytes. False where they will never be written: the reader has gone, or hangs after an interruption.
    bool put(std::span<const std::uint8_t> bytes);
    bool has_lost_reader();
    /// Throws core::Error where the reader has gone.
    void check();
    /// Waits until all is written. Throws core::Error; an interruption is none.
    void finish();
    std::uint64_t bytes() const { return taken_; }
    /// After finish().
    bool has_written_all() const { return taken_ == written_; }

  private:
    void write_all();
    bool wait_for_less_than(std::size_t waiting, std::unique_lock<std::mutex>& lock);

    int descriptor_;
    std::string name_;
    std::uint64_t taken_ = 0, written_ = 0;
    std::deque<std::vector<std::uint8_t>> queue_;
    int failure_ = 0;  ///< errno
    bool ended_ = false;
    std::mutex mutex_;
    std::condition_variable changed_;
    struct sigaction before_ {};
    std::thread writer_;
};

/// Writes all that is left of `from` into a pipe or device. Waits for a reader as long as it takes. Throws core::Error,
/// and Interrupted where an interruption came before all was taken.
void write_into(const std::filesystem::path& file, std::istream& from);

}  // namespace render2mpeg::app
