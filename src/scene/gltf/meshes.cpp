// Meshes of a glTF file.
#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "core/error.h"
#include "core/module.h"
#include "core/text.h"
#include "scene/gltf/accessor.h"
#include "scene/gltf/parts.h"
#include "scene/model/curves.h"
#include "scene/model/wording.h"

namespace render2mpeg::scene::gltf {
namespace {

enum Mode : std::size_t { lines = 1, line_strip = 3, triangles = 4, triangle_strip = 5, triangle_fan = 6 };

/// Corners in drawing order to triangles, each with the winding it is drawn with. [glTF2, 3.7.2.1]
std::vector<glm::uvec3> triangles_of(const Element& primitive, std::size_t mode,
                                     const std::vector<std::uint32_t>& corners) {
    std::vector<glm::uvec3> result;
    const std::size_t n = corners.size();
    if (mode == triangles) {
        if (n % 3 != 0)
            primitive.refuse("has " + std::to_string(n) + " corners, which are no whole number of triangles");
        for (std::size_t i = 0; i + 2 < n; i += 3) result.emplace_back(corners[i], corners[i + 1], corners[i + 2]);
        return result;
    }
    if (n < 3) primitive.refuse("has " + std::to_string(n) + " corners; a triangle needs 3");
    for (std::size_t i = 0; i + 2 < n; ++i) {
        if (mode == triangle_strip)
            result.emplace_back(corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]);
        else
            result.emplace_back(corners[i + 1], corners[i + 2], corners[0]);
    }
    return result;
}

/// Values of the vertices `used`; components that the accessor lacks are 1.
template <class Vector>
void take(const Floats& floats, const std::vector<std::uint32_t>& used, std::vector<Vector>& into) {
    into.assign(used.size(), Vector(1));
    for (std::size_t i = 0; i < used.size(); ++i)
        for (int k = 0; k < floats.components; ++k)
            into[i][k] =
                floats.values[static_cast<std::size_t>(floats.components) * used[i] + static_cast<std::size_t>(k)];
}

/// Strands of hair: lines whose vertices have radii, each from one vertex to the next. Returns for each of the mesh's
/// positions the vertex that it is.
std::vector<std::uint32_t> strands_of(const Element& primitive, std::size_t mode, const Floats& positions,
                                      const Floats& radii, const std::vector<std::uint32_t>& corners, Mesh& mesh) {
    std::vector<std::uint32_t> vertices;
    const auto add = [&](std::size_t first, std::size_t end, std::size_t step) {
        std::vector<glm::vec3> points;
        std::vector<float> widths;
        for (std::size_t k = first; k < end; k += k + 1 < end && k > first ? step : 1) {
            const std::uint32_t v = corners[k];
            points.emplace_back(positions.values[3 * v], positions.values[3 * v + 1], positions.values[3 * v + 2]);
            widths.push_back(radii.values[v]);
            vertices.insert(vertices.end(), k == first || k + 1 == end ? 2 : 1, v);
        }
        add_strand(mesh, points, widths);
    };
    if (corners.size() < 2 || (mode == lines && corners.size() % 2 != 0))
        primitive.refuse("has " + std::to_string(corners.size()) + " ends of lines");
    if (mode == line_strip) return add(0, corners.size(), 1), vertices;
    for (std::size_t first = 0, k = 2; k <= corners.size(); k += 2) {
        if (k < corners.size() && corners[k] == corners[k - 1]) continue;
        add(first, k, 2);
        first = k;
    }
    return vertices;
}

}  // namespace

int variant_of(const Document& document, const LoadOptions& options, Animation& animation) {
    std::vector<std::string> names;
    if (const auto extension = document.root().extension("KHR_materials_variants"))
        for (const Element& variant : extension->objects("variants")) names.push_back(variant.string("name", ""));
    if (options.variant) {
        const std::optional<std::size_t> chosen = choose(*options.variant, names);
        if (!chosen)
            throw core::Error("reading", document.file().string(), no_such("variant", *options.variant, names));
        return static_cast<int>(*chosen);
    }
    if (names.empty()) return -1;
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + in_quotes(name);
    note_once(animation,
              "has " + core::counted(names.size(), "variant") + " of materials (--variant): " + list.substr(0, 200));
    return -1;
}

const Floats& MeshReader::floats(int accessor, std::initializer_list<int> components, std::size_t count,
                                 const std::string& user) {
    if (const auto own = decompressed_.find(accessor); own != decompressed_.end()) {
        const bool allowed =
            std::find(components.begin(), components.end(), own->second.components) != components.end();
        if (!allowed || (count != 0 && own->second.count() != count))
            document_.refuse(user, "what is decompressed does not fit here");
        return own->second;
    }
    const auto known = decoded_.find(accessor);
    if (known != decoded_.end()) {
        const bool fits = (count == 0 || known->second.count() == count) &&
                          std::find(components.begin(), components.end(), known->second.components) != components.end();
        if (fits) return known->second;
    }
    // Read again for the error message.
    Floats floats = read_floats(document_, accessor, components, count, user);
    return decoded_.insert_or_assign(accessor, std::move(floats)).first->second;
}

const DracoMesh* MeshReader::read_draco(const Element& primitive, const std::map<std::string, int>& attributes) {
    draco_.reset();
    decompressed_.clear();
    const std::optional<Element> extension = primitive.extension("KHR_draco_mesh_compression");
    if (!extension) return nullptr;
    const std::optional<Element> numbers = extension->object("attributes");
    if (!numbers) extension->refuse("names no attributes");
    std::map<std::string, std::uint32_t> wanted;
    for (const auto& [name, accessor] : attributes)
        if (numbers->has(name.c_str()))
            wanted[name] = static_cast<std::uint32_t>(numbers->required_size(name.c_str()) & 0xffffffffu);
    const Document::Bytes bytes =
        document_.view(extension->required_index("bufferView", "bufferViews"), extension->where());
    std::vector<std::uint32_t> ids;
    for (const auto& [name, id] : wanted) ids.push_back(id);
    document_.before_decoding();
    static const DracoDecoder& decoder =
        *core::module_function<const DracoDecoder*()>("draco", "render2mpeg_draco_decoder")();
    try {
        draco_ = decoder.decode({bytes.first, bytes.size}, ids);
    } catch (const std::invalid_argument& error) {
        extension->refuse(error.what());
    }
    for (const auto& [name, id] : wanted) {
        DracoMesh::Values& values = draco_->attributes.at(id);
        const Element accessor = document_.at("accessors", attributes.at(name));
        // Draco may not say that integers are normalised.
        const std::size_t type = accessor.size("componentType", 5126);
        if (accessor.boolean("normalized", false) && !values.normalized && type >= 5120 && type <= 5123) {
            const float largest = type == 5120 ? 127.0f : type == 5121 ? 255.0f : type == 5122 ? 32767.0f : 65535.0f;
            for (float& value : values.values) value = std::max(value / largest, -1.0f);
        }
        decompressed_[attributes.at(name)] = {values.components, values.values};
    }
    return &*draco_;
}

std::vector<std::uint32_t> MeshReader::read_joint_numbers(int accessor, std::size_t count, const std::string& user) {
    const auto own = decompressed_.find(accessor);
    if (own == decompressed_.end()) return read_integers(document_, accessor, 4, count, user);
    const Floats& values = own->second;
    if (values.components != 4 || values.count() != count)
        document_.refuse(user, "what is decompressed does not fit here");
    std::vector<std::uint32_t> numbers;
    for (const float value : values.values)
        numbers.push_back(value >= 0 && value <= 65535 ? static_cast<std::uint32_t>(value) : 0x10000u);
    return numbers;
}

int MeshReader::material_of(const Element& primitive) const {
    const int own = primitive.index("material", "materials");
    const std::optional<Element> variants = primitive.extension("KHR_materials_variants");
    if (variant_ < 0 || !variants) return own;
    for (const Element& mapping : variants->objects("mappings"))
        for (const double number : mapping.numbers("variants", 0))
            if (number == variant_) return mapping.required_index("material", "materials");
    return own;
}

std::vector<std::uint32_t> MeshReader::read_corners(const Element& primitive, std::size_t vertices) const {
    if (draco_) return draco_->corners;
    const int accessor = primitive.index("indices", "accessors");
    if (accessor < 0) {
        std::vector<std::uint32_t> corners(vertices);
        std::iota(corners.begin(), corners.end(), 0u);
        return corners;
    }
    std::vector<std::uint32_t> corners = read_integers(document_, accessor, 1, 0, primitive.where() + ", indices");
    for (std::size_t i = 0; i < corners.size(); ++i)
        if (corners[i] >= vertices)
            primitive.refuse("index " + std::to_string(corners[i]) + " at position " + std::to_string(i) +
                             " is out of range: there are " + std::to_string(vertices) + " vertices");
    return corners;
}

void MeshReader::read_joints(const Element& primitive, const std::map<std::string, int>& attributes,
                             const std::vector<std::uint32_t>& used, Mesh& mesh) {
    if (attributes.contains("JOINTS_2")) too_many_joints_ = true;
    for (int set = 0; set < 2; ++set) {
        const auto joints = attributes.find("JOINTS_" + std::to_string(set)),
                   weights = attributes.find("WEIGHTS_" + std::to_string(set));
        if (joints == attributes.end() && weights == attributes.end()) return;
        if (joints == attributes.end() || weights == attributes.end())
            primitive.refuse("has joints without weights, or weights without joints");
        const Floats& weight = floats(weights->second, {4}, 0, primitive.where() + ", " + weights->first);
        const std::vector<std::uint32_t> joint =
            read_joint_numbers(joints->second, weight.count(), primitive.where() + ", " + joints->first);
        mesh.joints.resize(used.size());
        for (std::size_t v = 0; v < used.size(); ++v)
            for (std::size_t k = 0; k < 4; ++k) {
                const std::size_t from = 4 * static_cast<std::size_t>(used[v]) + k,
                                  to = 4 * static_cast<std::size_t>(set) + k;
                if (from >= weight.values.size())
                    primitive.refuse(joints->first + " has fewer elements than there are vertices");
                if (joint[from] > 0xffff)
                    primitive.refuse(joints->first + " refers to joint " + std::to_string(joint[from]));
                mesh.joints[v].joint[to] = static_cast<std::uint16_t>(joint[from]);
                mesh.joints[v].weight[to] = weight.values[from];
            }
    }
}

void MeshReader::read_morph_targets(const Element& primitive, const std::vector<std::uint32_t>& used,
                                    std::size_t vertices, Mesh& mesh) {
    for (const Element& target : primitive.objects("targets")) {
        MorphTarget morph;
        for (const auto& [name, accessor] : target.index_map(nullptr, "accessors")) {
            const std::string user = target.where() + ", " + name;
            if (name == "POSITION") take(floats(accessor, {3}, vertices, user), used, morph.positions);
            if (name == "NORMAL" && !mesh.normals.empty())
                take(floats(accessor, {3}, vertices, user), used, morph.normals);
        }
        mesh.morph_targets.push_back(std::move(morph));
    }
}

std::optional<Mesh> MeshReader::read_primitive(const Element& primitive) {
    const std::size_t mode = primitive.size("mode", triangles);
    if (mode > triangle_fan) primitive.refuse("mode " + std::to_string(mode) + " is none of glTF's");
    std::map<std::string, int> attributes;
    for (const auto& [name, accessor] : primitive.index_map("attributes", "accessors"))
        attributes.emplace(name, accessor);
    const auto radius = attributes.find("_RADIUS");
    const bool strands = (mode == lines || mode == line_strip) && radius != attributes.end();
    if (mode < triangles && !strands) return ++undrawn_, std::nullopt;
    const auto position = attributes.find("POSITION");
    if (position == attributes.end()) return ++without_positions_, std::nullopt;
    if (read_draco(primitive, attributes) != nullptr && mode != triangles)
        primitive.refuse("is compressed and not of single triangles");

    // Keep used vertices only: primitives often share one large array.
    const Floats& positions = floats(position->second, {3}, 0, primitive.where() + ", POSITION");
    const std::size_t vertices = positions.count();
    std::vector<std::uint32_t> corners = read_corners(primitive, vertices);
    Mesh mesh;
    std::vector<std::uint32_t> used;
    const auto read = [&](const char* name, std::initializer_list<int> components, auto& into) {
        if (const auto found = attributes.find(name); found != attributes.end())
            take(floats(found->second, components, vertices, primitive.where() + ", " + name), used, into);
    };
    if (strands) {
        const Floats& radii = floats(radius->second, {1}, vertices, primitive.where() + ", _RADIUS");
        used = strands_of(primitive, mode, positions, radii, corners, mesh);
    } else {
        used = corners;
        std::sort(used.begin(), used.end());
        used.erase(std::unique(used.begin(), used.end()), used.end());
        if (used.size() < vertices)
            for (std::uint32_t& corner : corners)
                corner = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), corner) - used.begin());
        take(positions, used, mesh.positions);
        mesh.triangles = triangles_of(primitive, mode, corners);
        read("NORMAL", {3}, mesh.normals);
        read("TANGENT", {4}, mesh.tangents);
        read("TEXCOORD_0", {2}, mesh.uv[0]);
        read("TEXCOORD_1", {2}, mesh.uv[1]);
    }
    read("COLOR_0", {3, 4}, mesh.colors);
    read_joints(primitive, attributes, used, mesh);
    read_morph_targets(primitive, used, vertices, mesh);
    return mesh;
}

const std::vector<MeshReader::Part>& MeshReader::parts_of(int index) {
    const auto known = parts_.find(index);
    if (known != parts_.end()) return known->second;
    const Element element = document_.at("meshes", index);
    const std::vector<Element> primitives = element.objects("primitives");
    const std::size_t targets = morph_targets_of(index);
    std::vector<Part> parts;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
        std::optional<Mesh> mesh = read_primitive(primitives[p]);
        if (!mesh) continue;
        if (mesh->morph_targets.size() != targets)
            primitives[p].refuse("has not as many morph targets as the other primitives of its mesh");
        mesh->name = element.string("name", "");
        if (primitives.size() > 1) mesh->name.append("/").append(std::to_string(p));
        parts.push_back({static_cast<int>(animation_.meshes.size()), material_of(primitives[p]), p});
        animation_.meshes.push_back(std::move(*mesh));
    }
    return parts_.emplace(index, std::move(parts)).first->second;
}

std::size_t MeshReader::morph_targets_of(int mesh) const {
    const std::vector<Element> primitives = document_.at("meshes", mesh).objects("primitives");
    return primitives.empty() ? 0 : primitives.front().objects("targets").size();
}

void MeshReader::add_notes() {
    if (undrawn_ > 0) note_once(animation_, "left out " + core::counted(undrawn_, "primitive") + " of points or lines");
    if (without_positions_ > 0)
        note_once(animation_, "left out " + core::counted(without_positions_, "primitive") + " without positions");
    if (too_many_joints_) note_once(animation_, "more than 8 joints move a vertex; the first 8 are used");
}

}  // namespace render2mpeg::scene::gltf
