#include "scene/assimp/parts.h"

#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "core/text.h"
#include "scene/assimp/classic_shading.h"
#include "scene/assimp/rest_pose.h"
#include "scene/model/png.h"

namespace render2mpeg::scene {
namespace {

glm::vec3 vec3_of(const aiVector3D& v) {
    return {v.x, v.y, v.z};
}

void read_morphs(const aiMesh& source, Mesh& mesh) {
    for (unsigned i = 0; i < source.mNumAnimMeshes; ++i) {
        const aiAnimMesh& shape = *source.mAnimMeshes[i];
        MorphTarget target;
        if (shape.mNumVertices != source.mNumVertices) continue;
        for (unsigned v = 0; shape.mVertices && v < shape.mNumVertices; ++v)
            target.positions.push_back(vec3_of(shape.mVertices[v] - source.mVertices[v]));
        for (unsigned v = 0; shape.mNormals && source.mNormals && v < shape.mNumVertices; ++v)
            target.normals.push_back(vec3_of(shape.mNormals[v]) - mesh.normals[v]);
        mesh.morph_targets.push_back(std::move(target));
    }
}

core::Wrap wrap_of(int mode) {
    if (mode == aiTextureMapMode_Mirror) return core::Wrap::mirrored_repeat;
    if (mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal) return core::Wrap::clamp_to_edge;
    return core::Wrap::repeat;
}

/// Assimp scales, then turns about (0.5, 0.5), then shifts, all with v already pointing down (aiProcess_FlipUVs).
void set_transform(const aiUVTransform& t, TextureUse& use) {
    const double c = std::cos(t.mRotation), s = std::sin(t.mRotation);
    const double m[2][2] = {{c * t.mScaling.x, -s * t.mScaling.y}, {s * t.mScaling.x, c * t.mScaling.y}};
    const double shift[2] = {0.5 - 0.5 * c + 0.5 * s + t.mTranslation.x, 0.5 - 0.5 * s - 0.5 * c + t.mTranslation.y};
    for (int r = 0; r < 2; ++r) {
        for (int k = 0; k < 2; ++k) use.transform[r][k] = static_cast<float>(m[r][k]);
        use.transform[r][2] = static_cast<float>(shift[r]);
    }
}

glm::vec3 color_or(const aiMaterial& m, const char* key, glm::vec3 otherwise) {
    aiColor3D c;
    return m.Get(key, 0, 0, c) == aiReturn_SUCCESS ? glm::vec3(c.r, c.g, c.b) : otherwise;
}

float number_or(const aiMaterial& m, const char* key, float otherwise) {
    ai_real x = 0;
    return m.Get(key, 0, 0, x) == aiReturn_SUCCESS && std::isfinite(x) ? static_cast<float>(x) : otherwise;
}

bool has_bump_that_is_a_normal_map(const std::string& file) {
    const std::string name = core::lower_case(file);
    for (const char* sign : {"normal", "_nrm", "_nor.", "_ddn", "_nm."})
        if (name.find(sign) != std::string::npos) return true;
    return false;
}

}  // namespace

/// Assimp's later steps trust indices and coordinates.
void refuse_unsound_meshes(const aiScene& scene, const std::string& file) {
    for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
        const aiMesh& mesh = *scene.mMeshes[m];
        const std::string object = "mesh \"" + std::string(mesh.mName.C_Str()) + "\"";
        if (mesh.mMaterialIndex >= std::max(1u, scene.mNumMaterials))
            throw core::Error("reading", file, object, "names a material that is not there");
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            const aiVector3D& p = mesh.mVertices[v];
            if (!core::is_finite(glm::vec3(p.x, p.y, p.z)))
                throw core::Error("reading", file, object,
                                  "vertex " + std::to_string(v) + " has a coordinate that is no finite number");
        }
        for (unsigned f = 0; f < mesh.mNumFaces; ++f)
            for (unsigned k = 0; k < mesh.mFaces[f].mNumIndices; ++k)
                if (mesh.mFaces[f].mIndices[k] >= mesh.mNumVertices)
                    throw core::Error("reading", file, object,
                                      "face " + std::to_string(f) + " names vertex " +
                                          std::to_string(mesh.mFaces[f].mIndices[k]) + " of " +
                                          std::to_string(mesh.mNumVertices));
    }
}

Mesh mesh_from(const aiMesh& source) {
    Mesh mesh;
    mesh.name = source.mName.C_Str();
    for (unsigned f = 0; f < source.mNumFaces; ++f) {
        const aiFace& face = source.mFaces[f];
        if (face.mNumIndices == 3) mesh.triangles.emplace_back(face.mIndices[0], face.mIndices[1], face.mIndices[2]);
    }
    for (unsigned v = 0; v < source.mNumVertices; ++v) mesh.positions.push_back(vec3_of(source.mVertices[v]));
    for (unsigned v = 0; source.mNormals && v < source.mNumVertices; ++v)
        mesh.normals.push_back(vec3_of(source.mNormals[v]));
    for (unsigned set = 0; set < 2; ++set)
        for (unsigned v = 0; source.mTextureCoords[set] && v < source.mNumVertices; ++v)
            mesh.uv[set].emplace_back(source.mTextureCoords[set][v].x, source.mTextureCoords[set][v].y);

    // Vertex colours of scans and modellers are what the screen shows.
    for (unsigned v = 0; source.mColors[0] && v < source.mNumVertices; ++v) {
        const aiColor4D& c = source.mColors[0][v];
        const auto linear = [](float x) { return core::srgb_to_linear(std::clamp(x, 0.0f, 1.0f)); };
        mesh.colors.emplace_back(linear(c.r), linear(c.g), linear(c.b), std::clamp(c.a, 0.0f, 1.0f));
    }
    read_morphs(source, mesh);
    return mesh;
}

int MaterialReader::image_named(const std::string& written, Animation& into) {
    if (const auto known = image_of_.find(written); known != image_of_.end()) return known->second;
    int& index = image_of_[written];
    index = -1;
    ImageSource image;
    image.name = written;

    // Embedded in the scene's file: compressed bytes, or plain texels, which become a PNG.
    if (const aiTexture* embedded = scene_.GetEmbeddedTexture(written.c_str())) {
        if (embedded->mHeight == 0) {
            const auto* bytes = reinterpret_cast<const std::byte*>(embedded->pcData);
            image.bytes.assign(bytes, bytes + embedded->mWidth);
        } else {
            std::vector<glm::u8vec4> texels;
            for (std::size_t i = 0; i < std::size_t{embedded->mWidth} * embedded->mHeight; ++i) {
                const aiTexel& t = embedded->pcData[i];
                texels.emplace_back(t.r, t.g, t.b, t.a);
            }
            image.bytes = encode_png(static_cast<int>(embedded->mWidth), static_cast<int>(embedded->mHeight), texels);
        }
    } else if (const auto found = finder_.find(written)) {
        image.path = *found;
    } else {
        into.notes.push_back("image \"" + written +
                             "\" is not in the scene's folder: the plain colour is shown instead");
        return index;
    }
    index = static_cast<int>(into.images.size());
    into.images.push_back(std::move(image));
    return index;
}

TextureUse MaterialReader::texture_from(const aiMaterial& source, int type_number, Animation& into) {
    const auto type = static_cast<aiTextureType>(type_number);
    TextureUse use;
    aiString path;
    if (source.Get(AI_MATKEY_TEXTURE(type, 0), path) != aiReturn_SUCCESS || path.length == 0) return use;
    use.image = image_named(path.C_Str(), into);
    if (!use.present()) return use;
    int uv_set = 0, mode_u = 0, mode_v = 0;
    source.Get(AI_MATKEY_UVWSRC(type, 0), uv_set);
    source.Get(AI_MATKEY_MAPPINGMODE_U(type, 0), mode_u);
    source.Get(AI_MATKEY_MAPPINGMODE_V(type, 0), mode_v);
    use.uv_set = uv_set == 1 ? 1 : 0;
    use.wrap_u = wrap_of(mode_u);
    use.wrap_v = wrap_of(mode_v);
    aiUVTransform transform;
    if (source.Get(AI_MATKEY_UVTRANSFORM(type, 0), transform) == aiReturn_SUCCESS) set_transform(transform, use);
    return use;
}

void MaterialReader::read_textures(const aiMaterial& source, Material& material, Animation& into) {
    const auto first_of = [&](std::initializer_list<aiTextureType> types) {
        for (const aiTextureType type : types)
            if (const TextureUse use = texture_from(source, type, into); use.present()) return use;
        return TextureUse{};
    };
    material.base_color_texture = first_of({aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE});
    material.emission_texture = first_of({aiTextureType_EMISSION_COLOR, aiTextureType_EMISSIVE});
    material.normal_texture = first_of({aiTextureType_NORMALS, aiTextureType_NORMAL_CAMERA});

    // Heights would have to become normals; many exporters put normal maps here.
    aiString height;
    if (!material.normal_texture.present() && source.Get(AI_MATKEY_TEXTURE_HEIGHT(0), height) == aiReturn_SUCCESS) {
        ai_real strength = 1;
        source.Get(AI_MATKEY_TEXBLEND_HEIGHT(0), strength);
        if (has_bump_that_is_a_normal_map(height.C_Str()))
            material.normal_texture = texture_from(source, aiTextureType_HEIGHT, into);
        else if (strength > 0 && !bumps_said_) {
            into.notes.push_back("height maps (\"" + std::string(height.C_Str()) +
                                 "\", ...) are not shown, only normal maps");
            bumps_said_ = true;
        }
    }

    // A factor of 0 beside a texture usually means "see the texture"; 3DS's maps replace the colour.
    if (material.base_color_texture.present() && material.transmission == 0) {
        ai_real amount = 1;
        source.Get(AI_MATKEY_TEXBLEND_DIFFUSE(0), amount);
        const glm::vec3 factor(material.base_color);
        const bool black = factor == glm::vec3(0);
        const glm::vec3 shown =
            format_ == "3ds" ? glm::mix(factor, glm::vec3(1), std::clamp(float(amount), 0.0f, 1.0f)) : factor;
        material.base_color = glm::vec4(black ? glm::vec3(1) : shown, material.base_color.a);
    }
    if (material.emission_texture.present() && material.emission == glm::vec3(0)) material.emission = glm::vec3(1);

    // Coverage. chosen: cut-outs (mask) where a map says what is there, since such maps are foliage, chains and grids;
    // the edge is the sample's business.
    if (const TextureUse coverage = texture_from(source, aiTextureType_OPACITY, into); coverage.present()) {
        if (coverage.image != material.base_color_texture.image) material.alpha_texture = coverage;
        material.alpha_mode = AlphaMode::mask;
    }
}

Material MaterialReader::material_from(const aiMaterial& source, Animation& into) {
    Material material;
    aiString name;
    if (source.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) material.name = name.C_Str();

    PhongLook look;
    look.diffuse = color_or(source, "$clr.base", color_or(source, "$clr.diffuse", glm::vec3(0.6f)));
    look.specular = color_or(source, "$clr.specular", glm::vec3(0)) * number_or(source, "$mat.shinpercent", 1);
    look.exponent = number_or(source, "$mat.shininess", 0);
    look.emission = color_or(source, "$clr.emissive", glm::vec3(0)) * number_or(source, "$mat.emissiveIntensity", 1);
    look.opacity = number_or(source, "$mat.opacity", 1);
    look.filter = color_or(source, "$clr.transparent", glm::vec3(1));
    look.ior = number_or(source, "$mat.refracti", 1);
    look.metallic = number_or(source, "$mat.metallicFactor", -1);
    look.roughness = number_or(source, "$mat.roughnessFactor", -1);
    look.reflectivity = number_or(source, "$mat.reflectivity", 0);
    look.reflection = color_or(source, "$clr.reflective", glm::vec3(-1));
    int model = -1;
    if (source.Get("$mat.illum", 0, 0, model) == aiReturn_SUCCESS) look.illumination_model = model;
    apply(look, material);

    // These formats know no back faces, and wind at random.
    material.double_sided = true;
    int shading = 0;
    if (source.Get(AI_MATKEY_SHADING_MODEL, shading) == aiReturn_SUCCESS && shading == aiShadingMode_Unlit)
        material.unlit = true;
    read_textures(source, material, into);
    return material;
}

namespace {

/// Appends keys in rising order; of keys at one instant the last counts.
template <class Value>
void append_key(Track& track, double seconds, const Value& values) {
    const auto time = static_cast<float>(seconds);
    if (!std::isfinite(time)) return;
    if (!track.times.empty() && time < track.times.back()) return;
    if (!track.times.empty() && time == track.times.back())
        track.values.resize(track.values.size() - static_cast<std::size_t>(track.width));
    else
        track.times.push_back(time);
    track.values.insert(track.values.end(), values.begin(), values.end());
}

}  // namespace

glm::dvec3 dvec3_of(const aiVector3D& v) {
    return {v.x, v.y, v.z};
}

glm::dmat4 dmat4_of(const aiMatrix4x4& m) {
    glm::dmat4 out;
    for (unsigned r = 0; r < 4; ++r)
        for (unsigned c = 0; c < 4; ++c) out[static_cast<int>(c)][static_cast<int>(r)] = m[r][c];
    return out;
}

std::optional<Skin> skin_from(const aiMesh& source, const std::unordered_map<std::string, int>& node_named,
                              Mesh& mesh) {
    Skin skin;
    mesh.joints.assign(mesh.positions.size(), VertexJoints{});
    for (unsigned b = 0; b < source.mNumBones; ++b) {
        const aiBone& bone = *source.mBones[b];
        const auto node = node_named.find(bone.mName.C_Str());
        if (node == node_named.end() || skin.joints.size() >= 65535) continue;
        const auto joint = static_cast<std::uint16_t>(skin.joints.size());
        skin.joints.push_back(node->second);
        skin.inverse_bind.push_back(dmat4_of(bone.mOffsetMatrix));
        for (unsigned w = 0; w < bone.mNumWeights; ++w) {
            const aiVertexWeight& weight = bone.mWeights[w];
            if (weight.mVertexId >= mesh.joints.size() || !(weight.mWeight > 0)) continue;
            VertexJoints& v = mesh.joints[weight.mVertexId];
            const auto free = std::find(v.weight.begin(), v.weight.end(), 0.0f);
            if (free == v.weight.end()) continue;
            v.joint[static_cast<std::size_t>(free - v.weight.begin())] = joint;
            *free = weight.mWeight;
        }
    }
    if (!skin.joints.empty()) return skin;
    mesh.joints.clear();
    return std::nullopt;
}

std::vector<Track> tracks_from(const aiNodeAnim& channel, int node, double ticks_per_second) {
    std::vector<Track> tracks(3);
    constexpr std::array targets{TrackTarget::translation, TrackTarget::rotation, TrackTarget::scale};
    for (std::size_t i = 0; i < tracks.size(); ++i) {
        tracks[i].target = targets[i];
        tracks[i].index = node;
        tracks[i].width = targets[i] == TrackTarget::rotation ? 4 : 3;
    }
    const auto add_vector = [&](Track& track, const aiVectorKey& key) {
        append_key(track, key.mTime / ticks_per_second, std::array<float, 3>{key.mValue.x, key.mValue.y, key.mValue.z});
    };
    for (unsigned k = 0; k < channel.mNumPositionKeys; ++k) add_vector(tracks[0], channel.mPositionKeys[k]);
    for (unsigned k = 0; k < channel.mNumScalingKeys; ++k) add_vector(tracks[2], channel.mScalingKeys[k]);
    for (unsigned k = 0; k < channel.mNumRotationKeys; ++k) {
        const aiQuatKey& key = channel.mRotationKeys[k];
        const glm::quat q(key.mValue.w, key.mValue.x, key.mValue.y, key.mValue.z);
        const float length = glm::length(q);
        if (!(length > 1e-6f) || !std::isfinite(length)) continue;
        append_key(tracks[1], key.mTime / ticks_per_second,
                   std::array<float, 4>{q.x / length, q.y / length, q.z / length, q.w / length});
    }
    std::erase_if(tracks, [](const Track& track) { return track.times.empty(); });
    return tracks;
}

Track weights_from(const aiMeshMorphAnim& channel, int node, std::size_t targets, double ticks_per_second) {
    Track track;
    track.target = TrackTarget::weights;
    track.index = node;
    track.width = static_cast<int>(targets);
    for (unsigned k = 0; k < channel.mNumKeys; ++k) {
        const aiMeshMorphKey& key = channel.mKeys[k];
        std::vector<float> weights(targets, 0.0f);
        for (unsigned i = 0; i < key.mNumValuesAndWeights; ++i)
            if (key.mValues[i] < weights.size()) weights[key.mValues[i]] = static_cast<float>(key.mWeights[i]);
        append_key(track, key.mTime / ticks_per_second, weights);
    }
    return track;
}

}  // namespace render2mpeg::scene
