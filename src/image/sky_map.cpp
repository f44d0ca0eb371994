#include "image/sky_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::image {
namespace {

/// chosen: cells of a quarter of a degree at least, of 0.09 to 0.7 (bench/tables/pictures.csv); 64 columns give an
/// image of a few pixels parts that are small enough to be lights.
constexpr int max_columns = 1440, max_rows = 720, min_columns = 64, min_rows = 32;

/// How an axis of `pixels` is cut into cells.
struct Axis {
    int pixels_per_cell = 1, cells_per_pixel = 1;
    int cells = 0;
    std::vector<double> edges;

    Axis(int pixels, int least, int most)
        : pixels_per_cell((pixels + most - 1) / most), cells_per_pixel((least + pixels - 1) / pixels) {
        cells = (pixels * cells_per_pixel + pixels_per_cell - 1) / pixels_per_cell;
        for (int i = 0; i <= cells; ++i)
            edges.push_back(std::min(
                1.0, static_cast<double>(i) * pixels_per_cell / (static_cast<double>(pixels) * cells_per_pixel)));
    }
};

/// Integral of sin from pi a to pi b, without cancellation: cos x - cos y = 2 sin((x + y) / 2) sin((y - x) / 2).
double band(double a, double b) {
    return 2 * std::sin(0.5 * std::numbers::pi * (a + b)) * std::sin(0.5 * std::numbers::pi * (b - a));
}

/// Power of a rectangle by columns or by rows.
std::vector<double> profile(const core::Plane<float>& power, int x0, int y0, int x1, int y1, bool by_columns) {
    std::vector<double> sums(static_cast<std::size_t>(by_columns ? x1 - x0 : y1 - y0), 0.0);
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) sums[static_cast<std::size_t>(by_columns ? x - x0 : y - y0)] += power.at(x, y);
    return sums;
}

/// Where to cut a profile so that its first piece has about `share` of the whole; also that piece's true share.
struct Cut {
    int at;        ///< 1 .. size - 1
    double share;  ///< 0..1
};
Cut cut_near(const std::vector<double>& profile, double share) {
    double total = 0;
    for (const double p : profile) total += p;
    Cut best{1, 0};
    double sum = 0, distance = 2;
    for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
        sum += profile[i];
        const double here = core::divide_or(sum, total, 0.0);
        if (std::abs(here - share) < distance) {
            distance = std::abs(here - share);
            best = {static_cast<int>(i) + 1, here};
        }
    }
    return best;
}

/// chosen: sums over a whole map of them stay finite.
constexpr float largest_radiance = 1e18f;
/// Probes that a texture has for a long footprint; longer ones would be blurred across, too.
constexpr float longest_footprint = 16;

/// Columns of the grid that an even sky is divided by. chosen: 512, cells of 0.7 degrees; a hundred thousand of them.
constexpr int even_columns = 512;

float usable(float radiance) {
    if (!(radiance > 0)) return 0.0f;
    return std::isinf(radiance) ? overflowed : std::min(radiance, largest_radiance);
}

constexpr float full_turn = 2 * std::numbers::pi_v<float>;

/// Sine of the angle to the zenith.
float sine_of(glm::vec3 d) {
    return std::sqrt(d.x * d.x + d.z * d.z);
}

/// Place on the map of a direction in it, of any length.
glm::vec2 place_of(glm::vec3 d) {
    return {0.5f + std::atan2(d.x, -d.z) / full_turn, std::atan2(sine_of(d), d.y) / (0.5f * full_turn)};
}

/// Evenly spread directions that stand for equal solid angles: a Fibonacci spiral. [Swinbank2006]
glm::vec3 spiral_direction(int i, int count) {
    const double y = 1 - (2.0 * i + 1) / count;
    const double turn = i * (2 * std::numbers::pi * (1 - 1 / std::numbers::phi));
    const double r = core::sqrt_or_zero(1 - y * y);
    return {r * std::cos(turn), y, r * std::sin(turn)};
}

}  // namespace

/// A rectangle of cells [x0, x1) x [y0, y1) that becomes `lights` parts.
struct SkyGrid::Part {
    int x0, y0, x1, y1;
    int lights;
};

SkyGrid::SkyGrid(const core::Plane<glm::vec4>& radiance) {
    const int width = radiance.width(), height = radiance.height();
    EXPECTS(width > 0 && height > 0);
    const Axis across(width, min_columns, max_columns), down(height, min_rows, max_rows);
    light_ = core::Plane<glm::vec3>(across.cells, down.cells, glm::vec3(0));
    center_ = core::Plane<glm::vec3>(across.cells, down.cells, glm::vec3(0));
    column_edges_ = across.edges;
    row_edges_ = down.edges;

    // Walk over the pieces, which are pixels or parts of them. Sums are scaled by the piece, so that no square of a sun
    // overflows.
    const int piece_columns = width * across.cells_per_pixel, piece_rows = height * down.cells_per_pixel;
    std::vector<glm::dvec2> azimuths;
    for (int x = 0; x < piece_columns; ++x) {
        const double azimuth = 2 * std::numbers::pi * ((x + 0.5) / piece_columns - 0.5);
        azimuths.emplace_back(std::sin(azimuth), -std::cos(azimuth));
    }
    glm::dvec3 total{0};
    for (int y = 0; y < piece_rows; ++y) {
        const double v = (y + 0.5) / piece_rows, sine = std::sin(std::numbers::pi * v),
                     cosine = std::cos(std::numbers::pi * v);
        const double solid_angle =
            2 * std::numbers::pi / piece_columns * band(static_cast<double>(y) / piece_rows, (y + 1.0) / piece_rows);
        const glm::vec4* const pixels = radiance.row(y / down.cells_per_pixel);
        for (int x = 0; x < piece_columns; ++x) {
            const glm::dvec3 light = glm::dvec3(glm::vec3(pixels[x / across.cells_per_pixel])) * solid_angle;
            const int column = x / across.pixels_per_cell, row = y / down.pixels_per_cell;
            const auto azimuth = azimuths[static_cast<std::size_t>(x)];
            light_.at(column, row) += glm::vec3(light);
            center_.at(column, row) +=
                core::luminance(glm::vec3(light)) * glm::vec3(sine * azimuth.x, cosine, sine * azimuth.y);
            total += light;
        }
    }
    total_ = glm::vec3(total);
    for (glm::vec3& center : center_.values()) center = core::normalize_or(center, {0, 1, 0});
}

double SkyGrid::solid_angle(const Part& part) const {
    const auto column = [&](int x) { return column_edges_[static_cast<std::size_t>(x)]; };
    const auto row = [&](int y) { return row_edges_[static_cast<std::size_t>(y)]; };
    const double a = std::numbers::pi * row(part.y0), b = std::numbers::pi * row(part.y1);
    return 2 * std::numbers::pi * (column(part.x1) - column(part.x0)) * 2 * std::sin(0.5 * (a + b)) *
           std::sin(0.5 * (b - a));
}

SkySample SkyGrid::sample_of(const Part& part, const core::Plane<float>& power) const {
    glm::dvec3 light{0}, center{0};
    float brightest = 0;
    glm::vec3 fallback{0, 1, 0};
    for (int y = part.y0; y < part.y1; ++y)
        for (int x = part.x0; x < part.x1; ++x) {
            if (!(power.at(x, y) > 0)) continue;  // a part of its own
            const float p = core::luminance(light_.at(x, y));
            light += glm::dvec3(light_.at(x, y));
            center += glm::dvec3(center_.at(x, y)) * static_cast<double>(p);
            if (p > brightest) {
                brightest = p;
                fallback = center_.at(x, y);
            }
        }
    const double length = std::sqrt(glm::dot(center, center));
    const glm::vec3 direction = length > 0 ? core::normalize_or(glm::vec3(center / length), fallback) : fallback;
    return {direction, glm::vec3(light), static_cast<float>(solid_angle(part)), 0};
}

std::vector<SkySample> SkyGrid::divide(int count, const SkyImportance& importance) const {
    std::vector<SkySample> samples;
    if (count <= 0 || empty()) return samples;

    // Weigh the cells, and take out those that are parts of their own.
    core::Plane<float> power(columns(), rows());
    for (int y = 0; y < rows(); ++y)
        for (int x = 0; x < columns(); ++x)
            power.at(x, y) = core::luminance(light_.at(x, y)) * (importance ? importance(center_.at(x, y)) : 1.0f);
    double total = 0, rest = 0;
    for (const float p : power.values()) total += p;
    for (int y = 0; y < rows(); ++y)
        for (int x = 0; x < columns(); ++x) {
            if (!(power.at(x, y) > total / count)) continue;
            samples.push_back(sample_of({x, y, x + 1, y + 1, 1}, power));
            power.at(x, y) = 0;
        }
    for (const float p : power.values()) rest += p;

    // Divide the rest in a fixed order: the first half of a part before its second.
    std::vector<Part> open;
    if (rest > 0) open.push_back({0, 0, columns(), rows(), std::max(1, count - static_cast<int>(samples.size()))});
    while (!open.empty()) {
        const Part part = open.back();
        open.pop_back();
        divide(part, power, open, samples);
    }
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i].id = static_cast<std::uint32_t>(i);
    return samples;
}

/// Cuts a part in two, which are then open, or makes it a sample.
void SkyGrid::divide(const Part& part, const core::Plane<float>& power, std::vector<Part>& open,
                     std::vector<SkySample>& samples) const {
    const int across = part.x1 - part.x0, down = part.y1 - part.y0;
    if (part.lights == 1 || (across == 1 && down == 1)) {
        samples.push_back(sample_of(part, power));
        return;
    }

    // Cut across the longer side as it lies on the sphere.
    const double middle = 0.5 * (part.y0 + part.y1) * std::numbers::pi / rows();
    const bool is_wide =
        across * 2 * std::numbers::pi / columns() * std::sin(middle) >= down * std::numbers::pi / rows();
    const bool by_columns = down == 1 || (across > 1 && is_wide);
    const int half = part.lights / 2;
    const Cut cut = cut_near(profile(power, part.x0, part.y0, part.x1, part.y1, by_columns),
                             static_cast<double>(half) / part.lights);

    // Give each side lights in proportion to its power; a side without power is dropped.
    Part first = part, second = part;
    (by_columns ? first.x1 : first.y1) = (by_columns ? part.x0 : part.y0) + cut.at;
    (by_columns ? second.x0 : second.y0) = (by_columns ? part.x0 : part.y0) + cut.at;
    first.lights = static_cast<int>(std::lround(cut.share * part.lights));
    if (cut.share > 0 && cut.share < 1) first.lights = std::clamp(first.lights, 1, part.lights - 1);
    second.lights = part.lights - first.lights;
    if (cut.share < 1) open.push_back(second);
    if (cut.share > 0) open.push_back(first);
}

SkyMap::SkyMap(glm::vec3 radiance) : mean_(usable(radiance.x), usable(radiance.y), usable(radiance.z)) {}

SkyMap::SkyMap(const StoredImage& image, glm::vec3 factor, float rotation)
    : cos_rotation_(std::cos(rotation)), sin_rotation_(std::sin(rotation)) {
    EXPECTS(std::isfinite(rotation));
    const int width = image.width, height = image.height;
    if (width == 0 || height == 0) return;

    // Make the radiance linear and usable. Its alpha weighs a row by its solid angle, so that the texture's means are
    // means over the sphere and not over the image.
    Image sky{core::Plane<glm::vec4>(width, height), true, true};
    for (int y = 0; y < height; ++y) {
        const auto weight = static_cast<float>(std::sin(std::numbers::pi * (y + 0.5) / height));
        for (int x = 0; x < width; ++x) {
            const glm::vec4 p = image.at(x, y);
            glm::vec4& radiance = sky.pixels.at(x, y);
            for (int c = 0; c < 3; ++c)
                radiance[c] =
                    usable(factor[c] * (image.high_range ? usable(p[c]) : core::srgb_to_linear(usable(p[c]))));
            radiance.w = weight;
        }
    }
    grid_ = SkyGrid(sky.pixels);
    mean_ = grid_.total() / (4 * std::numbers::pi_v<float>);
    texture_ =
        Texture(sky, Encoding::linear, core::Wrap::repeat, core::Wrap::clamp_to_edge, false, AlphaMeaning::coverage);
}

glm::vec3 SkyMap::to_world(glm::vec3 d) const {
    return {cos_rotation_ * d.x + sin_rotation_ * d.z, d.y, cos_rotation_ * d.z - sin_rotation_ * d.x};
}

glm::vec3 SkyMap::to_map(glm::vec3 d) const {
    return {cos_rotation_ * d.x - sin_rotation_ * d.z, d.y, cos_rotation_ * d.z + sin_rotation_ * d.x};
}

glm::vec3 SkyMap::radiance(glm::vec3 direction, float solid_angle) const {
    const glm::vec3 d = core::normalize_or(to_map(direction), glm::vec3(0));
    if (uniform() || d == glm::vec3(0) || !(solid_angle < 4 * std::numbers::pi_v<float>)) return mean_;

    // Take the cone for a square of the same solid angle, along the meridians.
    const float sine = sine_of(d);
    const float side = core::sqrt_or_zero(solid_angle);
    const float high = std::min(side / (0.5f * full_turn), 1.0f);
    const float widest = longest_footprint * std::max(high * static_cast<float>(texture_.height()), 1.0f);
    const float wide =
        std::min({core::divide_or(side, sine * full_turn, 1.0f), 1.0f, widest / static_cast<float>(texture_.width())});
    return glm::vec3(texture_.sample(place_of(d), {{wide, 0}, {0, high}}));
}

glm::vec3 SkyMap::radiance_of_ray(glm::vec3 direction, float solid_angle) const {
    if (uniform() || !(solid_angle < 2 * full_turn)) return mean_;
    const float high = core::sqrt_or_zero(solid_angle) / (0.5f * full_turn);
    return glm::vec3(texture_.probe(place_of(to_map(direction)), high * static_cast<float>(texture_.height())));
}

std::vector<SkySample> SkyMap::samples(int count, const SkyImportance& importance) const {
    if (count <= 0 || !(core::luminance(mean_) > 0)) return {};
    std::vector<SkySample> samples;
    if (uniform() && !importance) {
        const float solid_angle = 4 * std::numbers::pi_v<float> / static_cast<float>(count);
        for (int i = 0; i < count; ++i)
            samples.push_back(
                {spiral_direction(i, count), mean_ * solid_angle, solid_angle, static_cast<std::uint32_t>(i)});
        return samples;
    }
    SkyImportance in_map;
    if (importance) in_map = [&](glm::vec3 direction) { return importance(to_world(direction)); };
    samples = (uniform() ? SkyGrid(core::Plane<glm::vec4>(even_columns, even_columns / 2, glm::vec4(mean_, 1))) : grid_)
                  .divide(count, in_map);
    for (SkySample& sample : samples) sample.direction = to_world(sample.direction);
    return samples;
}

}  // namespace render2mpeg::image
