#include "app/job/scene_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "app/options/usage_error.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "app/system/terminal.h"
#include "core/text.h"
#include "encoder/av/av.h"
#include "encoder/codec.h"

namespace render2mpeg::app {
namespace {

const scene::SphereWindow& window_named(const std::string& panorama) {
    const auto known = std::ranges::find(scene::panorama_names, panorama);
    return scene::panorama_windows[static_cast<std::size_t>(known - scene::panorama_names.begin())];
}

core::FramePacking packing_named(const std::string& name) {
    return static_cast<core::FramePacking>(std::ranges::find(core::packing_names, name) - core::packing_names.begin());
}

std::vector<int> objects_named(const scene::Animation& animation, const std::string& name) {
    std::vector<int> found;
    std::vector<std::string_view> names;
    for (std::size_t i = 0; i < animation.objects.size(); ++i) {
        names.emplace_back(animation.objects[i].name);
        if (animation.objects[i].name == name) found.push_back(static_cast<int>(i));
    }
    if (!found.empty()) return found;
    throw UsageError(fmt::format("--focus {}: neither a distance above 0 nor an object{}", name,
                                 core::did_you_mean(name, names, "\"", "\"")));
}

void forget_tracks(scene::Animation& animation, scene::TrackTarget target) {
    std::erase_if(animation.tracks, [&](const scene::Track& track) { return track.target == target; });
}

void set_focus(scene::Animation& animation, const std::string& focus) {
    char* end = nullptr;
    const double distance = std::strtod(focus.c_str(), &end);
    const bool is_number = !focus.empty() && *end == '\0';
    if (is_number && !(distance > 0 && distance <= 1e9))
        throw UsageError("--focus " + focus + ": expected a distance above 0, or the name of an object");
    const std::vector<int> objects = is_number ? std::vector<int>() : objects_named(animation, focus);
    forget_tracks(animation, scene::TrackTarget::focus_distance);
    for (scene::CameraLens& lens : animation.cameras) {
        lens.focus_objects = objects;
        lens.focus_point.reset();
        lens.focus_distance = is_number ? static_cast<float>(distance) : 0.0f;
    }
}

bool has_focus(const scene::CameraLens& lens) {
    return lens.focus_distance > 0 || lens.focus_point || !lens.focus_objects.empty();
}

// fit: docs/measurements.md#shutter-and-lens
int samples_of_lens(double quantiser) {
    if (quantiser <= 6) return 64;
    return quantiser <= 12 ? 32 : 16;
}

int samples_of_shutter(double quantiser) {
    if (quantiser <= 2) return 32;
    if (quantiser <= 6) return 16;
    return quantiser <= 12 ? 8 : 4;
}

/// Uncoded frames count as quantiser 4.
double mpeg2_quantiser(const RenderJob& film, int quantiser) {
    if (film.kind != OutputKind::film) return 4;
    return std::clamp(encoder::mpeg2_quantiser_like(film.coding.codec, quantiser), 1.0, 31.0);
}

void set_f_stop(scene::Animation& animation, const RenderOptions& options) {
    const float f_stop = *options.f_stop;
    forget_tracks(animation, scene::TrackTarget::f_stop);
    for (scene::CameraLens& lens : animation.cameras) {
        if (f_stop > 0 && lens.is_panorama())
            throw UsageError(options.as_said("--f-stop") + ": a panorama has no lens, all of it is sharp");
        lens.f_stop = f_stop;
        if (f_stop > 0 && !has_focus(lens))
            throw UsageError(options.as_said("--f-stop") +
                             ": nothing says what is in focus; give --focus a distance or an object's name");
    }
}

void set_exposure(scene::Animation& animation, const RenderOptions& options) {
    if (options.shutter) {
        const auto [angle, phase, rolling] = *options.shutter;
        animation.shutter = {angle, phase, rolling};
    }
    if (options.focus) set_focus(animation, *options.focus);
    if (options.f_stop) set_f_stop(animation, options);
    const scene::Traits traits = scene::traits_of(animation);
    if (options.shutter && animation.shutter.is_open() && !traits.shows_motion())
        animation.notes.emplace_back("--shutter does nothing here: nothing moves");
    if (options.focus && !traits.has_aperture)
        animation.notes.emplace_back("--focus does nothing here: no camera has an f-stop");
    if (options.exposure_samples && !traits.shows_motion() && !traits.has_aperture)
        animation.notes.emplace_back("--exposure-samples does nothing here: neither shutter nor lens blur anything");
}

void set_glare(scene::Animation& animation, const GlareRequest& asked) {
    core::Glare& glare = animation.glare;
    glare.kind = asked.kind;
    if (asked.strength) glare.strength = *asked.strength;
    // An explicit --glare is never of strength 0.
    if (asked.kind == core::GlareKind::off || asked.strength || glare.strength > 0) return;
    glare.strength = core::Glare{}.strength;
    animation.notes.push_back(
        fmt::format("--glare {0}: the file's glare has strength 0; it is {1} now (--glare {0}:STRENGTH)",
                    core::glare_names[static_cast<std::size_t>(asked.kind)], glare.strength));
}

/// In smaller pictures too few pixels lie between edges of light. chosen: docs/measurements.md#irradiance-cache.
constexpr std::int64_t least_pixels = 160 * 160;

scene::DefaultLight light_of(const std::string& word) {
    if (word == "none") return scene::DefaultLight::none;
    return word == "even" ? scene::DefaultLight::even : scene::DefaultLight::studio;
}

/// Last frame that a film is asked for, where its frames surely count at the file's own rate.
std::optional<std::int64_t> last_frame_of(const RenderOptions& options) {
    if (!options.frames || options.rate || options.coding.preset != nullptr) return std::nullopt;
    return options.frames->last;
}

}  // namespace

scene::LoadOptions load_options_of(const RenderOptions& options) {
    scene::LoadOptions out;
    out.camera = options.camera;
    out.animation = options.animation;
    out.sky = options.sky;
    out.variant = options.variant;
    out.light = light_of(options.light);
    if (options.size) out.lines = options.size->height;
    out.last_frame = last_frame_of(options);
    out.stops = &InterruptGuard::requested;
    out.tells = [](const std::string& step) { tell_activity("Blender exports the scene: " + step); };
    return out;
}

void set_projection(scene::Animation& animation, const std::string& name) {
    const scene::SphereWindow& window = window_named(name);
    bool open = false;
    for (scene::CameraLens& lens : animation.cameras) {
        if (lens.projection == scene::ProjectionKind::orthographic)
            throw UsageError(fmt::format(
                "--projection {}: the camera \"{}\" is one of parallel rays, which has no place to look around from",
                name, lens.name));
        open = open || lens.f_stop > 0;
        scene::make_panorama(lens, window);
    }
    forget_tracks(animation, scene::TrackTarget::field_of_view);
    forget_tracks(animation, scene::TrackTarget::f_stop);
    if (open)
        animation.notes.push_back(fmt::format("--projection {}: a panorama has no lens, all of it is sharp", name));
}

namespace {

void check_packing(core::FramePacking packing, const std::string& who, Size of_eye, const FilmOptions& options) {
    const bool across = packing == core::FramePacking::side_by_side;
    if ((across ? of_eye.width : of_eye.height) % 2 != 0)
        throw UsageError(fmt::format("{}: {}x{} for each eye: take an even {}, so that no sample of colour is of both",
                                     who, of_eye.width, of_eye.height, across ? "width" : "height"));
    if (options.coding.preset != nullptr)
        throw UsageError(fmt::format("{}: the pictures of {} are for one eye; leave one of both out", who,
                                     options.coding.preset->option()));
}

}  // namespace

void set_stereo(scene::Animation& animation, const RenderOptions& options, Size of_eye) {
    if (options.stereo) animation.stereo = packing_named(*options.stereo);
    if (animation.stereo == core::FramePacking::none) return;
    const std::string_view packing = core::name_of(animation.stereo);
    const std::string who = options.stereo ? fmt::format("--stereo {}", packing) : fmt::format("stereo {}", packing);
    for (std::size_t shown = 0; shown < std::max<std::size_t>(1, animation.shots.size()); ++shown) {
        const int camera = animation.shots.empty() ? 0 : animation.shots[shown].camera;
        const scene::CameraLens& lens = animation.cameras[static_cast<std::size_t>(camera)];
        if (lens.projection == scene::ProjectionKind::orthographic)
            throw UsageError(
                fmt::format("{}: the camera \"{}\" is one of parallel rays, which see no depth", who, lens.name));
    }
    check_packing(animation.stereo, who, of_eye, options);
    if (options.audit > 0)
        throw UsageError(fmt::format("--audit: with {} it would know one eye alone; leave one of both out", who));
}

void tell_shape(scene::Animation& animation, Size size) {
    for (const scene::CameraLens& lens : animation.cameras) {
        if (!lens.is_panorama()) continue;
        // chosen: a thousandth, less than a pixel of 640.
        const double shape = static_cast<double>(size.width) / size.height / lens.window.aspect();
        if (std::abs(shape - 1) < 1e-3) continue;
        animation.notes.push_back(
            fmt::format("{}x{}: a panorama of {} is {:.3g} times as wide as high; it is stretched", size.width,
                        size.height, scene::text_of(lens.window), lens.window.aspect()));
        return;
    }
}

namespace {

/// Tells of the film and those beside it which of their files cannot say something.
void tell_silent(scene::Animation& animation, const RenderOptions& options, const std::string& what, auto&& says) {
    const auto tell = [&](const std::filesystem::path& file, encoder::Codec codec) {
        if (!file.empty() && !says(file, codec))
            animation.notes.push_back(fmt::format("{}: such files {}", file.string(), what));
    };
    if (av::is_film(options.output)) tell(options.output, codec_of(options.coding, options.output));
    for (const auto& [subject, file, view] : options.side_films)
        if (view) tell(file, view->codec_in(file));
}

encoder::SphereBounds bounds_of(const scene::SphereWindow& window) {
    const scene::SphereWindow whole;
    const double turn = whole.east - whole.west, half = whole.north - whole.south;
    return {(window.west - whole.west) / turn, (whole.north - window.north) / half, (whole.east - window.east) / turn,
            (window.south - whole.south) / half};
}

std::optional<encoder::SphereBounds> sphere_of(scene::Animation& animation, const RenderOptions& options) {
    std::vector<const scene::CameraLens*> shown;
    for (const scene::Shot& shot : animation.shots)
        shown.push_back(&animation.cameras[static_cast<std::size_t>(shot.camera)]);
    if (shown.empty()) shown.push_back(&animation.cameras.front());
    const scene::CameraLens& first = *shown.front();
    const auto is_other = [&](const scene::CameraLens* lens) {
        return lens->is_panorama() != first.is_panorama() || !(lens->window == first.window);
    };
    if (std::ranges::any_of(shown, is_other)) {
        animation.notes.emplace_back("cameras show different parts of the sphere: the file does not say which");
        return std::nullopt;
    }
    if (!first.is_panorama()) return std::nullopt;
    tell_silent(animation, options, "cannot say that they are panoramas; .mp4, .mkv and .webm do",
                [](const std::filesystem::path& file, encoder::Codec) { return av::tells_immersive(file); });
    return bounds_of(first.window);
}

core::FramePacking packing_of(scene::Animation& animation, const RenderOptions& options) {
    if (animation.stereo == core::FramePacking::none) return animation.stereo;
    tell_silent(animation, options, "cannot say that they are for two eyes; .mp4, .mkv and .webm do",
                [](const std::filesystem::path& file, encoder::Codec codec) {
                    return av::tells_immersive(file) || codec == encoder::Codec::h264;
                });
    return animation.stereo;
}

}  // namespace

void describe_view(scene::Animation& animation, const RenderOptions& options, encoder::Settings& coding) {
    coding.sphere = sphere_of(animation, options);
    coding.packing = packing_of(animation, options);
}

void set_chapters(scene::Animation& animation, const RenderOptions& options, const FrameRange& frames,
                  encoder::Labels& labels) {
    const std::vector<scene::Chapter>& all = animation.chapters;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const std::int64_t first = std::max(all[i].frame, frames.first),
                           end = std::min(i + 1 < all.size() ? all[i + 1].frame : frames.last + 1, frames.last + 1);
        if (first < end)
            labels.chapters.push_back({first - frames.first, end - frames.first, core::printable(all[i].title)});
    }
    const auto can = [](const std::filesystem::path& file, encoder::Codec) { return av::can_have_chapters(file); };
    if (!labels.chapters.empty())
        tell_silent(animation, options, "have no chapters; .mp4, .mov, .mkv and .webm have", can);
}

void describe_view(const EncodeOptions& options, encoder::Settings& coding) {
    if (options.projection) coding.sphere = bounds_of(window_named(*options.projection));
    coding.packing = packing_named(options.stereo.value_or("none"));
    const bool tells_eyes = coding.packing == core::FramePacking::none || coding.codec == encoder::Codec::h264;
    if (!options.quiet && (coding.sphere || !tells_eyes) && !av::tells_immersive(options.output))
        print_line(options.output.string() + ": such files cannot say what frames show; .mp4, .mkv and .webm do");
    if (coding.packing == core::FramePacking::none) return;
    const bool across = coding.packing == core::FramePacking::side_by_side;
    if ((across ? coding.width : coding.height) % 2 != 0)
        throw UsageError(
            fmt::format("--stereo {}: {}x{} has no halves of one size", *options.stereo, coding.width, coding.height));
    check_packing(coding.packing, "--stereo " + *options.stereo,
                  {coding.width / (across ? 2 : 1), coding.height / (across ? 1 : 2)}, options);
}

void change_scene(scene::Animation& animation, const RenderOptions& options) {
    set_exposure(animation, options);
    if (options.fog) animation.fog.visibility = *options.fog;
    if (options.glare) set_glare(animation, *options.glare);
    if (options.transparent) animation.transparent = *options.transparent == "on";
    if (options.limits == "none" && animation.layers) {
        animation.notes.push_back(fmt::format(
            "not kept: {} transparent bounces: behind as many layers Cycles is black, the film shows what is there "
            "(--limits blender: black)",
            *animation.layers));
        animation.layers.reset();
    }
}

void tell_samples(RenderJob& film) {
    std::vector<renderer::PlanRow> rows = film.plan.rows();
    for (renderer::PlanRow& row : rows) {
        if (!row.runs || (row.pass != renderer::Pass::shutter && row.pass != renderer::Pass::lens)) continue;
        const bool fixed = film.coding.rate_control.mode == encoder::RateMode::constant_quantiser;
        if (film.exposure_samples || film.kind != OutputKind::film || fixed)
            row.reason += fmt::format("; {} samples ({})", exposure_samples(film, film.coding.quantiser).most,
                                      film.exposure_samples           ? "as asked for"
                                      : film.kind != OutputKind::film ? "not coded"
                                                                      : "by quantiser");
        else
            row.reason += "; samples by each picture's quantiser";
    }
    film.plan = renderer::Plan(std::move(rows));
}

renderer::ExposureSamples exposure_samples(const RenderJob& film, int quantiser) {
    if (film.exposure_samples) return {*film.exposure_samples, *film.exposure_samples};
    // chosen: a draft shows that something is blurred, and by how much (2 to 16).
    if (film.preview) return {4, film.plan.runs(renderer::Pass::lens) ? 8 : 4};
    const double q = mpeg2_quantiser(film, quantiser);
    const int most = film.plan.runs(renderer::Pass::lens) ? samples_of_lens(q) : samples_of_shutter(q);
    // chosen: as many as sharp edges get (SeeSettings::edge_samples); with 4 they were rougher than those.
    return {std::min(most, 16), most};
}

renderer::ExposureSamples exposure_samples(const RenderJob& film, int quantiser, const perceptual::Display& display) {
    renderer::ExposureSamples samples = exposure_samples(film, quantiser);
    if (film.exposure_samples) return samples;
    samples.shown = [display](float luminance) { return perceptual::luma_of(display, glm::vec3(luminance)); };
    // chosen: 0.15 code values for each unit of the quantiser, not tuned; rims of discs are few pixels.
    samples.visible = 0.15f * static_cast<float>(mpeg2_quantiser(film, quantiser));
    return samples;
}

CacheChoice choose_cache(const std::string& asked, const scene::Traits& traits, bool rays, bool reference,
                         std::int64_t frames, std::int64_t pixels) {
    using enum renderer::CacheUse;
    if (asked == "off") return {off, "not wanted: --cache off"};
    if (reference) return {off, "no cause: every pixel is lit by itself"};
    if (asked == "on") return {on, "--cache on asks for it"};
    if (!traits.has_diffuse_surfaces) return {off, "would not pay: no surface shows one light from all sides"};
    if (rays) return {static_light, "pixels and frames share what gather rays found"};
    if (frames == 1) return {off, "would not pay: there is no later frame to keep light for"};
    if (pixels < least_pixels) return {off, "would not pay: the picture is small"};
    // A change of light discards all records: only the frame's own pixels would gain.
    if (traits.lights_change) return {off, "would not pay: lights change"};
    if (traits.changes_light()) return {off, "would not pay: what moves changes light"};
    return {static_light, traits.camera_moves ? "only the camera moves: light stays for later frames"
                                              : "nothing moves: light stays for later frames"};
}

std::string cache_word(const renderer::Settings& rendering) {
    constexpr const char* words[] = {"off", "static", "on"};
    return words[static_cast<int>(rendering.cache)];
}

}  // namespace render2mpeg::app
