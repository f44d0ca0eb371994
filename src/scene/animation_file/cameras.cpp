#include "scene/animation_file/cameras.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <string>

#include "core/text.h"
#include "scene/animation_file/keys.h"

namespace render2mpeg::scene {
namespace {

namespace keys = animation_file_keys;

/// A curve as the value that it has throughout, or at first, and as a track where it has more.
float add_curve(const Curve& curve, TrackTarget target, std::size_t camera, Animation& film) {
    double first = 0;
    curve.sample(curve.times.front(), {&first, 1});
    if (curve.times.size() > 1) film.tracks.push_back(track_of(curve, target, static_cast<int>(camera)));
    return static_cast<float>(first);
}

/// What is blurred by the lens. `focus` by an object's name waits for the objects (focus_on_objects).
void read_aperture(const JsonValue& value, std::size_t index, CameraLens& lens, Animation& film,
                   const FilmClock& clock) {
    const auto f_stop = value.find("f_stop");
    if (f_stop && f_stop->is_text()) {
        constexpr std::array<std::string_view, 1> words{"off"};
        f_stop->word(words);
    } else {
        const Curve stops = curve_of(value, {"f_stop", 1, 0.01, 1000, true}, clock, keys::camera_key);
        if (!stops.empty()) lens.f_stop = add_curve(stops, TrackTarget::f_stop, index, film);
    }
    const auto focus = value.find("focus");
    if (focus && focus->is_list()) {
        lens.focus_point = focus->position();
    } else if (!focus || !focus->is_text()) {
        const Curve distances = curve_of(value, {"focus", 1, 1e-6, 1e9, true}, clock, keys::camera_key);
        if (!distances.empty())
            lens.focus_distance = add_curve(distances, TrackTarget::focus_distance, index, film);
        else if (lens.f_stop > 0)
            value.fail("has an `f_stop` and no `focus`");
    }
    // chosen: 24 mm, of 35 mm film.
    if (const auto v = value.find("sensor_height"))
        lens.sensor_height = static_cast<float>(v->number(0.1, 1000) / 1000);
    if (const auto v = value.find("blades")) {
        lens.blades = static_cast<int>(v->integer(0, 64));
        if (lens.blades == 1 || lens.blades == 2) v->fail("is 0 (round) or 3 or more");
    }
    if (const auto v = value.find("blade_rotation"))
        lens.blade_rotation = static_cast<float>(glm::radians(v->number(-360, 360)));
    if (const auto v = value.find("squeeze")) lens.squeeze = static_cast<float>(v->number(0.1, 10));
}

void focus_on_object(const JsonValue& camera, CameraLens& lens, const Animation& film) {
    const auto focus = camera.find("focus");
    if (!focus || !focus->is_text()) return;
    const std::string name = focus->text();
    std::vector<std::string_view> names;
    for (std::size_t i = 0; i < film.objects.size(); ++i) {
        names.emplace_back(film.objects[i].name);
        if (film.objects[i].name == name) lens.focus_objects.push_back(static_cast<int>(i));
    }
    if (!lens.focus_objects.empty()) return;
    const std::string nearest = core::nearest_word(name, names);
    focus->fail("there is no object \"" + name + "\"" + (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
}

void read_camera(const JsonValue& value, const std::string& name, std::size_t index, Animation& film,
                 const FilmClock& clock) {
    if (const auto projection = value.find("projection"))
        projection->fail(
            "panoramas are not rendered: the encoder's exact motion is that of flat pictures; a camera has `fov`, or "
            "`height` for a parallel projection");
    value.allow_only(keys::camera);
    CameraLens lens;
    lens.name = name;
    lens.node = add_node(film, name, -1);
    place(film, lens.node, value, clock, keys::camera_key);
    if (const auto v = value.find("shift")) {
        const std::vector<JsonValue> shift = v->list(2, 2);
        lens.shift = glm::vec2(shift[0].number(-10, 10), shift[1].number(-10, 10));
    }
    if (const auto v = value.find("near")) lens.near = static_cast<float>(v->number(0, 1e6));

    // An orthographic camera is told by the height that it shows.
    const Curve fov = curve_of(value, {"fov", 1, 0.1, 175, true}, clock, keys::camera_key);
    if (const auto v = value.find("height")) {
        if (!fov.empty()) value.fail("has both `fov` (perspective) and `height` (parallel projection)");
        lens.perspective = false;
        lens.y_magnification = static_cast<float>(v->number(1e-6, 1e6) / 2);
    }
    // chosen: 45 degrees, the normal lens of a 4:3 picture's height.
    double degrees = 45;
    if (!fov.empty()) fov.sample(fov.times.front(), {&degrees, 1});
    lens.vertical_fov = static_cast<float>(glm::radians(degrees));
    if (fov.times.size() > 1)
        film.tracks.push_back(
            track_of(fov, TrackTarget::field_of_view, static_cast<int>(index), glm::pi<double>() / 180));
    read_aperture(value, index, lens, film, clock);
    film.cameras.insert(film.cameras.begin() + static_cast<std::ptrdiff_t>(index), lens);
}

}  // namespace

void read_cameras(const JsonValue& film_value, Animation& film, const FilmClock& clock) {
    const auto one = film_value.find("camera"), several = film_value.find("cameras");
    if (one && several) one->fail("stands beside `cameras`; put all of them there");
    if (one) read_camera(*one, "camera", 0, film, clock);
    if (!several) return;
    std::size_t index = 0;
    for (const auto& [name, value] : several->members()) read_camera(value, name, index++, film, clock);
}

void focus_on_objects(const JsonValue& film_value, Animation& film) {
    if (const auto one = film_value.find("camera")) focus_on_object(*one, film.cameras.front(), film);
    const auto several = film_value.find("cameras");
    if (!several) return;
    std::size_t index = 0;
    for (const auto& [name, value] : several->members()) focus_on_object(value, film.cameras[index++], film);
}

void read_shots(const JsonValue& shots, Animation& film, const FilmClock& clock) {
    std::vector<std::string_view> names;
    for (const CameraLens& lens : film.cameras) names.emplace_back(lens.name);
    film.shots.clear();
    for (const JsonValue& value : shots.list(1, 10000)) {
        value.allow_only(keys::shot);
        Shot shot;
        const JsonValue at = value.need("at");
        shot.frame = std::llround(clock.seconds(at) * clock.rate);
        if (film.shots.empty() && shot.frame != 0) at.fail("must be 0: the film begins with its first shot");
        if (!film.shots.empty() && shot.frame <= film.shots.back().frame)
            at.fail("must be at least a frame later than the shot before");
        const JsonValue camera = value.need("camera");
        const std::string name = camera.text();
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end()) {
            const std::string nearest = core::nearest_word(name, names);
            camera.fail("there is no camera \"" + name + "\"" +
                        (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
        }
        shot.camera = static_cast<int>(found - names.begin());
        film.shots.push_back(shot);
    }
}

}  // namespace render2mpeg::scene
