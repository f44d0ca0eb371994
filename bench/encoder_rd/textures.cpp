#include "encoder_rd/textures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <map>

#include "core/error.h"
#include "core/sampling.h"
#include "image/image.h"
#include "parallel/loops.h"

namespace render2mpeg::bench {
namespace {

constexpr int size = 1024;
constexpr float two_pi = 6.28318531f;

float random_of(std::uint64_t seed, int x, int y) {
    return core::uniform(seed, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y));
}

int wrapped(int i, int n) {
    return ((i % n) + n) % n;
}

float faded(float t) {
    return t * t * (3 - 2 * t);
}

/// Smooth noise in -1..1 with `nu` x `nv` bumps over the texture, without a seam.
float noise(std::uint64_t seed, int nu, int nv, glm::vec2 uv) {
    const glm::vec2 p{uv.x * static_cast<float>(nu), uv.y * static_cast<float>(nv)};
    const glm::vec2 cell = glm::floor(p), f = p - cell;
    const int x = static_cast<int>(cell.x), y = static_cast<int>(cell.y);
    const auto at = [&](int i, int j) { return random_of(seed, wrapped(x + i, nu), wrapped(y + j, nv)); };
    const float u = faded(f.x), v = faded(f.y);
    const float top = at(0, 0) + u * (at(1, 0) - at(0, 0)), low = at(0, 1) + u * (at(1, 1) - at(0, 1));
    return 2 * (top + v * (low - top)) - 1;
}

/// Octaves from `cells` bumps across to bumps of four texels, each `fall` times as strong as the one before; about
/// -1..1.
float clouds(std::uint64_t seed, int cells, glm::vec2 uv, float fall = 0.6f) {
    float sum = 0, weight = 1, weights = 0;
    for (int n = cells; n <= size / 4; n *= 2, weight *= fall) {
        sum += weight * noise(seed + static_cast<std::uint64_t>(n), n, n, uv);
        weights += weight;
    }
    return 1.8f * sum / weights;
}

glm::vec3 blend(glm::vec3 a, glm::vec3 b, float t) {
    return a + (b - a) * std::clamp(t, 0.0f, 1.0f);
}

/// 1 in the middle of a line that comes every 1, 0 beyond `width`.
float line(float x, float width) {
    const float d = std::abs(x - std::round(x));
    return std::max(0.0f, 1 - d / width);
}

glm::vec3 tiles(glm::vec2 uv) {
    const glm::vec2 p = uv * 4.0f, cell = glm::floor(p);
    const float tone = 0.88f + 0.2f * random_of(11, static_cast<int>(cell.x), static_cast<int>(cell.y));
    const glm::vec2 cut = uv + 0.37f * cell + glm::vec2(0.13f, 0.29f) * cell.y;  // each from another place of the block
    const float vein = 1 - std::min(1.0f, 5 * std::abs(clouds(12, 3, cut)));
    const glm::vec3 stone =
        blend({0.84f, 0.80f, 0.72f}, {0.52f, 0.46f, 0.40f}, 0.3f + 0.35f * clouds(13, 6, cut, 0.75f) + 0.4f * vein);
    return blend(tone * stone, {0.33f, 0.31f, 0.29f}, std::max(line(p.x, 0.02f), line(p.y, 0.02f)));
}

glm::vec3 bricks(glm::vec2 uv) {
    const float row = std::floor(uv.y * 12), shift = wrapped(static_cast<int>(row), 2) != 0 ? 0.5f : 0.0f;
    const glm::vec2 p{uv.x * 5 + shift, uv.y * 12};
    const int i = wrapped(static_cast<int>(std::floor(p.x)), 5), j = static_cast<int>(row);
    const float tone = 0.7f + 0.5f * random_of(21, i, j), hue = random_of(22, i, j);
    const glm::vec3 clay = blend({0.60f, 0.30f, 0.21f}, {0.70f, 0.46f, 0.32f}, hue);
    const float rough = clouds(23, 24, uv, 0.8f);
    const float edge = 0.012f * clouds(24, 32, uv);
    const float joint = std::max(line(p.x + edge, 0.035f) * 1.6f, line(p.y + 2 * edge, 0.09f) * 1.6f);
    return blend(tone * (1 + 0.3f * rough) * clay, (1 + 0.2f * rough) * glm::vec3(0.62f, 0.58f, 0.52f), joint);
}

glm::vec3 planks(glm::vec2 uv) {
    const int board = static_cast<int>(uv.y * 8);
    const float shift = random_of(31, board, 0), tone = 0.75f + 0.35f * random_of(32, board, 1);
    const glm::vec2 p{uv.x + shift, uv.y};
    const float wave = 0.01f * clouds(33, 3, p);
    const float grain = noise(34, 12, 256, {p.x, p.y + wave}) * 0.6f + noise(35, 24, 128, {p.x, p.y + wave}) * 0.6f;
    const float ring = std::sin(two_pi * 40 * (p.y + 3 * wave + 0.02f * noise(36, 4, 8, p)));
    const glm::vec3 wood = blend({0.72f, 0.51f, 0.32f}, {0.42f, 0.26f, 0.14f}, 0.45f + 0.3f * grain + 0.15f * ring);
    return blend(tone * wood, {0.10f, 0.06f, 0.04f}, std::max(line(uv.y * 8, 0.03f), line(p.x, 0.003f)));
}

glm::vec3 plaster(glm::vec2 uv) {
    return (1 + 0.10f * clouds(41, 4, uv, 0.85f)) * glm::vec3(0.82f, 0.77f, 0.68f);
}

glm::vec3 cloth(glm::vec2 uv) {
    const float weave = std::sin(two_pi * 128 * uv.x) * std::sin(two_pi * 128 * uv.y);
    const float stripe = uv.y * 6 - std::floor(uv.y * 6), check = uv.x * 8 - std::floor(uv.x * 8);
    glm::vec3 color = stripe < 0.5f   ? glm::vec3(0.66f, 0.16f, 0.13f)
                      : stripe < 0.8f ? glm::vec3(0.88f, 0.82f, 0.68f)
                                      : glm::vec3(0.16f, 0.22f, 0.42f);
    if (check > 0.62f) color *= 0.62f;
    if (std::abs(check - 0.3f) < 0.03f) color = {0.85f, 0.66f, 0.20f};
    return (1 + 0.14f * weave + 0.16f * noise(51, 256, 256, uv) + 0.08f * clouds(52, 8, uv)) * color;
}

glm::vec3 marble(glm::vec2 uv) {
    const float bent = clouds(61, 3, uv);
    const float vein = std::pow(1 - std::min(1.0f, std::abs(std::sin(two_pi * (3 * uv.x + 2 * uv.y + bent)))), 4.0f);
    const float fine = 1 - std::min(1.0f, 6 * std::abs(clouds(62, 8, uv, 0.7f)));
    return blend(blend({0.90f, 0.89f, 0.86f}, {0.25f, 0.30f, 0.30f}, 0.8f * vein), {0.48f, 0.46f, 0.45f}, 0.5f * fine);
}

glm::vec3 gravel(glm::vec2 uv) {
    // The nearest of scattered stones, and how near.
    constexpr int n = 48;
    const glm::vec2 p = uv * static_cast<float>(n), cell = glm::floor(p);
    float nearest = 4, second = 4, tone = 0;
    for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
            const int x = wrapped(static_cast<int>(cell.x) + i, n), y = wrapped(static_cast<int>(cell.y) + j, n);
            const glm::vec2 d = cell + glm::vec2(i, j) + glm::vec2(random_of(71, x, y), random_of(72, x, y)) - p;
            const float distance = std::sqrt(glm::dot(d, d));
            if (distance < nearest) {
                second = nearest;
                nearest = distance;
                tone = random_of(73, x, y);
            } else {
                second = std::min(second, distance);
            }
        }
    const glm::vec3 stone = blend({0.36f, 0.33f, 0.29f}, {0.74f, 0.70f, 0.63f}, tone + 0.15f * clouds(74, 32, uv));
    return blend({0.14f, 0.12f, 0.10f}, stone, 0.15f + 4 * (second - nearest));
}

/// Lines of what looks like print from afar: words of strokes.
glm::vec3 print(glm::vec2 uv) {
    const glm::vec2 p{uv.x * 96, uv.y * 40};
    const int column = static_cast<int>(p.x), row = static_cast<int>(p.y);
    const float x = p.x - static_cast<float>(column), y = p.y - static_cast<float>(row);
    const bool heading = row % 10 == 2, blank = row % 10 == 0 || random_of(81, column, row) < 0.17f || column % 48 < 3;
    const glm::vec3 paper = (1 + 0.04f * clouds(82, 8, uv)) *
                            (column < 48 ? glm::vec3(0.90f, 0.87f, 0.78f) : glm::vec3(0.75f, 0.82f, 0.88f));
    if (blank || y < 0.2f || y > 0.8f) return paper;
    const float stroke = std::sin(two_pi * (x + random_of(83, column, row))) *
                         std::cos(3.1416f * (y - 0.5f + random_of(84, column, row)));
    const glm::vec3 ink = heading ? glm::vec3(0.55f, 0.06f, 0.05f) : glm::vec3(0.08f, 0.08f, 0.10f);
    return blend(paper, ink, 3 * stroke - (heading ? 0.0f : 0.5f));
}

glm::vec3 carpet(glm::vec2 uv) {
    const glm::vec2 d = uv - 0.5f;
    const float angle = std::atan2(d.y, d.x), radius = std::sqrt(glm::dot(d, d));
    const float star = radius * (1 + 0.2f * std::cos(8 * angle)), rings = 0.5f + 0.5f * std::cos(star * 70);
    const float border = std::min({uv.x, uv.y, 1 - uv.x, 1 - uv.y});
    glm::vec3 color = blend({0.48f, 0.12f, 0.12f}, {0.82f, 0.70f, 0.48f}, (rings - 0.35f) * 4);
    if (border < 0.12f)
        color = line(24 * (border < 0.12f ? uv.x + uv.y : 0.0f), 0.2f) > 0 ? glm::vec3(0.78f, 0.62f, 0.35f)
                                                                           : glm::vec3(0.14f, 0.18f, 0.32f);
    return (1 + 0.22f * noise(91, 256, 256, uv) + 0.15f * noise(92, 128, 128, uv)) * color;
}

using Painter = std::function<glm::vec3(glm::vec2)>;

const std::map<std::string, Painter>& painters() {
    static const std::map<std::string, Painter> all = {{"bricks", bricks},   {"carpet", carpet}, {"cloth", cloth},
                                                       {"gravel", gravel},   {"marble", marble}, {"planks", planks},
                                                       {"plaster", plaster}, {"print", print},   {"tiles", tiles}};
    return all;
}

}  // namespace

std::vector<std::string> texture_names() {
    std::vector<std::string> names;
    for (const auto& [name, painter] : painters()) names.push_back(name);
    return names;
}

void write_texture(const std::filesystem::path& folder, const std::string& name) {
    const Painter& paint = painters().at(name);
    std::vector<unsigned char> rgb(3u * size * size);
    parallel::for_each(size, [&](std::size_t y) {
        for (std::size_t x = 0; x < size; ++x) {
            const glm::vec3 color =
                paint({(static_cast<float>(x) + 0.5f) / size, (static_cast<float>(y) + 0.5f) / size});
            for (std::size_t c = 0; c < 3; ++c)
                rgb[3 * (y * size + x) + c] = static_cast<unsigned char>(
                    std::lround(255 * std::clamp(color[static_cast<glm::vec3::length_type>(c)], 0.0f, 1.0f)));
        }
    });
    image::write_png(folder / (name + ".png"), size, size, rgb);
}

}  // namespace render2mpeg::bench
