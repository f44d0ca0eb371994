// The schema beside the documentation and the reader in the program must say the same.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "core/error.h"
#include "scene/animation_file/keys.h"
#include "scene/load.h"
#include "tests/support/places.h"

namespace render2mpeg::scene {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json read(const fs::path& file) {
    std::ifstream in(file);
    return json::parse(in, nullptr, true, true);
}
const json& schema() {
    static const json value = read(support::source_folder() / "docs/animation-file.schema.json");
    return value;
}

/// As much of JSON Schema as ours uses: the first thing that is wrong, or nothing.
std::string wrong_with(const json& value, const json& rule, const std::string& place) {
    if (rule.contains("$ref")) {
        const json::json_pointer target(rule["$ref"].get<std::string>().substr(1));
        if (auto wrong = wrong_with(value, schema().at(target), place); !wrong.empty()) return wrong;
    }
    if (rule.contains("anyOf")) {
        bool any = false;
        for (const json& choice : rule["anyOf"]) any = any || wrong_with(value, choice, place).empty();
        if (!any) return place + ": none of the choices";
    }
    if (rule.contains("const") && value != rule["const"]) return place + ": not the constant";
    if (rule.contains("enum") && std::find(rule["enum"].begin(), rule["enum"].end(), value) == rule["enum"].end())
        return place + ": no such word";
    if (rule.contains("type")) {
        const std::string type = rule["type"];
        const bool fits =
            (type == "object" && value.is_object()) || (type == "array" && value.is_array()) ||
            (type == "string" && value.is_string()) || (type == "boolean" && value.is_boolean()) ||
            (type == "number" && value.is_number()) ||
            (type == "integer" && value.is_number() && value.get<double>() == std::floor(value.get<double>()));
        if (!fits) return place + ": not of type " + type;
    }
    if (value.is_number()) {
        const double v = value.get<double>();
        if (rule.contains("minimum") && v < rule["minimum"].get<double>()) return place + ": too small";
        if (rule.contains("exclusiveMinimum") && v <= rule["exclusiveMinimum"].get<double>())
            return place + ": too small";
        if (rule.contains("maximum") && v > rule["maximum"].get<double>()) return place + ": too large";
    }
    if (value.is_string() && rule.contains("pattern") &&
        !std::regex_search(value.get<std::string>(), std::regex(rule["pattern"].get<std::string>())))
        return place + ": does not match";
    if (value.is_array()) {
        if (rule.contains("minItems") && value.size() < rule["minItems"].get<std::size_t>()) return place + ": too few";
        if (rule.contains("maxItems") && value.size() > rule["maxItems"].get<std::size_t>())
            return place + ": too many";
        for (std::size_t i = 0; rule.contains("items") && i < value.size(); ++i)
            if (auto wrong = wrong_with(value[i], rule["items"], place + "[" + std::to_string(i) + "]"); !wrong.empty())
                return wrong;
    }
    if (!value.is_object()) return "";
    for (const json& key : rule.value("required", json::array()))
        if (!value.contains(key.get<std::string>())) return place + ": lacks " + key.get<std::string>();
    for (const auto& [key, member] : value.items()) {
        const std::string below = place + "." + key;
        if (rule.contains("properties") && rule["properties"].contains(key)) {
            if (auto wrong = wrong_with(member, rule["properties"][key], below); !wrong.empty()) return wrong;
        } else if (rule.contains("additionalProperties")) {
            const json& others = rule["additionalProperties"];
            if (others.is_boolean() && !others.get<bool>()) return below + ": unknown";
            if (others.is_object())
                if (auto wrong = wrong_with(member, others, below); !wrong.empty()) return wrong;
        }
    }
    return "";
}

void expect_same_keys(const char* kind, const std::vector<std::string_view>& keys) {
    ASSERT_TRUE(schema()["$defs"].contains(kind)) << kind;
    const json& rule = schema()["$defs"][kind];
    std::set<std::string> said, known(keys.begin(), keys.end());
    for (const auto& [key, unused] : rule["properties"].items()) said.insert(key);
    EXPECT_EQ(said, known) << kind;
    EXPECT_EQ(rule["additionalProperties"], false) << kind;
}

TEST(AnimationFileSchema, HasTheKeysThatTheReaderKnows) {
    namespace keys = animation_file_keys;
    expect_same_keys("film", keys::film);
    expect_same_keys("camera", keys::camera);
    expect_same_keys("camera_key", keys::camera_key);
    expect_same_keys("shot", keys::shot);
    expect_same_keys("light", keys::light);
    expect_same_keys("light_key", keys::light_key);
    expect_same_keys("object", keys::object);
    expect_same_keys("object_key", keys::object_key);
    expect_same_keys("change", keys::change);
    expect_same_keys("reflection", keys::reflection);
    expect_same_keys("repeat", keys::repeat);
    expect_same_keys("ring", keys::ring);
    expect_same_keys("material", keys::material);
    expect_same_keys("material_key", keys::material_key);
    expect_same_keys("hair", keys::hair);
    expect_same_keys("subsurface", keys::subsurface);
    expect_same_keys("checker", keys::checker);
    expect_same_keys("sky", keys::sky);
    expect_same_keys("view", keys::view);
    expect_same_keys("fog", keys::fog);
    expect_same_keys("limits", keys::limits);
    expect_same_keys("glare", keys::glare);
    expect_same_keys("volume", keys::volume);
    expect_same_keys("volume_key", keys::volume_key);
}

TEST(AnimationFileSchema, AcceptsEveryFilmOfOurs) {
    int films = 0;
    for (const auto& entry : fs::directory_iterator(support::source_folder() / "animations")) {
        if (!fs::exists(entry.path() / "film.json")) continue;
        EXPECT_EQ(wrong_with(read(entry.path() / "film.json"), schema(), entry.path().filename().string()), "");
        ++films;
    }
    EXPECT_GE(films, 7);
}

/// Films that schema and reader must judge alike.
TEST(AnimationFileSchema, RefusesWhatTheReaderRefusesAndAcceptsWhatItAccepts) {
    const fs::path file = fs::path(::testing::TempDir()) / "r2m_schema_film.json";
    const auto judge = [&](const char* text) {
        std::ofstream(file) << text;
        bool read_well = true;
        std::string said;
        try {
            load_as_is(file, {});
        } catch (const core::Error& e) {
            read_well = false;
            said = e.what();
        }
        const std::string wrong = wrong_with(json::parse(text), schema(), "film");
        EXPECT_EQ(read_well, wrong.empty()) << text << "\n  reader: " << said << "\n  schema: " << wrong;
        return read_well;
    };
    for (
        const char* good :
        {R"({})",
         R"({"frames": 3, "exposure": "auto"})",
         R"({"camera": {"keys": [{"at": 0, "fov": 30, "roll": 4}]}})",
         R"({"objects": [{"shape": "box", "size": 2, "rotate": 3, "scale": [1, 2, 3], "uv": "units"}]})",
         R"({"lights": [{"kind": "spot", "angle": 10, "colors": ["#ffffff"], "repeat": {"ring": {"count": 3, "radius": 2}}}]})",
         R"({"view": "filmic-low-contrast"})",
         R"({"view": {"name": "agx", "gamma": 1.2}})",
         R"({"glare": "temporal"})",
         R"({"grain": 0})",
         R"({"grain": 400})",
         R"({"fog": 40})",
         R"({"fog": {"visibility": 40, "color": [1, 0.9, 0.8], "anisotropy": -0.3, "height": 2, "falloff": 4}})",
         R"({"fog": {"visibility": 40, "anisotropy": 0.95}})",
         R"({"fog": {"visibility": 40, "anisotropy": -0.95}})",
         R"({"glare": {"kind": "static", "strength": 0.5, "size": 1, "seed": 7}})",
         R"({"volumes": [{"size": [1, 2, 3], "density": 0, "anisotropy": 0.95, "keys": [{"at": 0, "scale": 2}]}]})",
         R"({"objects": [{"shape": "quad", "reflections": [{"at": [0, 0, 0], "see": [1, 2, 3], "radius": 1, "border": 2}]}]})",
         R"({"sky": {"zenith": [0, 0, 1], "horizon": 2}})",
         R"({"sky": "#102030"})",
         R"({"objects": [{"shape": "box", "material": {"alpha": "mask", "texture": {"checker": [0, 1]}, "texture_scale": [1, 2]}}]})"})
        EXPECT_TRUE(judge(good)) << good;
    for (const char* bad : {R"([])",
                            R"({"title": 5})",
                            R"({"frames": 0})",
                            R"({"frames": 1.5})",
                            R"({"frame": 1})",
                            R"({"times": "minutes"})",
                            R"({"camera": {"fov": 0}})",
                            R"({"camera": {"keys": []}})",
                            R"({"camera": {"keys": [{"fov": 3}]}})",
                            R"({"camera": {"position": [1, 2]}})",
                            R"({"camera": {"position": [1, 2, 1e8]}})",
                            R"({"objects": [{}]})",
                            R"({"objects": [{"shape": "blob"}]})",
                            R"({"objects": [{"shape": "box", "segments": 2}]})",
                            R"({"objects": [{"shape": "box", "visible": 1}]})",
                            R"({"objects": [{"shape": "sphere", "radius": -1}]})",
                            R"({"lights": [{"kind": "point", "color": "#12"}]})",
                            R"({"lights": [{"color": 1}]})",
                            R"({"lights": [{"kind": "spot", "softness": 2}]})",
                            R"({"shots": []})",
                            R"({"materials": {"m": {"roughness": 2}}})",
                            R"({"materials": {"m": {"ior": 0.5}}})",
                            R"({"sky": {"strength": -1}})",
                            R"({"sky": -1})",
                            R"({"size": [10]})",
                            R"({"exposure": "dark"})",
                            R"({"view": "dark"})",
                            R"({"view": {"gamma": 2}})",
                            R"({"view": {"name": "agx", "gamma": 0}})",
                            R"({"fog": 0})",
                            R"({"fog": "thick"})",
                            R"({"fog": {"color": 1}})",
                            R"({"fog": {"visibility": -1}})",
                            R"({"fog": {"visibility": 1, "anisotropy": 1}})",
                            R"({"fog": {"visibility": 1, "falloff": 0}})",
                            R"({"volumes": [{"density": 1}]})",
                            R"({"volumes": [{"size": 1, "density": -1}]})",
                            R"({"volumes": [{"size": 1, "blackbody": 2}]})",
                            R"({"volumes": [{"size": 1, "keys": [{"at": 0, "reflections": []}]}]})",
                            R"({"grain": 49})",
                            R"({"grain": 400.5})",
                            R"({"grain": 6401})",
                            R"({"glare": "bright"})",
                            R"({"glare": {"strength": 0.1}})",
                            R"({"glare": {"kind": "static", "strength": 0.6}})",
                            R"({"glare": {"kind": "static", "size": 0}})",
                            R"({"objects": [{"shape": "quad", "reflections": {}}]})",
                            R"({"objects": [{"shape": "quad", "reflections": [{"radius": 0}]}]})",
                            R"({"objects": [{"shape": "quad", "reflections": [{"looks": 1}]}]})",
                            R"({"change": []})"})
        EXPECT_FALSE(judge(bad)) << bad;
    fs::remove(file);
}

}  // namespace
}  // namespace render2mpeg::scene
