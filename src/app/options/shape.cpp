#include "app/options/shape.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/options/output_kind.h"
#include "app/options/usage_error.h"
#include "core/text.h"

namespace render2mpeg::app {
namespace {

/// Least side of most codecs' pictures; narrow ones are no smaller at any scale.
constexpr int usual_least_side = 16;

constexpr core::Rational wide{16, 9}, narrow{4, 3};

/// DVD-Video [DVDVideo]: MPEG-2 at Main level as fields, at most 36 fields a GOP at 525 lines, 30 at 625. chosen: 9
/// Mb/s of the 9.8 that video may take, since sound shares the 10.08 Mb/s of the disc (448 kb/s of AC-3 and headers of
/// 2 %).
Preset dvd(const char* name, int lines, const std::vector<const char*>& rates, int gop_fields) {
    Preset preset;
    preset.name = name;
    for (const int width : {720, 704}) preset.pictures.push_back({{width, lines}, {wide, narrow}, rates});
    preset.fields = true;
    preset.b_pictures = 2;
    preset.gop_fields = gop_fields;
    preset.gop_seconds = 0.6;
    preset.bit_rate = 9'800'000;
    preset.usual_rate = 9'000'000;
    preset.buffer_bits = 1'835'008;
    preset.disc = true;
    preset.endings = {".mpg", ".mpeg", ".vob", ".m2v"};
    return preset;
}

/// ATSC's compression formats [A53, table 6.2], those with progressive pictures.
/// chosen: 17.5 Mb/s of the 19.4 that bit_rate_value may say, for a channel of 19.39 Mb/s with sound, tables and
/// headers.
Preset atsc() {
    const std::vector<const char*> film{"23.976", "24", "29.97", "30"};
    std::vector<const char*> all = film;
    all.insert(all.end(), {"59.94", "60"});
    Preset preset;
    preset.name = "atsc";
    preset.pictures = {{{1280, 720}, {wide}, all},
                       {{1920, 1080}, {wide}, film},
                       {{704, 480}, {wide, narrow}, all},
                       {{640, 480}, {narrow}, all}};
    preset.bit_rate = 19'400'000;
    preset.usual_rate = 17'500'000;
    preset.buffer_bits = 7'995'392;
    preset.longest_delay = 0.5;  // vbv_delay <= 45000 [A53, 6.1.5]
    preset.endings = {".ts", ".m2v"};
    return preset;
}

const std::vector<Preset>& presets() {
    static const std::vector<Preset> all{dvd("dvd-ntsc", 480, {"23.976", "29.97"}, 36), dvd("dvd-pal", 576, {"25"}, 30),
                                         atsc()};
    return all;
}

/// Four pictures of 23.976 per second are shown as ten fields (encoder/cadence.h).
double fields_per_picture(const Preset& preset, const core::FrameRate& rate) {
    return preset.fields && rate.code == 1 ? 2.5 : 2;
}

using core::text_of;

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

/// Absolute logarithm of the ratio.
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

    // A scene has no frames of its own: take the nearest rate.
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

    // Finished frames must have a preset's shape; a scene is framed anew in the nearest.
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

const PresetPicture* Preset::picture_of(Size size) const {
    const auto found = std::ranges::find_if(
        pictures, [&](const PresetPicture& p) { return p.size.width == size.width && p.size.height == size.height; });
    return found == pictures.end() ? nullptr : &*found;
}

int Preset::longest_gop(const core::FrameRate& rate) const {
    return static_cast<int>(gop_fields / fields_per_picture(*this, rate));
}

int Preset::usual_gop(const core::FrameRate& rate) const {
    const int count = static_cast<int>(std::lround(gop_seconds * rate.hertz.value()));
    if (gop_fields == 0) return count;
    // Whole rounds of repeated fields, so that every GOP begins alike.
    const int longest = std::min(count, longest_gop(rate));
    return fields_per_picture(*this, rate) > 2 ? longest / 4 * 4 : longest;
}

void Preset::check_output(const std::filesystem::path& output) const {
    if (output.empty() || kind_of(output) != OutputKind::film) return;
    if (std::ranges::find(endings, core::ending_of(output)) == endings.end())
        throw UsageError(fmt::format("--output {}: {} takes {}", output.string(), option(), fmt::join(endings, ", ")));
}

double scale_taken(const Size& whole, double wished, std::optional<encoder::Codec> codec) {
    double scale = wished;
    const auto take = [&](int least, int pixels) {
        if (least > usual_least_side) scale = std::max(scale, 1.0 * least / pixels);
    };
    if (codec) {
        take(encoder::facts_of(*codec).least_width, whole.width);
        take(encoder::facts_of(*codec).least_height, whole.height);
    }
    return std::min(1.0, scale);
}

Size scaled(const Size& whole, double wished, std::optional<encoder::Codec> codec) {
    const double scale = scale_taken(whole, wished, codec);
    const int step = codec ? 2 : 1, least = codec ? usual_least_side : 1;
    const auto side = [&](int pixels) {
        return std::min(pixels, std::max(least, static_cast<int>(std::lround(scale * pixels / step)) * step));
    };
    return {side(whole.width), side(whole.height)};
}

std::vector<std::string> preset_names() {
    std::vector<std::string> names;
    for (const Preset& preset : presets()) names.emplace_back(preset.name);
    return names;
}

const Preset* preset_from(const std::string& name) {
    for (const Preset& preset : presets())
        if (preset.name == name) return &preset;
    throw UsageError(fmt::format("--for {}: there are {}", name, fmt::join(preset_names(), ", ")));
}

ShapeWishes shape_wishes(const CodingOptions& options) {
    ShapeWishes wishes;
    if (options.display_aspect) wishes.display_aspect = *options.display_aspect;
    if (options.pixel_aspect) wishes.pixel_aspect = *options.pixel_aspect;
    return wishes;
}

Shape settle_shape(const ShapeWishes& wishes, const Preset* preset) {
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
    return shape;
}

}  // namespace render2mpeg::app
