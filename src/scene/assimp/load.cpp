// Every mesh format but glTF, by way of Assimp; parts.cpp converts the pieces.
#include "scene/assimp/load.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <new>
#include <set>
#include <string_view>
#include <unordered_map>

#include "core/error.h"
#include "core/numeric.h"
#include "core/plain_file.h"
#include "core/rational.h"
#include "core/text.h"
#include "scene/assimp/classic_shading.h"
#include "scene/assimp/parts.h"
#include "scene/assimp/rest_pose.h"
#include "scene/model/node.h"
#include "scene/model/wording.h"

namespace render2mpeg::scene {
namespace {

namespace fs = std::filesystem;

/// Confines importers to the scene's folder.
class FolderOnly : public Assimp::DefaultIOSystem {
  public:
    FolderOnly(const fs::path& folder, Animation& into)
        : folder_(fs::weakly_canonical(folder)), notes_(into.notes), files_(into.files) {}

    /// Assimp's own opens the file, and waits at a pipe.
    bool Exists(const char* file) const override {
        std::error_code failure;
        return inside(file) && fs::exists(file, failure);
    }
    Assimp::IOStream* Open(const char* file, const char* mode) override {
        if (inside(file)) {
            std::error_code failure;
            if (fs::exists(file, failure) && !fs::is_regular_file(file, failure)) {
                tell(in_quotes(file) + ": " + core::why_no_plain_file(file));
                return nullptr;
            }
            Assimp::IOStream* stream = DefaultIOSystem::Open(file, mode);
            if (stream == nullptr)
                tell_missing(file);
            else if (std::find(files_.begin(), files_.end(), file) == files_.end())
                files_.emplace_back(file);
            return stream;
        }
        tell(in_quotes(file) + " lies outside of the scene's folder and was not read");
        return nullptr;
    }

  private:
    void tell(const std::string& line) {
        if (std::find(notes_.begin(), notes_.end(), line) == notes_.end()) notes_.push_back(line);
    }
    /// Names the first missing material library; importers try other names, too.
    void tell_missing(const fs::path& file) {
        if (core::ending_of(file) != ".mtl" || told_materials_) return;
        told_materials_ = true;
        tell("there is no file " + in_quotes(file.filename().string()) +
             ", which says what surfaces look like: they are grey");
    }
    bool inside(const char* file) const {
        std::error_code failed;
        const fs::path path = fs::weakly_canonical(fs::absolute(file, failed), failed);
        if (failed) return false;
        return std::mismatch(folder_.begin(), folder_.end(), path.begin(), path.end()).first == folder_.end();
    }

    fs::path folder_;
    std::vector<std::string>& notes_;
    std::vector<fs::path>& files_;
    bool told_materials_ = false;
};

/// Blender's FBX has every action for every object, "OBJECT|ACTION"; an object's own has its name.
bool is_own_take(const std::string& name) {
    const auto bar = name.find('|');
    return bar != std::string::npos && bar > 0 && name.compare(bar + 1, bar, name, 0, bar) == 0;
}

class SceneReader {
  public:
    SceneReader(const aiScene& scene, const fs::path& file, const LoadOptions& options, Animation& into)
        : scene_(scene), file_(file), options_(options), into_(into), format_(ending_of(file)) {}

    void read() {
        read_materials();
        for (unsigned i = 0; i < scene_.mNumMeshes; ++i) into_.meshes.push_back(mesh_from(*scene_.mMeshes[i]));
        read_nodes();
        read_objects();
        read_animations();
        if (format_ == "fbx") keep_last_key();
        to_world_ = rest_transforms(into_);
        if (format_ == "dae" && is_of_blender()) {
            place_armatures();
            tell_dimmed();
        }
        const RestBounds bounds = rest_bounds(into_, to_world_);
        settle_sides_of_lamps(into_, to_world_, bounds);
        read_lights(bounds);
        read_cameras();
    }

    static std::string ending_of(const fs::path& file) {
        const std::string ending = core::ending_of(file);
        return ending.empty() ? ending : ending.substr(1);
    }

  private:
    void read_materials();
    void read_nodes();
    void read_objects();
    void read_animations();
    void keep_last_key();
    void place_armatures();
    void read_channel(const aiNodeAnim& channel, double ticks_per_second, const std::string& name);
    void read_morphing(const aiMeshMorphAnim& channel, double ticks_per_second);
    void read_lights(const RestBounds& bounds);
    void tell_dimmed();
    void read_cameras();
    bool is_of_blender() const;
    int add_child(const std::string& name, glm::dvec3 position, glm::dquat rotation);

    const aiScene& scene_;
    const fs::path& file_;
    const LoadOptions& options_;
    Animation& into_;
    std::string format_;
    std::unordered_map<std::string, int> node_named_;  ///< the first of its name
    std::vector<std::vector<unsigned>> meshes_of_node_;
    std::vector<const aiNode*> source_of_node_;
    std::vector<glm::dmat4> to_world_;
    std::unordered_map<int, std::string> moved_by_;  ///< node: the animation that moves it
};

void SceneReader::read_materials() {
    MaterialReader reader(scene_, file_.parent_path().empty() ? fs::path(".") : file_.parent_path(), format_);
    for (unsigned i = 0; i < scene_.mNumMaterials; ++i)
        into_.materials.push_back(reader.material_from(*scene_.mMaterials[i], into_));
    if (into_.materials.empty()) into_.materials.emplace_back();

    // Corner colours of PLY must not be darkened by Assimp's grey.
    std::vector<char> only_colored(into_.materials.size(), 1);
    for (unsigned i = 0; i < scene_.mNumMeshes; ++i)
        if (!scene_.mMeshes[i]->mColors[0]) only_colored[scene_.mMeshes[i]->mMaterialIndex] = 0;
    if (format_ == "ply" && scene_.mNumMaterials == 1 && only_colored[0]) into_.materials[0].base_color = glm::vec4(1);
}

void SceneReader::read_nodes() {
    // FBX's unit (cm) and axes are left to us: a root node brings them to metres and +y up.
    int top = -1;
    if (format_ == "fbx" && scene_.mMetaData) {
        const auto said = [&](const char* key, int otherwise) {
            std::int32_t value = otherwise;
            scene_.mMetaData->Get(key, value);
            return static_cast<int>(value);
        };
        double centimetres = 1;
        float single = 1;
        if (!scene_.mMetaData->Get("UnitScaleFactor", centimetres) && scene_.mMetaData->Get("UnitScaleFactor", single))
            centimetres = single;
        Node root;
        root.name = "metres, +y up";
        root.scale = glm::dvec3(centimetres > 0 && std::isfinite(centimetres) ? 0.01 * centimetres : 0.01);
        root.rotation =
            upright({said("CoordAxis", 0), said("CoordAxisSign", 1)}, {said("UpAxis", 1), said("UpAxisSign", 1)},
                    {said("FrontAxis", 2), said("FrontAxisSign", 1)});
        into_.nodes.push_back(root);
        source_of_node_.push_back(nullptr);
        top = 0;
    }

    // Without recursion: a file may nest as deep as it likes.
    std::vector<std::pair<const aiNode*, int>> waiting{{scene_.mRootNode, top}};
    while (!waiting.empty()) {
        const auto [source, parent] = waiting.back();
        waiting.pop_back();
        Node node;
        node.name = source->mName.C_Str();
        node.parent = parent;
        node.matrix = dmat4_of(source->mTransformation);
        const int index = static_cast<int>(into_.nodes.size());
        into_.nodes.push_back(std::move(node));
        source_of_node_.push_back(source);
        node_named_.emplace(source->mName.C_Str(), index);
        for (unsigned i = source->mNumChildren; i-- > 0;) waiting.emplace_back(source->mChildren[i], index);
    }
}

void SceneReader::read_objects() {
    // Nodes that share a mesh share its skin.
    std::vector<int> skin_of_mesh(scene_.mNumMeshes, -1);
    for (unsigned i = 0; i < scene_.mNumMeshes; ++i) {
        if (scene_.mMeshes[i]->mNumBones == 0) continue;
        if (std::optional<Skin> skin = skin_from(*scene_.mMeshes[i], node_named_, into_.meshes[i])) {
            skin_of_mesh[i] = static_cast<int>(into_.skins.size());
            into_.skins.push_back(std::move(*skin));
        } else {
            into_.notes.push_back("mesh \"" + into_.meshes[i].name +
                                  "\": its bones name no node, so that it stands still");
        }
    }

    for (std::size_t n = 0; n < source_of_node_.size(); ++n) {
        const aiNode* source = source_of_node_[n];
        for (unsigned k = 0; source && k < source->mNumMeshes; ++k) {
            const unsigned m = source->mMeshes[k];
            const aiMesh& mesh = *scene_.mMeshes[m];
            Object object;
            object.name = into_.nodes[n].name.empty() ? into_.meshes[m].name : into_.nodes[n].name;
            object.node = static_cast<int>(n);
            object.mesh = static_cast<int>(m);
            object.material = static_cast<int>(std::min<std::size_t>(mesh.mMaterialIndex, into_.materials.size() - 1));
            object.skin = skin_of_mesh[m];
            if (!into_.meshes[m].morph_targets.empty())
                for (unsigned i = 0; i < mesh.mNumAnimMeshes && i < into_.meshes[m].morph_targets.size(); ++i)
                    object.morph_weights.push_back(mesh.mAnimMeshes[i]->mWeight);
            into_.objects.push_back(std::move(object));
        }
    }
}

void SceneReader::read_animations() {
    if (scene_.mNumAnimations == 0) {
        if (options_.animation)
            throw core::Error("reading", file_.string(), "has no animation \"" + *options_.animation + "\"");
        return;
    }
    std::string names;
    bool found = false;
    std::vector<unsigned> others;
    const auto read_take = [&](unsigned i) {
        const aiAnimation& animation = *scene_.mAnimations[i];
        // 0: not said; Assimp's own viewers take 25.
        const double ticks = animation.mTicksPerSecond > 0 ? animation.mTicksPerSecond : 25;
        for (unsigned c = 0; c < animation.mNumChannels; ++c)
            read_channel(*animation.mChannels[c], ticks, animation.mName.C_Str());
        for (unsigned c = 0; c < animation.mNumMorphMeshChannels; ++c)
            read_morphing(*animation.mMorphMeshChannels[c], ticks);
    };
    for (unsigned i = 0; i < scene_.mNumAnimations; ++i) {
        const aiAnimation& animation = *scene_.mAnimations[i];
        const std::string name = animation.mName.C_Str();
        names += (i ? ", " : "") + std::string("\"") + name + "\"";
        if (options_.animation && *options_.animation != name && *options_.animation != std::to_string(i)) continue;
        found = true;
        if (is_own_take(name))
            read_take(i);
        else
            others.push_back(i);
    }
    for (const unsigned i : others) read_take(i);
    if (!found)
        throw core::Error("reading", file_.string(), "has no animation \"" + *options_.animation + "\", but " + names);
}

/// FBX is baked frame by frame: the last key is a frame too.
void SceneReader::keep_last_key() {
    float least = 0, last = 0;
    for (const Track& track : into_.tracks)
        for (std::size_t k = 1; k < track.times.size(); ++k) {
            const float step = track.times[k] - track.times[k - 1];
            if (step > 0 && (least == 0 || step < least)) least = step;
            last = std::max(last, track.times[k]);
        }
    if (!(least > 0)) return;
    for (const char* name : {"24", "25", "30", "23.976", "29.97", "50", "60", "59.94"}) {
        const double rate = core::frame_rate_from(name).hertz.value(), frame = static_cast<double>(last) * rate;
        if (std::abs(static_cast<double>(least) * rate - 1) > 5e-4 || std::abs(frame - std::round(frame)) > 2e-2)
            continue;
        into_.frame_rate = name;
        into_.first_frame = 0;
        into_.last_frame = std::llround(frame);
        return;
    }
}

/// Blender's COLLADA leaves the armature's transform out of bind poses: restored where joints then agree with the rest
/// pose.
void SceneReader::place_armatures() {
    std::set<int> placed;
    for (const Object& object : into_.objects) {
        const int parent = object.node < 0 ? -1 : into_.nodes[static_cast<std::size_t>(object.node)].parent;
        if (object.skin < 0 || parent < 0 || !placed.insert(object.skin).second) continue;
        Skin& skin = into_.skins[static_cast<std::size_t>(object.skin)];
        if (skin.joints.empty()) continue;
        const auto bound = [&](std::size_t k) {
            return to_world_[static_cast<std::size_t>(skin.joints[k])] * skin.inverse_bind[k];
        };
        const glm::dmat4 shape = bound(0);
        bool agree = true;
        for (std::size_t k = 1; k < skin.joints.size(); ++k)
            for (int c = 0; c < 4; ++c)
                // chosen: a thousandth, what exporters round to; joints in another pose are off by far more.
                agree = agree && glm::length(bound(k)[c] - shape[c]) <= 1e-3 * (1 + glm::length(shape[c]));
        if (!agree) {
            note_once(into_,
                      "skinned meshes stand where the file's bind poses put them: Blender leaves their armature's "
                      "place out");
            continue;
        }
        const glm::dmat4 armature = to_world_[static_cast<std::size_t>(parent)] * glm::inverse(to_world_.front());
        for (std::size_t k = 0; k < skin.joints.size(); ++k)
            skin.inverse_bind[k] = glm::inverse(to_world_[static_cast<std::size_t>(skin.joints[k])]) * armature * shape;
    }
}

void SceneReader::read_channel(const aiNodeAnim& channel, double ticks, const std::string& name) {
    const auto node = node_named_.find(channel.mNodeName.C_Str());
    if (node == node_named_.end()) return;
    const int index = node->second;
    const auto [first, is_new] = moved_by_.emplace(index, name);
    if (!is_new) {
        if (first->second != name)
            note_once(into_, "animations " + in_quotes(first->second) + " and " + in_quotes(name) +
                                 " move the same nodes; there the first is used (--animation)");
        return;
    }
    Node& moved = into_.nodes[static_cast<std::size_t>(index)];
    separate(moved);
    for (Track& track : tracks_from(channel, index, ticks)) into_.tracks.push_back(std::move(track));
}

void SceneReader::read_morphing(const aiMeshMorphAnim& channel, double ticks) {
    // Named after the node, or the mesh, followed by '*' and a number.
    std::string name = channel.mName.C_Str();
    if (const auto star = name.rfind('*'); star != std::string::npos) name.resize(star);
    for (const Object& object : into_.objects) {
        const Mesh& mesh = into_.meshes[static_cast<std::size_t>(object.mesh)];
        if ((object.name != name && mesh.name != name) || mesh.morph_targets.empty()) continue;
        Track track = weights_from(channel, object.node, mesh.morph_targets.size(), ticks);
        if (!track.times.empty()) into_.tracks.push_back(std::move(track));
        return;
    }
}

int SceneReader::add_child(const std::string& name, glm::dvec3 position, glm::dquat rotation) {
    const auto parent = node_named_.find(name);
    Node node;
    node.name = name + " (as placed)";
    node.parent = parent == node_named_.end() ? 0 : parent->second;
    node.translation = position;
    node.rotation = rotation;
    // 3DS repeats the node's place in its tracks.
    if (format_ == "3ds" && parent != node_named_.end()) {
        const Node& own = into_.nodes[static_cast<std::size_t>(parent->second)];
        const glm::dvec3 there = own.matrix ? glm::dvec3((*own.matrix)[3]) : own.translation;
        if (glm::length(there - node.translation) < 1e-3 * (1 + glm::length(there))) node.translation = glm::dvec3(0);
    }
    into_.nodes.push_back(std::move(node));
    return static_cast<int>(into_.nodes.size()) - 1;
}

/// Blender's exporters of FBX and COLLADA write strengths in its own units.
bool SceneReader::is_of_blender() const {
    aiString generator;
    return scene_.mMetaData != nullptr && scene_.mMetaData->Get("SourceAsset_Generator", generator) &&
           std::string_view(generator.C_Str()).starts_with("Blender");
}

void SceneReader::read_lights(const RestBounds& bounds) {
    bool reduced = false;
    const bool blender = is_of_blender();
    for (unsigned i = 0; i < scene_.mNumLights; ++i) {
        const aiLight& source = *scene_.mLights[i];
        const std::string name = source.mName.C_Str();
        ClassicLight classic;
        if (source.mType == aiLightSource_SPOT) classic.kind = LightKind::spot;
        if (source.mType == aiLightSource_DIRECTIONAL) classic.kind = LightKind::directional;
        if (source.mType != aiLightSource_POINT && classic.kind == LightKind::point) {
            into_.notes.push_back("light \"" + name + "\": neither point, spot nor directional; left out");
            continue;
        }
        classic.color = {source.mColorDiffuse.r, source.mColorDiffuse.g, source.mColorDiffuse.b};
        classic.constant = source.mAttenuationConstant;
        classic.linear = source.mAttenuationLinear;
        classic.quadratic = source.mAttenuationQuadratic;
        classic.inner_angle = source.mAngleInnerCone;
        classic.outer_angle = source.mAngleOuterCone;
        const glm::dvec3 position = dvec3_of(source.mPosition);
        const int node = add_child(name, position, turn_towards(dvec3_of(source.mDirection), dvec3_of(source.mUp)));

        // chosen: matched at the scene's middle, or, inside the scene, a quarter of its diagonal away, so that a lamp
        // in a room lights its walls as the file says, whatever the unit.
        const auto parent = static_cast<std::size_t>(into_.nodes[static_cast<std::size_t>(node)].parent);
        const glm::dvec3 there(to_world_[parent] * glm::dvec4(position, 1));
        const double distance = std::max(glm::length(there - bounds.center()), 0.25 * bounds.diagonal());
        Light light = blender ? blender_light(classic) : physical_light(classic, distance > 0 ? distance : 1);
        light.name = name;
        light.node = node;
        reduced = reduced || (!blender && !falls_off_physically(classic));
        into_.lights.push_back(light);
    }
    if (reduced)
        into_.notes.push_back(
            "lights without inverse square falloff were given it, as bright as before at the scene's middle");
}

/// Blender's COLLADA scales strengths above 1 down to 1.
void SceneReader::tell_dimmed() {
    for (const Material& material : into_.materials) {
        const glm::vec3 e = material.emission;
        if (std::max({e.r, e.g, e.b}) != 1) continue;
        into_.notes.push_back("material \"" + material.name +
                              "\" shines with 1, where Blender's COLLADA ends: it may have been brighter in Blender, "
                              "and glTF (.glb) keeps it");
        return;
    }
}

void SceneReader::read_cameras() {
    for (unsigned i = 0; i < scene_.mNumCameras; ++i) {
        const aiCamera& source = *scene_.mCameras[i];
        ClassicCamera classic;
        classic.horizontal_angle = source.mHorizontalFOV;
        classic.aspect = source.mAspect;
        classic.half_width = source.mOrthographicWidth;
        glm::dvec3 up = dvec3_of(source.mUp);
        // Assimp takes 3DS's focal length (mm on 36 mm film) for degrees, and its +z up for +y.
        if (format_ == "3ds") {
            const double millimetres = glm::degrees(classic.horizontal_angle);
            classic.horizontal_angle = millimetres > 0 ? 2 * std::atan(18.0 / millimetres) : 0;
            up = {0, 0, 1};
        }
        // Clip planes of modellers' viewports would cut the picture.
        CameraLens lens = lens_of(classic);
        lens.name = source.mName.C_Str();
        lens.node = add_child(lens.name, dvec3_of(source.mPosition), turn_towards(dvec3_of(source.mLookAt), up));
        into_.cameras.push_back(lens);
    }
}

}  // namespace

Animation load_with_assimp(const fs::path& file, const LoadOptions& options) {
    Animation animation;
    animation.source = file.string();
    if (!fs::is_regular_file(file)) throw core::Error("reading", file.string(), "no such file");
    const fs::path folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();

    Assimp::Importer importer;
    importer.SetIOHandler(new FolderOnly(folder, animation));  // the importer owns it
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    importer.SetPropertyInteger(AI_CONFIG_PP_LBW_MAX_WEIGHTS, 8);
    // chosen: 45 degrees keeps boxes flat and makes scanned and turned shapes smooth where a file has no normals.
    importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 45.0f);

    const auto refuse = [&](const std::string& cause) { throw core::Error("reading", file.string(), cause); };
    const aiScene* scene = importer.ReadFile(file.string(), 0);
    // std::bad_alloc is no message.
    if (!scene && std::string_view(importer.GetErrorString()) == "std::bad_alloc") throw std::bad_alloc();
    if (!scene && std::string_view(importer.GetErrorString()).starts_with("No suitable reader"))
        refuse(
            "it is no kind of scene that is known: .blend, .glb, .gltf, .usd, .abc, .fbx, .obj and what else Assimp "
            "reads");
    if (!scene) {
        std::string words = importer.GetErrorString();
        while (words.ends_with('.') || words.ends_with(' ')) words.pop_back();
        refuse("it is damaged, or is not what its name says (" + words + ")");
    }
    if (!scene->mRootNode || scene->mNumMeshes == 0) refuse("has no mesh");
    refuse_unsound_meshes(*scene, file.string());
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_GenSmoothNormals |
                                         aiProcess_GenUVCoords | aiProcess_LimitBoneWeights |
                                         aiProcess_JoinIdenticalVertices | aiProcess_FlipUVs);
    if (!scene) refuse(importer.GetErrorString());
    if (scene->mNumMeshes == 0) refuse("has points or lines, but no triangle");

    SceneReader(*scene, file, options, animation).read();
    return animation;
}

}  // namespace render2mpeg::scene
