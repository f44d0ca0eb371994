#include "perceptual/heatmap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::perceptual {
namespace {

/// Signals at equal steps. chosen: luma rises by a sixth at each, hues are as far apart as that leaves room for.
constexpr std::array<glm::vec3, 7> stops{{{0.00f, 0.00f, 0.00f},
                                          {0.15f, 0.12f, 0.62f},
                                          {0.55f, 0.15f, 0.70f},
                                          {0.90f, 0.30f, 0.35f},
                                          {1.00f, 0.58f, 0.10f},
                                          {0.98f, 0.86f, 0.30f},
                                          {1.00f, 1.00f, 1.00f}}};

constexpr glm::vec3 unknown{0.5f, 0.5f, 0.5f}, paper{0.08f, 0.08f, 0.08f}, ink{0.92f, 0.92f, 0.92f};

/// Five columns of seven dots, the lowest bit on top.
struct Glyph {
    char letter;
    std::array<std::uint8_t, 5> columns;
};
constexpr int glyph_width = 5, glyph_height = 7, glyph_step = 6;

constexpr Glyph font[] = {
    {'0', {0x3e, 0x51, 0x49, 0x45, 0x3e}}, {'1', {0x00, 0x42, 0x7f, 0x40, 0x00}}, {'2', {0x42, 0x61, 0x51, 0x49, 0x46}},
    {'3', {0x21, 0x41, 0x45, 0x4b, 0x31}}, {'4', {0x18, 0x14, 0x12, 0x7f, 0x10}}, {'5', {0x27, 0x45, 0x45, 0x45, 0x39}},
    {'6', {0x3c, 0x4a, 0x49, 0x49, 0x30}}, {'7', {0x01, 0x71, 0x09, 0x05, 0x03}}, {'8', {0x36, 0x49, 0x49, 0x49, 0x36}},
    {'9', {0x06, 0x49, 0x49, 0x29, 0x1e}}, {'A', {0x7e, 0x11, 0x11, 0x11, 0x7e}}, {'B', {0x7f, 0x49, 0x49, 0x49, 0x36}},
    {'C', {0x3e, 0x41, 0x41, 0x41, 0x22}}, {'D', {0x7f, 0x41, 0x41, 0x22, 0x1c}}, {'E', {0x7f, 0x49, 0x49, 0x49, 0x41}},
    {'F', {0x7f, 0x09, 0x09, 0x09, 0x01}}, {'G', {0x3e, 0x41, 0x49, 0x49, 0x7a}}, {'H', {0x7f, 0x08, 0x08, 0x08, 0x7f}},
    {'I', {0x00, 0x41, 0x7f, 0x41, 0x00}}, {'J', {0x20, 0x40, 0x41, 0x3f, 0x01}}, {'K', {0x7f, 0x08, 0x14, 0x22, 0x41}},
    {'L', {0x7f, 0x40, 0x40, 0x40, 0x40}}, {'M', {0x7f, 0x02, 0x0c, 0x02, 0x7f}}, {'N', {0x7f, 0x04, 0x08, 0x10, 0x7f}},
    {'O', {0x3e, 0x41, 0x41, 0x41, 0x3e}}, {'P', {0x7f, 0x09, 0x09, 0x09, 0x06}}, {'Q', {0x3e, 0x41, 0x51, 0x21, 0x5e}},
    {'R', {0x7f, 0x09, 0x19, 0x29, 0x46}}, {'S', {0x46, 0x49, 0x49, 0x49, 0x31}}, {'T', {0x01, 0x01, 0x7f, 0x01, 0x01}},
    {'U', {0x3f, 0x40, 0x40, 0x40, 0x3f}}, {'V', {0x1f, 0x20, 0x40, 0x20, 0x1f}}, {'W', {0x3f, 0x40, 0x38, 0x40, 0x3f}},
    {'X', {0x63, 0x14, 0x08, 0x14, 0x63}}, {'Y', {0x07, 0x08, 0x70, 0x08, 0x07}}, {'Z', {0x61, 0x51, 0x49, 0x45, 0x43}},
    {'.', {0x00, 0x60, 0x60, 0x00, 0x00}}, {'%', {0x23, 0x13, 0x08, 0x64, 0x62}}, {'/', {0x20, 0x10, 0x08, 0x04, 0x02}},
    {'-', {0x08, 0x08, 0x08, 0x08, 0x08}}, {':', {0x00, 0x36, 0x36, 0x00, 0x00}}, {'(', {0x00, 0x1c, 0x22, 0x41, 0x00}},
    {')', {0x00, 0x41, 0x22, 0x1c, 0x00}},
};

int width_of(std::string_view text) {
    return static_cast<int>(text.size()) * glyph_step - (glyph_step - glyph_width);
}

/// Draws from (left, top) on, clipped to the picture.
void write(core::Plane<glm::vec3>& image, std::string_view text, int left, int top) {
    for (const char letter : text) {
        const Glyph* glyph =
            std::find_if(std::begin(font), std::end(font), [&](const Glyph& g) { return g.letter == letter; });
        if (glyph != std::end(font))
            for (int i = 0; i < glyph_width; ++i)
                for (int j = 0; j < glyph_height; ++j) {
                    const int x = left + i, y = top + j;
                    const bool dot = (glyph->columns[static_cast<std::size_t>(i)] >> j & 1) != 0;
                    if (dot && x >= 0 && y >= 0 && x < image.width() && y < image.height()) image.at(x, y) = ink;
                }
        left += glyph_step;
    }
}

float place_of(float value, const HeatScale& scale) {
    const auto map = [&](float v) { return scale.logarithmic ? std::log(std::max(v, 1e-30f)) : v; };
    return core::divide_or(map(value) - map(scale.low), map(scale.high) - map(scale.low), 0.0f);
}

/// The words of a title that there is room for; the first one always.
std::string_view words_within(std::string_view title, int width) {
    while (width_of(title) > width) {
        const std::size_t space = title.find_last_of(' ');
        if (space == std::string_view::npos) break;
        title = title.substr(0, title.find_last_not_of(" /:", space) + 1);
    }
    return title;
}

/// The title, the bar and its marks on the lines below `top`.
void draw_legend(core::Plane<glm::vec3>& image, int top, const HeatScale& scale) {
    constexpr int margin = 4, bar_top = 11, bar_height = 8, text_top = 22;
    const int left = margin, right = std::max(left + 1, image.width() - margin - 1);
    write(image, words_within(scale.title, image.width() - left), left, top + 2);
    for (int x = left; x <= right && x < image.width(); ++x) {
        const float t = static_cast<float>(x - left) / static_cast<float>(right - left);
        HeatScale unit;
        const glm::vec3 color = heat_color(t, unit);
        for (int y = 0; y < bar_height; ++y) image.at(x, top + bar_top + y) = color;
    }
    int free_from = 0;
    for (const HeatScale::Mark& mark : scale.marks) {
        const float t = std::clamp(place_of(mark.value, scale), 0.0f, 1.0f);
        const int x = left + static_cast<int>(std::lround(t * static_cast<float>(right - left)));
        const int at = std::clamp(x - width_of(mark.text) / 2, 0, std::max(0, image.width() - width_of(mark.text)));
        if (at < free_from) continue;  // it would cover the one before
        for (int y = 0; y < 2; ++y)
            if (x < image.width()) image.at(x, top + bar_top + bar_height + y) = ink;
        write(image, mark.text, at, top + text_top);
        free_from = at + width_of(mark.text) + glyph_step;
    }
}

}  // namespace

glm::vec3 heat_color(float value, const HeatScale& scale) {
    if (!std::isfinite(value)) return unknown;
    const float place = std::clamp(place_of(value, scale), 0.0f, 1.0f) * static_cast<float>(stops.size() - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(place), stops.size() - 2);
    return stops[i] + (place - static_cast<float>(i)) * (stops[i + 1] - stops[i]);
}

core::Picture heatmap(const core::Plane<float>& values, const HeatScale& scale, ColorMatrix matrix) {
    EXPECTS(scale.low < scale.high && (!scale.logarithmic || scale.low > 0));
    core::Plane<glm::vec3> image(values.width(), values.height() + legend_height, paper);
    for (int y = 0; y < values.height(); ++y)
        for (int x = 0; x < values.width(); ++x) image.at(x, y) = heat_color(values.at(x, y), scale);
    draw_legend(image, values.height(), scale);
    return picture_of_signals(image, matrix);
}

}  // namespace render2mpeg::perceptual
