#include "app/loop/vector_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "app/loop/motion_pipe.h"
#include "app/options/output_kind.h"
#include "core/error.h"
#include "core/numeric.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

using Values = const std::vector<float>*;

/// Whether a name is `end`, alone or behind a layer's name and a dot.
bool ends_with(const std::string& name, const std::string& end) {
    return name.ends_with(end) && (name.size() == end.size() || name[name.size() - end.size() - 1] == '.');
}

/// Channels of a file found by the end of their names: "ViewLayer.Vector.X" is "Vector.X" of some layer.
class Layers {
  public:
    explicit Layers(image::ExrChannels channels) : file_(std::move(channels)) {}

    int width() const { return file_.width; }
    int height() const { return file_.height; }

    /// Two channels of the same layer: the first such pair. Nothing unless both are there.
    std::optional<std::pair<Values, Values>> pair(const std::string& first, const std::string& second) const {
        for (const image::Channel& channel : file_.channels) {
            if (!ends_with(channel.name, first)) continue;
            const std::string layer = channel.name.substr(0, channel.name.size() - first.size());
            if (const Values other = exact(layer + second)) return std::pair{&channel.values, other};
        }
        return {};
    }
    /// Null where there is none.
    Values exact(const std::string& name) const {
        for (const image::Channel& channel : file_.channels)
            if (channel.name == name) return &channel.values;
        return nullptr;
    }

  private:
    image::ExrChannels file_;
};

/// Adds a direction to a field: `scale` times the values are reference minus current position, y up.
void fill(core::MotionField& field, const std::pair<Values, Values>& values, float scale) {
    for (std::size_t i = 0; i < field.vector.size(); ++i) {
        const glm::vec2 v{scale * (*values.first)[i], -scale * (*values.second)[i]};
        if (core::is_finite(v))
            field.vector.values()[i] = v;
        else
            field.kind.values()[i] = core::PixelClass::none;
    }
}

/// X and Y: previous minus current. Z and W: current minus next. [BlenderVector]
bool fill_blender(FrameMotion& motion, const Layers& layers) {
    const auto previous = layers.pair("Vector.X", "Vector.Y"), next = layers.pair("Vector.Z", "Vector.W");
    if (!previous || !next) return false;
    fill(motion.to_previous, *previous, 1);
    fill(motion.to_next, *next, -1);
    return true;
}

/// `forward`: next minus current; `backward`: previous minus current; `motion` alone is forward [NukeVectors]. What is
/// missing of both is the other turned round: what moves evenly goes on as it came.
bool fill_nuke(FrameMotion& motion, const Layers& layers) {
    const auto backward = layers.pair("backward.u", "backward.v");
    auto forward = layers.pair("forward.u", "forward.v");
    if (!forward && !backward) forward = layers.pair("motion.u", "motion.v");
    if (!forward && !backward) return false;
    fill(motion.to_previous, backward ? *backward : *forward, backward ? 1.0f : -1.0f);
    fill(motion.to_next, forward ? *forward : *backward, forward ? 1.0f : -1.0f);
    return true;
}

/// What our own files say beside Vector; others tell surfaces and sky not apart.
core::Plane<core::PixelClass> classes(const Layers& layers) {
    core::Plane<core::PixelClass> kinds(layers.width(), layers.height(), core::PixelClass::surface);
    if (const Values values = layers.exact("render2mpeg.Class.X"))
        for (std::size_t i = 0; i < kinds.size(); ++i) {
            const float value = (*values)[i];
            kinds.values()[i] = value >= 0.0f && value < 3.5f ? static_cast<core::PixelClass>(std::lround(value))
                                                              : core::PixelClass::none;
        }
    return kinds;
}

/// Follows `step`, a field of the frame where the way stands, one frame on.
void extend(core::MotionField& way, const core::MotionField& step) {
    const int width = way.vector.width(), height = way.vector.height();
    const core::PixelClass* kinds_there = step.kind.row(0);
    const glm::vec2* vectors_there = step.vector.row(0);
    parallel::for_each(static_cast<std::size_t>(height), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        core::PixelClass* kinds = way.kind.row(y);
        glm::vec2* vectors = way.vector.row(y);
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
            // What is not below 0 is rounded down by being cut off.
            const std::ptrdiff_t there =
                inside ? std::ptrdiff_t{static_cast<int>(at_y)} * width + static_cast<int>(at_x) : 0;
            if (inside && kinds_there[there] == kinds[x])
                vectors[x] += vectors_there[there];
            else
                kinds[x] = core::PixelClass::none;
        }
    });
}

/// Motion from channels of a file.
FrameMotion motion_from(const std::filesystem::path& file, image::ExrChannels channels, std::int64_t frame, int width,
                        int height, MotionConvention convention) {
    const Layers layers(std::move(channels));
    if (layers.width() != width || layers.height() != height)
        throw core::Error("reading", file.string(),
                          fmt::format("its motion is {}x{} pixels, the pictures are {}x{}", layers.width(),
                                      layers.height(), width, height));
    FrameMotion motion;
    for (core::MotionField* field : {&motion.to_previous, &motion.to_next}) {
        field->picture = frame;
        field->reference = field == &motion.to_previous ? frame - 1 : frame + 1;
        field->vector = core::Plane<glm::vec2>(width, height, glm::vec2(0));
        field->kind = classes(layers);
    }
    const bool found =
        convention == MotionConvention::blender ? fill_blender(motion, layers) : fill_nuke(motion, layers);
    if (!found)
        throw core::Error("reading", file.string(),
                          convention == MotionConvention::blender
                              ? "it has no motion: Blender's convention has channels Vector.X, .Y, .Z and .W"
                              : "it has no motion: Nuke's convention has channels forward.u and .v, backward.u and .v, "
                                "or motion.u and .v");
    return motion;
}

}  // namespace

bool is_motion(const std::string& channel) {
    for (const char* end : {"Vector.X", "Vector.Y", "Vector.Z", "Vector.W", "forward.u", "forward.v", "backward.u",
                            "backward.v", "motion.u", "motion.v", "render2mpeg.Class.X"})
        if (ends_with(channel, end)) return true;
    return false;
}

FrameMotion read_motion(const std::filesystem::path& file, std::int64_t frame, int width, int height,
                        MotionConvention convention) {
    return motion_from(file, image::read_exr(file, is_motion), frame, width, height, convention);
}

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
    core::MotionField way = step(picture);
    for (std::int64_t n = picture + direction; n != reference; n += direction) extend(way, step(n));
    way.reference = reference;
    return way;
}

FrameMotion VectorLayers::read(std::int64_t number) const {
    const std::filesystem::path file = numbered(pattern_, number);
    if (core::ending_of(file) == ".motion") return read_motion_file(file, number, width_, height_);
    std::optional<image::ExrChannels> channels = shared_ ? shared_->take(number, reach) : std::nullopt;
    if (!channels) channels = image::read_exr(file, is_motion);
    return motion_from(file, std::move(*channels), number, width_, height_, convention_);
}

const FrameMotion& VectorLayers::frame(std::int64_t number) {
    const auto known = read_.find(number);
    if (known != read_.end()) return known->second;
    const auto is_far = [&](const auto& entry) { return std::abs(entry.first - number) > reach; };
    std::erase_if(read_, is_far);
    std::erase_if(reading_, is_far);
    auto ahead = reading_.extract(number);
    FrameMotion motion = ahead.empty() ? read(number) : ahead.mapped().get();
    // chosen: 2: as many as frames.
    for (std::int64_t n = number + 1; n <= std::min(number + 2, last_) && !shared_; ++n)
        if (!read_.contains(n) && !reading_.contains(n))
            reading_.emplace(n, std::async(std::launch::async, [this, n] { return read(n); }));
    return read_.emplace(number, std::move(motion)).first->second;
}

}  // namespace render2mpeg::app
