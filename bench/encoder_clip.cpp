#include "encoder_clip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/sampling.h"
#include "parallel/loops.h"

namespace render2mpeg::bench {
namespace {

constexpr float pi = 3.14159265f;

/// Noise of falling spectrum on a torus, with a pyramid of halved copies so that distance does not alias.
class Texture {
  public:
    explicit Texture(std::uint64_t seed) {
        core::Plane<float> base(size, size);
        for (int octave = 0, cell = 256; cell >= 2; ++octave, cell /= 2)
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x)
                    base.at(x, y) +=
                        lattice(seed + static_cast<std::uint64_t>(octave), x, y, cell) * std::pow(cell / 256.0f, 0.5f);
        levels_.push_back(std::move(base));
        while (levels_.back().width() > 4) levels_.push_back(halved(levels_.back()));
    }

    /// About -0.8..0.8. `footprint` is the width that one sample covers, in texels.
    float at(glm::vec2 p, float footprint) const {
        const float level =
            std::clamp(std::log2(std::max(footprint, 1.0f)), 0.0f, static_cast<float>(levels_.size() - 2));
        const auto lower = static_cast<std::size_t>(level);
        const float share = level - static_cast<float>(lower);
        return (1 - share) * bilinear(lower, p) + share * bilinear(lower + 1, p);
    }

  private:
    static constexpr int size = 1024;

    static float lattice(std::uint64_t seed, int x, int y, int cell) {
        const int n = size / cell, cx = x / cell, cy = y / cell;
        const float fx = static_cast<float>(x % cell) / static_cast<float>(cell),
                    fy = static_cast<float>(y % cell) / static_cast<float>(cell);
        const auto value = [&](int i, int j) {
            return core::uniform(seed, static_cast<std::uint64_t>(i % n), static_cast<std::uint64_t>(j % n)) - 0.5f;
        };
        const float sx = fx * fx * (3 - 2 * fx), sy = fy * fy * (3 - 2 * fy);
        const float a = value(cx, cy) + sx * (value(cx + 1, cy) - value(cx, cy));
        const float b = value(cx, cy + 1) + sx * (value(cx + 1, cy + 1) - value(cx, cy + 1));
        return a + sy * (b - a);
    }
    static core::Plane<float> halved(const core::Plane<float>& from) {
        core::Plane<float> to(from.width() / 2, from.height() / 2);
        for (int y = 0; y < to.height(); ++y)
            for (int x = 0; x < to.width(); ++x)
                to.at(x, y) = 0.25f * (from.at(2 * x, 2 * y) + from.at(2 * x + 1, 2 * y) + from.at(2 * x, 2 * y + 1) +
                                       from.at(2 * x + 1, 2 * y + 1));
        return to;
    }
    float bilinear(std::size_t level, glm::vec2 p) const {
        const core::Plane<float>& t = levels_[level];
        const glm::vec2 q = p / static_cast<float>(1 << level) - 0.5f, f = glm::floor(q);
        const int n = t.width(), x = static_cast<int>(f.x) & (n - 1), y = static_cast<int>(f.y) & (n - 1);
        const int x1 = (x + 1) & (n - 1), y1 = (y + 1) & (n - 1);
        const glm::vec2 s = q - f;
        return (1 - s.y) * ((1 - s.x) * t.at(x, y) + s.x * t.at(x1, y)) +
               s.y * ((1 - s.x) * t.at(x, y1) + s.x * t.at(x1, y1));
    }

    std::vector<core::Plane<float>> levels_;
};

/// Place and turn of camera and spheres at a time in pictures.
struct World {
    glm::vec3 eye;
    glm::mat3 axes;  ///< columns: right, down, forward
    struct Sphere {
        glm::vec3 centre;
        float radius;
        glm::mat3 turn;
    };
    std::array<Sphere, 6> spheres;
};

glm::mat3 turn_about_y(float a) {
    return {{std::cos(a), 0, -std::sin(a)}, {0, 1, 0}, {std::sin(a), 0, std::cos(a)}};
}
glm::mat3 turn_about_x(float a) {
    return {{1, 0, 0}, {0, std::cos(a), std::sin(a)}, {0, -std::sin(a), std::cos(a)}};
}

World world_at(float t) {
    World w;
    w.eye = {0.8f * std::sin(0.011f * t), -1.6f + 0.03f * std::sin(0.2f * t), -4.0f + 0.02f * t};
    w.axes = turn_about_y(0.25f * std::sin(0.017f * t)) * turn_about_x(-0.05f + 0.02f * std::sin(0.03f * t));
    for (std::size_t i = 0; i < w.spheres.size(); ++i) {
        const float k = static_cast<float>(i), phase = 1.1f * k + t * (0.012f + 0.006f * k);
        w.spheres[i] = {{2.4f * std::cos(phase), -1.2f - 0.5f * std::sin(1.7f * phase), 3.0f + 1.6f * std::sin(phase)},
                        0.35f + 0.06f * k,
                        turn_about_y(0.03f * t + k) * turn_about_x(0.02f * t * (k - 2))};
    }
    return w;
}

struct Hit {
    glm::vec3 point{0.0f}, normal{0.0f};
    int sphere = -1;
    float distance = std::numeric_limits<float>::infinity();
};

constexpr glm::vec3 room_low{-4, -3, -6}, room_high{4, 0, 9};  // y points down: the floor is at 0

Hit trace(const World& w, glm::vec3 origin, glm::vec3 d) {
    Hit hit;
    for (int axis = 0; axis < 3; ++axis) {
        const float wall = d[axis] > 0 ? room_high[axis] : room_low[axis];
        const float s = d[axis] != 0 ? (wall - origin[axis]) / d[axis] : -1;
        if (s <= 1e-4f || s >= hit.distance) continue;
        hit.distance = s;
        hit.normal = glm::vec3{0.0f};
        hit.normal[axis] = d[axis] > 0 ? -1.0f : 1.0f;
    }
    for (std::size_t i = 0; i < w.spheres.size(); ++i) {
        const glm::vec3 c = origin - w.spheres[i].centre;
        const float b = glm::dot(c, d), disc = b * b - glm::dot(c, c) + w.spheres[i].radius * w.spheres[i].radius;
        if (disc < 0) continue;
        const float s = -b - std::sqrt(disc);
        if (s <= 1e-3f || s >= hit.distance) continue;
        hit.distance = s;
        hit.sphere = static_cast<int>(i);
        hit.normal = (origin + d * s - w.spheres[i].centre) / w.spheres[i].radius;
    }
    hit.point = origin + d * hit.distance;
    return hit;
}

struct Look {
    float luma, cb, cr;
};

class Painter {
  public:
    Painter(int width, int height) : width_(width), height_(height) {}

    glm::vec3 ray(const World& w, float x, float y) const {
        const float f = 0.5f * static_cast<float>(width_);
        const glm::vec3 d = w.axes * glm::vec3{(x - 0.5f * static_cast<float>(width_)) / f,
                                               (y - 0.5f * static_cast<float>(height_)) / f, 1.0f};
        return d / std::sqrt(glm::dot(d, d));
    }
    /// Pixel position, and whether the point lies before the camera.
    bool project(const World& w, glm::vec3 p, glm::vec2& at) const {
        const glm::vec3 c = glm::transpose(w.axes) * (p - w.eye);
        if (c.z <= 0.01f) return false;
        const float f = 0.5f * static_cast<float>(width_);
        at = {0.5f * static_cast<float>(width_) + f * c.x / c.z, 0.5f * static_cast<float>(height_) + f * c.y / c.z};
        return true;
    }

    Look shade(const World& w, const Hit& hit) const {
        // Light by one lamp with shadows of the spheres, and a constant.
        const glm::vec3 lamp{1.5f, -2.7f, 2.0f};
        const glm::vec3 to = lamp - hit.point;
        const float distance = std::sqrt(glm::dot(to, to)),
                    cosine = std::max(0.0f, glm::dot(hit.normal, to) / distance);
        const Hit block = trace(w, hit.point + hit.normal * 2e-3f, to / distance);
        const float lit = block.sphere >= 0 && block.distance < distance ? 0.0f : 1.0f;
        const float light = 0.35f + 2.2f * lit * cosine / (1.0f + 0.25f * distance * distance);

        const float texel = 160.0f, footprint = texel * hit.distance / (0.5f * static_cast<float>(width_));
        glm::vec2 p;
        if (hit.sphere >= 0) {
            const glm::vec3 local = glm::transpose(w.spheres[static_cast<std::size_t>(hit.sphere)].turn) * hit.normal;
            p = {300.0f * std::atan2(local.z, local.x) / pi, 150.0f * local.y};
        } else {
            p = std::abs(hit.normal.y) > 0.5f   ? glm::vec2{hit.point.x, hit.point.z}
                : std::abs(hit.normal.x) > 0.5f ? glm::vec2{hit.point.z, hit.point.y}
                                                : glm::vec2{hit.point.x, hit.point.y};
            p *= texel;
        }
        const int kind = hit.sphere >= 0 ? hit.sphere : hit.normal.y < -0.5f ? 7 : 6;
        const float albedo = std::clamp(
            0.5f + 0.4f * texture_.at(p + glm::vec2(37.0f * static_cast<float>(kind)), footprint), 0.05f, 0.95f);
        const float luma = 16 + 219 * std::pow(std::clamp(albedo * light, 0.0f, 1.0f), 1 / 2.2f);
        const float saturation = luma / 235.0f;
        return {luma, 128 + 35 * saturation * std::sin(1.3f * static_cast<float>(kind)),
                128 + 35 * saturation * std::cos(2.1f * static_cast<float>(kind))};
    }

    int width() const { return width_; }
    int height() const { return height_; }

  private:
    int width_, height_;
    Texture texture_{1};
};

void paint_row(const Painter& painter, const World& now, int y, core::Plane<glm::vec3>& colours) {
    for (int x = 0; x < painter.width(); ++x) {
        glm::vec3 sum{0.0f};
        for (int s = 0; s < 4; ++s) {
            const Hit hit = trace(now, now.eye,
                                  painter.ray(now, static_cast<float>(x) + 0.25f + 0.5f * static_cast<float>(s % 2),
                                              static_cast<float>(y) + 0.25f + 0.5f * static_cast<float>(s / 2)));
            const Look look = painter.shade(now, hit);
            sum += glm::vec3{look.luma, look.cb, look.cr};
        }
        colours.at(x, y) = sum * 0.25f;
    }
}

void move_row(const Painter& painter, const World& now, const World& then, int y, core::MotionField& motion) {
    for (int x = 0; x < motion.vector.width(); ++x) {
        const glm::vec2 centre{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
        const Hit hit = trace(now, now.eye, painter.ray(now, centre.x, centre.y));
        glm::vec3 point = hit.point;
        if (hit.sphere >= 0) {
            const auto i = static_cast<std::size_t>(hit.sphere);
            point = then.spheres[i].centre +
                    then.spheres[i].turn * (glm::transpose(now.spheres[i].turn) * (hit.point - now.spheres[i].centre));
        }
        glm::vec2 at{0.0f};
        const bool seen = painter.project(then, point, at);
        motion.vector.at(x, y) = at - centre;
        motion.kind.at(x, y) = seen ? core::PixelClass::surface : core::PixelClass::none;
    }
}

std::uint8_t code(float v) {
    return static_cast<std::uint8_t>(std::clamp(std::lround(v), 16l, 240l));
}

core::Picture to_picture(const core::Plane<glm::vec3>& colours, int number) {
    core::Picture picture;
    picture.number = number;
    const int w = colours.width(), h = colours.height();
    picture.y = core::Plane<std::uint8_t>(w, h);
    picture.cb = picture.cr = core::Plane<std::uint8_t>((w + 1) / 2, (h + 1) / 2);
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) picture.y.at(x, y) = code(colours.at(x, y).x);
    for (int y = 0; y < picture.cb.height(); ++y)
        for (int x = 0; x < picture.cb.width(); ++x) {
            const int x1 = std::min(2 * x + 1, w - 1), y1 = std::min(2 * y + 1, h - 1);
            const glm::vec3 mean =
                0.25f * (colours.at(2 * x, 2 * y) + colours.at(x1, 2 * y) + colours.at(2 * x, y1) + colours.at(x1, y1));
            picture.cb.at(x, y) = code(mean.y);
            picture.cr.at(x, y) = code(mean.z);
        }
    return picture;
}

}  // namespace

Clip::Clip(int width, int height, int count, float speed) : width_(width), height_(height), speed_(speed) {
    const Painter painter(width, height);
    for (int n = 0; n < count; ++n) {
        const World now = world_at(speed * static_cast<float>(n));
        core::Plane<glm::vec3> colours(width, height);
        parallel::for_each(static_cast<std::size_t>(height),
                           [&](std::size_t y) { paint_row(painter, now, static_cast<int>(y), colours); });
        pictures.push_back(to_picture(colours, n));
    }
}

const core::MotionField& Clip::motion(std::int64_t picture, std::int64_t reference) const {
    const auto [at, is_new] = fields_.try_emplace({picture, reference});
    core::MotionField& field = at->second;
    if (!is_new) return field;
    field.picture = picture;
    field.reference = reference;
    field.vector = core::Plane<glm::vec2>(width_, height_);
    field.kind = core::Plane<core::PixelClass>(width_, height_);
    const World now = world_at(speed_ * static_cast<float>(picture)),
                then = world_at(speed_ * static_cast<float>(reference));
    const Painter eye(width_, height_);
    parallel::for_each(static_cast<std::size_t>(height_),
                       [&](std::size_t y) { move_row(eye, now, then, static_cast<int>(y), field); });
    return field;
}

}  // namespace render2mpeg::bench
