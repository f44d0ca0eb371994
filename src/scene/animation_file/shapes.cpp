#include "scene/animation_file/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <initializer_list>
#include <utility>

#include "core/error.h"
#include "core/numeric.h"

namespace render2mpeg::scene {
namespace {

constexpr double tau = glm::two_pi<double>();

struct Corner {
    glm::dvec3 position, normal;
    glm::dvec2 uv;
};

unsigned add(Mesh& mesh, const Corner& c) {
    mesh.positions.emplace_back(c.position);
    mesh.normals.emplace_back(glm::normalize(c.normal));
    mesh.uv[0].emplace_back(c.uv);
    return static_cast<unsigned>(mesh.positions.size() - 1);
}

void add_triangle(Mesh& mesh, unsigned a, unsigned b, unsigned c) {
    if (mesh.positions[a] == mesh.positions[b] || mesh.positions[b] == mesh.positions[c] ||
        mesh.positions[c] == mesh.positions[a])
        return;
    mesh.triangles.emplace_back(a, b, c);
}

/// Rectangle with full edges `right` and `up` as seen from the front.
void add_face(Mesh& mesh, glm::dvec3 middle, glm::dvec3 right, glm::dvec3 up, TextureLayout layout) {
    const glm::dvec3 normal = glm::cross(right, up);
    const glm::dvec2 span =
        layout == TextureLayout::fit ? glm::dvec2(1) : glm::dvec2(glm::length(right), glm::length(up));
    unsigned index[4];
    for (int k = 0; k < 4; ++k) {
        const double s = k == 1 || k == 2 ? 1 : 0, t = k >= 2 ? 1 : 0;
        index[k] = add(mesh, {middle + (s - 0.5) * right + (t - 0.5) * up, normal, {s * span.x, (1 - t) * span.y}});
    }
    add_triangle(mesh, index[0], index[1], index[2]);
    add_triangle(mesh, index[0], index[2], index[3]);
}

/// Right-hand normal of an outline's piece (dr, dh).
glm::dvec2 outward(glm::dvec2 piece) {
    return {piece.y, -piece.x};
}

struct OutlinePoint {
    glm::dvec2 at, normal;
    double along;  ///< length of the outline up to here
};

/// Doubles points at sharp corners; pairs (2i, 2i + 1) are pieces.
std::vector<OutlinePoint> pieces_of(const std::vector<glm::dvec2>& outline, double crease_degrees) {
    std::vector<glm::dvec2> piece;
    for (std::size_t i = 0; i + 1 < outline.size(); ++i)
        piece.push_back(glm::normalize(outward(outline[i + 1] - outline[i])));
    const double limit = std::cos(glm::radians(crease_degrees));
    std::vector<OutlinePoint> points;
    double along = 0;
    for (std::size_t i = 0; i < piece.size(); ++i) {
        const auto mixed = [&](std::size_t j) {
            return glm::dot(piece[i], piece[j]) > limit ? glm::normalize(piece[i] + piece[j]) : piece[i];
        };
        points.push_back({outline[i], i > 0 ? mixed(i - 1) : piece[i], along});
        along += glm::length(outline[i + 1] - outline[i]);
        points.push_back({outline[i + 1], i + 1 < piece.size() ? mixed(i + 1) : piece[i], along});
    }
    return points;
}

}  // namespace

Mesh box_mesh(glm::dvec3 s, TextureLayout layout) {
    Mesh mesh;
    const glm::dvec3 x(s.x, 0, 0), y(0, s.y, 0), z(0, 0, s.z), middle = 0.5 * y;
    add_face(mesh, middle + 0.5 * z, x, y, layout);
    add_face(mesh, middle - 0.5 * z, -x, y, layout);
    add_face(mesh, middle + 0.5 * x, -z, y, layout);
    add_face(mesh, middle - 0.5 * x, z, y, layout);
    add_face(mesh, y, x, -z, layout);
    add_face(mesh, glm::dvec3(0), x, z, layout);
    return mesh;
}

Mesh plane_mesh(glm::dvec2 s, TextureLayout layout) {
    Mesh mesh;
    add_face(mesh, glm::dvec3(0), {s.x, 0, 0}, {0, 0, -s.y}, layout);
    return mesh;
}

Mesh quad_mesh(glm::dvec2 s, TextureLayout layout) {
    Mesh mesh;
    add_face(mesh, glm::dvec3(0), {s.x, 0, 0}, {0, s.y, 0}, layout);
    return mesh;
}

Mesh lathe_mesh(const std::vector<glm::dvec2>& outline, int segments, double crease, TextureLayout layout) {
    EXPECTS(outline.size() >= 2 && segments >= 3);
    Mesh mesh;
    const std::vector<OutlinePoint> points = pieces_of(outline, crease);
    const double length = points.back().along;
    double widest = 0;
    for (const glm::dvec2 p : outline) widest = std::max(widest, p.x);
    const glm::dvec2 span = layout == TextureLayout::fit ? glm::dvec2(1, 1) : glm::dvec2(tau * widest, length);

    // One ring of corners per point of a piece, closed by a copy of its first corner, where the texture begins anew.
    const auto ring = static_cast<unsigned>(segments + 1);
    for (const OutlinePoint& p : points)
        for (int k = 0; k <= segments; ++k) {
            const double turn = tau * k / segments, c = k == segments ? 1 : std::cos(turn),
                         s = k == segments ? 0 : std::sin(turn);
            const glm::dvec2 uv(span.x * k / segments, span.y * (1 - core::divide_or(p.along, length, 0.0)));
            add(mesh, {{p.at.x * s, p.at.y, p.at.x * c}, {p.normal.x * s, p.normal.y, p.normal.x * c}, uv});
        }
    for (unsigned piece = 0; piece + 1 < points.size(); piece += 2)
        for (unsigned k = 0; k + 1 < ring; ++k) {
            const unsigned below = piece * ring + k, above = below + ring;
            add_triangle(mesh, below, below + 1, above + 1);
            add_triangle(mesh, below, above + 1, above);
        }
    return mesh;
}

Mesh sphere_mesh(double radius, int segments, TextureLayout layout) {
    std::vector<glm::dvec2> outline;
    const int rings = std::max(2, segments / 2);
    for (int i = 0; i <= rings; ++i) {
        const double polar = glm::pi<double>() * i / rings;
        outline.emplace_back(i == 0 || i == rings ? 0.0 : radius * std::sin(polar), -radius * std::cos(polar));
    }
    Mesh mesh = lathe_mesh(outline, segments, 181, layout);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        mesh.normals[i] = core::normalize_or(mesh.positions[i], glm::vec3(0, 1, 0));
    return mesh;
}

Mesh lamp_mesh(double radius) {
    // An icosahedron, its triangles cut into four again and again: they stay alike, and together in the list.
    constexpr int cuts = 3;
    using Face = std::array<glm::dvec3, 3>;
    const double g = glm::golden_ratio<double>();
    const std::array<glm::dvec3, 12> corners{{{-1, g, 0},
                                              {1, g, 0},
                                              {-1, -g, 0},
                                              {1, -g, 0},
                                              {0, -1, g},
                                              {0, 1, g},
                                              {0, -1, -g},
                                              {0, 1, -g},
                                              {g, 0, -1},
                                              {g, 0, 1},
                                              {-g, 0, -1},
                                              {-g, 0, 1}}};
    std::vector<Face> faces;
    for (const auto& [a, b, c] : std::initializer_list<std::array<std::size_t, 3>>{
             {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
             {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
             {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}})
        faces.push_back({glm::normalize(corners[a]), glm::normalize(corners[b]), glm::normalize(corners[c])});
    for (int cut = 0; cut < cuts; ++cut) {
        std::vector<Face> finer;
        for (const auto& [a, b, c] : faces) {
            const glm::dvec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
            for (const Face& face : {Face{a, ab, ca}, Face{ab, b, bc}, Face{ca, bc, c}, Face{ab, bc, ca}})
                finer.push_back(face);
        }
        faces = std::move(finer);
    }
    double area = 0;
    for (const auto& [a, b, c] : faces) area += 0.5 * glm::length(glm::cross(b - a, c - a));
    const double scale = radius * std::sqrt(2 * tau / area);
    Mesh mesh;
    for (const Face& face : faces) {
        const auto first = static_cast<unsigned>(mesh.positions.size());
        for (const glm::dvec3& p : face) add(mesh, {scale * p, p, {0, 0}});
        add_triangle(mesh, first, first + 1, first + 2);
    }
    return mesh;
}

Mesh cylinder_mesh(double radius, double top_radius, double height, int segments, TextureLayout layout) {
    std::vector<glm::dvec2> outline{{0, 0}, {radius, 0}, {top_radius, height}};
    if (top_radius > 0) outline.emplace_back(0, height);
    return lathe_mesh(outline, segments, 1, layout);
}

Mesh disc_mesh(double radius, int segments, TextureLayout layout) {
    Mesh mesh;
    const glm::dvec2 span(layout == TextureLayout::fit ? 1.0 : 2 * radius);
    const unsigned middle = add(mesh, {{0, 0, 0}, {0, 1, 0}, 0.5 * span});
    for (int k = 0; k <= segments; ++k) {
        const double turn = tau * (k % segments) / segments, s = std::sin(turn), c = std::cos(turn);
        add(mesh, {{radius * s, 0, radius * c}, {0, 1, 0}, {span.x * (0.5 + 0.5 * s), span.y * (0.5 + 0.5 * c)}});
        const auto last = static_cast<unsigned>(mesh.positions.size() - 1);
        if (k > 0) add_triangle(mesh, middle, last - 1, last);
    }
    return mesh;
}

Mesh torus_mesh(double radius, double tube_radius, int segments, TextureLayout layout) {
    std::vector<glm::dvec2> outline;
    const int around = std::max(6, segments / 2);
    for (int i = 0; i <= around; ++i) {
        const double turn = tau * (i % around) / around;
        outline.emplace_back(radius - tube_radius * std::cos(turn), -tube_radius * std::sin(turn));
    }
    Mesh mesh = lathe_mesh(outline, segments, 181, layout);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const glm::vec3 p = mesh.positions[i];
        const glm::vec3 spine = static_cast<float>(radius) * core::normalize_or({p.x, 0, p.z}, glm::vec3(1, 0, 0));
        mesh.normals[i] = core::normalize_or(p - spine, glm::vec3(0, 1, 0));
    }
    return mesh;
}

namespace {

/// Rim of a round-headed opening from lower right to lower left, and radially opposite points of the rectangle.
struct ArchOutline {
    std::vector<glm::dvec2> rim, edge;
    double spring;  ///< where the head begins
};

ArchOutline arch_outline(double half_width, double height, glm::dvec2 opening, int segments) {
    const double r = opening.x / 2, spring = opening.y - r, rise = height - spring;
    ArchOutline outline{{{r, 0}}, {{half_width, 0}}, spring};
    const auto add_ray = [&](double turn) {
        const double c = std::cos(turn), s = std::sin(turn);
        const double reach = std::min(core::divide_or(half_width, std::abs(c), 1e30), s > 1e-12 ? rise / s : 1e30);
        outline.rim.emplace_back(r * c, spring + r * s);
        outline.edge.emplace_back(reach * c, spring + reach * s);
    };
    // The rectangle's corners get rays of their own.
    std::vector<double> turns{std::atan2(rise, half_width), std::atan2(rise, -half_width)};
    for (int k = 0; k <= segments; ++k) turns.push_back(glm::pi<double>() * k / segments);
    std::sort(turns.begin(), turns.end());
    double last = -1;
    for (const double turn : turns)
        if (turn > last + 1e-6) add_ray(last = turn);
    outline.rim.emplace_back(-r, 0);
    outline.edge.emplace_back(-half_width, 0);
    return outline;
}

/// The wall about the opening as seen from +z (`side` 1) or -z (`side` -1).
void add_arch_wall(Mesh& mesh, const ArchOutline& outline, glm::dvec3 size, double side, glm::dvec2 span) {
    for (std::size_t i = 0; i + 1 < outline.rim.size(); ++i) {
        unsigned index[4];
        const glm::dvec2 corners[4] = {outline.rim[i], outline.edge[i], outline.edge[i + 1], outline.rim[i + 1]};
        for (int k = 0; k < 4; ++k) {
            const glm::dvec2 p = corners[side > 0 ? k : 3 - k];
            index[k] = add(mesh, {{p.x, p.y, 0.5 * side * size.z},
                                  {0, 0, side},
                                  {(side * p.x + size.x / 2) * span.x, (size.y - p.y) * span.y}});
        }
        add_triangle(mesh, index[0], index[1], index[2]);
        add_triangle(mesh, index[0], index[2], index[3]);
    }
}

void add_soffit(Mesh& mesh, const ArchOutline& outline, double depth, double spread) {
    double along = 0;
    for (std::size_t i = 0; i + 1 < outline.rim.size(); ++i) {
        const double step = glm::length(outline.rim[i + 1] - outline.rim[i]);
        unsigned index[4];
        for (int k = 0; k < 4; ++k) {
            const glm::dvec2 p = outline.rim[k < 2 ? i : i + 1];
            const double front = k == 0 || k == 3 ? 0.5 : -0.5;
            const glm::dvec3 inward(-p.x, std::min(0.0, outline.spring - p.y), 0);
            index[k] = add(mesh, {{p.x, p.y, front * depth},
                                  inward,
                                  {(0.5 - front) * depth * spread, (k < 2 ? along : along + step) * spread}});
        }
        add_triangle(mesh, index[0], index[3], index[2]);
        add_triangle(mesh, index[0], index[2], index[1]);
        along += step;
    }
}

}  // namespace

Mesh arch_mesh(glm::dvec3 size, glm::dvec2 opening, int segments, TextureLayout layout) {
    EXPECTS(opening.x < size.x && opening.y < size.y && 2 * opening.y >= opening.x);
    Mesh mesh;
    const bool fit = layout == TextureLayout::fit;
    const ArchOutline outline = arch_outline(size.x / 2, size.y, opening, segments);
    for (const double side : {1.0, -1.0})
        add_arch_wall(mesh, outline, size, side, fit ? glm::dvec2(1 / size.x, 1 / size.y) : glm::dvec2(1));
    add_soffit(mesh, outline, size.z, fit ? 1 / size.z : 1);
    const glm::dvec3 y(0, size.y, 0), z(0, 0, size.z);
    add_face(mesh, {size.x / 2, size.y / 2, 0}, -z, y, layout);
    add_face(mesh, {-size.x / 2, size.y / 2, 0}, z, y, layout);
    add_face(mesh, {0, size.y, 0}, {size.x, 0, 0}, -z, layout);
    return mesh;
}

}  // namespace render2mpeg::scene
