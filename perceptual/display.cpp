#include "perceptual/display.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "core/color.h"
#include "core/error.h"
#include "core/film_grain.h"
#include "core/numeric.h"

namespace render2mpeg::perceptual {
namespace {

/// Luma as a share of the way from black to white, and colour differences B' - Y', R' - Y'.
struct Signals {
    std::vector<float> luma, blue, red;
    explicit Signals(int width) : luma(extent(width)), blue(extent(width)), red(extent(width)) {}
    static std::size_t extent(int width) { return static_cast<std::size_t>(width); }
};

/// Writes one row of signals R', G', B'. Returns 0, or NaN if any component is not finite.
using SignalsOfRow = std::function<float(int y, std::span<glm::vec3> signals)>;

void divide(std::span<const glm::vec3> row, glm::vec3 weight, Signals& out) {
    for (std::size_t x = 0; x < row.size(); ++x) {
        const float luma = weight.x * row[x].x + weight.y * row[x].y + weight.z * row[x].z;
        out.luma[x] = luma;
        out.blue[x] = row[x].z - luma;
        out.red[x] = row[x].x - luma;
    }
}

/// Colour differences at half the width, sited on the even columns: [1 2 1] / 4, the edges repeated.
void halve(const std::vector<float>& full, std::vector<float>& half) {
    const std::size_t last = full.size() - 1;
    for (std::size_t i = 0; i < half.size(); ++i) {
        const std::size_t x = 2 * i;
        half[i] = 0.25f * (full[x > 0 ? x - 1 : 0] + 2.0f * full[x] + full[std::min(x + 1, last)]);
    }
}

std::uint8_t code(float value) {
    return static_cast<std::uint8_t>(std::lround(value));
}

/// Chroma code values halfway between two rows, also before rounding unless `exact` is null. `scale` brings the colour
/// difference to -112..112.
void write_chroma(const std::vector<float>& upper, const std::vector<float>& lower, float scale, std::uint8_t* out,
                  float* exact) {
    for (std::size_t i = 0; i < upper.size(); ++i) {
        const float value = std::clamp(128.0f + scale * 0.5f * (upper[i] + lower[i]), 16.0f, 240.0f);
        out[i] = code(value);
        if (exact != nullptr) exact[i] = value;
    }
}

/// The same at full width, as code values that are not rounded.
void write_full(const std::vector<float>& differences, float scale, std::span<float> out) {
    for (std::size_t x = 0; x < out.size(); ++x) out[x] = std::clamp(128.0f + scale * differences[x], 16.0f, 240.0f);
}

/// A black picture with room for what `chroma` keeps.
core::Picture empty_picture(int width, int height, core::ExactChroma chroma) {
    core::Picture picture;
    picture.y = core::Plane<std::uint8_t>(width, height);
    picture.luma = core::Plane<float>(width, height);
    picture.cb = core::Plane<std::uint8_t>((width + 1) / 2, (height + 1) / 2);
    picture.cr = core::Plane<std::uint8_t>((width + 1) / 2, (height + 1) / 2);
    if (chroma == core::ExactChroma::full) picture.exact_cb = picture.exact_cr = core::Plane<float>(width, height);
    if (chroma == core::ExactChroma::halved)
        picture.exact_cb = picture.exact_cr = core::Plane<float>(picture.cb.width(), picture.cb.height());
    return picture;
}

core::Picture picture_of(int width, int height, ColorMatrix matrix, core::ExactChroma chroma,
                         const SignalsOfRow& signals_of_row) {
    core::Picture picture = empty_picture(width, height, chroma);
    if (picture.y.empty()) return picture;

    const glm::vec3 weight = luma_weights(matrix);
    // [BT709, 3.4] and [BT601, 2.5.3]: C = 224 (difference) / (2 (1 - weight)).
    const float blue_scale = 112.0f / (1.0f - weight.z), red_scale = 112.0f / (1.0f - weight.x);
    std::vector<glm::vec3> row(static_cast<std::size_t>(width));
    Signals signals(width);
    std::vector<float> blue[2], red[2];
    for (int k = 0; k < 2; ++k) blue[k] = red[k] = std::vector<float>(static_cast<std::size_t>(picture.cb.width()));

    float finite = 0.0f;
    for (int pair = 0; pair < picture.cb.height(); ++pair) {
        for (int k = 0; k < 2; ++k) {
            const int y = std::min(2 * pair + k, height - 1);
            finite += signals_of_row(y, row);
            divide(row, weight, signals);
            for (int x = 0; x < width; ++x) {
                const float luma = 16.0f + 219.0f * signals.luma[static_cast<std::size_t>(x)];
                picture.luma.row(y)[x] = luma;
                picture.y.row(y)[x] = code(luma);
            }
            halve(signals.blue, blue[k]);
            halve(signals.red, red[k]);
            if (chroma != core::ExactChroma::full) continue;
            const auto row_length = static_cast<std::size_t>(width);
            write_full(signals.blue, blue_scale, {picture.exact_cb.row(y), row_length});
            write_full(signals.red, red_scale, {picture.exact_cr.row(y), row_length});
        }
        const bool halved = chroma == core::ExactChroma::halved;
        write_chroma(blue[0], blue[1], blue_scale, picture.cb.row(pair), halved ? picture.exact_cb.row(pair) : nullptr);
        write_chroma(red[0], red[1], red_scale, picture.cr.row(pair), halved ? picture.exact_cr.row(pair) : nullptr);
    }
    EXPECTS(finite == 0.0f);
    return picture;
}

/// Signals of the view `neutral`.
glm::vec3 neutral_signals(glm::vec3 exposed) {
    const SignalCurve& curve = SignalCurve::instance();
    return {curve.signal(exposed.x), curve.signal(exposed.y), curve.signal(exposed.z)};
}

float largest(glm::vec3 v) {
    return std::max({v.x, v.y, v.z});
}

std::vector<float> lit_of(std::span<const float> luminances) {
    std::vector<float> lit;
    for (const float luminance : luminances)
        if (luminance > 0.0f && std::isfinite(luminance)) lit.push_back(luminance);
    return lit;
}

/// Chroma at a luma sample: on the even columns, and between each two rows.
float chroma_at(const core::Plane<std::uint8_t>& plane, int x, int y) {
    const int left = x / 2, right = std::min(left + x % 2, plane.width() - 1);
    const int near = y / 2, far = std::clamp(y % 2 == 0 ? near - 1 : near + 1, 0, plane.height() - 1);
    const auto mean = [&](int row) { return 0.5f * (plane.at(left, row) + plane.at(right, row)); };
    return 0.75f * mean(near) + 0.25f * mean(far) - 128.0f;
}

}  // namespace

glm::vec3 luma_weights(ColorMatrix matrix) {
    if (matrix == ColorMatrix::bt2020) return {0.2627f, 0.6780f, 0.0593f};
    return matrix == ColorMatrix::bt709 ? glm::vec3{0.2126f, 0.7152f, 0.0722f} : glm::vec3{0.299f, 0.587f, 0.114f};
}

Display::Display(float exposure, ColorMatrix matrix, const core::View& view, core::ExactChroma chroma, int grain)
    : exposure_(exposure), gain_(std::exp2(exposure)), matrix_(matrix), chroma_(chroma), grain_(grain) {
    EXPECTS(std::abs(exposure) <= max_exposure);
    if (view.name != core::ViewName::neutral) view_ = std::make_shared<const ViewTransform>(view);
    is_hdr_ = view.is_hdr();
}

glm::vec3 Display::signals_of(glm::vec3 exposed) const {
    return view_ ? view_->signals(exposed) : neutral_signals(exposed);
}

core::Picture Display::develop(const core::Radiance& radiance) const {
    const core::Plane<glm::vec3>& light = radiance.combined;
    core::Picture picture =
        picture_of(light.width(), light.height(), matrix_, chroma_, [&](int y, std::span<glm::vec3> row) {
            const glm::vec3* from = light.row(y);
            float finite = 0.0f;
            for (std::size_t x = 0; x < row.size(); ++x) {
                const glm::vec3 c = from[x];
                finite += c.x * 0.0f + c.y * 0.0f + c.z * 0.0f;
                row[x] = signals_of(c * gain_);
            }
            return finite;
        });
    picture.number = radiance.frame;
    core::add_grain(picture, grain_);
    if (view_ && view_->view().name == core::ViewName::pq) picture.level = level_of(light);
    return picture;
}

core::Picture Display::develop(const core::Radiance& radiance, const core::Mattes& mattes) const {
    core::Picture picture = develop(unmultiplied(radiance, mattes));
    picture.alpha = core::Plane<float>(picture.width(), picture.height());
    for (std::size_t i = 0; i < picture.alpha.size(); ++i) picture.alpha.values()[i] = mattes.alpha(i);
    return picture;
}

core::Radiance unmultiplied(const core::Radiance& radiance, const core::Mattes& mattes) {
    core::Radiance whole;
    whole.frame = radiance.frame;
    whole.combined = radiance.combined;
    for (std::size_t i = 0; i < whole.combined.size(); ++i) {
        const float alpha = mattes.alpha(i);
        glm::vec3& light = whole.combined.values()[i];
        light = alpha > 0 ? light / std::max(alpha, 1.0f / 255) : glm::vec3(0);
    }
    return whole;
}

core::LightLevel Display::level_of(const core::Plane<glm::vec3>& light) const {
    core::LightLevel level;
    double sum = 0;
    for (const glm::vec3& c : light.values()) {
        const float brightest = largest(view_->luminances(c * gain_));
        level.most = std::max(level.most, brightest);
        sum += static_cast<double>(brightest);
    }
    level.mean = static_cast<float>(core::divide_or(sum, static_cast<double>(light.size()), 0.0));
    return level;
}

float luma_of(const Display& display, glm::vec3 radiance) {
    const glm::vec3 signals = display.signals_of(radiance * std::exp2(display.exposure()));
    return 16.0f + 219.0f * glm::dot(luma_weights(display.matrix()), signals);
}

core::Picture picture_of_signals(const core::Plane<glm::vec3>& signals, ColorMatrix matrix, core::ExactChroma chroma) {
    return picture_of(signals.width(), signals.height(), matrix, chroma, [&](int y, std::span<glm::vec3> row) {
        const glm::vec3* from = signals.row(y);
        float finite = 0.0f;
        for (std::size_t x = 0; x < row.size(); ++x) {
            finite += from[x].x * 0.0f + from[x].y * 0.0f + from[x].z * 0.0f;
            // NaN becomes 0 here, so that no conversion meets it before the contract is checked.
            for (int k = 0; k < 3; ++k) row[x][k] = from[x][k] > 0.0f ? std::min(from[x][k], 1.0f) : 0.0f;
        }
        return finite;
    });
}

std::vector<std::uint8_t> Display::develop_srgb(const core::Radiance& radiance) const {
    const core::Plane<glm::vec3>& light = radiance.combined;
    std::optional<core::FilmGrain> grain;
    core::Plane<float> noise;
    if (grain_ > 0 && !light.empty()) {
        grain.emplace(grain_, light.height());
        noise = grain->noise(light.width(), light.height(), radiance.frame);
    }
    std::vector<std::uint8_t> codes;
    codes.reserve(3 * light.size());
    for (std::size_t i = 0; i < light.size(); ++i) {
        const glm::vec3 c = light.values()[i];
        EXPECTS(core::is_finite(c));
        glm::vec3 signal = is_hdr_ ? neutral_signals(c * gain_) : signals_of(c * gain_);
        if (grain) {
            const float luma = 16.0f + 219.0f * glm::dot(luma_weights(matrix_), signal);
            signal = glm::clamp(signal + grain->deviation(luma) * noise.values()[i] / 219.0f, 0.0f, 1.0f);
        }
        for (int k = 0; k < 3; ++k) codes.push_back(code(255.0f * signal[k]));
    }
    return codes;
}

float Display::tone_curve(float exposed) {
    return static_cast<float>(perceptual::tone_curve(static_cast<double>(exposed)));
}

SignalCurve::Point Display::luma_at(glm::vec3 exposed) const {
    const glm::vec3 weight = luma_weights(matrix_);
    if (view_) {
        const ShownLight shown = view_->show(exposed);
        return {glm::dot(weight, shown.signal), glm::dot(weight, shown.log_slope)};
    }
    const SignalCurve& curve = SignalCurve::instance();
    const SignalCurve::Point r = curve.point(exposed.x), g = curve.point(exposed.y), b = curve.point(exposed.z);
    return {weight.x * r.signal + weight.y * g.signal + weight.z * b.signal,
            weight.x * r.log_slope + weight.y * g.log_slope + weight.z * b.log_slope};
}

glm::vec3 Display::with_luma(glm::vec3 radiance, float luma) const {
    const float size = largest(radiance);
    const glm::vec3 hue = size > 0.0f && std::isfinite(size) ? glm::max(radiance, 0.0f) / size : glm::vec3(1.0f);

    // Answer the ends, black and white. The neutral curve is nowhere steeper than at 0: that bounds the answer from
    // below. Less than the other bound is black in all views.
    const float wanted = (std::clamp(luma, 16.0f, 235.0f) - 16.0f) / 219.0f;
    if (!(wanted > 0.0f)) return glm::vec3(0.0f);
    const float most = luma_at(hue * SignalCurve::brightest).signal;
    if (wanted >= most) return hue * (SignalCurve::brightest / gain_);
    const float least = view_ ? 1e-12f : wanted / (core::srgb_slope_at_black * glm::dot(luma_weights(matrix_), hue));
    float low = least, high = SignalCurve::brightest;

    // Find the peak p with signal(p) = wanted. f = signal / (most - signal) is proportional to p at both ends and a
    // mild power of it between, so that Newton's rule on log f over log p needs two to four steps from the radiance's
    // own place, which is near where a tolerance is asked for; where a weak channel makes a plateau, bisection on log p
    // takes over.
    low = std::min(low, high);
    const float grey = view_ ? 0.18f : low;  // views are flat at their ends
    float peak = std::clamp(size > 0.0f ? size * gain_ : grey, low, std::max(low, 64.0f));
    for (int step = 0; step < 48; ++step) {
        const SignalCurve::Point at = luma_at(hue * peak);
        (at.signal < wanted ? low : high) = peak;
        // Views have flat ends, which Newton's rule does not leave, and slopes that are too steep where a channel is
        // cut off, with which it comes near too slowly.
        if (view_ && std::abs(at.signal - wanted) < 5e-7f) break;
        if (!(at.signal > 0.0f) || (view_ && (most - at.signal < 1e-6f || step >= 8))) {
            peak = std::sqrt(low) * std::sqrt(high);
            continue;
        }
        const float rest = std::max(most - at.signal, 1e-7f);  // resolution of float near 1
        const float slope = at.log_slope * most / (at.signal * rest);
        const float ratio = wanted * rest / (at.signal * (most - wanted));
        const float next = peak * std::exp(core::divide_or(std::log(ratio), slope, 100.0f));
        // chosen: 1e-5, and the step is still carried out; tried 1e-2 .. 1e-5 on 400000 colours and lumas: the worst
        // errors are 11, 0.015, 3e-4 and 5e-5 code values, the time differs by a tenth per step.
        const bool close = !view_ && std::abs(next - peak) <= 1e-5f * peak;
        peak = close || (next > low && next < high) ? next : std::sqrt(low) * std::sqrt(high);
        if (close) break;
    }
    return hue * (peak / gain_);
}

float auto_exposure(std::span<const float> surfaces, std::span<const float> sky) {
    std::vector<float> lit = lit_of(surfaces);
    // chosen: 1/20 of what is lit, between a bird before the sky (1/100) and the land below a high horizon (1/5).
    const std::vector<float> lit_sky = lit_of(sky);
    if (lit.size() * 19 < lit_sky.size()) lit.insert(lit.end(), lit_sky.begin(), lit_sky.end());
    if (lit.empty()) return 0.0f;
    std::sort(lit.begin(), lit.end());

    // Leave out what is next to black with any exposure that suits the bright samples: those lie some 2.5 stops above
    // mid grey, which makes ten stops below them three code values. chosen: ten stops below the 90th percentile, tried
    // 6 .. 14 with a third of the samples in unlit corners: 6 leaves out what is seen, 12 is led 0.9 EV astray by what
    // is black.
    const float bright = lit[(lit.size() - 1) * 9 / 10];
    const auto first = std::lower_bound(lit.begin(), lit.end(), bright / 1024.0f);

    // Average the logarithms [Reinhard2002, eq. 1] over the middle half. chosen: a quarter off either end, tried 0 ..
    // 0.4: without, lamps and shadows decide (0.3 EV on animations/colonnade); more is the median, blind to the rest.
    const auto count = static_cast<std::size_t>(lit.end() - first);
    const std::size_t begin = count / 4, end = count - begin;
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i)
        sum += std::log2(static_cast<double>(first[static_cast<std::ptrdiff_t>(i)]));
    const double key = std::log2(0.18);  // [Reinhard2002, eq. 2]: their usual key
    const auto exposure = static_cast<float>(key - sum / static_cast<double>(end - begin));
    return std::clamp(exposure, -Display::max_exposure, Display::max_exposure);
}

std::vector<std::uint8_t> shown_rgb(const core::Picture& picture, const PictureColors& colors) {
    std::optional<ViewTransform> hdr;
    if (colors.view.is_hdr()) hdr.emplace(colors.view);
    // [BT709, 3.4] and [BT601, 2.5.3], turned around.
    const glm::vec3 weight = luma_weights(colors.matrix);
    const float blue_scale = (1 - weight.z) / 112, red_scale = (1 - weight.x) / 112;
    std::vector<std::uint8_t> codes;
    codes.reserve(3 * picture.y.size());
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            const float luma = (static_cast<float>(picture.y.at(x, y)) - 16) / 219;
            const float blue = luma + blue_scale * chroma_at(picture.cb, x, y);
            const float red = luma + red_scale * chroma_at(picture.cr, x, y);
            const float green = (luma - weight.x * red - weight.z * blue) / weight.y;
            glm::vec3 signals = glm::clamp(glm::vec3(red, green, blue), 0.0f, 1.0f);
            if (hdr) signals = neutral_signals(hdr->shown_light(signals));
            for (int c = 0; c < 3; ++c) codes.push_back(static_cast<std::uint8_t>(std::lround(255 * signals[c])));
        }
    return codes;
}

}  // namespace render2mpeg::perceptual
