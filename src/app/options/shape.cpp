#include "app/options/shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/options/usage_error.h"

namespace render2mpeg::app {
namespace {

std::string text_of(core::Rational ratio) {
    // 2.21:1 is how that shape is known; others are ratios of whole numbers.
    if (ratio == core::Rational{221, 100}) return "2.21:1";
    return fmt::format("{}:{}", ratio.num, ratio.den);
}

std::string text_of(Size size) {
    return fmt::format("{}x{}", size.width, size.height);
}

template <class List, class Text>
std::string listed(const List& list, Text text) {
    std::string all;
    for (std::size_t i = 0; i < list.size(); ++i)
        all += (i == 0 ? "" : i + 1 == list.size() ? " and " : ", ") + text(list[i]);
    return all;
}

/// How far two shapes or rates are apart, as the logarithm of their ratio.
double distance(double a, double b) {
    return std::abs(std::log(a / b));
}

core::Rational display_of(core::Rational pixel, Size size) {
    return core::product(pixel, {size.width, size.height});
}
core::Rational pixel_of(core::Rational display, Size size) {
    return core::product(display, {size.height, size.width});
}

/// chosen: pixel shapes in use give 4:3 or 16:9 for the 702, 704 or 720 columns of a line: up to 2.6 % away; MPEG-2's
/// three shapes lie 25 % apart.
constexpr double same_shape = 0.03;

/// aspect_ratio_information [H262, table 6-3]: square pixels, or the shape of the whole picture; 0: none of them.
int aspect_ratio_code(core::Rational pixel, Size size) {
    if (pixel.num == pixel.den) return 1;
    for (const auto& [code, shape] : {std::pair{2, 4.0 / 3}, {3, 16.0 / 9}, {4, 2.21}})
        if (distance(display_of(pixel, size).value(), shape) < same_shape) return code;
    return 0;
}

int code_of_display(core::Rational display) {
    return display == core::Rational{4, 3} ? 2 : display == core::Rational{16, 9} ? 3 : 4;
}

/// A small picture of this shape: 640x360, 640x480, 360x640.
Size size_of_shape(core::Rational shape) {
    constexpr double longest = 640;  // chosen: about as many pixels as 512x512
    const double width = longest * std::min(1.0, shape.value()), height = longest * std::min(1.0, 1 / shape.value());
    const auto even = [](double side) { return std::max(2, 2 * static_cast<int>(std::lround(side / 2))); };
    return {even(width), even(height)};
}

Size settle_size(const ShapeWishes& wishes, const Preset* preset) {
    const auto taken = [&](Size size, const std::string& who) {
        if (preset != nullptr && preset->picture_of(size) == nullptr)
            throw UsageError(fmt::format("{}: {} has {}", who, preset->option(),
                                         listed(preset->pictures, [](const auto& p) { return text_of(p.size); })));
        return size;
    };
    if (wishes.size) return taken(*wishes.size, "--size " + text_of(*wishes.size));
    if (wishes.finished)
        return taken(*wishes.source_size,
                     fmt::format("the frames of {} have {}", wishes.source, text_of(*wishes.source_size)));
    if (preset != nullptr) return preset->pictures.front().size;
    if (!wishes.source_size && wishes.framed) return size_of_shape(*wishes.framed);
    return wishes.source_size.value_or(Size{512, 512});
}

core::FrameRate settle_rate(const ShapeWishes& wishes, const PresetPicture* picture, const Preset* preset) {
    const auto taken = [&](const core::FrameRate& rate, const std::string& who) {
        if (picture == nullptr) return rate;
        for (const char* name : picture->rates)
            if (core::frame_rate_from(name).code == rate.code) return rate;
        throw UsageError(fmt::format("{}: {} has {} at {}", who, preset->option(),
                                     listed(picture->rates, [](const char* name) { return std::string(name); }),
                                     text_of(picture->size)));
    };
    if (wishes.rate) return taken(*wishes.rate, fmt::format("--fps {}", wishes.rate->name));
    if (wishes.finished && wishes.source_rate)
        return taken(*wishes.source_rate,
                     fmt::format("{} has {} frames per second", wishes.source, wishes.source_rate->name));

    // A scene moves in time, not in frames: take the nearest rate.
    const core::FrameRate wished = wishes.source_rate.value_or(core::frame_rate_from("25"));
    if (picture == nullptr) return wished;
    core::FrameRate nearest = core::frame_rate_from(picture->rates.front());
    for (const char* name : picture->rates) {
        const core::FrameRate rate = core::frame_rate_from(name);
        if (distance(rate.hertz.value(), wished.hertz.value()) < distance(nearest.hertz.value(), wished.hertz.value()))
            nearest = rate;
    }
    return nearest;
}

/// The shape that a preset's picture is shown in.
core::Rational display_for(const ShapeWishes& wishes, const PresetPicture& picture, const Preset& preset) {
    const auto& shapes = picture.display_aspects;
    const auto complaint = [&](const std::string& who, const std::string& advice) {
        return UsageError(fmt::format("{}: {} has {} at {}{}", who, preset.option(),
                                      listed(shapes, [](core::Rational r) { return text_of(r); }),
                                      text_of(picture.size), advice));
    };
    if (wishes.pixel_aspect)
        throw complaint("--pixel-aspect " + text_of(*wishes.pixel_aspect), "; --display-aspect chooses");
    const std::optional<core::Rational>& said = wishes.display_aspect;
    if (said) {
        for (const core::Rational shape : shapes)
            if (shape == *said) return shape;
        throw complaint("--display-aspect " + text_of(*said), "");
    }

    // Frames that say their shape must have the right one; a scene is framed anew in the nearest.
    const std::optional<core::Rational>& source = wishes.source_display_aspect;
    if (!source) {
        if (wishes.finished && shapes.size() > 1)
            throw complaint("the frames of " + wishes.source + " do not say their shape", "; --display-aspect chooses");
        return shapes.front();
    }
    core::Rational nearest = shapes.front();
    for (const core::Rational shape : shapes)
        if (distance(shape.value(), source->value()) < distance(nearest.value(), source->value())) nearest = shape;
    if (wishes.finished && distance(nearest.value(), source->value()) >= same_shape)
        throw complaint(fmt::format("the frames of {} are shown as {}", wishes.source, text_of(*source)),
                        "; --display-aspect overrules it");
    return nearest;
}

}  // namespace

ShapeWishes shape_wishes(const CodingOptions& options) {
    ShapeWishes wishes;
    if (options.display_aspect) wishes.display_aspect = core::ratio_from(*options.display_aspect);
    if (options.pixel_aspect) wishes.pixel_aspect = core::ratio_from(*options.pixel_aspect);
    return wishes;
}

Shape settle_shape(const ShapeWishes& wishes, const Preset* preset, bool film) {
    Shape shape;
    shape.size = settle_size(wishes, preset);
    const PresetPicture* picture = preset != nullptr ? preset->picture_of(shape.size) : nullptr;
    shape.rate = settle_rate(wishes, picture, preset);
    if (picture != nullptr) {
        const core::Rational display = display_for(wishes, *picture, *preset);
        shape.pixel_aspect = pixel_of(display, shape.size);
        shape.aspect_ratio_code = code_of_display(display);
        return shape;
    }

    const std::optional<core::Rational> display = wishes.display_aspect ? wishes.display_aspect
                                                  : wishes.pixel_aspect || !wishes.source_display_aspect
                                                      ? std::nullopt
                                                      : wishes.source_display_aspect;
    if (wishes.pixel_aspect) shape.pixel_aspect = *wishes.pixel_aspect;
    if (display) shape.pixel_aspect = pixel_of(*display, shape.size);
    shape.aspect_ratio_code = aspect_ratio_code(shape.pixel_aspect, shape.size);
    if (film && shape.aspect_ratio_code == 0)
        throw UsageError(fmt::format(
            "pixels of {} in a picture of {}, shown as {:.3f}:1: MPEG-2 has square ones, and pictures of 4:3, 16:9 and "
            "2.21:1",
            text_of(shape.pixel_aspect), text_of(shape.size), display_of(shape.pixel_aspect, shape.size).value()));
    return shape;
}

}  // namespace render2mpeg::app
