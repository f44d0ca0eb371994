#include "scene/preparation/validate.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/numeric.h"
#include "core/rational.h"
#include "core/text.h"
#include "scene/model/wording.h"
#include "scene/pose/pose.h"

namespace render2mpeg::scene {
namespace {

bool is_finite(glm::dvec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool is_finite(const glm::dmat4& m) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(m[c][r])) return false;
    return true;
}

/// Refuses an index that names none of `count` things; -1 may stand for none of them, where `least` is -1.
void check_index(const Animation& animation, const std::string& name, const char* kind, int index, std::size_t count,
                 int least = 0) {
    if (index < least || index >= static_cast<int>(count))
        refuse(animation, name,
               std::string("refers to ") + kind + " " + std::to_string(index) + ", but there " +
                   (count == 1 ? "is " : "are ") + std::to_string(count));
}

/// Whether a material is invisible whatever its textures; emission needs no alpha.
bool is_invisible(const Material& material) {
    const bool covers_nothing = material.alpha_mode == AlphaMode::blend ||
                                (material.alpha_mode == AlphaMode::mask && material.alpha_cutoff > 0);
    return covers_nothing && material.base_color.w <= 0 && !material.emits();
}

/// One material under check; remembers whether a value had to be clamped.
class MaterialCheck {
  public:
    MaterialCheck(Animation& animation, std::size_t index)
        : animation_(animation),
          material_(animation.materials[index]),
          name_(described("material", index, material_.name)) {}

    void run() {
        for (int k = 0; k < 4; ++k) clamp(material_.base_color[k], 0, 1, "base colour");
        clamp(material_.metallic, 0, 1, "metallic");
        clamp(material_.roughness, 0, 1, "roughness");
        for (int k = 0; k < 3; ++k) clamp(material_.specular[k], 0, 1, "specular colour");
        clamp(material_.glossiness, 0, 1, "glossiness");
        clamp(material_.transmission, 0, 1, "transmission");
        clamp(material_.specular_weight, 0, 1, "specular factor");
        for (int k = 0; k < 3; ++k) clamp(material_.specular_tint[k], 0, largest, "specular colour");
        clamp(material_.coat, 0, 1, "clearcoat");
        clamp(material_.coat_roughness, 0, 1, "clearcoat roughness");
        for (int k = 0; k < 3; ++k) clamp(material_.sheen[k], 0, 1, "sheen colour");
        clamp(material_.sheen_roughness, 0, 1, "sheen roughness");
        clamp(material_.iridescence, 0, 1, "iridescence");
        clamp(material_.film_ior, 1, 100, "index of the thin film");
        // chosen: a tenth of a millimetre, where no wave is told from the next.
        clamp(material_.film_thinnest, 0, 1e5f, "thickness of the thin film");
        clamp(material_.film_thickest, 0, 1e5f, "thickness of the thin film");
        clamp(material_.anisotropy, 0, 1, "anisotropy");
        clamp(material_.anisotropy_rotation, -largest, largest, "anisotropy's rotation");
        clamp(material_.diffuse_transmission, 0, 1, "diffuse transmission");
        for (int k = 0; k < 3; ++k)
            clamp(material_.diffuse_transmission_color[k], 0, 1, "diffuse transmission's colour");
        // chosen: 100 is beyond every substance; glTF itself sets no limit.
        clamp(material_.ior, 1, 100, "index of refraction");
        for (int k = 0; k < 3; ++k) clamp(material_.attenuation_color[k], 0, 1, "attenuation colour");
        clamp(material_.attenuation_distance, 0, largest, "attenuation distance");
        // chosen: 20 / 1, far beyond every substance; rutile has 2.
        clamp(material_.dispersion, 0, 20, "dispersion");
        clamp(material_.specular_level, 0, 10, "specular");
        clamp(material_.diffuse_roughness, 0, 1, "diffuse roughness");
        clamp(material_.coat_ior, 1, 100, "index of the coat");
        for (int k = 0; k < 3; ++k) clamp(material_.coat_tint[k], 0, 1, "tint of the coat");
        for (int k = 0; k < 3; ++k) clamp(material_.gloss[k], 0, 1, "gloss");
        clamp(material_.alpha_cutoff, 0, largest, "alpha cutoff");
        clamp(material_.normal_scale, -largest, largest, "normal scale");
        for (int k = 0; k < 3; ++k) clamp(material_.emission[k], 0, largest, "emission");
        for (const auto& [use, name] : texture_uses) check(material_.*use, name);
    }

  private:
    /// Beyond it sums of light points leave single precision. chosen: 1e30, far above any real radiance.
    static constexpr float largest = 1e30f;

    void clamp(float& value, float low, float high, const char* what) {
        if (!std::isfinite(value)) refuse(animation_, name_, std::string(what) + " is not finite");
        if (value >= low && value <= high) return;
        value = std::clamp(value, low, high);
        note_once(animation_, name_ + ": " + what + " is out of range; clamped");
    }

    void check(const TextureUse& use, const char* what) {
        check_index(animation_, name_ + ", " + what, "image", use.image, animation_.images.size(), -1);
        if (use.uv_set < 0 || use.uv_set > 1)
            refuse(animation_, name_,
                   std::string(what) + " uses texture coordinates " + std::to_string(use.uv_set) +
                       "; there are sets 0 and 1");
        for (const auto& row : use.transform)
            for (const float v : row)
                if (!std::isfinite(v))
                    refuse(animation_, name_, std::string(what) + " has a transform that is not finite");
    }

    Animation& animation_;
    Material& material_;
    std::string name_;
};

}  // namespace

void validate_nodes(Animation& animation) {
    std::vector<Node>& nodes = animation.nodes;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        Node& node = nodes[i];
        const std::string name = described("node", i, node.name);
        check_index(animation, name, "node", node.parent, nodes.size(), -1);
        if (node.matrix && !is_finite(*node.matrix))
            refuse(animation, name, "its matrix has a number that is not finite");
        if (!is_finite(node.translation)) refuse(animation, name, "its translation is not finite");
        if (!is_finite(node.scale)) refuse(animation, name, "its scale is not finite");
        const double length = glm::length(node.rotation);
        if (!std::isfinite(length)) refuse(animation, name, "its rotation is not finite");
        if (length == 0) note_once(animation, name + ": its rotation is zero; taken as none");
        // Unit vectors stay as they are, so that completing twice changes nothing.
        if (length == 0)
            node.rotation = {1, 0, 0, 0};
        else if (std::abs(length - 1) > 1e-15)
            node.rotation = glm::normalize(node.rotation);
    }

    // A node without a root is in or below a cycle; name one of the cycle.
    const std::vector<int> order = parents_first(nodes);
    if (order.size() == nodes.size()) return;
    std::vector<char> reached(nodes.size(), 0);
    for (const int n : order) reached[static_cast<std::size_t>(n)] = 1;
    std::size_t at = static_cast<std::size_t>(std::find(reached.begin(), reached.end(), 0) - reached.begin());
    for (std::size_t step = 0; step < nodes.size(); ++step) at = static_cast<std::size_t>(nodes[at].parent);
    refuse(animation, described("node", at, nodes[at].name), "the node graph has a cycle through it");
}

void validate_focus(const Animation& animation, const CameraLens& lens, const std::string& name) {
    const auto above_zero = [](float value) { return value > 0 && std::isfinite(value); };
    if (!(lens.f_stop >= 0) || !std::isfinite(lens.f_stop)) refuse(animation, name, "its f-stop must be 0 or more");
    if (lens.f_stop == 0) return;
    if (lens.focus_objects.empty() && !lens.focus_point && !above_zero(lens.focus_distance))
        refuse(animation, name, "it has an f-stop, and nothing that it is focused on");
    for (const int object : lens.focus_objects)
        check_index(animation, name, "object", object, animation.objects.size());
    if (!above_zero(lens.sensor_height) || !above_zero(lens.squeeze) || !std::isfinite(lens.blade_rotation))
        refuse(animation, name, "its sensor and its squeeze must be above 0");
}

void validate_cameras(Animation& animation) {
    for (std::size_t i = 0; i < animation.cameras.size(); ++i) {
        const CameraLens& lens = animation.cameras[i];
        const std::string name = described("camera", i, lens.name);
        check_index(animation, name, "node", lens.node, animation.nodes.size(), -1);
        // 3.1415 rather than pi: beyond it half the height of the picture at unit depth exceeds 20000.
        if (lens.projection == ProjectionKind::perspective && !(lens.vertical_fov > 0 && lens.vertical_fov < 3.1415f))
            refuse(animation, name,
                   "its vertical field of view is " + std::to_string(lens.vertical_fov) +
                       " rad; it must lie between 0 and pi");
        if (lens.projection == ProjectionKind::orthographic &&
            !(lens.y_magnification > 0 && std::isfinite(lens.y_magnification)))
            refuse(animation, name, "its vertical magnification must be above 0");
        if (!(lens.near >= 0) || !std::isfinite(lens.near))
            refuse(animation, name, "its near distance must be 0 or more");
        if (lens.far != 0 && !(lens.far > lens.near))
            refuse(animation, name, "its far distance must be above its near distance");
        validate_focus(animation, lens, name);
    }
    if (!Shutter::is_angle(static_cast<double>(animation.shutter.angle)))
        refuse(animation, "shutter", "its angle must lie between 0 and 360 degrees");
    if (!Shutter::is_phase(static_cast<double>(animation.shutter.phase)))
        refuse(animation, "shutter", "its phase must lie between -0.5 and 0.5 frames");
    if (!Shutter::is_rolling(static_cast<double>(animation.shutter.rolling)))
        refuse(animation, "shutter", "it must roll by 0 to 1 frames");
    for (std::size_t i = 0; i < animation.shots.size(); ++i)
        check_index(animation, described("shot", i, ""), "camera", animation.shots[i].camera, animation.cameras.size());
    std::stable_sort(animation.shots.begin(), animation.shots.end(),
                     [](const Shot& a, const Shot& b) { return a.frame < b.frame; });
    if (animation.frame_rate) {
        try {
            core::frame_rate_from(*animation.frame_rate);
        } catch (const core::Error& error) {
            throw core::Error("reading", animation.source, error.what());
        }
    }
    if (animation.first_frame && *animation.first_frame < 0) refuse(animation, "first frame", "must be 0 or more");
    if (animation.first_frame && animation.last_frame && *animation.last_frame < *animation.first_frame)
        refuse(animation, "last frame", "must not be before the first");
}

void validate_lights(Animation& animation) {
    for (std::size_t i = 0; i < animation.lights.size(); ++i) {
        Light& light = animation.lights[i];
        const std::string name = described("light", i, light.name);
        check_index(animation, name, "node", light.node, animation.nodes.size(), -1);
        if (!core::is_finite(light.color) || light.color.x < 0 || light.color.y < 0 || light.color.z < 0)
            refuse(animation, name, "its colour must be finite and not negative");
        if (!(light.intensity >= 0) || !std::isfinite(light.intensity))
            refuse(animation, name, "its intensity must be finite and not negative");
        if (!core::is_finite(light.color * light.intensity)) refuse(animation, name, "its intensity is too large");
        if (!(light.range >= 0)) refuse(animation, name, "its range must not be negative");
        if (std::isinf(light.range)) light.range = 0;
        if (!(light.angle >= 0 && light.angle <= 1.5707964f))
            refuse(animation, name, "its angle must be 0 <= angle <= pi/2");
        if (light.kind != LightKind::spot) continue;
        // pi / 2 in single precision is above pi / 2 by 4e-8.
        if (!(light.inner_cone >= 0 && light.inner_cone < light.outer_cone && light.outer_cone <= 1.5707964f))
            refuse(animation, name, "its cone angles must be 0 <= inner < outer <= pi/2");
    }
}

/// Strands are no lamps: next events ask triangles.
void note_shining_strands(Animation& animation) {
    std::string first;
    std::size_t count = 0;
    for (std::size_t i = 0; i < animation.objects.size(); ++i) {
        const Object& object = animation.objects[i];
        const Material& material = animation.materials[static_cast<std::size_t>(object.material)];
        if (!animation.meshes[static_cast<std::size_t>(object.mesh)].has_curves() || !material.emits()) continue;
        if (count++ == 0) first = described("object", i, object.name);
    }
    if (count == 0) return;
    const std::string others = count > 1 ? " and " + core::counted(count - 1, "other") : "";
    note_once(animation,
              first + others + ": its strands are seen to shine, but are no lamps: they light little or nothing");
}

void validate_objects(Animation& animation) {
    for (std::size_t i = 0; i < animation.skins.size(); ++i) {
        const Skin& skin = animation.skins[i];
        const std::string name = described("skin", i, "");
        if (skin.joints.empty()) refuse(animation, name, "has no joints");
        if (skin.inverse_bind.size() != skin.joints.size())
            refuse(animation, name, "has not as many inverse bind matrices as joints");
        for (std::size_t j = 0; j < skin.joints.size(); ++j) {
            check_index(animation, name, "node", skin.joints[j], animation.nodes.size());
            if (!is_finite(skin.inverse_bind[j]))
                refuse(animation, name,
                       "inverse bind matrix " + std::to_string(j) + " has a number that is not finite");
        }
    }

    // Check the references of the objects.
    for (std::size_t i = 0; i < animation.objects.size(); ++i) {
        Object& object = animation.objects[i];
        const std::string name = described("object", i, object.name);
        check_index(animation, name, "node", object.node, animation.nodes.size(), -1);
        check_index(animation, name, "mesh", object.mesh, animation.meshes.size());
        check_index(animation, name, "material", object.material, animation.materials.size());
        const Mesh& mesh = animation.meshes[static_cast<std::size_t>(object.mesh)];
        check_index(animation, name, "skin", object.skin, animation.skins.size(), -1);
        if (object.skin >= 0 && mesh.joints.empty()) object.skin = -1;
        if (object.skin >= 0) {
            const std::size_t count = animation.skins[static_cast<std::size_t>(object.skin)].joints.size();
            for (const VertexJoints& joints : mesh.joints)
                for (std::size_t k = 0; k < joints.joint.size(); ++k)
                    if (joints.weight[k] != 0) check_index(animation, name, "joint", joints.joint[k], count);
        }
        if (!object.morph_weights.empty() && object.morph_weights.size() != mesh.morph_targets.size())
            refuse(animation, name,
                   "has " + core::counted(object.morph_weights.size(), "morph weight") + " for " +
                       core::counted(mesh.morph_targets.size(), "morph target"));
        for (const float w : object.morph_weights)
            if (!std::isfinite(w)) refuse(animation, name, "a morph weight is not finite");
    }

    note_shining_strands(animation);

    // Remove objects that have nothing to show.
    const auto is_empty = [&](const Object& o) {
        return animation.meshes[static_cast<std::size_t>(o.mesh)].primitives() == 0;
    };
    std::erase_if(animation.objects, is_empty);
    const std::size_t unseen = std::erase_if(animation.objects, [&](const Object& o) {
        return is_invisible(animation.materials[static_cast<std::size_t>(o.material)]);
    });
    if (unseen > 0)
        animation.notes.push_back(core::counted(unseen, "object") + " of alpha 0 throughout cannot be seen: left out");
}

void validate_looks(Animation& animation) {
    for (std::size_t i = 0; i < animation.materials.size(); ++i) MaterialCheck(animation, i).run();
    for (std::size_t i = 0; i < animation.images.size(); ++i) {
        const ImageSource& image = animation.images[i];
        if (image.path.empty() && image.bytes.empty())
            refuse(animation, described("image", i, image.name), "has neither a file nor bytes");
    }
    Sky& sky = animation.sky;
    if (!core::is_finite(sky.color) || sky.color.x < 0 || sky.color.y < 0 || sky.color.z < 0)
        refuse(animation, "sky", "its colour must be finite and not negative");
    if (!std::isfinite(sky.rotation)) refuse(animation, "sky", "its rotation is not finite");
    check_index(animation, "sky", "image", sky.image, animation.images.size(), -1);
}

}  // namespace render2mpeg::scene
