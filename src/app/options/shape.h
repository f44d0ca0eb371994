#pragma once

#include <optional>
#include <string>

#include "app/options/options.h"
#include "app/options/preset.h"
#include "core/rational.h"

namespace render2mpeg::app {

/// Size, rate and shape of a film's pictures.
struct Shape {
    Size size;
    core::FrameRate rate;
    core::Rational pixel_aspect{1, 1};  ///< width by height of a pixel
    int aspect_ratio_code = 1;          ///< [H262, table 6-3]; 0: MPEG-2 has no such shape
};

/// What is known before the film's preset has a say; what is absent is not said. What the command line says counts
/// before what the pictures' source says.
struct ShapeWishes {
    std::optional<Size> size;  ///< of the command line
    std::optional<core::FrameRate> rate;
    std::optional<core::Rational> display_aspect, pixel_aspect;  ///< not both

    /// Of the source: a scene, whose wishes a preset may overrule, or finished frames, which are as they are.
    std::string source;
    bool finished = false;
    std::optional<Size> source_size;
    std::optional<core::FrameRate> source_rate;
    std::optional<core::Rational> source_display_aspect;
    std::optional<core::Rational> framed;  ///< width by height that the scene's camera was framed in
};

/// The wishes of the command line's shape options.
ShapeWishes shape_wishes(const CodingOptions& options);

/// Settles a shape. `preset` may be null; else throws core::Error, naming the preset and what contradicts it. `film`:
/// it is to be coded, so that core::Error is thrown for shapes that MPEG-2 does not have.
Shape settle_shape(const ShapeWishes& wishes, const Preset* preset, bool film);

}  // namespace render2mpeg::app
