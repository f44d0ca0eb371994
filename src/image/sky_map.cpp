// Skies as lights. The partition into parts of equal power is Debevec's median cut [Debevec2005]. We changed: parts are
// divided in proportion to the number of samples they still get, so that any count works; cells that alone exceed a
// part's power are taken out first, so that a sun does not drag the borders of all other parts to itself; the longer
// side is measured on the sphere, not in the image.
#include "image/sky_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::image {
namespace {

constexpr double pi = std::numbers::pi;

/// chosen: cells of the partition's grid. 4096 columns are 0.09 degrees, a sixth of the sun; 64 columns give an image
/// of a few pixels parts small enough to be lights.
constexpr int max_columns = 4096, max_rows = 2048, min_columns = 64, min_rows = 32;
/// The largest half float.
constexpr float overflowed_sun = 65504.0f;
/// chosen: values beyond it are cut so that a whole map of them times a factor of 1e6 stays finite.
constexpr float largest_radiance = 1e18f;
/// Probes that a texture has for a long footprint; longer ones would be blurred across, too.
constexpr float longest_footprint = 16;

float usable(float radiance) {
    if (!(radiance > 0)) return 0.0f;
    return std::isinf(radiance) ? overflowed_sun : std::min(radiance, largest_radiance);
}

/// Integral of sin over one of `rows` equal bands from pole to pole, without cancellation: cos a - cos b = 2
/// sin((a+b)/2) sin((b-a)/2).
double band(int row, int rows) {
    const double height = pi / rows;
    return 2 * std::sin((row + 0.5) * height) * std::sin(0.5 * height);
}

int grid_size(int pixels, int least, int most) {
    return pixels >= least ? std::min(pixels, most) : pixels * ((least + pixels - 1) / pixels);
}

/// Evenly spread directions that stand for equal solid angles: a Fibonacci spiral. [Swinbank2006]
glm::vec3 spiral_direction(int i, int count) {
    const double y = 1 - (2.0 * i + 1) / count;
    const double turn = i * (2 * pi * (1 - 1 / std::numbers::phi));
    const double r = core::sqrt_or_zero(1 - y * y);
    return {r * std::cos(turn), y, r * std::sin(turn)};
}

}  // namespace

/// A rectangle of cells [x0, x1) x [y0, y1) that becomes `samples` parts.
struct SkyMap::Part {
    int x0, y0, x1, y1;
    int samples;
};

namespace {

/// Power of a part by columns or by rows.
std::vector<double> profile(const core::Plane<float>& power, int x0, int y0, int x1, int y1, bool by_columns) {
    std::vector<double> sums(static_cast<std::size_t>(by_columns ? x1 - x0 : y1 - y0), 0.0);
    for (int y = y0; y < y1; ++y) {
        const float* const row = power.row(y);
        if (by_columns)
            for (int x = x0; x < x1; ++x) sums[static_cast<std::size_t>(x - x0)] += row[x];
        else
            for (int x = x0; x < x1; ++x) sums[static_cast<std::size_t>(y - y0)] += row[x];
    }
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

}  // namespace

SkyMap::SkyMap(glm::vec3 radiance) : mean_(usable(radiance.x), usable(radiance.y), usable(radiance.z)) {}

SkyMap::SkyMap(const Image& image, glm::vec3 factor, float rotation)
    : cos_rotation_(std::cos(rotation)), sin_rotation_(std::sin(rotation)) {
    EXPECTS(std::isfinite(rotation));
    const int width = image.pixels.width(), height = image.pixels.height();
    if (width == 0 || height == 0) return;

    // Make the radiance linear and usable. Its alpha weighs a row by its solid angle, so that the texture's means are
    // means over the sphere and not over the image.
    Image sky{core::Plane<glm::vec4>(width, height), true, true};
    const double widest = band(height / 2, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const glm::vec4 p = image.pixels.at(x, y);
            glm::vec4& radiance = sky.pixels.at(x, y);
            for (int c = 0; c < 3; ++c)
                radiance[c] =
                    usable(factor[c] * (image.high_range ? usable(p[c]) : core::srgb_to_linear(usable(p[c]))));
            radiance.w = static_cast<float>(band(y, height) / widest);
        }
    texture_ =
        Texture(sky, Encoding::linear, core::Wrap::repeat, core::Wrap::clamp_to_edge, false, AlphaMeaning::coverage);

    // Sum the light of each cell; cells divide pixels, or pixels cells.
    const int columns = grid_size(width, min_columns, max_columns), rows = grid_size(height, min_rows, max_rows);
    grid_ = core::Plane<glm::vec3>(columns, rows, glm::vec3(0));
    const int down = std::max(rows, height), across = std::max(columns, width);
    glm::dvec3 total{0};
    for (int y = 0; y < down; ++y) {
        const double solid_angle = 2 * pi / across * band(y, down);
        for (int x = 0; x < across; ++x) {
            const auto pixel_x = static_cast<int>(std::int64_t{x} * width / across),
                       pixel_y = static_cast<int>(std::int64_t{y} * height / down);
            const auto cell_x = static_cast<int>(std::int64_t{x} * columns / across),
                       cell_y = static_cast<int>(std::int64_t{y} * rows / down);
            const glm::dvec3 light = glm::dvec3(glm::vec3(sky.pixels.at(pixel_x, pixel_y))) * solid_angle;
            grid_.at(cell_x, cell_y) += glm::vec3(light);
            total += light;
        }
    }
    mean_ = glm::vec3(total / (4 * pi));
}

glm::vec3 SkyMap::to_world(glm::vec3 d) const {
    return {cos_rotation_ * d.x + sin_rotation_ * d.z, d.y, cos_rotation_ * d.z - sin_rotation_ * d.x};
}

glm::vec3 SkyMap::to_map(glm::vec3 d) const {
    return {cos_rotation_ * d.x - sin_rotation_ * d.z, d.y, cos_rotation_ * d.z + sin_rotation_ * d.x};
}

/// In the map's space; columns and rows of the grid, counted from 0.
glm::vec3 SkyMap::direction_of(float column, float row) const {
    const double polar = (row + 0.5) * pi / grid_.height(), azimuth = 2 * pi * ((column + 0.5) / grid_.width() - 0.5);
    return {std::sin(polar) * std::sin(azimuth), std::cos(polar), -std::sin(polar) * std::cos(azimuth)};
}

double SkyMap::cell_solid_angle(int row) const {
    return 2 * pi / grid_.width() * band(row, grid_.height());
}

glm::vec3 SkyMap::radiance(glm::vec3 direction, float solid_angle) const {
    const glm::vec3 d = core::normalize_or(to_map(direction), glm::vec3(0));
    if (uniform() || d == glm::vec3(0) || !(solid_angle < 4 * std::numbers::pi_v<float>)) return mean_;

    // Take the cone for a square of the same solid angle, along the meridians.
    constexpr float turn = 2 * std::numbers::pi_v<float>;
    const float sine = std::sqrt(d.x * d.x + d.z * d.z);
    const glm::vec2 uv{0.5f + std::atan2(d.x, -d.z) / turn, std::atan2(sine, d.y) / (0.5f * turn)};
    const float side = core::sqrt_or_zero(solid_angle);
    const float high = std::min(side / (0.5f * turn), 1.0f);
    const float widest = longest_footprint * std::max(high * static_cast<float>(texture_.height()), 1.0f);
    const float wide =
        std::min({core::divide_or(side, sine * turn, 1.0f), 1.0f, widest / static_cast<float>(texture_.width())});
    return glm::vec3(texture_.sample(uv, {{wide, 0}, {0, high}}));
}

glm::vec3 SkyMap::irradiance(glm::vec3 normal) const {
    if (uniform()) return mean_ * std::numbers::pi_v<float>;

    // Cut cells that are large on the sphere into smaller ones, for the cosine varies within them.
    const int pieces = (1023 + grid_.width()) / grid_.width();
    const int columns = grid_.width() * pieces, rows = grid_.height() * pieces;
    std::vector<glm::vec2> azimuths(static_cast<std::size_t>(columns));
    for (int x = 0; x < columns; ++x) {
        const double azimuth = 2 * pi * ((x + 0.5) / columns - 0.5);
        azimuths[static_cast<std::size_t>(x)] = {std::sin(azimuth), -std::cos(azimuth)};
    }

    // Weigh each cell by the mean cosine of its pieces.
    const glm::vec3 n = to_map(normal);
    glm::dvec3 sum{0};
    for (int y = 0; y < rows; ++y) {
        const double polar = (y + 0.5) * pi / rows;
        const double share = band(y, rows) / (band(y / pieces, grid_.height()) * pieces);
        const auto sine = static_cast<float>(std::sin(polar)), height = static_cast<float>(n.y * std::cos(polar));
        for (int x = 0; x < grid_.width(); ++x) {
            float cosine = 0;
            for (int piece = x * pieces; piece < (x + 1) * pieces; ++piece) {
                const glm::vec2 azimuth = azimuths[static_cast<std::size_t>(piece)];
                cosine += std::max(0.0f, height + sine * (n.x * azimuth.x + n.z * azimuth.y));
            }
            sum += glm::dvec3(grid_.at(x, y / pieces)) * (share * cosine);
        }
    }
    return glm::vec3(sum);
}

SkySample SkyMap::sample_of(const Part& part, const core::Plane<float>& power) const {
    glm::dvec3 light{0}, center{0};
    double solid_angle = 0;
    float brightest = -1;
    glm::vec3 fallback{0, 1, 0};
    for (int y = part.y0; y < part.y1; ++y)
        for (int x = part.x0; x < part.x1; ++x) {
            const float p = power.at(x, y);
            if (!(p > 0)) continue;
            const glm::vec3 direction = direction_of(static_cast<float>(x), static_cast<float>(y));
            light += glm::dvec3(grid_.at(x, y));
            center += glm::dvec3(direction) * static_cast<double>(p);
            if (p > brightest) {
                brightest = p;
                fallback = direction;
            }
        }
    for (int y = part.y0; y < part.y1; ++y) solid_angle += cell_solid_angle(y) * (part.x1 - part.x0);
    const double length = std::sqrt(glm::dot(center, center));
    const glm::vec3 direction = length > 0 ? core::normalize_or(glm::vec3(center / length), fallback) : fallback;
    return {to_world(direction), glm::vec3(light), static_cast<float>(solid_angle), 0};
}

std::vector<SkySample> SkyMap::samples(int count) const {
    std::vector<SkySample> samples;
    if (count <= 0 || !(core::luminance(mean_) > 0)) return samples;
    if (uniform()) {
        const float solid_angle = 4 * std::numbers::pi_v<float> / static_cast<float>(count);
        for (int i = 0; i < count; ++i)
            samples.push_back(
                {spiral_direction(i, count), mean_ * solid_angle, solid_angle, static_cast<std::uint32_t>(i)});
        return samples;
    }

    // Weigh the cells, and take out those that are parts of their own.
    core::Plane<float> power(grid_.width(), grid_.height());
    std::transform(grid_.values().begin(), grid_.values().end(), power.values().begin(), core::luminance);
    double total = 0, rest = 0;
    for (const float p : power.values()) total += p;
    std::vector<Part> peaks;
    for (int y = 0; y < power.height(); ++y)
        for (int x = 0; x < power.width(); ++x)
            if (power.at(x, y) > total / count) peaks.push_back({x, y, x + 1, y + 1, 1});
    for (const Part& peak : peaks) {
        samples.push_back(sample_of(peak, power));
        power.at(peak.x0, peak.y0) = 0;
    }
    for (const float p : power.values()) rest += p;

    // Divide the rest, the part that is still to be divided first in first.
    std::vector<Part> open;
    if (rest > 0)
        open.push_back({0, 0, power.width(), power.height(), std::max(1, count - static_cast<int>(peaks.size()))});
    while (!open.empty()) {
        const Part part = open.back();
        open.pop_back();
        divide(part, power, open, samples);
    }
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i].id = static_cast<std::uint32_t>(i);
    return samples;
}

/// Cuts a part in two, which are then open, or makes it a sample.
void SkyMap::divide(const Part& part, const core::Plane<float>& power, std::vector<Part>& open,
                    std::vector<SkySample>& samples) const {
    const int across = part.x1 - part.x0, down = part.y1 - part.y0;
    if (part.samples == 1 || (across == 1 && down == 1)) {
        samples.push_back(sample_of(part, power));
        return;
    }

    // Cut across the longer side as it lies on the sphere.
    const double middle = 0.5 * (part.y0 + part.y1) * pi / power.height();
    const bool by_columns =
        down == 1 || (across > 1 && across * 2 * pi / power.width() * std::sin(middle) >= down * pi / power.height());
    const int half = part.samples / 2;
    const Cut cut = cut_near(profile(power, part.x0, part.y0, part.x1, part.y1, by_columns),
                             static_cast<double>(half) / part.samples);

    // Give each side samples in proportion to its power; a side without power is dropped.
    Part first = part, second = part;
    (by_columns ? first.x1 : first.y1) = (by_columns ? part.x0 : part.y0) + cut.at;
    (by_columns ? second.x0 : second.y0) = (by_columns ? part.x0 : part.y0) + cut.at;
    first.samples = static_cast<int>(std::lround(cut.share * part.samples));
    if (cut.share > 0 && cut.share < 1) first.samples = std::clamp(first.samples, 1, part.samples - 1);
    second.samples = part.samples - first.samples;
    if (cut.share < 1) open.push_back(second);
    if (cut.share > 0) open.push_back(first);
}

}  // namespace render2mpeg::image
