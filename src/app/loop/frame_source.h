#pragma once
#include <cstdint>
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "app/loop/run_statistics.h"
#include "app/loop/vector_layers.h"
#include "app/options/film.h"
#include "app/options/options.h"
#include "core/picture.h"
#include "core/rational.h"
#include "encoder/look_ahead.h"
#include "encoder/types.h"
#include "perceptual/display.h"

namespace render2mpeg::app {

/// Frames that a pipe may bring, at most: more than a year of them.
inline constexpr std::int64_t most_piped_frames = std::int64_t{1} << 31;

/// Finished frames from outside: a Y4M file, numbered images, or Y4M from a pipe.
class FrameSource {
  public:
    virtual ~FrameSource() = default;

    /// Of every frame.
    virtual Size size() const = 0;
    /// The frames there are, without a gap; of an open-ended source all that there may be.
    virtual FrameRange frames() const = 0;
    /// Whether only reading tells where it ends.
    virtual bool is_open_ended() const { return false; }
    /// Pictures per second, and width by height of a pixel; none: the frames do not say.
    virtual std::optional<core::Rational> rate() const { return {}; }
    virtual std::optional<core::Rational> pixel_aspect() const { return {}; }
    /// Reads one of frames(), each once; none behind the end of an open-ended source. Threads may read at once. Throws
    /// core::Error, also where its size is another.
    virtual std::optional<core::Picture> read(std::int64_t frame) = 0;
    /// Values that were not finite and became 0 in the frames read so far.
    virtual std::uint64_t non_finite() const { return 0; }
};

/// How a film's signals come from images.
struct FilmSignals {
    std::optional<perceptual::ColorMatrix> matrix = {};  ///< none: by the pictures' height
    bool keeps_codes = false;  ///< PNG's code values are the film's R'G'B' as they are, whatever curve they have
    core::View view = {};      ///< of scene-linear images
};

/// Opens FRAMES: `-`, Y4M from standard input, `film.y4m`, `frames.%04d.exr` (scene-linear; developed with `exposure`
/// EV, 0 where none is given) or `frames.%04d.png` (display-referred sRGB). `wanted`: only these frames need be there;
/// else all from the first number to the last. `film`: what pictures the images become. Throws core::Error, also for an
/// exposure that frames have no use for. `shared` gets the motion channels (vector_layers.h) of every OpenEXR frame
/// that is read; null: nobody wants them.
std::unique_ptr<FrameSource> open_frames(const std::filesystem::path& input, std::optional<float> exposure,
                                         const std::optional<FrameRange>& wanted, const FilmSignals& film = {},
                                         std::shared_ptr<SharedChannels> shared = nullptr);

/// The frames of one chunk in order, read in threads of their own as far ahead as the look-ahead asks for. What it
/// says depends on the chunk's frames alone.
class FramesAhead {
  public:
    FramesAhead(FrameSource& frames, const Chunk& chunk, const encoder::Settings& coding);
    ~FramesAhead();

    /// The next frame; those that look() needs are there then. None behind the last one, which of an open-ended source
    /// only comes to be known. Waiting counts as reading. Throws core::Error.
    std::optional<core::Picture> next(RunStatistics& statistics);
    /// Those that next() will give, as far as they are read now; so many that look() needs them for the first.
    const std::deque<core::Picture>& waiting(RunStatistics& statistics);
    encoder::LookAhead& look() { return look_; }

  private:
    void start_reading();

    FrameSource& frames_;
    std::int64_t next_, last_;  ///< frame to be read next, and the chunk's last
    std::deque<std::future<std::optional<core::Picture>>> reading_;
    std::deque<core::Picture> read_;
    encoder::LookAhead look_;
};

}  // namespace render2mpeg::app
