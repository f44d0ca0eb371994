// Our own format: docs/scenes.md, docs/animation-file.schema.json.
#include "scene/animation_file/load.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/film_grain.h"
#include "core/fog.h"
#include "core/glare.h"
#include "core/rational.h"
#include "core/text.h"
#include "core/view.h"
#include "scene/animation_file/cameras_and_lights.h"
#include "scene/animation_file/json.h"
#include "scene/animation_file/keys.h"
#include "scene/animation_file/looks.h"
#include "scene/animation_file/objects.h"
#include "scene/animation_file/volumes.h"

namespace render2mpeg::scene {
namespace {

namespace fs = std::filesystem;

/// The scene that the film builds on, or an empty one.
Animation base_scene(const JsonValue& value, const fs::path& folder, const LoadOptions& options,
                     const LoadScene& load_scene) {
    const auto scene = value.find("scene");
    if (!scene) {
        if (options.variant) value.fail("names no scene, so that it has no variant \"" + *options.variant + "\"");
        if (options.animation) value.fail("names no scene, so that it has no animation \"" + *options.animation + "\"");
        return {};
    }
    const fs::path file = Looks::file_below(folder, *scene);
    if (core::ending_of(file) == ".json") scene->fail("is an animation file itself; name the scene that it refers to");
    return load_scene(file, options);
}

/// `"filmic"`, or `{ "name": "filmic", "gamma": 1.2 }`.
core::View view_of(const JsonValue& value) {
    core::View view;
    if (value.is_text()) {
        view.name = static_cast<core::ViewName>(value.word(core::view_names));
        return view;
    }
    value.allow_only(animation_file_keys::view);
    const auto name = value.find("name");
    if (!name) value.fail("has no `name`");
    view.name = static_cast<core::ViewName>(name->word(core::view_names));
    if (const auto gamma = value.find("gamma")) {
        view.gamma = static_cast<float>(gamma->number(core::least_gamma, core::largest_gamma));
        if (!view.is_blenders() && view.gamma != 1) gamma->fail("is for Blender's views");
    }
    return view;
}

/// `"static"`, or `{ "kind": "temporal", "strength": 0.2 }`.
core::Glare glare_of(const JsonValue& value) {
    core::Glare glare;
    if (value.is_text()) {
        glare.kind = static_cast<core::GlareKind>(value.word(core::glare_names));
        return glare;
    }
    value.allow_only(animation_file_keys::glare);
    const auto kind = value.find("kind");
    if (!kind) value.fail("has no `kind`");
    glare.kind = static_cast<core::GlareKind>(kind->word(core::glare_names));
    constexpr double least_size = 0.01;  // chosen: below it nothing is seen of it
    value.set("strength", glare.strength, 0, core::most_glare);
    value.set("size", glare.size, least_size, 1);
    if (const auto seed = value.find("seed")) glare.seed = static_cast<std::uint32_t>(seed->integer(0, 1'000'000));
    return glare;
}

/// `60`, how far one sees, or `{ "visibility": 60, "color": [1, 0.9, 0.8] }`, or `"off"`.
core::Fog fog_of(const JsonValue& value) {
    core::Fog fog;
    constexpr std::array<std::string_view, 1> words{"off"};
    if (value.is_text()) {
        value.word(words);
        return fog;
    }
    const auto visibility = [](const JsonValue& v) {
        return static_cast<float>(v.number(core::least_visibility, core::most_visibility));
    };
    if (value.is_number()) {
        fog.visibility = visibility(value);
        return fog;
    }
    value.allow_only(animation_file_keys::fog);
    const auto far = value.find("visibility");
    if (!far) value.fail("has no `visibility`");
    fog.visibility = visibility(*far);
    if (const auto color = value.find("color")) fog.color = color->color(1);
    value.set("anisotropy", fog.anisotropy, -core::most_anisotropy, core::most_anisotropy);
    if (const auto bounces = value.find("bounces")) fog.bounces = bounces->boolean();
    constexpr double most_height = 1e7;  // as of positions
    value.set("falloff", fog.falloff, 1e-3, most_height);
    if (const auto height = value.find("height")) {
        fog.height = static_cast<float>(height->number(-most_height, most_height));
        if (!(fog.falloff > 0)) height->fail("stands without `falloff`: the fog is everywhere the same");
    }
    return fog;
}

core::FrameRate rate_of(const JsonValue& value) {
    std::string text;
    if (value.is_number()) {
        text = std::to_string(value.number(0.1, 1000));
        text.erase(text.find_last_not_of('0') + 1);
        if (text.back() == '.') text.pop_back();
    } else {
        text = value.text();
    }
    try {
        return core::frame_rate_from(text);
    } catch (const core::Error& e) {
        value.fail(e.what());
    }
}

/// Frame rate, range, exposure, view, fog and glare.
FilmClock read_format(const JsonValue& value, Animation& film) {
    FilmClock clock;
    film.frame_rate = "25";  // initial rate of FilmClock
    if (const auto rate = value.find("frame_rate")) {
        const core::FrameRate known = rate_of(*rate);
        film.frame_rate = known.name;
        clock.rate = known.hertz.value();
    }
    constexpr std::array<std::string_view, 2> units{"seconds", "frames"};
    if (const auto times = value.find("times")) clock.in_frames = times->word(units) == 1;

    // chosen: 10 million frames, four days of film.
    constexpr std::int64_t most = 10'000'000;
    const auto frames = value.find("frames"), seconds = value.find("seconds");
    if (frames && seconds) seconds->fail("stands beside `frames`; one of them says how long the film is");
    if (frames && frames->is_list()) {
        const std::vector<JsonValue> range = frames->list(2, 2);
        film.first_frame = range[0].integer(0, most);
        film.last_frame = range[1].integer(*film.first_frame, most);
    } else if (frames) {
        film.first_frame = 0;
        film.last_frame = frames->integer(1, most) - 1;
    } else if (seconds) {
        film.first_frame = 0;
        film.last_frame =
            std::max<std::int64_t>(
                1, std::llround(seconds->number(0, static_cast<double>(most) / clock.rate) * clock.rate)) -
            1;
    }
    if (film.last_frame) clock.end = static_cast<double>(*film.last_frame + 1) / clock.rate;

    if (const auto exposure = value.find("exposure")) {
        if (!exposure->is_text())
            film.exposure = static_cast<float>(exposure->number(-50, 50));
        else if (exposure->text() != "auto")
            exposure->fail("is a number (EV) or \"auto\"");
    }
    value.set("shutter", film.shutter.angle, 0, 360);
    value.set("shutter_phase", film.shutter.phase, -0.5, 0.5);
    value.set("rolling_shutter", film.shutter.rolling, 0, 1);
    if (const auto view = value.find("view")) film.view = view_of(*view);
    if (const auto fog = value.find("fog")) film.fog = fog_of(*fog);
    if (const auto v = value.find("transparent")) film.transparent = v->boolean();
    if (const auto limits = value.find("limits")) {
        limits->allow_only(animation_file_keys::limits);
        if (const auto v = limits->find("layers")) film.layers = static_cast<int>(v->integer(0, 1024));
    }
    if (const auto grain = value.find("grain"); grain && grain->number(0, core::most_iso) != 0)
        film.grain = static_cast<int>(grain->integer(core::least_iso, core::most_iso));
    if (const auto glare = value.find("glare")) film.glare = glare_of(*glare);
    return clock;
}

void read_shape(const JsonValue& value, Animation& film) {
    if (const auto size = value.find("size")) {
        const std::vector<JsonValue> v = size->list(2, 2);
        film.size = glm::ivec2(v[0].integer(1, 16384), v[1].integer(1, 16384));
    }
    if (const auto v = value.find("stereo"))
        film.stereo = static_cast<core::FramePacking>(v->word(core::packing_names));
    if (const auto aspect = value.find("display_aspect")) {
        try {
            film.display_aspect = core::ratio_from(aspect->text());
        } catch (const core::Error& e) {
            aspect->fail(e.what());
        }
    }
}

void read_chapters(const JsonValue& chapters, Animation& film, const FilmClock& clock) {
    for (const JsonValue& value : chapters.list(1, 10000)) {
        value.allow_only(animation_file_keys::chapter);
        const JsonValue at = value.need("at");
        const std::int64_t frame = std::llround(clock.seconds(at) * clock.rate);
        if (!film.chapters.empty() && frame <= film.chapters.back().frame)
            at.fail("must be at least a frame later than the chapter before");
        film.chapters.push_back({frame, value.need("title").text()});
    }
}

}  // namespace

Animation load_animation_file(const fs::path& given, const LoadOptions& options, const LoadScene& load_scene) {
    std::error_code failure;
    const fs::path file = fs::is_directory(given, failure) ? given / "film.json" : given;
    const JsonValue value = JsonValue::read(file);
    value.allow_only(animation_file_keys::film);
    for (const std::string_view words : {"$schema", "title"})
        if (const auto v = value.find(words)) v->text();  // for people and editors, but text
    const fs::path folder = file.parent_path().empty() ? fs::path(".") : file.parent_path();

    // Changes go by the scene's names, and so come first.
    Animation film = base_scene(value, folder, options, load_scene);
    film.source = file.string();
    film.files.insert(film.files.begin(), file);
    const FilmClock clock = read_format(value, film);
    read_shape(value, film);
    Looks looks(film, folder, clock);
    Objects objects(film, looks, clock);
    read_cameras(value, film, clock);
    if (const auto v = value.find("materials")) looks.read_materials(*v);
    if (const auto v = value.find("change")) objects.read_changes(*v);
    if (const auto v = value.find("objects")) objects.read(*v);
    objects.read_edits();
    if (const auto v = value.find("volumes")) read_volumes(*v, film, folder, clock);
    if (const auto v = value.find("lights")) read_lights(*v, film, clock);
    if (const auto v = value.find("sky")) looks.read_sky(*v);
    focus_on_objects(value, film);
    if (const auto v = value.find("shots")) read_shots(*v, film, clock);
    if (const auto v = value.find("chapters")) read_chapters(*v, film, clock);
    if (const auto v = value.find("closed_glass_is_solid"); v && v->boolean())
        for (Material& material : film.materials)
            if (material.transmission > 0 && material.thickness == Thickness::thin)
                material.thickness = Thickness::solid_where_closed;
    if (const auto v = value.find("sound")) film.sound = Looks::file_below(folder, *v);
    looks.refuse_unused();
    return film;
}

}  // namespace render2mpeg::scene
