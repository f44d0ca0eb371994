#pragma once
#include <cstdint>
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "app/loop/motion_source.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"
#include "app/options/options.h"
#include "core/picture.h"
#include "core/rational.h"
#include "encoder/look_ahead.h"
#include "encoder/types.h"
#include "perceptual/display.h"

namespace render2mpeg::app {

/// Finished frames from outside: a Y4M file, numbered images, or Y4M from a pipe.
class FrameSource {
  public:
    virtual ~FrameSource() = default;

    /// Of what read() gives, which may be larger than the frames.
    Size size() const { return size_; }
    /// All frames, without a gap; of an open-ended source the most there may be.
    FrameRange frames() const { return frames_; }
    bool is_open_ended() const { return is_open_ended_; }
    /// None where the frames do not say.
    std::optional<core::Rational> rate() const { return rate_; }
    std::optional<core::Rational> pixel_aspect() const { return pixel_aspect_; }
    /// Whether the first frame has alpha, which its film is to have.
    bool has_alpha() const { return has_alpha_; }
    /// Reads a frame, each once; none behind the end of an open-ended source. Thread-safe. Throws core::Error, also for
    /// another size.
    virtual std::optional<core::Picture> read(std::int64_t frame) = 0;
    /// Non-finite values that became 0 so far.
    virtual std::uint64_t non_finite() const { return 0; }
    /// A line about what read() adds to the frames; empty: nothing.
    virtual std::string note() const { return {}; }

  protected:
    Size size_;
    FrameRange frames_;
    bool is_open_ended_ = false, has_alpha_ = false;
    std::optional<core::Rational> rate_, pixel_aspect_;
};

/// Signals of a film made of images.
struct FilmSignals {
    std::optional<perceptual::ColorMatrix> matrix = {};  ///< none: by the pictures' height
    core::View view = {};                                ///< of scene-linear images
    core::ExactChroma chroma = core::ExactChroma::none;
    bool alpha = false;       ///< it has that of its images; else they are over black
    bool even_sides = false;  ///< the last column or row of frames with odd ones is shown twice
};

/// Opens `-` (Y4M from standard input), `film.y4m`, `frames.%04d.exr` (scene-linear, developed with `exposure` EV,
/// default 0; TIFF of floats likewise) or `frames.%04d.png` (sRGB; TIFF and JPEG likewise). Only the `wanted` frames
/// need exist, else all between the first and last number. `shared` receives motion channels of OpenEXR frames unless
/// null. Throws core::Error, also for an unused exposure.
std::unique_ptr<FrameSource> open_frames(const std::filesystem::path& input, std::optional<float> exposure,
                                         const std::optional<FrameRange>& wanted, const FilmSignals& film = {},
                                         std::shared_ptr<SharedChannels> shared = nullptr);

/// Frames of one chunk in order, read ahead in threads. Its look-ahead depends on the chunk's frames alone.
class FramesAhead {
  public:
    FramesAhead(FrameSource& frames, const Chunk& chunk, const encoder::Settings& coding);
    ~FramesAhead();

    /// The next frame, once those that look() needs are read; none behind the last. Waiting counts as reading. Throws
    /// core::Error.
    std::optional<core::Picture> next(RunStatistics& statistics);
    /// Frames read and not taken yet, at least those that look() needs.
    const std::deque<core::Picture>& waiting(RunStatistics& statistics);
    /// Those that are read and not given.
    const std::deque<core::Picture>& later() const { return read_; }
    encoder::LookAhead& look() { return look_; }

  private:
    void start_reading();

    FrameSource& frames_;
    std::int64_t next_, last_;  ///< frame to be read next, and the chunk's last
    int grain_;                 ///< ISO of film grain that they get; 0: none
    std::deque<std::future<std::optional<core::Picture>>> reading_;
    std::deque<core::Picture> read_;
    encoder::LookAhead look_;
};

}  // namespace render2mpeg::app
