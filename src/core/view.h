#pragma once
// Views: which curve a film shows its light with.
#include <array>
#include <string>
#include <string_view>

namespace render2mpeg::core {

/// From exposed light to what a display shows (docs/model/display.md). `neutral` is our own; the others are Blender's.
enum class ViewName {
    neutral,
    standard,
    filmic,
    filmic_very_high_contrast,
    filmic_high_contrast,
    filmic_medium_high_contrast,
    filmic_medium_low_contrast,
    filmic_low_contrast,
    filmic_very_low_contrast,
    agx
};

/// Their names, in that order.
inline constexpr std::array<std::string_view, 10> view_names{"neutral",
                                                             "standard",
                                                             "filmic",
                                                             "filmic-very-high-contrast",
                                                             "filmic-high-contrast",
                                                             "filmic-medium-high-contrast",
                                                             "filmic-medium-low-contrast",
                                                             "filmic-low-contrast",
                                                             "filmic-very-low-contrast",
                                                             "agx"};

/// Views' gammas lie within these.
inline constexpr float least_gamma = 0.1f, largest_gamma = 5.0f;

struct View {
    ViewName name = ViewName::neutral;
    float gamma = 1;  ///< the view's signals become their power 1 / gamma; 1 for `neutral`

    bool operator==(const View&) const = default;
};

/// The view of that name. Throws Error for others, with all names.
ViewName view_from(const std::string& name);

/// Its name, with its gamma where that is not 1: "filmic, gamma 1.2".
std::string text_of(const View& view);

}  // namespace render2mpeg::core
