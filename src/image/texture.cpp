// Textures are averaged over the pixel's footprint, since an unfiltered texture shimmers and costs more bits than any
// encoder saves. The footprint's ellipse is covered by trilinear probes along its longer axis [McCormack1999]; its
// shorter axis chooses the level of a mip pyramid [Williams1983]. We changed: equal weights instead of a Gaussian's;
// the scale of each level is the true ratio of the sizes, which for sides that are no power of two is not 2^k.
#include "image/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::image {
namespace {

/// Source texels and weights of one texel of the shorter row.
struct Mixture {
    std::vector<int> from;
    std::vector<float> weight;  ///< sums to 1
};

/// Integral from -infinity to x of the filter: a tent of unit half width. chosen: against a box, a quadratic B-spline
/// and Kaiser windows (bench/tables/pictures.csv).
double tent_integral(double x) {
    if (x <= -1) return 0;
    if (x >= 1) return 1;
    return x < 0 ? 0.5 * (1 + x) * (1 + x) : 1 - 0.5 * (1 - x) * (1 - x);
}

/// One axis from n texels to m. Each weight is the integral of the filter over the texel, so that any ratio n / m
/// treats all texels alike.
std::vector<Mixture> mixtures(int n, int m, core::Wrap wrap) {
    const double ratio = static_cast<double>(n) / m;
    std::vector<Mixture> row(static_cast<std::size_t>(m));
    if (n == m) {
        for (int i = 0; i < m; ++i) row[static_cast<std::size_t>(i)] = {{i}, {1.0f}};
        return row;
    }
    for (int i = 0; i < m; ++i) {
        const double center = (i + 0.5) * ratio;
        const int first = static_cast<int>(std::floor(center - ratio)),
                  last = static_cast<int>(std::ceil(center + ratio));
        Mixture& mixture = row[static_cast<std::size_t>(i)];
        for (int j = first; j < last; ++j) {
            const double weight = tent_integral((j + 1 - center) / ratio) - tent_integral((j - center) / ratio);
            if (weight <= 0) continue;
            mixture.from.push_back(wrapped(j, n, wrap));
            mixture.weight.push_back(static_cast<float>(weight));
        }
    }
    return row;
}

/// chosen: 16 of 4 to 32 (bench/tables/pictures.csv).
constexpr int max_probes = 16;
/// Coordinates from here on have no fraction.
constexpr float no_fraction = 16777216.0f;
/// Footprints longer than this many times the texture are its mean; keeps the fourth powers below finite.
constexpr float endless = 4096.0f;
/// chosen: sums over 2^28 pixels and products of two values stay finite.
constexpr float largest_value = 1e18f;

/// Four floats that the compiler keeps in one register, on any processor.
using Float4 = float __attribute__((vector_size(16)));

Float4 mix(Float4 a, Float4 b, float t) {
    return a + (b - a) * t;
}

/// Code value to linear light: sRGB, then as it is.
struct Tables {
    std::array<float, 256> srgb{}, linear{};
    Tables() {
        for (int i = 0; i < 256; ++i) {
            linear[static_cast<std::size_t>(i)] = static_cast<float>(i) / 255.0f;
            srgb[static_cast<std::size_t>(i)] = core::srgb_to_linear(static_cast<float>(i) / 255.0f);
        }
    }
};
const Tables tables;

float finite(float v) {
    if (std::isinf(v)) return std::copysign(overflowed, v);
    return std::isnan(v) ? 0.0f : std::clamp(v, -largest_value, largest_value);
}

std::uint8_t code_of(float v) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0f, 1.0f) * 255.0f));
}

/// The linear value of a pixel that is a float.
glm::vec4 linear_value(glm::vec4 p, Encoding encoding) {
    for (int c = 0; c < 4; ++c) p[c] = finite(p[c]);
    if (encoding == Encoding::srgb)
        for (int c = 0; c < 3; ++c) p[c] = core::srgb_to_linear(p[c]);
    return p;
}

/// The linear value of a pixel in code values.
glm::vec4 linear_value(const Codes& codes, Encoding encoding) {
    const glm::vec4 p = StoredImage::value_of(codes);
    if (encoding == Encoding::linear) return p;
    return {tables.srgb[codes.rgba[0]], tables.srgb[codes.rgba[1]], tables.srgb[codes.rgba[2]], p.w};
}

/// A coordinate brought into [0, 1] as the wrap mode says.
float folded(float t, core::Wrap wrap) {
    if (wrap == core::Wrap::clamp_to_edge) return std::clamp(t, 0.0f, 1.0f);
    if (!(std::abs(t) < no_fraction)) return 0.0f;
    int turn = static_cast<int>(t);
    if (t < static_cast<float>(turn)) --turn;
    t -= static_cast<float>(turn);
    return wrap == core::Wrap::mirrored_repeat && (turn & 1) != 0 ? 1.0f - t : t;
}

/// Where a coordinate falls between two texels of a row.
struct Tap {
    int low, high;
    float fraction;  ///< weight of `high`
};

/// `sharpness` >= 1 narrows the blend between two texels about the middle between their centres; 1 is linear
/// interpolation.
Tap tap_at(float t, int n, core::Wrap wrap, float sharpness) {
    const float x = folded(t, wrap) * static_cast<float>(n) - 0.5f;
    const int low = static_cast<int>(x + 1.0f) - 1;  // x >= -0.5
    Tap tap{low, low + 1, x - static_cast<float>(low)};
    if (sharpness > 1.0f) tap.fraction = std::clamp((tap.fraction - 0.5f) * sharpness + 0.5f, 0.0f, 1.0f);
    const bool repeats = wrap == core::Wrap::repeat;
    if (tap.low < 0) tap.low = repeats ? n - 1 : 0;
    if (tap.high >= n) tap.high = repeats ? 0 : n - 1;
    return tap;
}

/// Texels kept as code values.
struct CodeTexels {
    const std::uint8_t* texel;
    const float* color;

    Float4 operator()(std::size_t i) const {
        const std::uint8_t* const t = texel + i * 4;
        return Float4{color[t[0]], color[t[1]], color[t[2]], tables.linear[t[3]]};
    }
};

/// Texels kept as they are.
struct Floats {
    const glm::vec4* texel;

    Float4 operator()(std::size_t i) const { return Float4{texel[i].x, texel[i].y, texel[i].z, texel[i].w}; }
};

/// Colours times coverage.
template <class Texels>
struct Covered {
    Texels texels;

    Float4 operator()(std::size_t i) const {
        const Float4 t = texels(i);
        return t * Float4{t[3], t[3], t[3], 1.0f};
    }
};

}  // namespace

int wrapped(int i, int n, core::Wrap wrap) {
    switch (wrap) {
        case core::Wrap::repeat:
            return ((i % n) + n) % n;
        case core::Wrap::mirrored_repeat: {
            const int j = ((i % (2 * n)) + 2 * n) % (2 * n);
            return j < n ? j : 2 * n - 1 - j;
        }
        case core::Wrap::clamp_to_edge:
            break;
    }
    return std::clamp(i, 0, n - 1);
}

core::Plane<glm::vec4> halve(int width, int height, const RowOf& row, core::Wrap wrap_u, core::Wrap wrap_v) {
    const int half_width = std::max(1, width / 2), half_height = std::max(1, height / 2);
    const std::vector<Mixture> columns = mixtures(width, half_width, wrap_u);
    const std::vector<Mixture> rows = mixtures(height, half_height, wrap_v);

    // Rows of half the width, each kept while it is wanted: a row of the result is made of six neighbours at most, of
    // which those at an edge may come from the other.
    constexpr int kept = 8;
    std::array<std::vector<glm::vec4>, kept> narrow;
    std::array<int, kept> number;
    number.fill(-1);
    const auto narrow_row = [&](int y) -> const std::vector<glm::vec4>& {
        const auto place = static_cast<std::size_t>(y % kept);
        if (number[place] == y) return narrow[place];
        number[place] = y;
        narrow[place].resize(static_cast<std::size_t>(half_width));
        const glm::vec4* const from = row(y);
        std::transform(columns.begin(), columns.end(), narrow[place].begin(), [&](const Mixture& mixture) {
            glm::vec4 sum{0};
            for (std::size_t i = 0; i < mixture.from.size(); ++i) sum += mixture.weight[i] * from[mixture.from[i]];
            return sum;
        });
        return narrow[place];
    };

    core::Plane<glm::vec4> half(half_width, half_height, glm::vec4{0});
    for (int y = 0; y < half_height; ++y) {
        const Mixture& mixture = rows[static_cast<std::size_t>(y)];
        for (std::size_t i = 0; i < mixture.from.size(); ++i) {
            const std::vector<glm::vec4>& from = narrow_row(mixture.from[i]);
            glm::vec4* const to = half.row(y);
            for (std::size_t x = 0; x < from.size(); ++x) to[x] += mixture.weight[i] * from[x];
        }
    }
    return half;
}

core::Plane<glm::vec4> halve(const core::Plane<glm::vec4>& level, core::Wrap wrap_u, core::Wrap wrap_v) {
    return halve(
        level.width(), level.height(), [&](int y) { return level.row(y); }, wrap_u, wrap_v);
}

/// How a footprint is covered: `count` probes of one size, evenly along a line.
struct Texture::Probes {
    glm::vec2 first{0}, step{0};
    int count = 1;
    std::size_t level = 0;
    float coarser = 0;  ///< weight of level + 1
    glm::vec2 sharpness{1, 1};
};

Texture::Texture(const StoredImage& image, Encoding encoding, core::Wrap wrap_u, core::Wrap wrap_v, bool nearest,
                 AlphaMeaning alpha)
    : wrap_u_(wrap_u),
      wrap_v_(wrap_v),
      encoding_(image.high_range ? Encoding::linear : encoding),
      alpha_(image.has_alpha ? alpha : AlphaMeaning::value),
      nearest_(nearest) {
    EXPECTS(image.pixels() > 0);
    const bool in_codes = !image.codes.empty();
    const std::size_t size = image.pixels(), columns = static_cast<std::size_t>(image.width);
    if (in_codes)
        codes_.reserve(size * 6);
    else
        floats_.reserve(size + size / 2);

    // Take the finest level row by row, since as linear floats it would be as large as the image; its mean in double
    // precision.
    std::vector<glm::vec4> line(columns);
    const auto linear_row = [&](int y) -> const glm::vec4* {
        const std::size_t first = static_cast<std::size_t>(y) * columns;
        const auto take = [&](const auto& row) {
            std::transform(row.begin(), row.end(), line.begin(),
                           [&](const auto& pixel) { return linear_value(pixel, encoding_); });
        };
        if (in_codes)
            take(image.codes.subspan(first, columns));
        else
            take(image.values.subspan(first, columns));
        if (alpha_ == AlphaMeaning::coverage)
            for (glm::vec4& p : line) p = glm::vec4(glm::vec3(p) * p.w, p.w);
        return line.data();
    };
    glm::dvec4 sum{0};
    for (int y = 0; y < image.height; ++y)
        for (const glm::vec4& p : std::span(linear_row(y), columns)) sum += glm::dvec4(p);
    const auto whole = glm::vec4(sum / static_cast<double>(size));
    mean_ = unassociated(whole);
    begin_level(image.width, image.height);
    const auto* const first_code = reinterpret_cast<const std::uint8_t*>(image.codes.data());
    codes_.insert(codes_.end(), first_code, first_code + image.codes.size_bytes());
    for (int y = 0; y < image.height && !in_codes; ++y) append_linear({linear_row(y), columns}, in_codes);

    // Build the pyramid down to one texel, which is the mean whatever the filter did at the edges. Only what is stored
    // is rounded, not what the next level is made of.
    if (size == 1) return;
    for (core::Plane<glm::vec4> level = halve(image.width, image.height, linear_row, wrap_u, wrap_v);;
         level = halve(level, wrap_u, wrap_v)) {
        if (level.size() == 1) level.at(0, 0) = whole;
        begin_level(level.width(), level.height());
        append_linear(level.values(), in_codes);
        if (level.size() == 1) return;
    }
}

/// Colour from a sum of colours times coverage; that of the last level where nothing is covered.
glm::vec4 Texture::unassociated(glm::vec4 v) const {
    if (alpha_ == AlphaMeaning::value) return v;
    if (!(v.w > 0)) return glm::vec4(glm::vec3(mean_), 0);
    return glm::vec4(glm::vec3(v) / v.w, v.w);
}

/// Begins a level of this size, for all texels stored from now on.
void Texture::begin_level(int columns, int rows) {
    Level level{columns, rows, 1, std::max(codes_.size() / 4, floats_.size())};
    if (!levels_.empty())
        level.texel = std::max(static_cast<float>(width()) / static_cast<float>(columns),
                               static_cast<float>(height()) / static_cast<float>(rows));
    levels_.push_back(level);
}

/// Stores linear values, in codes or as floats.
void Texture::append_linear(std::span<const glm::vec4> linear, bool in_codes) {
    for (const glm::vec4& value : linear) {
        const glm::vec4 texel = unassociated(value);
        if (!in_codes) {
            floats_.push_back(texel);
            continue;
        }
        for (int c = 0; c < 4; ++c) {
            const bool curved = encoding_ == Encoding::srgb && c < 3;
            codes_.push_back(code_of(curved ? core::linear_to_srgb(texel[c]) : texel[c]));
        }
    }
}

float Texture::texel(int x, int y, int channel) const {
    const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width()) + static_cast<std::size_t>(x);
    return codes_.empty() ? floats_[i][channel] : tables.linear[codes_[i * 4 + static_cast<std::size_t>(channel)]];
}

Texture::Probes Texture::cover(glm::vec2 uv, const Footprint& footprint) const {
    const glm::vec2 size{width(), height()};
    const glm::vec2 a = footprint.dx * size, b = footprint.dy * size;

    // Find the axes of the ellipse {a cos t + b sin t}: singular values and the first singular vector of the matrix (a
    // b), in texels.
    const float xx = a.x * a.x + b.x * b.x, yy = a.y * a.y + b.y * b.y, xy = a.x * a.y + b.x * b.y;
    const float half_gap = 0.5f * (xx - yy);
    const float longer_squared = 0.5f * (xx + yy) + std::sqrt(half_gap * half_gap + xy * xy);
    const float longer = std::sqrt(longer_squared);
    Probes probes{uv, {0, 0}, 1, 0, 0, {1, 1}};
    if (longer <= 1.0f) {
        // The mean of texels with hard edges over a box is a ramp as wide as the box.
        if (nearest_) probes.sharpness = 1.0f / glm::max(glm::abs(a) + glm::abs(b), glm::vec2(1e-6f));
        return probes;
    }
    const float shorter = std::abs(a.x * b.y - a.y * b.x) / longer;

    // Cover it by probes as large as the shorter axis, or larger where there would be too many.
    const float ratio = longer / std::max(shorter, 1.0f);
    probes.count = std::clamp(static_cast<int>(std::ceil(std::min(ratio, 64.0f) - 0.05f)), 1, max_probes);
    const float probe = std::max({shorter, 1.0f, longer / static_cast<float>(probes.count)});
    if (probes.count > 1) {
        // Space them so that the variance along the axis is that of the whole length, whatever their number: nothing
        // jumps where it changes.
        const auto n = static_cast<float>(probes.count);
        const float step = core::sqrt_or_zero((longer_squared - probe * probe) / (n * n - 1.0f));
        const glm::vec2 axis = half_gap >= 0 ? glm::vec2(longer_squared - yy, xy) : glm::vec2(xy, longer_squared - xx);
        probes.step = axis * core::divide_or(step, std::sqrt(glm::dot(axis, axis)), 0.0f) / size;
        probes.first = uv - probes.step * (0.5f * (n - 1.0f));
    }

    // Choose the two levels between whose texels a probe's size lies. Level k's texels are at least 2^k long.
    probes.level = std::min(static_cast<std::size_t>(std::ilogb(probe)), levels_.size() - 1);
    while (levels_[probes.level].texel > probe) --probes.level;
    if (probes.level + 1 < levels_.size()) {
        const float fine = levels_[probes.level].texel, coarse = levels_[probes.level + 1].texel;
        probes.coarser = (probe - fine) / (coarse - fine);
    }
    return probes;
}

template <class Texels>
glm::vec4 Texture::filter(const Texels& texels, const Probes& probes) const {
    const auto interpolate = [&](const Level& level, glm::vec2 uv) {
        const Tap x = tap_at(uv.x, level.width, wrap_u_, probes.sharpness.x);
        const Tap y = tap_at(uv.y, level.height, wrap_v_, probes.sharpness.y);
        const std::size_t upper = level.first + static_cast<std::size_t>(y.low) * static_cast<std::size_t>(level.width);
        const std::size_t lower =
            level.first + static_cast<std::size_t>(y.high) * static_cast<std::size_t>(level.width);
        const auto low = static_cast<std::size_t>(x.low), high = static_cast<std::size_t>(x.high);
        return mix(mix(texels(upper + low), texels(upper + high), x.fraction),
                   mix(texels(lower + low), texels(lower + high), x.fraction), y.fraction);
    };

    const Level& fine = levels_[probes.level];
    Float4 sum{0, 0, 0, 0};
    for (int i = 0; i < probes.count; ++i) {
        const glm::vec2 uv = probes.first + probes.step * static_cast<float>(i);
        Float4 value = interpolate(fine, uv);
        if (probes.coarser > 0) value = mix(value, interpolate(levels_[probes.level + 1], uv), probes.coarser);
        sum += value;
    }
    const float share = 1.0f / static_cast<float>(probes.count);
    return unassociated(glm::vec4(sum[0], sum[1], sum[2], sum[3]) * share);
}

glm::vec4 Texture::sample(glm::vec2 uv, const Footprint& footprint) const {
    // Answer with the mean where there is no finer answer; comparisons are written so that NaN fails them.
    const float reach = std::max(std::abs(footprint.dx.x) + std::abs(footprint.dy.x),
                                 std::abs(footprint.dx.y) + std::abs(footprint.dy.y));
    if (levels_.size() < 2 || !core::is_finite(uv) || !core::is_finite(footprint.dx) ||
        !core::is_finite(footprint.dy) || !(reach < endless))
        return mean_;

    return filter(cover(uv, footprint));
}

glm::vec4 Texture::probe(glm::vec2 uv, float texels) const {
    if (levels_.size() < 2 || !core::is_finite(uv)) return mean_;
    Probes probes{uv, {0, 0}, 1, 0, 0, {1, 1}};
    while (probes.level + 1 < levels_.size() &&
           texels * texels > levels_[probes.level].texel * levels_[probes.level + 1].texel)
        ++probes.level;
    return filter(probes);
}

glm::vec4 Texture::filter(const Probes& probes) const {
    const bool covered = alpha_ == AlphaMeaning::coverage;
    if (codes_.empty()) {
        const Floats texels{floats_.data()};
        return covered ? filter(Covered<Floats>{texels}, probes) : filter(texels, probes);
    }
    const CodeTexels texels{codes_.data(), encoding_ == Encoding::srgb ? tables.srgb.data() : tables.linear.data()};
    return covered ? filter(Covered<CodeTexels>{texels}, probes) : filter(texels, probes);
}

}  // namespace render2mpeg::image
