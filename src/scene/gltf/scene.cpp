// Nodes, cameras and lights of a glTF file.
#include <algorithm>
#include <glm/gtc/type_ptr.hpp>
#include <map>
#include <set>

#include "core/numeric.h"
#include "core/text.h"
#include "scene/gltf/accessor.h"
#include "scene/gltf/parts.h"
#include "scene/model/wording.h"

namespace render2mpeg::scene::gltf {
namespace {

Node node_of(const Element& element) {
    Node node;
    node.name = element.string("name", "");
    if (const std::vector<double> matrix = element.numbers("matrix", 16); !matrix.empty())
        node.matrix = glm::make_mat4(matrix.data());
    if (const std::vector<double> t = element.numbers("translation", 3); !t.empty())
        node.translation = {t[0], t[1], t[2]};
    if (const std::vector<double> r = element.numbers("rotation", 4); !r.empty())
        node.rotation = {r[3], r[0], r[1], r[2]};
    if (const std::vector<double> s = element.numbers("scale", 3); !s.empty()) node.scale = {s[0], s[1], s[2]};
    return node;
}

CameraLens lens_of(const Element& element) {
    CameraLens lens;
    lens.name = element.string("name", "");
    const std::string type = element.string("type", "");
    const bool perspective = type == "perspective";
    lens.projection = perspective ? ProjectionKind::perspective : ProjectionKind::orthographic;
    if (!perspective && type != "orthographic") element.refuse("type " + in_quotes(type) + " is none of glTF's");
    const std::optional<Element> own = element.object(type.c_str());
    if (!own) element.refuse("lacks " + in_quotes(type));
    if (perspective) {
        lens.vertical_fov = static_cast<float>(own->number("yfov", 0));
        lens.aspect = static_cast<float>(own->number("aspectRatio", 0));
    } else {
        lens.y_magnification = static_cast<float>(own->number("ymag", 0));
        lens.aspect = core::divide_or(static_cast<float>(own->number("xmag", 0)), lens.y_magnification, 0.0f);
    }
    lens.near = static_cast<float>(own->number("znear", 0));
    lens.far = static_cast<float>(own->number("zfar", 0));
    return lens;
}

Light light_of(const Element& element) {
    Light light;
    light.name = element.string("name", "");
    const std::string type = element.string("type", "");
    if (type == "spot")
        light.kind = LightKind::spot;
    else if (type == "directional")
        light.kind = LightKind::directional;
    else if (type != "point")
        element.refuse("type " + in_quotes(type) + " is none of the extension's");
    if (const std::vector<double> color = element.numbers("color", 3); !color.empty())
        light.color = glm::vec3(color[0], color[1], color[2]);
    light.intensity = static_cast<float>(element.number("intensity", 1));
    light.range = static_cast<float>(element.number("range", 0));
    if (const std::optional<Element> spot = element.object("spot")) {
        light.inner_cone = static_cast<float>(spot->number("innerConeAngle", 0));
        light.outer_cone = static_cast<float>(spot->number("outerConeAngle", 0.7853981633974483));
    }
    return light;
}

class SceneReader {
  public:
    SceneReader(const Document& document, MeshReader& meshes, Animation& animation)
        : document_(document), meshes_(meshes), animation_(animation), skin_of_(document.count("skins"), -1) {
        if (const auto extension = document.root().extension("KHR_lights_punctual"))
            lights_ = extension->objects("lights");
        for (const PointedTrack& pointed : pointed_tracks(document))
            if (pointed.what == TrackTarget::visibility) switched_.insert(pointed.index);
    }

    Carried run() {
        read_nodes();
        for (const int node : nodes_of_scene()) read_contents(node, is_hidden(node));
        name_cameras();
        return carried_;
    }

  private:
    void read_nodes() {
        const std::vector<Element> elements = document_.all("nodes");
        children_.resize(elements.size());
        for (const Element& element : elements) animation_.nodes.push_back(node_of(element));
        for (std::size_t i = 0; i < elements.size(); ++i) {
            children_[i] = elements[i].indices("children", "nodes");
            for (const int child : children_[i]) {
                int& parent = animation_.nodes[static_cast<std::size_t>(child)].parent;
                const std::string name = described("node", static_cast<std::size_t>(child),
                                                   animation_.nodes[static_cast<std::size_t>(child)].name);
                if (child == static_cast<int>(i))
                    document_.refuse(name, "the node graph has a cycle: it is its own child");
                if (parent >= 0)
                    document_.refuse(name,
                                     "has two parents, nodes " + std::to_string(parent) + " and " + std::to_string(i));
                parent = static_cast<int>(i);
            }
        }
    }

    /// Nodes of the default scene, else the first, else all, depth first.
    std::vector<int> nodes_of_scene() {
        std::vector<int> pending;
        int scene = document_.root().index("scene", "scenes");
        if (scene < 0 && document_.count("scenes") > 0) {
            scene = 0;
            if (document_.count("scenes") > 1)
                note_once(animation_, "several scenes and no default: the first is shown");
        }
        if (scene >= 0) {
            pending = document_.at("scenes", scene).indices("nodes", "nodes");
        } else {
            for (std::size_t i = 0; i < animation_.nodes.size(); ++i)
                if (animation_.nodes[i].parent < 0) pending.push_back(static_cast<int>(i));
        }
        std::reverse(pending.begin(), pending.end());
        std::vector<char> taken(animation_.nodes.size(), 0);
        std::vector<int> order;
        while (!pending.empty()) {
            const int node = pending.back();
            pending.pop_back();
            if (taken[static_cast<std::size_t>(node)]) continue;
            taken[static_cast<std::size_t>(node)] = 1;
            order.push_back(node);
            const std::vector<int>& below = children_[static_cast<std::size_t>(node)];
            pending.insert(pending.end(), below.rbegin(), below.rend());
        }
        return order;
    }

    /// Whether a node is never visible [KHR_node_visibility]; parents are asked first.
    bool is_hidden(int node) {
        hidden_.resize(animation_.nodes.size(), 0);
        const int parent = animation_.nodes[static_cast<std::size_t>(node)].parent;
        char& hidden = hidden_[static_cast<std::size_t>(node)];
        hidden = parent >= 0 && hidden_[static_cast<std::size_t>(parent)];
        const auto extension = document_.at("nodes", node).extension("KHR_node_visibility");
        if (!extension || extension->boolean("visible", true)) return hidden;
        if (!switched_.contains(node)) {
            hidden = 1;
            return true;
        }
        Track track;
        track.target = TrackTarget::visibility;
        track.index = node;
        track.interpolation = Interpolation::step;
        track.width = 1;
        track.times = {0};
        track.values = {0};
        animation_.tracks.push_back(std::move(track));
        return hidden;
    }

    void read_contents(int node, bool hidden) {
        const Element element = document_.at("nodes", node);
        if (const int mesh = element.index("mesh", "meshes"); mesh >= 0 && !hidden) {
            if (const auto copies = element.extension("EXT_mesh_gpu_instancing"))
                read_copies(*copies, element, node, mesh);
            else
                read_objects(element, node, node, mesh);
        }
        if (const int camera = element.index("camera", "cameras"); camera >= 0) {
            CameraLens lens = lens_of(document_.at("cameras", camera));
            lens.node = node;
            animation_.cameras.push_back(std::move(lens));
            carried_.cameras.push_back(camera);
        }
        if (const auto extension = element.extension("KHR_lights_punctual"); extension && !hidden) {
            const std::size_t index = extension->required_size("light");
            if (index >= lights_.size())
                element.refuse("refers to light " + std::to_string(index) + ", but there are " +
                               std::to_string(lights_.size()));
            Light light = light_of(lights_[index]);
            if (light.name.empty()) light.name = animation_.nodes[static_cast<std::size_t>(node)].name;
            light.node = node;
            animation_.lights.push_back(std::move(light));
            carried_.lights.push_back(static_cast<int>(index));
        }
    }

    /// Copies of a node's objects [EXT_mesh_gpu_instancing].
    void read_copies(const Element& extension, const Element& element, int node, int mesh) {
        std::size_t count = 0;
        std::map<std::string, Floats> columns;
        for (const auto& [name, accessor] : extension.index_map("attributes", "accessors")) {
            const int components = name == "ROTATION" ? 4 : name == "TRANSLATION" || name == "SCALE" ? 3 : 0;
            if (components == 0) continue;  // attributes of one's own
            columns[name] = read_finite_floats(document_, accessor, {components}, count, element.where() + ", " + name);
            count = columns[name].count();
        }
        // chosen: 2^20 copies, some 400 bytes each; fields of grass have a tenth.
        constexpr std::size_t most_copies = std::size_t{1} << 20;
        copies_ += count;
        if (copies_ > most_copies) element.refuse("has too many copies; at most 1048576 are read");
        if (element.index("skin", "skins") >= 0)
            note_once(animation_, element.where() + ": copies are not moved by its skin");
        const auto values = [&](const char* name, std::size_t i) -> const float* {
            const auto column = columns.find(name);
            if (column == columns.end()) return nullptr;
            return &column->second.values[i * static_cast<std::size_t>(column->second.components)];
        };
        for (std::size_t i = 0; i < count; ++i) {
            Node copy;
            copy.name = animation_.nodes[static_cast<std::size_t>(node)].name;
            copy.parent = node;
            if (const float* t = values("TRANSLATION", i)) copy.translation = {t[0], t[1], t[2]};
            if (const float* r = values("ROTATION", i)) copy.rotation = {r[3], r[0], r[1], r[2]};
            if (const float* s = values("SCALE", i)) copy.scale = {s[0], s[1], s[2]};
            animation_.nodes.push_back(std::move(copy));
            read_objects(element, node, static_cast<int>(animation_.nodes.size()) - 1, mesh);
        }
    }

    /// Objects of `owner`'s mesh at `node`.
    void read_objects(const Element& element, int owner, int node, int mesh) {
        const std::vector<MeshReader::Part>& parts = meshes_.parts_of(mesh);
        const Element mesh_element = document_.at("meshes", mesh);
        const std::size_t targets = meshes_.morph_targets_of(mesh);
        std::vector<double> weights = element.numbers("weights", 0);
        if (weights.empty()) weights = mesh_element.numbers("weights", 0);
        if (!weights.empty() && weights.size() != targets)
            element.refuse("has " + core::counted(weights.size(), "morph weight") + " for " +
                           core::counted(targets, "morph target"));
        const int skin = element.index("skin", "skins");
        std::string name = animation_.nodes[static_cast<std::size_t>(owner)].name;
        if (name.empty()) name = mesh_element.string("name", "");
        for (const MeshReader::Part& part : parts) {
            Object object;
            object.name = parts.size() > 1 ? name + "/" + std::to_string(part.primitive) : name;
            object.node = node;
            object.mesh = part.mesh;
            object.material = part.material >= 0 ? part.material : default_material(animation_);
            if (skin >= 0 && owner == node && !animation_.meshes[static_cast<std::size_t>(part.mesh)].joints.empty())
                object.skin = skin_index(skin);
            object.morph_weights.assign(weights.begin(), weights.end());
            animation_.objects.push_back(std::move(object));
        }
    }

    int skin_index(int skin) {
        int& known = skin_of_[static_cast<std::size_t>(skin)];
        if (known >= 0) return known;
        const Element element = document_.at("skins", skin);
        Skin result;
        result.joints = element.indices("joints", "nodes");
        if (result.joints.empty()) element.refuse("has no joints");
        result.inverse_bind.assign(result.joints.size(), glm::dmat4(1.0));
        if (const int accessor = element.index("inverseBindMatrices", "accessors"); accessor >= 0) {
            const Floats matrices =
                read_finite_floats(document_, accessor, {16}, 0, element.where() + ", inverseBindMatrices");
            if (matrices.count() < result.joints.size())
                element.refuse("has " + std::to_string(matrices.count()) + " inverse bind matrices for " +
                               core::counted(result.joints.size(), "joint"));
            for (std::size_t j = 0; j < result.joints.size(); ++j)
                result.inverse_bind[j] = glm::dmat4(glm::make_mat4(&matrices.values[16 * j]));
        }
        known = static_cast<int>(animation_.skins.size());
        animation_.skins.push_back(std::move(result));
        return known;
    }

    /// Names cameras by their nodes where their names are missing or shared.
    void name_cameras() {
        std::vector<CameraLens>& cameras = animation_.cameras;
        std::vector<std::string> own;
        for (const CameraLens& lens : cameras) own.push_back(lens.name);
        for (CameraLens& lens : cameras) {
            const std::string& node = animation_.nodes[static_cast<std::size_t>(lens.node)].name;
            if ((lens.name.empty() || std::count(own.begin(), own.end(), lens.name) > 1) && !node.empty())
                lens.name = node;
        }
    }

    const Document& document_;
    MeshReader& meshes_;
    Animation& animation_;
    std::vector<Element> lights_;
    std::vector<std::vector<int>> children_;
    std::vector<int> skin_of_;
    Carried carried_;
    std::vector<char> hidden_;
    std::set<int> switched_;  ///< nodes that an animation shows and hides
    std::size_t copies_ = 0;
};

}  // namespace

Carried read_scene(const Document& document, MeshReader& meshes, Animation& animation) {
    return SceneReader(document, meshes, animation).run();
}

}  // namespace render2mpeg::scene::gltf
