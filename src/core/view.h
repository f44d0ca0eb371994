#pragma once
// Views: which curve a film shows its light with.
#include <array>
#include <string>
#include <string_view>

namespace render2mpeg::core {

/// From exposed light to what a display shows (docs/model/display.md). `neutral` is our own, `pq` and `hlg` are those
/// of high dynamic range [BT2100]; the others are Blender's.
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
    agx,
    pq,
    hlg
};

/// Their names, in that order.
inline constexpr std::array<std::string_view, 12> view_names{"neutral",
                                                             "standard",
                                                             "filmic",
                                                             "filmic-very-high-contrast",
                                                             "filmic-high-contrast",
                                                             "filmic-medium-high-contrast",
                                                             "filmic-medium-low-contrast",
                                                             "filmic-low-contrast",
                                                             "filmic-very-low-contrast",
                                                             "agx",
                                                             "pq",
                                                             "hlg"};

/// Views' gammas lie within these.
inline constexpr float least_gamma = 0.1f, largest_gamma = 5.0f;

/// Light of the brightest white that a film is made for, cd/m^2; the view `hlg` has its own.
inline constexpr float least_peak = 203, largest_peak = 10000, usual_peak = 1000;

struct View {
    ViewName name = ViewName::neutral;
    float gamma = 1;          ///< signals become their power 1 / gamma; 1 but for Blender's views
    float peak = usual_peak;  ///< of `pq`, least_peak..largest_peak

    /// Light of a code value over that of the others, at mid grey.
    double coarseness() const { return name == ViewName::pq ? 2 : 1; }  // chosen: 2.2 times as much light
    /// Whether films of it are of high dynamic range, with the primaries and the matrix of [BT2020].
    bool is_hdr() const { return name == ViewName::pq || name == ViewName::hlg; }
    /// Whether it is one of Blender's, whose signals are sRGB code values.
    bool is_blenders() const { return name != ViewName::neutral && !is_hdr(); }

    bool operator==(const View&) const = default;
};

/// The view of that name. Throws Error for others, with all names.
ViewName view_from(const std::string& name);

/// Its name, with gamma or peak where those are not the usual ones: "filmic, gamma 1.2".
std::string text_of(const View& view);

}  // namespace render2mpeg::core
