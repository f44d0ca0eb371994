#include "scene/animation_file/objects.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text.h"
#include "scene/animation_file/keys.h"
#include "scene/animation_file/reflections.h"
#include "scene/animation_file/shapes.h"
#include "scene/model/curves.h"

namespace render2mpeg::scene {
namespace {

namespace keys = animation_file_keys;

constexpr std::array<std::string_view, 12> shapes{"box",  "plane", "quad",  "sphere", "cylinder", "cone",
                                                  "disc", "torus", "lathe", "arch",   "strands",  "group"};
enum Shape { box, plane, quad, sphere, cylinder, cone, disc, torus, lathe, arch, strands, group };

constexpr std::size_t most_objects = 500000;
constexpr double largest = largest_size;

/// Keys of each shape; others would be ignored in silence.
constexpr std::array<std::string_view, 12> own_keys{"size",
                                                    "size",
                                                    "size",
                                                    "radius, segments",
                                                    "radius, top_radius, height, segments",
                                                    "radius, height, segments",
                                                    "radius, segments",
                                                    "radius, tube_radius, segments",
                                                    "profile, crease, segments",
                                                    "size, opening, segments",
                                                    "strands, radius, tip_radius",
                                                    "parts"};

void refuse_foreign_keys(const JsonValue& value, Shape shape) {
    const std::string own = ", " + std::string(own_keys[shape]) + ",";
    for (const std::string_view key : {"size", "radius", "top_radius", "tube_radius", "height", "opening", "profile",
                                       "crease", "segments", "strands", "tip_radius", "parts"})
        if (value.has(key) && own.find(" " + std::string(key) + ",") == std::string::npos)
            value.need(key).fail("a " + std::string(shapes[shape]) + " has no such key; it has " +
                                 std::string(own_keys[shape]));
}

Mesh lathe_of(const JsonValue& value, int segments, TextureLayout layout) {
    std::vector<glm::dvec2> outline;
    for (const JsonValue& point : value.need("profile").list(2, 1000)) {
        const std::vector<JsonValue> p = point.list(2, 2);
        outline.emplace_back(p[0].number(0, largest), p[1].number(-largest, largest));
        if (outline.size() > 1 && outline[outline.size() - 2] == outline.back())
            point.fail("is the same point as the one before");
    }
    const auto crease = value.find("crease");
    return lathe_mesh(outline, segments, crease ? crease->number(0, 180) : 30, layout);
}

Mesh torus_of(const JsonValue& value, int segments, TextureLayout layout) {
    const double radius = size_or(value, "radius", 0.5), tube = size_or(value, "tube_radius", radius / 4);
    if (tube >= radius) value.fail("`tube_radius` must be smaller than `radius`");
    return torus_mesh(radius, tube, segments, layout);
}

Mesh arch_of(const JsonValue& value, int segments, TextureLayout layout) {
    const glm::dvec3 size = sizes_or<3>(value, "size", 1);
    const glm::dvec2 opening = sizes_or<2>(value, "opening", 0.5);
    if (opening.x >= size.x || opening.y >= size.y || 2 * opening.y < opening.x)
        value.fail("`opening` must be smaller than the wall, and at least half as high as wide");
    return arch_mesh(size, opening, segments, layout);
}

Mesh strands_of(const JsonValue& value) {
    Mesh mesh;
    const double root = size_or(value, "radius", 0.001), tip = value.number_or("tip_radius", 0, largest_size, root);
    for (const JsonValue& strand : value.need("strands").list(1, 1000000)) {
        std::vector<glm::vec3> points;
        std::vector<float> radii;
        for (const JsonValue& point : strand.list(2, 1000)) points.emplace_back(point.position());
        for (std::size_t k = 0; k < points.size(); ++k)
            radii.push_back(static_cast<float>(
                std::lerp(root, tip, static_cast<double>(k) / static_cast<double>(points.size() - 1))));
        add_strand(mesh, points, radii);
    }
    return mesh;
}

Mesh shape_of(const JsonValue& value, Shape shape) {
    constexpr std::array<std::string_view, 2> layouts{"fit", "units"};
    const auto uv = value.find("uv");
    const auto layout = uv ? static_cast<TextureLayout>(uv->word(layouts)) : TextureLayout::fit;
    // chosen: 48 sides: a disc a quarter of the picture wide shows its corners below 24.
    const auto segments = value.has("segments") ? static_cast<int>(value.need("segments").integer(3, 1024)) : 48;
    const auto size = [&](std::string_view key, double otherwise) { return size_or(value, key, otherwise); };
    switch (shape) {
        case box:
            return box_mesh(sizes_or<3>(value, "size", 1), layout);
        case plane:
            return plane_mesh(sizes_or<2>(value, "size", 1), layout);
        case quad:
            return quad_mesh(sizes_or<2>(value, "size", 1), layout);
        case sphere:
            return sphere_mesh(size("radius", 0.5), segments, layout);
        case disc:
            return disc_mesh(size("radius", 0.5), segments, layout);
        case cylinder:
            return cylinder_mesh(size("radius", 0.5), size("top_radius", size("radius", 0.5)), size("height", 1),
                                 segments, layout);
        case cone:
            return cylinder_mesh(size("radius", 0.5), 0, size("height", 1), segments, layout);
        case torus:
            return torus_of(value, segments, layout);
        case lathe:
            return lathe_of(value, segments, layout);
        case arch:
            return arch_of(value, segments, layout);
        case strands:
            return strands_of(value);
        case group:
            break;
    }
    return {};
}

}  // namespace

int Objects::mesh_of(const JsonValue& value) {
    if (const auto known = mesh_at_.find(value.place()); known != mesh_at_.end()) return known->second;
    Mesh mesh = shape_of(value, static_cast<Shape>(value.need("shape").word(shapes)));
    mesh.name = value.place();
    film_.meshes.push_back(std::move(mesh));
    return mesh_at_[value.place()] = static_cast<int>(film_.meshes.size()) - 1;
}

void Objects::build(const JsonValue& value, int parent) {
    value.allow_only(keys::object);
    const auto shape = static_cast<Shape>(value.need("shape").word(shapes));
    refuse_foreign_keys(value, shape);
    const std::string name = value.has("name") ? value.need("name").text() : value.place();
    const int placed = add_node(film_, name, parent);
    place(film_, placed, value, clock_, keys::object_key);

    std::vector<glm::vec3> colors;
    if (const auto v = value.find("colors"))
        for (const JsonValue& color : v->list(1, 1000)) colors.push_back(color.color(1));
    if (shape == group && (value.has("material") || !colors.empty() || value.has("uv")))
        value.fail("a group has no surface of its own; give its parts material, uv and colors");
    const bool edited = has_reflections(value);
    if (shape == group && edited) value.fail("a group mirrors nothing; give its parts `reflections`");
    const auto material = value.find("material");
    const int own_material =
        shape == group ? -1 : (material ? looks_.material_of(*material, -1) : looks_.default_material());

    const std::vector<int> copies = copies_of(value, placed, film_);
    if (film_.nodes.size() > most_objects) value.fail("makes more than " + std::to_string(most_objects) + " things");
    std::size_t number = 0;
    for (const int node : copies) {
        if (shape == group) {
            for (const JsonValue& part : value.need("parts").list(1, 10000)) build(part, node);
        } else {
            const int painted =
                colors.empty() ? own_material : looks_.recolored(own_material, colors[number % colors.size()]);
            add_object(film_, film_.nodes[static_cast<std::size_t>(node)].name, node, mesh_of(value), painted);
            if (edited) edited_.emplace_back(value, node);
        }
        ++number;
    }
}

void Objects::read(const JsonValue& objects) {
    for (const JsonValue& object : objects.list(0, 100000)) build(object, -1);
}

void Objects::read_edits() {
    for (const auto& [value, node] : edited_) read_reflections(value, node, film_, clock_);
}

void Objects::repaint(const JsonValue& material, const std::vector<int>& nodes, const std::string& name) {
    for (Object& object : film_.objects) {
        const bool meant = object.name == name || std::find(nodes.begin(), nodes.end(), object.node) != nodes.end();
        if (meant) object.material = looks_.material_of(material, material.is_text() ? -1 : object.material);
    }
}

void Objects::read_changes(const JsonValue& changes) {
    const std::size_t node_count = film_.nodes.size();
    for (const auto& [name, value] : changes.members()) {
        value.allow_only(keys::change);
        std::vector<int> nodes;
        std::vector<std::string_view> names;
        for (std::size_t i = 0; i < node_count; ++i) {
            if (film_.nodes[i].name == name) nodes.push_back(static_cast<int>(i));
            names.emplace_back(film_.nodes[i].name);
        }
        for (const Object& object : film_.objects) {
            if (nodes.empty() && object.name == name && object.node >= 0) nodes.push_back(object.node);
            names.emplace_back(object.name);
        }
        if (nodes.empty())
            value.fail("the scene has no object of this name" + core::did_you_mean(name, names, "\"", "\""));
        for (const int node : nodes) place(film_, node, value, clock_, keys::object_key);
        if (has_reflections(value))
            for (const int node : nodes) edited_.emplace_back(value, node);
        if (const auto material = value.find("material")) repaint(*material, nodes, name);
    }
}

}  // namespace render2mpeg::scene
