#include "app/loop/frame_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iostream>
#include <map>
#include <mutex>
#include <string_view>
#include <utility>

#include "app/loop/statistics_recorder.h"
#include "app/options/mistakes.h"
#include "app/options/output_kind.h"
#include "core/error.h"
#include "core/film_grain.h"
#include "core/radiance.h"
#include "core/text.h"
#include "encoder/av/y4m_reader.h"
#include "encoder/codec.h"
#include "image/image.h"

namespace render2mpeg::app {
namespace {

/// Upper bound on a pipe's frames: more than a year.
constexpr std::int64_t most_piped_frames = std::int64_t{1} << 31;

void check_range(const FrameRange& wanted, const FrameRange& there, const std::string& name) {
    if (wanted.first < there.first || wanted.last > there.last)
        throw core::Error(
            "reading", name,
            fmt::format("it has frames {} to {}, not {} to {}", there.first, there.last, wanted.first, wanted.last));
}

/// Frames of a YUV4MPEG2 stream, one at a time.
class Y4mSource : public FrameSource {
  protected:
    void take(const av::Y4mFormat& format) {
        size_ = {format.width, format.height};
        rate_ = format.hertz;
        pixel_aspect_ = format.pixel_aspect;
    }
    std::mutex mutex_;
};

class Y4mFrames : public Y4mSource {
  public:
    Y4mFrames(const std::filesystem::path& file, const std::optional<FrameRange>& wanted, core::ExactChroma chroma)
        : reader_(file, chroma) {
        take(reader_.format());
        frames_ = {0, reader_.frames() - 1};
        if (wanted) check_range(*wanted, frames_, file.string());
        if (wanted) frames_ = *wanted;
    }
    std::optional<core::Picture> read(std::int64_t frame) override {
        const std::lock_guard lock(mutex_);
        return reader_.read(frame);
    }

  private:
    av::Y4mReader reader_;
};

/// Y4M from standard input. A reader keeps the frames that others asked for.
class PipedFrames : public Y4mSource {
  public:
    PipedFrames(const std::optional<FrameRange>& wanted, core::ExactChroma chroma)
        : pipe_(std::cin, "standard input", chroma) {
        take(pipe_.format());
        frames_ = {0, most_piped_frames - 1};
        is_open_ended_ = true;
        if (wanted)
            throw core::Error("frames: standard input has no frames to choose from; choose where they are made");
    }
    std::optional<core::Picture> read(std::int64_t frame) override {
        const std::lock_guard lock(mutex_);
        for (; !ended_ && next_ <= frame; ++next_) {
            std::optional<core::Picture> picture = pipe_.next();
            ended_ = !picture;
            if (picture) waiting_.emplace(next_, std::move(*picture));
        }
        const auto found = waiting_.extract(frame);
        return found.empty() ? std::nullopt : std::optional(std::move(found.mapped()));
    }

  private:
    av::Y4mPipe pipe_;
    std::map<std::int64_t, core::Picture> waiting_;  ///< read, and not asked for yet
    std::int64_t next_ = 0;
    bool ended_ = false;
};

/// Numbers of existing files, which must be consecutive.
FrameRange frames_on_disk(const std::filesystem::path& pattern) {
    const std::vector<std::int64_t> numbers = numbers_on_disk(pattern);
    if (numbers.empty()) throw core::Error("reading", pattern.string(), "no file has such a name");
    for (std::size_t i = 1; i < numbers.size(); ++i)
        if (numbers[i] != numbers[i - 1] + 1)
            throw core::Error("reading", pattern.string(),
                              fmt::format("frame {} is missing; --frames takes a part", numbers[i - 1] + 1));
    return {numbers.front(), numbers.back()};
}

class ImageFrames : public FrameSource {
  public:
    ImageFrames(const std::filesystem::path& pattern, std::optional<float> exposure,
                const std::optional<FrameRange>& wanted, const FilmSignals& film,
                std::shared_ptr<SharedChannels> shared)
        : pattern_(pattern), chroma_(film.chroma), shared_(std::move(shared)) {
        frames_ = wanted ? *wanted : frames_on_disk(pattern);
        for (std::int64_t n = frames_.first; n <= frames_.last; ++n)
            if (!std::filesystem::exists(numbered(pattern_, n)))
                throw core::Error("reading", numbered(pattern_, n).string(), "no such file");
        const image::Image first = read_image(frames_.first);
        size_ = {first.pixels.width(), first.pixels.height()};
        has_alpha_ = film.alpha && first.has_alpha;
        const int height = size_.height + (film.even_sides ? size_.height % 2 : 0);
        matrix_ = film.matrix.value_or(perceptual::matrix_for(height, film.view));
        display_.emplace(exposure.value_or(0.0f), matrix_, film.view, chroma_);
        // Files that know no other shape say square pixels.
        if (first.pixel_aspect > 0.001f && first.pixel_aspect < 1000 && first.pixel_aspect != 1)
            pixel_aspect_ = core::product({std::lround(10000 * first.pixel_aspect), 10000}, {1, 1});
        if (film.view.is_hdr() && !first.high_range)
            throw core::Error("view " + core::text_of(film.view) + ": the frames of " + pattern.string() +
                              " are as a display shows them; only scene-linear ones (EXR) have brighter light");
        if (exposure && !first.high_range)
            throw core::Error("exposure: the frames of " + pattern.string() +
                              " are as a display shows them; only scene-linear ones (EXR) are exposed");
    }
    std::uint64_t non_finite() const override { return non_finite_; }
    std::optional<core::Picture> read(std::int64_t frame) override {
        const image::Image image = read_image(frame);
        if (image.pixels.width() != size_.width || image.pixels.height() != size_.height)
            throw core::Error("reading", numbered(pattern_, frame).string(),
                              fmt::format("it has {}x{} pixels, the first frame {}x{}", image.pixels.width(),
                                          image.pixels.height(), size_.width, size_.height));
        core::Plane<float> alpha = has_alpha_ ? alpha_of(image) : core::Plane<float>();
        core::Plane<glm::vec3> colors = finite_colors(image);
        // Scene-linear colours are multiplied by alpha, code values are not. Light where alpha is 0 belongs to nothing.
        for (std::size_t i = 0; image.high_range && i < alpha.size(); ++i) {
            const float share = alpha.values()[i];
            glm::vec3& color = colors.values()[i];
            color = share > 0 ? color / std::max(share, 1.0f / 255) : glm::vec3(0);
        }
        core::Picture picture;
        if (image.high_range) {
            core::Radiance radiance;
            radiance.combined = colors;
            picture = display_->develop(radiance);
        } else {
            picture = perceptual::picture_of_signals(colors, matrix_, chroma_);
        }
        picture.number = frame;
        picture.alpha = std::move(alpha);
        return picture;
    }

  private:
    static core::Plane<float> alpha_of(const image::Image& image) {
        core::Plane<float> alpha(image.pixels.width(), image.pixels.height());
        for (std::size_t i = 0; i < alpha.size(); ++i) {
            const float value = image.pixels.values()[i].w;
            alpha.values()[i] = value > 0 ? std::min(value, 1.0f) : 0.0f;
        }
        return alpha;
    }
    image::Image read_image(std::int64_t frame) const {
        const std::filesystem::path file = numbered(pattern_, frame);
        if (core::ending_of(file) != ".exr") return image::read_image(file, {}, file.string());
        image::ExrFrame read = image::read_exr_frame(
            file, [&](const std::string& channel) { return shared_ && image::is_motion(channel); });
        if (shared_) shared_->put(frame, std::move(read.others));
        return std::move(read.image);
    }
    /// Values that are no numbers become 0.
    core::Plane<glm::vec3> finite_colors(const image::Image& image) {
        std::uint64_t found = 0;
        core::Plane<glm::vec3> colors(image.pixels.width(), image.pixels.height());
        for (std::size_t i = 0; i < colors.size(); ++i)
            for (int c = 0; c < 3; ++c) {
                const float value = image.pixels.values()[i][c];
                found += std::isfinite(value) ? 0u : 1u;
                // Half floats overflow at lamps.
                const float instead = value > 0 ? image::overflowed : 0.0f;
                colors.values()[i][c] = std::isfinite(value) ? value : instead;
            }
        non_finite_ += found;
        return colors;
    }

    std::filesystem::path pattern_;
    std::optional<perceptual::Display> display_;
    core::ExactChroma chroma_;
    perceptual::ColorMatrix matrix_ = perceptual::ColorMatrix::bt709;
    std::shared_ptr<SharedChannels> shared_;
    std::atomic<std::uint64_t> non_finite_ = 0;
};

/// Frames of odd sides, with their last column or row once more.
class EvenFrames : public FrameSource {
  public:
    explicit EvenFrames(std::unique_ptr<FrameSource> odd) : odd_(std::move(odd)) {
        size_ = {odd_->size().width + odd_->size().width % 2, odd_->size().height + odd_->size().height % 2};
        frames_ = odd_->frames();
        is_open_ended_ = odd_->is_open_ended();
        has_alpha_ = odd_->has_alpha();
        rate_ = odd_->rate();
        pixel_aspect_ = odd_->pixel_aspect();
    }
    std::optional<core::Picture> read(std::int64_t frame) override {
        std::optional<core::Picture> picture = odd_->read(frame);
        if (!picture) return picture;
        extend(picture->y);
        for (core::Plane<float>* plane : {&picture->luma, &picture->exact_cb, &picture->exact_cr, &picture->alpha})
            if (plane->width() == odd_->size().width && plane->height() == odd_->size().height) extend(*plane);
        return picture;
    }
    std::uint64_t non_finite() const override { return odd_->non_finite(); }
    std::string note() const override {
        return fmt::format("frames of {}x{}: sides are even, so the last column or row is shown twice, {}x{}",
                           odd_->size().width, odd_->size().height, size_.width, size_.height);
    }

  private:
    template <class Value>
    void extend(core::Plane<Value>& plane) const {
        if (plane.empty()) return;
        core::Plane<Value> larger(size_.width, size_.height);
        for (int y = 0; y < size_.height; ++y)
            for (int x = 0; x < size_.width; ++x)
                larger.at(x, y) = plane.at(std::min(x, plane.width() - 1), std::min(y, plane.height() - 1));
        plane = std::move(larger);
    }

    std::unique_ptr<FrameSource> odd_;
};

std::unique_ptr<FrameSource> open_as_they_are(const std::filesystem::path& input, std::optional<float> exposure,
                                              const std::optional<FrameRange>& wanted, const FilmSignals& film,
                                              std::shared_ptr<SharedChannels> shared) {
    if (input == "-") {
        if (exposure) throw core::Error("exposure: the frames of standard input are as a display shows them");
        return std::make_unique<PipedFrames>(wanted, film.chroma);
    }
    const std::string ending = core::ending_of(input);
    if (ending == ".y4m") {
        if (exposure)
            throw core::Error("exposure: the frames of " + input.string() +
                              " are as a display shows them; only scene-linear ones (EXR) are exposed");
        return std::make_unique<Y4mFrames>(input, wanted, film.chroma);
    }
    constexpr std::array<std::string_view, 6> images{".exr", ".png", ".tif", ".tiff", ".jpg", ".jpeg"};
    if (std::ranges::find(images, ending) == images.end())
        throw core::Error("reading", input.string(), not_frames(input));
    if (!is_numbered(input))
        throw core::Error("reading", input.string(),
                          "numbered images need one frame number in their name, e.g. frames.%04d" + ending);
    return std::make_unique<ImageFrames>(input, exposure, wanted, film, std::move(shared));
}

/// chosen: 2: frames of many packed channels take several times as long to read as to code.
constexpr std::size_t readers = 2;

}  // namespace

std::unique_ptr<FrameSource> open_frames(const std::filesystem::path& input, std::optional<float> exposure,
                                         const std::optional<FrameRange>& wanted, const FilmSignals& film,
                                         std::shared_ptr<SharedChannels> shared) {
    std::unique_ptr<FrameSource> frames = open_as_they_are(input, exposure, wanted, film, std::move(shared));
    const bool is_odd = frames->size().width % 2 != 0 || frames->size().height % 2 != 0;
    return film.even_sides && is_odd ? std::make_unique<EvenFrames>(std::move(frames)) : std::move(frames);
}

FramesAhead::FramesAhead(FrameSource& frames, const Chunk& chunk, const encoder::Settings& coding)
    : frames_(frames),
      next_(chunk.first),
      last_(chunk.last),
      grain_(encoder::grain_of_pictures(coding)),
      look_(frames.size().width, frames.size().height, coding.b_pictures) {
    start_reading();
}

FramesAhead::~FramesAhead() {
    for (const std::future<std::optional<core::Picture>>& frame : reading_) frame.wait();
}

void FramesAhead::start_reading() {
    for (; next_ <= last_ && reading_.size() < readers; ++next_)
        reading_.push_back(std::async(std::launch::async, [this, n = next_] {
            std::optional<core::Picture> picture = frames_.read(n);
            if (picture) core::add_grain(*picture, grain_);
            return picture;
        }));
}

const std::deque<core::Picture>& FramesAhead::waiting(RunStatistics& statistics) {
    while (!reading_.empty() && static_cast<std::int64_t>(read_.size()) <= encoder::LookAhead::depth) {
        std::future<std::optional<core::Picture>> frame = std::move(reading_.front());
        reading_.pop_front();
        std::optional<core::Picture> picture = timed(statistics, Stage::develop, [&] { return frame.get(); });
        if (!picture) {  // the source has ended, and what is being read lies behind its end
            last_ = -1;
            continue;
        }
        read_.push_back(std::move(*picture));
        start_reading();
        timed(statistics, Stage::encode, [&] { look_.add(read_.back()); });
    }
    if (reading_.empty()) look_.end();
    return read_;
}

std::optional<core::Picture> FramesAhead::next(RunStatistics& statistics) {
    if (waiting(statistics).empty()) return {};
    core::Picture picture = std::move(read_.front());
    read_.pop_front();
    look_.forget_before(picture.number - 4);
    return picture;
}

}  // namespace render2mpeg::app
