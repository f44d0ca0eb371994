#pragma once
// Writes bytes to a pipe whose reader may be slow, or go.
#include <condition_variable>
#include <csignal>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "app/options/film.h"
#include "encoder/av/av.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// Hands bytes to whoever reads a descriptor, in a thread of its own. Whoever is quicker than the reader waits. While
/// it lives, SIGPIPE is ignored. One at a time.
class OutputStream {
  public:
    /// `name` is what messages call it. The descriptor stays open.
    explicit OutputStream(int descriptor, std::string name);
    /// Gives up what is not written.
    ~OutputStream();
    OutputStream(const OutputStream&) = delete;
    OutputStream& operator=(const OutputStream&) = delete;

    /// Takes bytes, once most of those before are written. False where they will never be: the reader has gone, or
    /// takes nothing any more after an interruption.
    bool put(std::span<const std::uint8_t> bytes);
    bool has_lost_reader();
    /// Throws core::Error where the reader has gone, also if nothing was put since.
    void check();
    /// Waits until all is written. Throws core::Error where it cannot be; an interruption is no error.
    void finish();
    std::uint64_t bytes() const { return taken_; }

  private:
    void write_all();
    /// Waits for room, a beat at a time; false where none comes.
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

/// Hands coded pictures on as they come: a transport stream or an elementary one. The last picture carries the end code
/// with it, so that each waits for the next one to come. Throws core::Error where nobody takes them.
class FilmStream {
  public:
    /// `name`'s ending, .ts or .m2v, says which.
    FilmStream(OutputStream& out, const std::filesystem::path& name, const Film& film);

    /// Pictures in coding order.
    void write(const encoder::CodedPicture& picture);
    /// After the last picture; there was one.
    void finish();

  private:
    struct Waiting {
        std::vector<std::uint8_t> bytes;
        std::int64_t number = 0;
        bool starts_gop = false;
    };
    void pass_on();

    OutputStream& out_;
    encoder::Codec codec_;
    std::int64_t first_frame_;
    av::Muxer muxer_;
    std::int64_t coded_ = 0;  ///< pictures passed on
    std::optional<Waiting> waiting_;
};

}  // namespace render2mpeg::app
