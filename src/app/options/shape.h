#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/options/options.h"
#include "core/rational.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// A picture size of a preset, with its shapes and rates.
struct PresetPicture {
    Size size;
    std::vector<core::Rational> display_aspects;  ///< the first is the default
    std::vector<const char*> rates;               ///< pictures per second
};

/// Preset of --for.
struct Preset {
    const char* name;
    std::vector<PresetPicture> pictures;  ///< the first is the default
    /// Pictures as two fields, 23.976 with repeated fields; else as frames.
    bool fields = false;
    int b_pictures = 3;            ///< most in a row
    int gop_fields = 0;            ///< longest GOP; 0: no limit
    double gop_seconds = 0.5;      ///< of the GOPs by default
    std::int64_t bit_rate = 0;     ///< most, bits per second
    std::int64_t usual_rate = 0;   ///< most, by default: leaves room for sound
    std::int64_t buffer_bits = 0;  ///< VBV size
    double longest_delay = 0;      ///< seconds that bits may wait in the buffer at the highest rate; 0: any
    bool disc = false;             ///< program streams are a DVD's
    std::vector<const char*> endings;

    std::string option() const { return std::string("--for ") + name; }
    const PresetPicture* picture_of(Size size) const;
    /// Pictures per GOP at a rate: default, and maximum (0: none).
    int usual_gop(const core::FrameRate& rate) const;
    int longest_gop(const core::FrameRate& rate) const;
    /// Throws core::Error for another container.
    void check_output(const std::filesystem::path& output) const;
};

/// In pixels.
inline double area_of(const Size& size) {
    return static_cast<double>(size.width) * size.height;
}

/// The nearest scale from `wished` to 1 at which a codec takes pictures of `whole`; none: nothing codes them.
double scale_taken(const Size& whole, double wished, std::optional<encoder::Codec> codec);

/// `whole` by that scale, in even sides of at least 16 where it is coded.
Size scaled(const Size& whole, double wished, std::optional<encoder::Codec> codec);

std::vector<std::string> preset_names();

/// Never null. Throws core::Error with the list of names.
const Preset* preset_from(const std::string& name);

struct Shape {
    Size size;
    core::FrameRate rate;
    core::Rational pixel_aspect{1, 1};  ///< width by height of a pixel
    int aspect_ratio_code = 1;          ///< [H262, table 6-3]; 0: MPEG-2 has no such shape
};

/// Known shape before the preset; the command line wins over the source.
struct ShapeWishes {
    std::optional<Size> size;  ///< of the command line
    std::optional<core::FrameRate> rate;
    std::optional<core::Rational> display_aspect, pixel_aspect;  ///< not both

    /// Source: a scene, which a preset may overrule, or finished frames, which are as they are.
    std::string source;
    bool finished = false;
    std::optional<Size> source_size;
    std::optional<core::FrameRate> source_rate;
    std::optional<core::Rational> source_display_aspect;
    std::optional<core::Rational> framed;  ///< width by height that the scene's camera was framed in
};

ShapeWishes shape_wishes(const CodingOptions& options);

/// `preset` may be null. Throws core::Error for contradictions to the preset.
Shape settle_shape(const ShapeWishes& wishes, const Preset* preset);

}  // namespace render2mpeg::app
