#include "app/job/eyes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

using core::FramePacking;

/// Which part of the picture an eye has.
glm::ivec2 corner_of(int width, int height, FramePacking packing, std::size_t eye) {
    if (eye == 0) return {0, 0};
    return packing == FramePacking::side_by_side ? glm::ivec2(width, 0) : glm::ivec2(0, height);
}

/// Values of one eye alone are left as they are.
template <class T>
core::Plane<T> packed_planes(std::span<core::Plane<T>* const> eyes, FramePacking packing) {
    core::Plane<T>& first = *eyes.front();
    if (eyes.size() == 1 || first.empty()) return std::move(first);
    const int width = first.width(), height = first.height();
    const glm::ivec2 last = corner_of(width, height, packing, 1);
    core::Plane<T> all(last.x + width, last.y + height);
    for (std::size_t e = 0; e < eyes.size(); ++e) {
        EXPECTS(eyes[e]->width() == width && eyes[e]->height() == height);
        const glm::ivec2 at = corner_of(width, height, packing, e);
        for (int y = 0; y < height; ++y) std::copy(eyes[e]->row(y), eyes[e]->row(y) + width, all.row(at.y + y) + at.x);
    }
    return all;
}

template <class T, class Picture>
core::Plane<T> packed_member(std::vector<Picture>& eyes, core::Plane<T> Picture::*member, FramePacking packing) {
    std::vector<core::Plane<T>*> planes;
    for (Picture& eye : eyes) planes.push_back(&(eye.*member));
    return packed_planes<T>(planes, packing);
}

/// Packs these planes of pictures; the rest is as the first has it.
template <class Picture, class... Members>
Picture packed_picture(std::vector<Picture>& eyes, FramePacking packing, Members... members) {
    Picture all;
    ((all.*members = packed_member(eyes, members, packing)), ...);
    return all;
}

template <class T>
core::Plane<T> part_of_plane(const core::Plane<T>& whole, FramePacking packing, std::size_t eye) {
    if (packing == FramePacking::none || whole.empty()) return whole;
    const scene::PictureFormat format = of_eye({whole.width(), whole.height()}, packing);
    const glm::ivec2 at = corner_of(format.width, format.height, packing, eye);
    core::Plane<T> part(format.width, format.height);
    for (int y = 0; y < format.height; ++y) {
        const T* from = whole.row(at.y + y) + at.x;
        std::copy(from, from + format.width, part.row(y));
    }
    return part;
}

/// Forgets points that leave the picture where another eye's part goes on.
void end_at_sides(core::MotionField& field, FramePacking packing) {
    const bool across = packing == FramePacking::side_by_side;
    const int width = field.vector.width(), height = field.vector.height();
    const auto side = static_cast<float>(across ? width : height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const glm::vec2 to = glm::vec2(x, y) + 0.5f + field.vector.at(x, y);
            const float along = across ? to.x : to.y;
            if (!(along >= 0 && along < side)) field.kind.at(x, y) = core::PixelClass::none;
        }
}

/// Places of a depth that differ by more than this share of it are different ones. chosen: 0.05, as a floor that is
/// seen at a grazing angle changes between two pixels; only a rough look depends on it.
constexpr float same_depth = 0.05f;

/// The left eye's pixel that shows what a pixel of the right one shows; -1: none.
int pixel_in_left(const core::Visible& left, const core::Visible& right, const core::MotionField& to_left, int x,
                  int y) {
    const core::PixelClass kind = to_left.kind.at(x, y);
    const glm::vec2 to = glm::vec2(x, y) + to_left.vector.at(x, y);
    if (kind == core::PixelClass::none || !(std::abs(to.x) < 1e6f && std::abs(to.y) < 1e6f)) return -1;
    const long column = std::lround(to_left.column(to.x)), row = std::lround(to.y);
    if (column < 0 || row < 0 || column >= left.width() || row >= left.height()) return -1;
    const auto i = static_cast<std::size_t>(row * left.width() + column);
    if (left.kind.values()[i] != right.kind.at(x, y)) return -1;
    if (kind != core::PixelClass::sky) {
        const float depth = left.depth.values()[i], wanted = to_left.depth_in_reference.at(x, y);
        if (left.address.values()[i].object != right.address.at(x, y).object ||
            !(std::abs(depth - wanted) <= same_depth * wanted))
            return -1;
    }
    return static_cast<int>(i);
}

/// That of each pixel of a row, or of the nearest one that has any; a row without any has its own.
std::vector<int> row_in_left(const core::Visible& left, const core::Visible& right, const core::MotionField& to_left,
                             int y) {
    const int width = right.width();
    std::vector<int> from, before, after(static_cast<std::size_t>(width));
    for (int x = 0; x < width; ++x) from.push_back(pixel_in_left(left, right, to_left, x, y));
    // The nearest columns that have any, on both sides.
    const auto has = [&](int x) { return from[static_cast<std::size_t>(x)] >= 0; };
    for (int x = 0, last = -width; x < width; ++x) before.push_back(last = has(x) ? x : last);
    for (int x = width - 1, last = 2 * width; x >= 0; --x)
        after[static_cast<std::size_t>(x)] = last = has(x) ? x : last;
    std::vector<int> nearest;
    for (int x = 0; x < width; ++x) {
        const int a = before[static_cast<std::size_t>(x)], b = after[static_cast<std::size_t>(x)];
        const int column = x - a <= b - x ? a : b;
        const bool any = column >= 0 && column < width;
        nearest.push_back(any ? from[static_cast<std::size_t>(column)] : y * width + x);
    }
    return nearest;
}

}  // namespace

std::span<const scene::Eye> eyes_of(FramePacking packing) {
    static constexpr std::array single{scene::Eye::single};
    static constexpr std::array both{scene::Eye::left, scene::Eye::right};
    if (packing == FramePacking::none) return single;
    return both;
}

std::string eyes_text(FramePacking packing) {
    if (packing == FramePacking::none) return {};
    return " for two eyes (" + std::string(core::name_of(packing)) + ")";
}

scene::PictureFormat packed(scene::PictureFormat of_eye, FramePacking packing) {
    if (packing == FramePacking::side_by_side) of_eye.width *= 2;
    if (packing == FramePacking::top_bottom) of_eye.height *= 2;
    return of_eye;
}

scene::PictureFormat of_eye(scene::PictureFormat whole, FramePacking packing) {
    if (packing == FramePacking::side_by_side) whole.width = std::max(whole.width / 2, 1);
    if (packing == FramePacking::top_bottom) whole.height = std::max(whole.height / 2, 1);
    return whole;
}

core::Visible packed(std::vector<core::Visible> eyes, FramePacking packing) {
    using V = core::Visible;
    if (eyes.size() == 1) return std::move(eyes.front());
    V all = packed_picture(eyes, packing, &V::address, &V::depth, &V::geometric_normal, &V::shading_normal,
                           &V::material, &V::kind);
    all.frame = eyes.front().frame;
    return all;
}

core::Radiance packed(std::vector<core::Radiance> eyes, FramePacking packing) {
    using R = core::Radiance;
    if (eyes.size() == 1) return std::move(eyes.front());
    // An eye in which nothing is exposed has no coverage.
    const bool covers = std::ranges::any_of(eyes, [](const R& eye) { return !eye.coverage.empty(); });
    for (R& eye : eyes)
        if (covers && eye.coverage.empty())
            eye.coverage = core::Plane<float>(eye.combined.width(), eye.combined.height(), 1.0f);
    R all = packed_picture(eyes, packing, &R::combined, &R::emission, &R::direct_irradiance, &R::indirect_irradiance,
                           &R::albedo, &R::glossy, &R::specular, &R::direct_cut, &R::indirect_cut, &R::error,
                           &R::shared_error, &R::half, &R::record_density, &R::record_age, &R::record_reuse,
                           &R::coverage, &R::capped);
    all.frame = eyes.front().frame;
    return all;
}

core::Mattes packed(std::vector<core::Mattes> eyes, FramePacking packing) {
    if (eyes.size() == 1 || eyes.front().empty()) return std::move(eyes.front());
    const int width = eyes.front().width, height = eyes.front().height;
    const scene::PictureFormat format = packed({width, height}, packing);
    core::Mattes all{format.width, format.height, {0}, {}};
    for (int y = 0; y < format.height; ++y)
        for (int x = 0; x < format.width; ++x) {
            const std::size_t eye = x >= width || y >= height ? 1 : 0;
            const glm::ivec2 at = glm::ivec2(x, y) - corner_of(width, height, packing, eye);
            const auto parts = eyes[eye].of_pixel(static_cast<std::size_t>(at.y * width + at.x));
            all.parts.insert(all.parts.end(), parts.begin(), parts.end());
            all.starts.push_back(all.parts.size());
        }
    return all;
}

core::ToleranceMap packed(std::vector<core::ToleranceMap> eyes, FramePacking packing) {
    core::ToleranceMap all = packed_picture(eyes, packing, &core::ToleranceMap::pixels);
    all.typical = eyes.front().typical;
    all.means = eyes.front().means;
    all.most_rays = eyes.front().most_rays;
    return all;
}

core::MotionField packed(std::vector<core::MotionField> eyes, FramePacking packing) {
    using M = core::MotionField;
    if (eyes.size() == 1) return std::move(eyes.front());
    for (M& eye : eyes) end_at_sides(eye, packing);
    M all = packed_picture(eyes, packing, &M::vector, &M::depth_in_reference, &M::kind);
    all.picture = eyes.front().picture;
    all.reference = eyes.front().reference;
    // Where columns go on within an eye's part, the picture's edges do not.
    all.wraps = eyes.front().wraps && packing == FramePacking::top_bottom;
    return all;
}

core::ToleranceMap part_of(const core::ToleranceMap& whole, FramePacking packing, std::size_t eye) {
    return {part_of_plane(whole.pixels, packing, eye), whole.typical, whole.means, whole.most_rays};
}

core::MotionField part_of(const core::MotionField& whole, FramePacking packing, std::size_t eye) {
    core::MotionField part{whole.picture, whole.reference, part_of_plane(whole.vector, packing, eye),
                           part_of_plane(whole.depth_in_reference, packing, eye),
                           part_of_plane(whole.kind, packing, eye)};
    part.wraps = whole.wraps;
    return part;
}

core::Radiance carried_to_right(const core::Radiance& left, const core::Visible& seen_left,
                                const core::Visible& seen_right, const core::MotionField& to_left) {
    EXPECTS(left.combined.width() == seen_right.width() && left.combined.height() == seen_right.height());
    core::Radiance right = left;
    const auto width = static_cast<std::size_t>(seen_right.width());
    parallel::for_each(static_cast<std::size_t>(seen_right.height()), [&](std::size_t y) {
        const std::vector<int> from = row_in_left(seen_left, seen_right, to_left, static_cast<int>(y));
        const auto carry = [&](auto& to, const auto& all) {
            for (std::size_t x = 0; !all.empty() && x < width; ++x)
                to.values()[y * width + x] = all.values()[static_cast<std::size_t>(from[x])];
        };
        carry(right.combined, left.combined);
        carry(right.error, left.error);
        carry(right.shared_error, left.shared_error);
    });
    return right;
}

}  // namespace render2mpeg::app
