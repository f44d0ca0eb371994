#include "image/layers.h"

#include <cmath>
#include <string>
#include <vector>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::image {
namespace {

/// Blender's depth value for pixels without depth.
constexpr float no_depth = 1e10f;

/// The channels of one frame, added layer by layer.
class Frame {
  public:
    Frame(int width, int height) : width_(width), height_(height) {}

    /// One channel; `value(i)` is that of pixel i, row by row.
    template <class Value>
    void add(const std::string& name, bool half, const Value& value) {
        Channel channel{name, std::vector<float>(pixels()), half};
        for (std::size_t i = 0; i < channel.values.size(); ++i) channel.values[i] = value(i);
        channels_.push_back(std::move(channel));
    }

    /// Red, green and blue, unless the plane is empty.
    void add_color(const std::string& layer, const core::Plane<glm::vec3>& plane) {
        if (plane.empty()) return;
        EXPECTS(plane.width() == width_ && plane.height() == height_);
        for (int c = 0; c < 3; ++c)
            add(layer.empty() ? std::string(1, "RGB"[c]) : layer + "." + "RGB"[c], true,
                [&, c](std::size_t i) { return plane.values()[i][c]; });
    }

    /// Colour with alpha; `layer` may be empty: the plain names, which every viewer looks for.
    void add_covered(const std::string& layer, const core::Plane<glm::vec3>& plane, const core::Mattes& mattes) {
        add_color(layer, plane);
        add(layer.empty() ? "A" : layer + ".A", true,
            [&](std::size_t i) { return mattes.empty() ? 1.0f : mattes.alpha(i); });
    }

    void add_mattes(const core::Mattes& mattes, const MatteNames& names, FrameFacts& facts) {
        if (!mattes.empty()) add_cryptomatte(mattes, names, channels_, facts);
    }

    void add_normal(const std::string& layer, const core::Plane<core::PackedNormal>& plane,
                    const core::Plane<core::PixelClass>& kind) {
        for (int c = 0; c < 3; ++c)
            add(layer + "." + "XYZ"[c], false, [&, c](std::size_t i) {
                const core::PixelClass k = kind.values()[i];
                const bool has_surface = k == core::PixelClass::surface || k == core::PixelClass::reflected;
                return has_surface ? plane.values()[i].unpack()[c] : 0.0f;
            });
    }

    void write(const std::filesystem::path& path, const FrameFacts& facts) const {
        write_exr(path, width_, height_, channels_, facts);
    }

  private:
    std::size_t pixels() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_); }

    int width_, height_;
    std::vector<Channel> channels_;
};

/// Reference minus current, y up; zero where nothing is known.
glm::vec2 motion_of(const core::MotionField* field, std::size_t i) {
    if (field == nullptr || field->kind.values()[i] == core::PixelClass::none) return {0, 0};
    const glm::vec2 v = field->vector.values()[i];
    return core::is_finite(v) ? glm::vec2(v.x, -v.y) : glm::vec2(0, 0);
}

/// Blender's Vector: previous minus current, and current minus next.
void add_motion(Frame& frame, const core::MotionField* to_previous, const core::MotionField* to_next) {
    if (to_previous == nullptr && to_next == nullptr) return;
    frame.add("ViewLayer.Vector.X", false, [&](std::size_t i) { return motion_of(to_previous, i).x; });
    frame.add("ViewLayer.Vector.Y", false, [&](std::size_t i) { return motion_of(to_previous, i).y; });
    frame.add("ViewLayer.Vector.Z", false, [&](std::size_t i) { return 0 - motion_of(to_next, i).x; });
    frame.add("ViewLayer.Vector.W", false, [&](std::size_t i) { return 0 - motion_of(to_next, i).y; });
}

/// Indices count from 1, so that 0 is nothing.
void add_surfaces(Frame& frame, const core::Visible& visible) {
    const auto index = [](std::uint32_t id) { return id == core::no_id ? 0.0f : static_cast<float>(id) + 1.0f; };
    frame.add("ViewLayer.Depth.Z", false, [&](std::size_t i) {
        const float depth = visible.depth.values()[i];
        return std::isfinite(depth) ? depth : no_depth;
    });
    frame.add_normal("ViewLayer.Normal", visible.shading_normal, visible.kind);
    frame.add_normal("render2mpeg.GeometricNormal", visible.geometric_normal, visible.kind);
    frame.add("ViewLayer.IndexOB.X", false, [&](std::size_t i) { return index(visible.address.values()[i].object); });
    frame.add("ViewLayer.IndexMA.X", false, [&](std::size_t i) { return index(visible.material.values()[i]); });
    frame.add("render2mpeg.Class.X", false,
              [&](std::size_t i) { return static_cast<float>(visible.kind.values()[i]); });
}

/// Adds emission, divided into surfaces and sky by the class of the pixel's centre.
void add_emission(Frame& frame, const core::Visible& visible, const core::Plane<glm::vec3>& emission) {
    if (emission.empty()) return;
    core::Plane<glm::vec3> surfaces = emission, sky = emission;
    for (std::size_t i = 0; i < emission.size(); ++i)
        (visible.kind.values()[i] == core::PixelClass::sky ? surfaces : sky).values()[i] = glm::vec3(0);
    frame.add_color("ViewLayer.Emit", surfaces);
    frame.add_color("ViewLayer.Env", sky);
}

/// How much of a pixel is what its centre shows, and what light that is kept in records did.
void add_shares(Frame& frame, const core::Radiance& radiance) {
    const auto add = [&](const char* name, const core::Plane<float>& plane) {
        if (!plane.empty()) frame.add(name, false, [&](std::size_t i) { return plane.values()[i]; });
    };
    add("render2mpeg.Coverage.X", radiance.coverage);
    add("render2mpeg.RecordDensity.X", radiance.record_density);
    add("render2mpeg.RecordAge.X", radiance.record_age);
    add("render2mpeg.RecordReuse.X", radiance.record_reuse);
}

bool fits(const core::MotionField* field, const core::Visible& visible) {
    return field == nullptr ||
           (field->vector.width() == visible.width() && field->vector.height() == visible.height() &&
            field->kind.size() == field->vector.size());
}

}  // namespace

void write_layers(const std::filesystem::path& path, const core::Visible& visible, const core::Radiance& radiance,
                  const core::MotionField* to_previous, const core::MotionField* to_next, const FrameFacts& facts,
                  const core::ToleranceMap* tolerance, const core::Mattes& mattes, const MatteNames& names) {
    EXPECTS(visible.width() == radiance.combined.width() && visible.height() == radiance.combined.height());
    EXPECTS(fits(to_previous, visible) && fits(to_next, visible));

    Frame frame(visible.width(), visible.height());
    frame.add_covered("", radiance.combined, mattes);
    frame.add_covered("ViewLayer.Combined", radiance.combined, mattes);
    add_surfaces(frame, visible);
    add_motion(frame, to_previous, to_next);

    // Light without texture, and texture without light: Combined is DiffCol x (DiffDir + DiffInd) + Emit + Env + Glossy
    // + Specular.
    frame.add_color("ViewLayer.DiffDir", radiance.direct_irradiance);
    frame.add_color("ViewLayer.DiffInd", radiance.indirect_irradiance);
    frame.add_color("ViewLayer.DiffCol", radiance.albedo);
    add_emission(frame, visible, radiance.emission);
    frame.add_color("render2mpeg.Glossy", radiance.glossy);
    frame.add_color("render2mpeg.Specular", radiance.specular);

    if (!radiance.direct_cut.empty())
        frame.add("render2mpeg.CutDirect.X", false, [&](std::size_t i) { return radiance.direct_cut.values()[i]; });
    if (!radiance.indirect_cut.empty())
        frame.add("render2mpeg.CutIndirect.X", false, [&](std::size_t i) { return radiance.indirect_cut.values()[i]; });
    if (!radiance.error.empty())
        frame.add("render2mpeg.Error.X", false, [&](std::size_t i) { return radiance.error.values()[i]; });
    frame.add_color("render2mpeg.Half", radiance.half);
    add_shares(frame, radiance);
    if (tolerance != nullptr && !tolerance->is_reference()) {
        EXPECTS(tolerance->pixels.size() == radiance.combined.size());
        frame.add("render2mpeg.Tolerance.X", false, [&](std::size_t i) {
            const core::Tolerance& t = tolerance->pixels.values()[i];
            return t.allows(core::luminance(radiance.combined.values()[i]));
        });
    }
    FrameFacts all = facts;
    frame.add_mattes(mattes, names, all);
    frame.write(path, all);
}

void write_frame(const std::filesystem::path& path, const core::Plane<glm::vec3>& radiance, const FrameFacts& facts,
                 const core::Mattes& mattes) {
    Frame frame(radiance.width(), radiance.height());
    frame.add_covered("", radiance, mattes);
    frame.write(path, facts);
}

}  // namespace render2mpeg::image
