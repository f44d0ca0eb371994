#include "app/report/frame_view.h"

#include <fmt/format.h>
#include <algorithm>
#include <vector>

#include "app/report/figures.h"
#include "app/report/heatmap_film.h"
#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "encoder/codec.h"
#include "image/image.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

/// chosen: what a desktop's page has room for, some 150 to 250 kB as PNG (320x240..640x480).
constexpr int most_width = 480, most_height = 360;

template <class T>
core::Plane<T> cut_out(const core::Plane<T>& plane, int left, int top, int width, int height) {
    core::Plane<T> part(width, height);
    for (int y = 0; y < height; ++y) std::copy_n(plane.row(top + y) + left, width, part.row(y));
    return part;
}

/// [RFC4648, 4]
std::string base64(const std::vector<unsigned char>& bytes) {
    constexpr const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve(bytes.size() / 3 * 4 + 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
        unsigned value = 0;
        for (std::size_t k = 0; k < 3; ++k) value = value << 8 | (k < left ? bytes[i + k] : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += k <= left ? letters[value >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

/// chosen: differences that one hardly sees in a picture are seen as large as this (4..16).
constexpr int difference_gain = 8;

core::Picture difference_of(const core::Picture& a, const core::Picture& b) {
    core::Picture difference = a;
    const auto fill = [](core::Plane<std::uint8_t>& plane, const auto& first, const auto& second, int middle) {
        for (std::size_t i = 0; i < plane.size(); ++i)
            plane.values()[i] = static_cast<std::uint8_t>(
                std::clamp(middle + difference_gain * (first.values()[i] - second.values()[i]), 16, 235));
    };
    fill(difference.y, a.y, b.y, 126);
    fill(difference.cb, a.cb, b.cb, 128);
    fill(difference.cr, a.cr, b.cr, 128);
    return difference;
}

}  // namespace

ViewBox view_of(int width, int height) {
    const int w = std::min(width, most_width), h = std::min(height, most_height);
    return {(width - w) / 4 * 2, (height - h) / 4 * 2, w, h};
}

core::Picture part_of(const core::Picture& picture, const ViewBox& box) {
    core::Picture part;
    part.number = picture.number;
    part.y = cut_out(picture.y, box.left, box.top, box.width, box.height);
    const int width = (box.width + 1) / 2, height = (box.height + 1) / 2;
    part.cb = cut_out(picture.cb, box.left / 2, box.top / 2, width, height);
    part.cr = cut_out(picture.cr, box.left / 2, box.top / 2, width, height);
    return part;
}

core::Plane<float> part_of(const core::Plane<float>& plane, const ViewBox& box) {
    return cut_out(plane, box.left, box.top, box.width, box.height);
}

int shown_width(int width) {
    // chosen: 320, a phone's width and the narrowest in which a heatmap's legend and a slider can be read.
    constexpr int least = 320;
    return width * std::max(1, (least + width - 1) / width);
}

std::string source_of(const std::string& name, const core::Picture& picture, const perceptual::PictureColors& colors) {
    const std::vector<std::uint8_t> rgb = perceptual::shown_rgb(picture, colors);
    return "data:image/png;base64," + base64(image::png_bytes(picture.width(), picture.height(), rgb, name));
}

json pair_of(const std::string& title, const ShownPicture& left, const ShownPicture& right,
             const perceptual::PictureColors& colors, bool with_difference) {
    EXPECTS(left.picture.width() == right.picture.width() && left.picture.height() == right.picture.height());
    json pair{{"title", title},
              {"width", shown_width(left.picture.width())},
              {"names", {left.name, right.name}},
              {"sources", {source_of(left.name, left.picture, colors), source_of(right.name, right.picture, colors)}}};
    if (!with_difference) return pair;
    pair["names"].push_back("difference");
    pair["sources"].push_back(source_of("difference", difference_of(left.picture, right.picture), {colors.matrix}));
    pair["gain"] = difference_gain;
    return pair;
}

json heat_of(const std::string& title, const core::Plane<float>& values, const perceptual::HeatScale& scale) {
    // Full-range colours need no film's matrix.
    const perceptual::ColorMatrix matrix = perceptual::ColorMatrix::bt709;
    const core::Picture picture = perceptual::heatmap(values, scale, matrix);
    return {{"title", title}, {"width", shown_width(picture.width())}, {"source", source_of(title, picture, {matrix})}};
}

SampleFrameObserver::SampleFrameObserver(const RenderJob& film)
    : frame_(film.frames.first + (film.frame_count() - 1) / 2), codec_(film.coding.codec), colors_(film.colors()) {}

void SampleFrameObserver::lit(const LitFrame& frame) {
    if (frame.world.frame != frame_) return;
    const ViewBox box = view_of(frame.picture.width(), frame.picture.height());
    lit_ = part_of(frame.picture, box);
    const core::Plane<glm::vec3>& light = frame.lit.radiance.combined;
    const auto over_luminance = [&](auto&& value) {
        core::Plane<float> plane(light.width(), light.height());
        for (std::size_t i = 0; i < plane.size(); ++i)
            plane.values()[i] = core::divide_or(value(i), core::luminance(light.values()[i]), 1.0f);
        return part_of(plane, box);
    };
    if (!frame.tolerance.is_reference())
        tolerance_ = over_luminance([&](std::size_t i) {
            const core::Tolerance& t = frame.tolerance.pixels.values()[i];
            return t.allows(core::luminance(light.values()[i]));
        });
    if (!frame.lit.radiance.error.empty())
        error_ = over_luminance([&](std::size_t i) { return frame.lit.radiance.error.values()[i]; });
}

void SampleFrameObserver::coded(const encoder::CodedPicture& coded) {
    if (coded.plan.number != frame_) return;
    decoded_ = part_of(coded.reconstruction, view_of(coded.reconstruction.width(), coded.reconstruction.height()));
    coding_ =
        fmt::format("{} picture, {} {}, {}", "-IPB"[static_cast<int>(coded.plan.type)], encoder::facts_of(codec_).scale,
                    coded.quantiser, size_text(static_cast<double>(coded.bytes.size())));
}

nlohmann::json SampleFrameObserver::figures() const {
    if (!lit_) return earlier_;
    nlohmann::json all = nlohmann::json::array();
    if (decoded_)
        all.push_back(pair_of(fmt::format("Frame {}: {}", frame_, coding_), {"decoded", *decoded_},
                              {"as it was lit", *lit_}, colors_, true));
    if (!tolerance_.empty())
        all.push_back(heat_of("What each pixel's light may be off by", tolerance_, scale_of(HeatSubject::tolerance)));
    if (!error_.empty())
        all.push_back(heat_of("Standard error of its light", error_, scale_of(HeatSubject::tolerance)));
    return all;
}

}  // namespace render2mpeg::app
