#include "scene/pose/motion.h"

#include <limits>
#include <optional>

#include "core/error.h"

namespace render2mpeg::scene {
namespace {

/// A pixel's point in both pictures; none where the reference cannot show it.
struct Move {
    glm::vec2 vector;
    float depth;
};

/// Projecting both ends cancels the address's rounding: no motion is exactly 0.
std::optional<Move> move_of_surface(const core::SurfaceAddress& address, const Snapshot& here,
                                    const Snapshot& reference) {
    const std::optional<glm::dvec3> from = carry_exact(address, here), to = carry_exact(address, reference);
    if (!from || !to) return std::nullopt;
    const std::optional<ScreenPoint> start = here.camera.project_exact(*from),
                                     end = reference.camera.project_exact(*to);
    if (!start || !end) return std::nullopt;
    return Move{reference.camera.nearest_turn(end->position, start->position) - start->position, end->depth};
}

/// Where a flat mirror shows a point: behind its plane as far as the point is before it; an edited one on it. Both as
/// they are at that time.
std::optional<glm::dvec3> image_of(const core::SurfaceAddress& point, const core::SurfaceAddress& mirror,
                                   const Snapshot& world) {
    const auto corner = [&](float u, float v) { return carry_exact({mirror.object, mirror.primitive, u, v}, world); };
    const std::optional<glm::dvec3> at = carry_exact(point, world), a = corner(0, 0), b = corner(1, 0),
                                    c = corner(0, 1);
    if (!at || !a || !b || !c) return std::nullopt;
    if (world.bends && world.bends->edits(mirror.object)) return shown_at(*at, mirror, world);
    const glm::dvec3 across = glm::cross(*b - *a, *c - *a);
    const double area2 = glm::dot(across, across);
    if (!(area2 > 0)) return std::nullopt;
    return *at - (2 * glm::dot(*at - *a, across) / area2) * across;
}

/// Motion vector of the image in a flat mirror; the depth stays that of the mirror itself.
std::optional<glm::vec2> move_of_image(const core::SurfaceAddress& point, const core::SurfaceAddress& mirror,
                                       const Snapshot& here, const Snapshot& reference) {
    const std::optional<glm::dvec3> from = image_of(point, mirror, here), to = image_of(point, mirror, reference);
    if (!from || !to) return std::nullopt;
    const std::optional<ScreenPoint> start = here.camera.project_exact(*from),
                                     end = reference.camera.project_exact(*to);
    if (!start || !end) return std::nullopt;
    return reference.camera.nearest_turn(end->position, start->position) - start->position;
}

std::optional<Move> move_of_sky(glm::vec2 pixel, const Camera& here, const Camera& reference) {
    const glm::vec3 direction = here.ray_through(pixel).direction;
    // Orthographic cameras see one point of the sky everywhere: it stays or it is gone.
    if (!here.has_eye() || !reference.has_eye()) {
        const bool same = here.has_eye() == reference.has_eye() && here.forward() == reference.forward();
        return same ? std::optional(Move{glm::vec2(0), std::numeric_limits<float>::infinity()}) : std::nullopt;
    }
    const std::optional<ScreenPoint> start = here.project_direction(direction),
                                     end = reference.project_direction(direction);
    if (!start || !end) return std::nullopt;
    return Move{reference.nearest_turn(end->position, start->position) - start->position, end->depth};
}

}  // namespace

core::MotionField motion_field_for(const core::Visible& visible, const Snapshot& here, const Snapshot& reference) {
    core::MotionField field;
    field.picture = here.frame;
    field.reference = reference.frame;
    field.wraps = reference.camera.wraps();
    field.vector = core::Plane<glm::vec2>(visible.width(), visible.height(), glm::vec2(0));
    field.depth_in_reference = core::Plane<float>(visible.width(), visible.height(), 0.0f);
    field.kind = core::Plane<core::PixelClass>(visible.width(), visible.height(), core::PixelClass::none);
    return field;
}

void motion_of_rows(const core::Visible& visible, const Snapshot& here, const Snapshot& reference, int first_row,
                    int last_row, core::MotionField& field, const MirrorImages* imaged) {
    EXPECTS(field.kind.width() == visible.width() && field.kind.height() == visible.height());
    EXPECTS(0 <= first_row && last_row <= visible.height());
    for (int y = first_row; y < last_row; ++y) {
        for (int x = 0; x < visible.width(); ++x) {
            const core::PixelClass kind = visible.kind.at(x, y);
            std::optional<Move> move;
            if (kind == core::PixelClass::surface || kind == core::PixelClass::reflected)
                move = move_of_surface(visible.address.at(x, y), here, reference);
            else if (kind == core::PixelClass::sky)
                move = move_of_sky({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}, here.camera,
                                   reference.camera);
            if (!move) continue;
            if (kind == core::PixelClass::reflected && imaged != nullptr && !imaged->empty() &&
                imaged->at(x, y).is_surface())
                if (const auto image = move_of_image(imaged->at(x, y), visible.address.at(x, y), here, reference))
                    move->vector = *image;
            field.vector.at(x, y) = move->vector;
            field.depth_in_reference.at(x, y) = move->depth;
            field.kind.at(x, y) = kind;
        }
    }
}

core::MotionField motion_between(const core::Visible& visible, const Snapshot& here, const Snapshot& reference,
                                 const MirrorImages* imaged) {
    core::MotionField field = motion_field_for(visible, here, reference);
    motion_of_rows(visible, here, reference, 0, visible.height(), field, imaged);
    return field;
}

}  // namespace render2mpeg::scene
