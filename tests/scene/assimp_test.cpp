#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/gtc/constants.hpp>
#include <map>
#include <string>

#include "core/error.h"
#include "core/sampling.h"
#include "scene/assimp/classic_shading.h"
#include "scene/assimp/load.h"
#include "scene/assimp/rest_pose.h"
#include "scene/pose/snapshot.h"
#include "scene/preparation/complete.h"
#include "tests/support/places.h"

namespace render2mpeg::scene {
namespace {

namespace fs = std::filesystem;

class Assimp : public ::testing::Test {
  protected:
    Assimp() {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::path(::testing::TempDir()) / (std::string("r2m_assimp_") + test->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    ~Assimp() override { fs::remove_all(folder_); }

    void write(const std::string& name, const std::string& content) const {
        fs::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name, std::ios::binary) << content;
    }
    Animation read(const std::string& name, const std::string& content) const {
        write(name, content);
        return load_with_assimp(folder_ / name, {});
    }
    /// A square of one material whose library has these lines.
    Material material(const std::string& lines) const {
        write("m.mtl", "newmtl m\n" + lines + "\n");
        const Animation a = read("m.obj", square);
        return a.materials[static_cast<std::size_t>(a.objects.at(0).material)];
    }
    std::string complaint(const std::string& name, const std::string& content) const {
        try {
            Animation a = read(name, content);
            complete(a);
        } catch (const core::Error& e) {
            EXPECT_NE(std::string(e.what()).find(name), std::string::npos) << e.what();
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
            return e.what();
        }
        return "";
    }

    static constexpr const char* square =
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 "
        "4/4\n";
    fs::path folder_;
};

std::size_t triangles(const Animation& a) {
    std::size_t count = 0;
    for (const Object& object : a.objects) count += a.meshes[static_cast<std::size_t>(object.mesh)].triangles.size();
    return count;
}

bool noted(const Animation& a, const std::string& words) {
    for (const std::string& note : a.notes)
        if (note.find(words) != std::string::npos) return true;
    return false;
}

TEST_F(Assimp, TriangulatesPolygonsAndTurnsTextureCoordinatesDown) {
    write("m.mtl", "newmtl m\nKd 0.2 0.4 0.6\n");
    const Animation a = read("m.obj", square);
    EXPECT_EQ(triangles(a), 2u);
    const Mesh& mesh = a.meshes[0];
    ASSERT_EQ(mesh.positions.size(), 4u);  // corners are shared
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(mesh.uv[0][i].x, mesh.positions[i].x);
        EXPECT_EQ(mesh.uv[0][i].y, 1 - mesh.positions[i].y);
        EXPECT_EQ(mesh.normals[i], glm::vec3(0, 0, 1));
    }
    EXPECT_EQ(glm::vec3(a.materials[static_cast<std::size_t>(a.objects[0].material)].base_color),
              glm::vec3(0.2f, 0.4f, 0.6f));
}

TEST_F(Assimp, OursTinyObjHasItsPartsMaterialsAndTexture) {
    Animation a = load_with_assimp(support::source_folder() / "tests/scene/assimp_house/house.obj", {});
    EXPECT_EQ(triangles(a), 16u);
    ASSERT_EQ(a.objects.size(), 3u);
    EXPECT_EQ(a.images.size(), 1u);
    EXPECT_TRUE(a.notes.empty());
    complete(a);
    EXPECT_NEAR(a.bounds_max.y, 1.5, 1e-6);
}

TEST_F(Assimp, MattMaterialsHaveNoHighlight) {
    const Material m = material("Kd 0.5 0.4 0.3\nKs 0 0 0\nNs 50");
    EXPECT_TRUE(m.specular_glossiness);
    EXPECT_EQ(m.specular, glm::vec3(0));
    EXPECT_EQ(m.alpha_mode, AlphaMode::opaque);
    EXPECT_EQ(m.transmission, 0);
    EXPECT_TRUE(m.double_sided);
}

TEST_F(Assimp, HighlightsOfPaintBecomeDielectricsAndThoseOfMetalStay) {
    const Material paint = material("Kd 0.5 0.5 0.5\nKs 0.9 0.9 0.9\nNs 40");
    EXPECT_GE(paint.specular.x, 0.04f);
    EXPECT_LE(paint.specular.x, 0.08f);
    EXPECT_NEAR(1 - paint.glossiness, std::sqrt(std::sqrt(2.0 / 42.0)), 1e-5);
    const Material varnish = material("Kd 0.5 0.5 0.5\nKs 0.03 0.03 0.03\nNs 40");
    EXPECT_FLOAT_EQ(varnish.specular.x, 0.03f);
    const Material steel = material("Kd 0.1 0.1 0.1\nKs 0.8 0.7 0.6\nNs 200");
    EXPECT_EQ(steel.specular, glm::vec3(0.8f, 0.7f, 0.6f));
    // A higher exponent is a smoother surface.
    EXPECT_GT(steel.glossiness, paint.glossiness);
}

TEST_F(Assimp, IlluminationModelsSayMirrorAndGlass) {
    const Material mirror = material("Kd 0 0 0\nKs 0.9 0.9 0.9\nNs 100\nillum 5");
    EXPECT_EQ(mirror.specular, glm::vec3(0.9f));
    EXPECT_EQ(mirror.glossiness, 1);
    const Material glass = material("Kd 0 0 0\nKs 0.1 0.1 0.1\nNi 1.33\nTf 0.5 1 0.5\nillum 7");
    EXPECT_EQ(glass.transmission, 1);
    EXPECT_FLOAT_EQ(glass.ior, 1.33f);
    EXPECT_EQ(glm::vec3(glass.base_color), glm::vec3(0.5f, 1, 0.5f));
    EXPECT_EQ(glass.roughness, 0);
    EXPECT_EQ(glass.thickness, Thickness::solid_where_closed);
    EXPECT_EQ(material("Kd 0 0 0\nNi 1.5\nillum 4").thickness, Thickness::thin);
    EXPECT_EQ(material("Kd 0 0 0\nNi 1.5\nd 0.05").thickness, Thickness::solid_where_closed);
    EXPECT_EQ(glass.alpha_mode, AlphaMode::opaque);
    const Material opaque = material("Kd 0.5 0.5 0.5\nNi 1.5\nillum 2");
    EXPECT_EQ(opaque.transmission, 0);
}

TEST_F(Assimp, PhysicallyBasedMtlIsTakenAsItIs) {
    const Material m = material("Kd 0.5 0.5 0.5\nPm 1\nPr 0.25");
    EXPECT_FALSE(m.specular_glossiness);
    EXPECT_EQ(m.metallic, 1);
    EXPECT_EQ(m.roughness, 0.25f);
}

TEST_F(Assimp, AMissingLibraryIsToldOnce) {
    const Animation a = read("alone.obj", square);
    EXPECT_TRUE(noted(a, "there is no file \"m.mtl\", which says what surfaces look like"));
    EXPECT_EQ(a.notes.size(), 1u);
    EXPECT_EQ(a.files.size(), 1u);
}

TEST(Phong, ReflectionInTheSurfacesOwnColourIsMetal) {
    PhongLook look;
    look.diffuse = look.reflection = {1, 0.8f, 0.3f};
    look.roughness = 0.3f;
    look.reflectivity = 0.75f;
    Material material;
    apply(look, material);
    EXPECT_FLOAT_EQ(material.metallic, 0.75f);
    look.reflection = glm::vec3(1);
    apply(look, material);
    EXPECT_EQ(material.metallic, 0);
}

TEST_F(Assimp, DissolveBlendsAndMapsOfItCutOut) {
    const Material veil = material("Kd 0.5 0.5 0.5\nd 0.25");
    EXPECT_EQ(veil.alpha_mode, AlphaMode::blend);
    EXPECT_EQ(veil.base_color.a, 0.25f);
    write("leaf.png", "x");
    write("leaf_mask.png", "x");
    const Material leaf = material("Kd 1 1 1\nmap_Kd leaf.png\nmap_d leaf_mask.png");
    EXPECT_EQ(leaf.alpha_mode, AlphaMode::mask);
    EXPECT_TRUE(leaf.alpha_texture.present());
    EXPECT_NE(leaf.alpha_texture.image, leaf.base_color_texture.image);
    const Material own = material("Kd 1 1 1\nmap_Kd leaf.png\nmap_d leaf.png");
    EXPECT_EQ(own.alpha_mode, AlphaMode::mask);
    EXPECT_FALSE(own.alpha_texture.present());
}

TEST_F(Assimp, LampsShineIntoTheSceneFromOneSide) {
    const std::string room =
        "mtllib m.mtl\nv 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nv 1 3 1\nv 2 3 1\nv 2 3 2\nv 1 3 2\nusemtl floor\nf 4 3 2 "
        "1\nusemtl lamp\n";
    write("m.mtl", "newmtl floor\nKd 1 1 1\nnewmtl lamp\nKe 17 12 4\n");
    const auto lamp = [&](const char* face) {
        const Animation a = read("m.obj", room + face);
        for (const Material& m : a.materials)
            if (m.emits()) return m;
        return Material{};
    };
    EXPECT_EQ(lamp("f 5 6 7 8\n").emission, glm::vec3(17, 12, 4));
    EXPECT_FALSE(lamp("f 5 6 7 8\n").double_sided);  // winds downwards
    EXPECT_TRUE(lamp("f 8 7 6 5\n").double_sided);   // winds upwards, away from everything
}

TEST_F(Assimp, FindsImagesAsOldMachinesNamedThem) {
    write("textures/Wood.PNG", "x");
    write("mramor-floor.jpg", "x");
    write("mramor-floor-bump.jpg", "x");
    const auto image = [&](const std::string& named) {
        write("m.mtl", "newmtl m\nKd 1 1 1\nmap_Kd " + named + "\n");
        const Animation a = read("m.obj", square);
        return a.images.empty() ? std::string("none") : a.images[0].path.filename().string();
    };
    EXPECT_EQ(image("textures/Wood.PNG"), "Wood.PNG");
    EXPECT_EQ(image("WOOD.png"), "Wood.PNG");
    EXPECT_EQ(image("C:\\maps\\old\\wood.png"), "Wood.PNG");
    EXPECT_EQ(image("wood.tga"), "Wood.PNG");
    EXPECT_EQ(image("MRAMOR~1.tga"), "mramor-floor.jpg");
    EXPECT_EQ(image("MRAMOR~2.JPG"), "mramor-floor-bump.jpg");
    EXPECT_EQ(image("marble.png"), "none");
    EXPECT_EQ(image("MARBLE~1.JPG"), "none");
}

TEST_F(Assimp, NeverLooksForImagesOutsideOfTheScenesFolder) {
    write("secret.png", "x");
    write("scene/m.mtl", "newmtl m\nKd 0.3 0.3 0.3\nmap_Kd ../secret.png\n");
    const Animation a = read("scene/m.obj", square);
    EXPECT_TRUE(a.images.empty());
    EXPECT_TRUE(noted(a, "secret.png"));
    EXPECT_EQ(a.materials[static_cast<std::size_t>(a.objects[0].material)].base_color.x, 0.3f);
}

TEST_F(Assimp, NeverReadsLibrariesOutsideOfTheScenesFolder) {
    write("m.mtl", "newmtl m\nKd 1 0 0\n");
    std::string text = square;
    text.replace(text.find("m.mtl"), 5, "../m.mtl");
    const Animation a = read("scene/m.obj", text);
    EXPECT_TRUE(noted(a, "outside"));
    for (const Material& m : a.materials) EXPECT_NE(glm::vec3(m.base_color), glm::vec3(1, 0, 0));
}

TEST_F(Assimp, PlyKeepsItsColoursAsLinearLight) {
    const Animation a = read("t.ply",
                             "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
                             "float z\nproperty uchar red\n"
                             "property uchar green\nproperty uchar blue\nelement face 2\nproperty list uchar int "
                             "vertex_indices\nend_header\n"
                             "0 0 0 255 0 128\n1 0 0 255 0 128\n1 1 0 255 0 128\n0 1 0 255 0 128\n3 0 1 2\n3 0 2 3\n");
    EXPECT_EQ(triangles(a), 2u);
    ASSERT_EQ(a.meshes[0].colors.size(), a.meshes[0].positions.size());
    EXPECT_NEAR(a.meshes[0].colors[0].x, 1, 1e-6);
    EXPECT_NEAR(a.meshes[0].colors[0].z, 0.2158605, 2e-4);
    EXPECT_EQ(glm::vec3(a.materials[static_cast<std::size_t>(a.objects[0].material)].base_color), glm::vec3(1));
}

constexpr const char* collada = R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_lights>
<light id="bulb" name="bulb"><technique_common><point><color>1 0.5 0.25</color><constant_attenuation>0</constant_attenuation><quadratic_attenuation>0.5</quadratic_attenuation></point></technique_common></light>
<light id="sun" name="sun"><technique_common><directional><color>1 1 1</color></directional></technique_common></light>
<light id="glow" name="glow"><technique_common><ambient><color>.1 .1 .1</color></ambient></technique_common></light></library_lights>
<library_effects><effect id="e"><profile_COMMON><technique sid="c"><lambert><diffuse><color>0.8 0.1 0.1 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="mm" name="mm"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g" name="g"><mesh><source id="p"><float_array id="pa" count="12">0 0 0 100 0 0 100 100 0 0 100 0</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><polylist material="mat" count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4</vcount><p>0 1 2 3</p></polylist></mesh></geometry></library_geometries>
<library_animations><animation id="move"><source id="in"><float_array id="ina" count="2">0 2</float_array><technique_common><accessor source="#ina" count="2" stride="1"><param name="TIME" type="float"/></accessor></technique_common></source>
<source id="out"><float_array id="outa" count="6">0 0 0 0 0 300</float_array><technique_common><accessor source="#outa" count="2" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<source id="ip"><Name_array id="ipa" count="2">LINEAR LINEAR</Name_array><technique_common><accessor source="#ipa" count="2" stride="1"><param name="INTERPOLATION" type="name"/></accessor></technique_common></source>
<sampler id="s"><input semantic="INPUT" source="#in"/><input semantic="OUTPUT" source="#out"/><input semantic="INTERPOLATION" source="#ip"/></sampler><channel source="#s" target="n/place"/></animation></library_animations>
<library_visual_scenes><visual_scene id="vs"><node id="n" name="n"><translate sid="place">0 0 0</translate><instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="mat" target="#mm"/></technique_common></bind_material></instance_geometry></node>
<node id="n1"><translate>100 200 300</translate><instance_light url="#bulb"/></node><node id="n2"><instance_light url="#sun"/></node><node id="n3"><instance_light url="#glow"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#vs"/></scene></COLLADA>)";

TEST_F(Assimp, ColladaIsMetresAndYUpWithPhysicalLightsAndMotion) {
    Animation a = read("t.dae", collada);
    EXPECT_EQ(triangles(a), 2u);
    EXPECT_TRUE(noted(a, "\"n3\""));  // ambient light is left out
    complete(a);
    const auto at = [&](double t) { return snapshot_at(a, 0, {std::llround(t * 1000), 1000}, {64, 48, 1}); };

    // z up becomes y up, centimetres become metres, and the mesh rises 3 m in 2 s.
    const glm::vec3 start = triangle_of(at(0), 0, 0).a + glm::vec3(a.origin),
                    half = triangle_of(at(1), 0, 0).a + glm::vec3(a.origin);
    EXPECT_LT(glm::length(half - start - glm::vec3(0, 1.5f, 0)), 1e-4);
    EXPECT_NEAR(a.duration, 2, 1e-4);

    const Snapshot s = at(0);
    ASSERT_EQ(s.lights.size(), 2u);
    const std::size_t bulb = s.lights[0].kind == LightKind::point ? 0 : 1;
    EXPECT_LT(glm::length(s.lights[bulb].position + glm::vec3(a.origin) - glm::vec3(1, 3, -2)), 1e-4);
    // 1 / (0.5 d^2) of colour 1 on white is radiance 2 / d^2: radiant intensity 2 pi.
    EXPECT_NEAR(s.lights[bulb].intensity.x, 2 * glm::pi<double>(), 1e-4);
    EXPECT_NEAR(s.lights[bulb].intensity.y, glm::pi<double>(), 1e-4);
    EXPECT_NEAR(s.lights[1 - bulb].intensity.x, glm::pi<double>(), 1e-4);
    EXPECT_LT(glm::length(s.lights[1 - bulb].direction - glm::vec3(0, -1, 0)), 1e-5);  // -z of a z-up file
}

TEST_F(Assimp, LampsOfBlendersColladaAreWatts) {
    std::string text = collada;
    const std::string asset = "<asset>";
    ASSERT_NE(text.find(asset), std::string::npos);
    text.insert(text.find(asset) + asset.size(),
                "<contributor><authoring_tool>Blender 3.4.1</authoring_tool></contributor>");
    const Animation plain = read("plain.dae", collada), blender = read("blender.dae", text);
    for (std::size_t i = 0; i < plain.lights.size(); ++i) {
        const bool sun = plain.lights[i].kind == LightKind::directional;
        EXPECT_NEAR(blender.lights[i].intensity, sun ? 1 : 1 / (4 * glm::pi<double>()), 1e-6);
    }
}

/// Has `instead` where a text says `what`.
void put(std::string& text, const std::string& what, const std::string& instead) {
    const auto at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    text.replace(at, what.size(), instead);
}

TEST_F(Assimp, TellsThatBlendersColladaDimsWhatShines) {
    std::string text = collada;
    put(text, "<asset>", "<asset><contributor><authoring_tool>Blender 3.4.1</authoring_tool></contributor>");
    put(text, "<lambert>", "<lambert><emission><color>1 0.75 0.5 1</color></emission>");
    EXPECT_TRUE(noted(read("dimmed.dae", text), "where Blender's COLLADA ends"));
    put(text, "<color>1 0.75 0.5 1</color>", "<color>0.9 0.75 0.5 1</color>");
    EXPECT_FALSE(noted(read("dim.dae", text), "where Blender's COLLADA ends"));
}

TEST_F(Assimp, ArmaturesOfBlendersColladaStandAtTheirPlace) {
    std::string text = collada;
    put(text, "<asset>", "<asset><contributor><authoring_tool>Blender 3.4.1</authoring_tool></contributor>");
    put(text, R"(<node id="n" name="n"><translate sid="place">0 0 0</translate><instance_geometry url="#g">)",
        R"(<node id="A" name="A"><translate>-150 0 0</translate><node id="j" name="j" sid="j" type="JOINT"></node>)"
        R"(<node id="n" name="n"><translate sid="place">0 0 0</translate><instance_controller url="#c">)");
    put(text, "</instance_geometry></node>", "</instance_controller></node></node>");
    // What Blender writes: the joint's place undone together with the armature's, and the mesh's place in the armature.
    put(text, "<library_animations>",
        R"(<library_controllers><controller id="c"><skin source="#g"><bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 80 0 0 0 1</bind_shape_matrix>
<source id="cj"><Name_array id="cja" count="1">j</Name_array><technique_common><accessor source="#cja" count="1" stride="1"><param name="JOINT" type="name"/></accessor></technique_common></source>
<source id="cb"><float_array id="cba" count="16">1 0 0 150 0 1 0 0 0 0 1 0 0 0 0 1</float_array><technique_common><accessor source="#cba" count="1" stride="16"><param name="TRANSFORM" type="float4x4"/></accessor></technique_common></source>
<source id="cw"><float_array id="cwa" count="1">1</float_array><technique_common><accessor source="#cwa" count="1" stride="1"><param name="WEIGHT" type="float"/></accessor></technique_common></source>
<joints><input semantic="JOINT" source="#cj"/><input semantic="INV_BIND_MATRIX" source="#cb"/></joints>
<vertex_weights count="4"><input semantic="JOINT" source="#cj" offset="0"/><input semantic="WEIGHT" source="#cw" offset="1"/><vcount>1 1 1 1</vcount><v>0 0 0 0 0 0 0 0</v></vertex_weights></skin></controller></library_controllers>
<library_animations>)");
    Animation a = read("skin.dae", text);
    complete(a);
    ASSERT_EQ(a.skins.size(), 1u);
    const Snapshot s = snapshot_at(a, 0, {0, 1}, {64, 48, 1});
    glm::vec3 low(1e9f);
    for (const glm::vec3& p : s.deformed[0].positions) low = glm::min(low, p + glm::vec3(a.origin));
    EXPECT_LT(glm::length(low - glm::vec3(-1.5f, 0.8f, -1)), 1e-4f);
}

TEST(AssimpAxes, AreTurnedUprightWhateverTheFileCallsUp) {
    const auto near = [](glm::dvec3 a, glm::dvec3 b) { return glm::length(a - b) < 1e-12; };
    // As 3ds Max writes: z up, -y to the front.
    const glm::dquat max = upright({0, 1}, {2, 1}, {1, -1});
    EXPECT_TRUE(near(max * glm::dvec3(0, 0, 1), {0, 1, 0}));
    EXPECT_TRUE(near(max * glm::dvec3(0, -1, 0), {0, 0, 1}));
    EXPECT_TRUE(near(max * glm::dvec3(1, 0, 0), {1, 0, 0}));
    EXPECT_TRUE(near(upright({0, 1}, {1, 1}, {2, 1}) * glm::dvec3(1, 2, 3), {1, 2, 3}));
    // Frames that contradict themselves keep their up.
    for (int axis = 0; axis < 3; ++axis)
        for (const int sign : {-1, 1}) {
            glm::dvec3 up{0};
            up[axis] = sign;
            EXPECT_TRUE(near(upright({axis, 1}, {axis, sign}, {axis, 1}) * up, {0, 1, 0})) << axis << " " << sign;
        }
}

TEST_F(Assimp, AnimationsAreChosenByNameOrRefusedWithTheList) {
    write("t.dae", collada);
    LoadOptions options;
    options.animation = "jump";
    EXPECT_THROW(load_with_assimp(folder_ / "t.dae", options), core::Error);
    options.animation = "0";
    EXPECT_EQ(load_with_assimp(folder_ / "t.dae", options).tracks.size(),
              load_with_assimp(folder_ / "t.dae", {}).tracks.size());
}

TEST_F(Assimp, RefusesBrokenFilesInOneLine) {
    EXPECT_NE(complaint("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n"), "");
    EXPECT_NE(complaint("b.ply",
                        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
                        "z\nelement face 1\n"
                        "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n")
                  .find("vertex 7 of 3"),
              std::string::npos);
    EXPECT_NE(complaint("n.ply",
                        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
                        "z\nelement face 1\n"
                        "property list uchar int vertex_indices\nend_header\n0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n"),
              "");
    EXPECT_NE(complaint("c.obj", ""), "");
    EXPECT_NE(complaint("d.dae", "<COLLADA"), "");
    EXPECT_NE(complaint("e.fbx", "Kaydara"), "");
    EXPECT_NE(complaint("f.3ds", std::string("MM\x10\0\0\0", 6)), "");
    EXPECT_NE(complaint("g.unknown", "?"), "");
    EXPECT_NE(complaint("points.obj", "v 0 0 0\nv 1 0 0\np 1 2\n"), "");
    EXPECT_THROW(load_with_assimp(folder_ / "missing.obj", {}), core::Error);
}

}  // namespace
}  // namespace render2mpeg::scene
