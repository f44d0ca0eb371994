#include "scene/animation_file/looks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "core/plain_file.h"
#include "core/text.h"
#include "scene/animation_file/keys.h"
#include "scene/model/png.h"

namespace render2mpeg::scene {
namespace {

/// Light that goes no farther below a surface stays where it came in, scene units. chosen: what single precision tells
/// apart a few units from the origin.
constexpr float least_free_path = 1e-6f;

namespace fs = std::filesystem;
namespace keys = animation_file_keys;

// Radiances of suns and welding arcs stay below; larger numbers are mistakes.
constexpr double brightest = 1e6;

// chosen: the reflectance of light stone or paint; with 0.5 rooms look dim, with 0.9 washed out.
constexpr glm::vec3 light_grey(0.7f);

/// White beside a texture or for glass, else light grey.
glm::vec3 first_color(const JsonValue& value) {
    return value.is_object() && (value.has("texture") || value.has("transmission")) ? glm::vec3(1) : light_grey;
}

glm::u8vec4 code_values(glm::vec3 linear) {
    glm::u8vec4 out(255);
    for (int k = 0; k < 3; ++k)
        out[k] = static_cast<glm::uint8>(std::lround(255 * core::linear_to_srgb(std::clamp(linear[k], 0.0f, 1.0f))));
    return out;
}

void change_body(const JsonValue& value, Material& material) {
    if (const auto v = value.find("solid")) material.thickness = v->boolean() ? Thickness::solid : Thickness::thin;
    if (const auto v = value.find("attenuation")) {
        material.attenuation_color = v->color(1);
        if (!(material.attenuation_distance > 0)) material.attenuation_distance = 1;
    }
    value.set("attenuation_distance", material.attenuation_distance, 1e-6, 1e6);
    value.set("dispersion", material.dispersion, 0, 20);
}

void change_model(const JsonValue& value, Material& material) {
    constexpr std::array<std::string_view, 3> models{"gltf", "principled-3", "principled-4"};
    if (const auto v = value.find("model")) {
        material.model = static_cast<SurfaceModel>(v->word(models));
        material.multiscatter = material.model == SurfaceModel::principled_4;
        material.specular_glossiness = false;
    }
    value.set("diffuse_roughness", material.diffuse_roughness, 0, 1);
    for (const char* key : {"specular", "multiscatter", "gloss", "coat_ior", "coat_tint"})
        if (value.has(key) && material.model == SurfaceModel::gltf)
            value.need(key).fail("is for the models principled-3 and principled-4");
    value.set("specular", material.specular_level, 0, 10);
    value.set("coat_ior", material.coat_ior, 1, 5);
    if (const auto v = value.find("multiscatter")) material.multiscatter = v->boolean();
    if (const auto v = value.find("gloss")) material.gloss = v->color(1);
    if (const auto v = value.find("coat_tint")) material.coat_tint = v->color(1);
}

void change_hair(const JsonValue& value, Material& material) {
    value.allow_only(keys::hair);
    Hair hair = material.hair.value_or(Hair{});
    value.set("roughness", hair.roughness, 0, 1);
    value.set("azimuthal_roughness", hair.azimuthal_roughness, 0, 1);
    value.set("coat", hair.coat, 0, 1);
    value.set("ior", hair.ior, 1, 5);
    if (const auto v = value.find("tilt")) hair.tilt = static_cast<float>(v->number(-45, 45) * 0.017453292519943295);
    if (value.has("absorption") && (value.has("color") || value.has("melanin")))
        value.fail("says how much is absorbed twice: by `absorption`, and by `color` or `melanin`");
    if (value.has("redness") && !value.has("melanin"))
        value.need("redness").fail("is that of `melanin`, which is not said");
    const bool known = material.hair.has_value() || value.has("absorption") || value.has("melanin");
    if (const auto v = value.find("absorption")) hair.absorption = v->channels(1e4);
    if (const auto v = value.find("melanin"))
        hair.absorption = absorption_of_melanin(static_cast<float>(v->number(0, 1)),
                                                static_cast<float>(value.number_or("redness", 0, 1, 0)));
    if (const auto v = value.find("color"))
        hair.absorption = absorption_of(v->color(1), hair.azimuthal_roughness) +
                          (value.has("melanin") ? hair.absorption : glm::vec3(0));
    else if (!known)
        hair.absorption = absorption_of(glm::vec3(material.base_color), hair.azimuthal_roughness);
    material.hair = hair;
}

void change_subsurface(const JsonValue& value, Material& material) {
    value.allow_only(keys::subsurface);
    Subsurface below = material.subsurface.value_or(Subsurface{});
    value.set("weight", below.weight, 0, 1);
    if (const auto v = value.find("free_path")) below.free_path = v->channels(1e6);
    const bool spreads =
        below.weight > 0 && std::max({below.free_path.x, below.free_path.y, below.free_path.z}) > least_free_path;
    material.subsurface = spreads ? std::optional(below) : std::nullopt;
}

/// Shares of the other value by steps of the angle: numbers or triples.
std::vector<glm::vec3> shares_of(const JsonValue& value) {
    std::vector<glm::vec3> shares;
    for (const JsonValue& one : value.list(2, 1025)) shares.push_back(one.channels(1));
    return shares;
}

}  // namespace

fs::path Looks::file_below(const fs::path& folder, const JsonValue& name) {
    return file_below(folder, name, name.text());
}

fs::path Looks::file_below(const fs::path& folder, const JsonValue& name, const std::string& text) {
    const fs::path path(text);
    std::error_code failure;
    const fs::path home = fs::weakly_canonical(folder, failure);
    const fs::path target = fs::weakly_canonical(folder / path, failure);
    const bool below = !failure && !path.is_absolute() &&
                       std::mismatch(home.begin(), home.end(), target.begin(), target.end()).first == home.end();
    if (!below) name.fail("\"" + text + "\" lies outside of the film's own folder");
    if (!fs::exists(target, failure)) name.fail("there is no file \"" + text + "\" in the film's folder");
    if (const std::string why = core::why_no_plain_file(target); !why.empty()) name.fail("\"" + text + "\": " + why);
    return folder / path;
}

int Looks::add_image(ImageSource image) {
    for (std::size_t i = 0; i < film_.images.size(); ++i)
        if (!image.path.empty() && film_.images[i].path == image.path) return static_cast<int>(i);
    film_.images.push_back(std::move(image));
    return static_cast<int>(film_.images.size()) - 1;
}

TextureUse Looks::checker_of(const JsonValue& value) {
    value.allow_only(keys::checker);
    const std::vector<JsonValue> colors = value.need("checker").list(2, 2);
    const auto squares = value.has("squares") ? static_cast<int>(value.need("squares").integer(2, 64)) : 8;
    if (squares % 2 != 0) value.need("squares").fail("must be even, so that the pattern continues where it repeats");
    const glm::u8vec4 shades[2] = {code_values(colors[0].color(1)), code_values(colors[1].color(1))};

    // chosen: 16 texels a square: edges are sharper than a sample sees until a square fills a tenth of the picture.
    constexpr int texels = 16;
    const int side = squares * texels;
    std::vector<glm::u8vec4> image;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) image.push_back(shades[(x / texels + y / texels) % 2]);
    TextureUse use;
    use.image = add_image({"checker", {}, encode_png(side, side, image)});
    return use;
}

TextureUse Looks::texture_of(const JsonValue& value) {
    if (value.is_object()) return checker_of(value);
    TextureUse use;
    use.image = add_image({value.text(), file_below(folder_, value), {}});
    return use;
}

void Looks::change_by_angle(const JsonValue& value, Material& material) {
    value.allow_only(keys::by_angle);
    material.by_angle.clear();
    for (std::size_t k = 0; k < keys::by_angle.size(); ++k) {
        const auto says = value.find(keys::by_angle[k]);
        if (!says) continue;
        says->allow_only(keys::angle_curve);
        AngleCurve curve;
        curve.input = static_cast<AngledInput>(k);
        curve.share = shares_of(says->need("share"));
        const bool is_base = curve.input == AngledInput::base_color, shines = curve.input == AngledInput::emission;
        curve.other = is_base || shines || curve.input == AngledInput::gloss
                          ? says->need("other").color(shines ? brightest : 1)
                          : glm::vec3(static_cast<float>(says->need("other").number(0, 1)));
        material.by_angle.push_back(std::move(curve));
        const auto texture = says->find("texture");
        if (!texture) continue;
        if (!is_base && !shines) texture->fail("is for base_color and emission");
        TextureUse use = is_base ? material.base_color_texture : material.emission_texture;
        use.image = texture_of(*texture).image;
        (is_base ? material.other_base_color_texture : material.other_emission_texture) = use;
    }
}

void Looks::change(const JsonValue& value, int index) {
    value.allow_only(keys::material);
    const auto material = [&]() -> Material& { return film_.materials[static_cast<std::size_t>(index)]; };
    const auto texture = [&](std::string_view key, TextureUse Material::*into) {
        if (const auto v = value.find(key)) {
            const TextureUse use = texture_of(*v);
            material().*into = use;
        }
    };

    if (const auto v = value.find("base_color"))
        material().base_color = glm::vec4(v->color(1), material().base_color.a);
    texture("texture", &Material::base_color_texture);
    texture("normal_texture", &Material::normal_texture);
    texture("emission_texture", &Material::emission_texture);
    value.set("metallic", material().metallic, 0, 1);
    value.set("roughness", material().roughness, 0, 1);
    value.set("normal_scale", material().normal_scale, 0, 10);
    value.set("transmission", material().transmission, 0, 1);
    value.set("ior", material().ior, 1, 5);
    change_model(value, material());
    change_body(value, material());
    if (const auto v = value.find("subsurface")) change_subsurface(*v, material());
    if (const auto v = value.find("by_angle")) change_by_angle(*v, material());
    if (const auto v = value.find("hair")) change_hair(*v, material());
    const bool derived = value.has("metallic") || value.has("roughness") || value.has("transmission");
    if (material().specular_glossiness && derived) material().specular_glossiness = false;
    if (const auto v = value.find("double_sided")) material().double_sided = v->boolean();
    if (const auto v = value.find("unlit")) material().unlit = v->boolean();
    if (const auto v = value.find("holdout")) material().holdout = v->boolean();
    if (const auto v = value.find("seen")) material().seen = v->boolean();

    // Coverage: a number below 1 blends, a word chooses how the texture's alpha is taken.
    value.set("alpha_cutoff", material().alpha_cutoff, 0, 1);
    if (const auto v = value.find("alpha")) {
        constexpr std::array<std::string_view, 3> modes{"opaque", "mask", "blend"};
        if (v->is_text()) {
            material().alpha_mode = static_cast<AlphaMode>(v->word(modes));
        } else {
            material().base_color.a = static_cast<float>(v->number(0, 1));
            material().alpha_mode = material().base_color.a < 1 ? AlphaMode::blend : AlphaMode::opaque;
        }
    }

    if (const auto v = value.find("emission")) material().emission = v->color(brightest);
    const Curve power = curve_of(value, {"power", 1, 0, brightest, true}, clock_, keys::material_key);
    if (!power.empty()) {
        std::erase_if(film_.tracks,
                      [&](const Track& t) { return t.target == TrackTarget::emission && t.index == index; });
        film_.tracks.push_back(track_of(power, TrackTarget::emission, index));
    }

    if (const auto v = value.find("texture_scale")) {
        const std::vector<double> scale = v->is_number() ? std::vector<double>(2, v->number(-1e4, 1e4)) : v->numbers(2);
        for (TextureUse Material::*use :
             {&Material::base_color_texture, &Material::normal_texture, &Material::emission_texture})
            for (int k = 0; k < 2; ++k)
                (material().*use).transform[k][k] = static_cast<float>(scale[static_cast<std::size_t>(k)]);
    }
}

void Looks::read_materials(const JsonValue& materials) {
    const std::size_t from_scene = film_.materials.size();
    for (const auto& [name, value] : materials.members()) {
        bool known = false;
        for (std::size_t i = 0; i < from_scene; ++i) {
            if (film_.materials[i].name != name) continue;
            change(value, static_cast<int>(i));
            known = true;
        }
        if (known) continue;
        film_.materials.push_back(matt(name, first_color(value)));
        unused_.emplace(name, value);
        const int index = static_cast<int>(film_.materials.size()) - 1;
        change(value, index);
    }
}

int Looks::default_material() {
    if (default_ >= 0) return default_;
    film_.materials.push_back(matt("light grey", light_grey));
    return default_ = static_cast<int>(film_.materials.size()) - 1;
}

int Looks::material_of(const JsonValue& value, int base) {
    if (value.is_text()) {
        const std::string name = value.text();
        std::vector<std::string_view> names;
        for (std::size_t i = 0; i < film_.materials.size(); ++i) {
            if (film_.materials[i].name == name) {
                unused_.erase(name);
                return static_cast<int>(i);
            }
            names.emplace_back(film_.materials[i].name);
        }
        value.fail("there is no material \"" + name + "\"" + core::did_you_mean(name, names, "\"", "\""));
    }
    const std::string place = value.place() + "/" + std::to_string(base);
    if (const auto known = made_.find(place); known != made_.end()) return known->second;
    Material copy = matt(value.place(), first_color(value));
    if (base >= 0) {
        copy = film_.materials[static_cast<std::size_t>(base)];
        copy.name += " (" + value.place() + ")";
    }
    film_.materials.push_back(std::move(copy));
    const int index = static_cast<int>(film_.materials.size()) - 1;
    copy_power(base, index);
    change(value, index);
    return made_[place] = index;
}

/// A copy shines when its original does.
void Looks::copy_power(int from, int to) {
    const std::size_t tracks = film_.tracks.size();
    for (std::size_t i = 0; i < tracks; ++i) {
        Track track = film_.tracks[i];
        if (track.target != TrackTarget::emission || track.index != from) continue;
        track.index = to;
        film_.tracks.push_back(std::move(track));
    }
}

int Looks::recolored(int material, glm::vec3 color) {
    const std::string key = std::to_string(color.x) + " " + std::to_string(color.y) + " " + std::to_string(color.z);
    if (const auto known = recolored_.find({material, key}); known != recolored_.end()) return known->second;
    Material copy = film_.materials[static_cast<std::size_t>(material)];
    const float strength = std::max({copy.emission.x, copy.emission.y, copy.emission.z});
    if (strength > 0)
        copy.emission = strength * color;
    else
        copy.base_color = glm::vec4(glm::min(color, glm::vec3(1)), copy.base_color.a);
    film_.materials.push_back(std::move(copy));
    const int index = static_cast<int>(film_.materials.size()) - 1;
    copy_power(material, index);
    return recolored_[{material, key}] = index;
}

int Looks::gradient_image(glm::vec3 zenith, glm::vec3 horizon, glm::vec3 ground) {
    // Rows of one colour; a few columns, since images of one column are a rare case to filter. The ground begins softly
    // below the horizon. chosen: power 0.4 of the height: skies change most near the horizon; 1 looks like fog, 0.2
    // like a rim.
    constexpr int width = 8, height = 256;
    std::vector<glm::u8vec4> texels;
    for (int y = 0; y < height; ++y) {
        const float up = std::cos(3.14159265f * (static_cast<float>(y) + 0.5f) / height);
        const glm::vec3 above = glm::mix(horizon, zenith, std::pow(std::max(up, 0.0f), 0.4f));
        const glm::vec3 below = glm::mix(horizon, ground, std::clamp(-up / 0.05f, 0.0f, 1.0f));
        texels.insert(texels.end(), width, code_values(up >= 0 ? above : below));
    }
    return add_image({"sky gradient", {}, encode_png(width, height, texels)});
}

void Looks::read_sky(const JsonValue& value) {
    Sky sky;
    if (!value.is_object()) {
        sky.color = value.color(brightest);
        film_.sky = sky;
        return;
    }
    value.allow_only(keys::sky);
    const double strength = value.number_or("strength", 0, brightest, 1);
    sky.color = glm::vec3(1);
    if (const auto v = value.find("rotation")) sky.rotation = static_cast<float>(glm::radians(v->number(-1e4, 1e4)));
    if (const auto v = value.find("color")) sky.color = v->color(brightest);
    if (const auto v = value.find("image")) sky.image = texture_of(*v).image;
    const bool gradient = value.has("zenith") || value.has("horizon") || value.has("ground");
    if (gradient) {
        if (value.has("image") || value.has("color"))
            value.fail("is either a gradient (zenith, horizon, ground), an image or a colour");
        const glm::vec3 horizon = value.need("horizon").color(brightest),
                        zenith = value.need("zenith").color(brightest);
        const glm::vec3 ground = value.has("ground") ? value.need("ground").color(brightest) : 0.4f * horizon;
        // The image holds 0..1; the colour carries the strength.
        float peak = 0;
        for (const glm::vec3 c : {horizon, zenith, ground}) peak = std::max({peak, c.x, c.y, c.z});
        if (peak > 0) sky.image = gradient_image(zenith / peak, horizon / peak, ground / peak);
        sky.color = glm::vec3(peak);
    }
    sky.color *= static_cast<float>(strength);
    film_.sky = sky;
}

void Looks::refuse_unused() const {
    if (unused_.empty()) return;
    const auto& [name, value] = *unused_.begin();
    std::vector<std::string_view> others;
    for (const Material& m : film_.materials)
        if (m.name != name) others.emplace_back(m.name);
    value.fail("nothing has this material" + core::did_you_mean(name, others, "\"", "\""));
}

}  // namespace render2mpeg::scene
