#include "app/job/render_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <span>
#include <system_error>
#include <utility>

#include "app/job/scene_settings.h"
#include "app/options/mistakes.h"
#include "app/options/usage_error.h"
#include "app/system/interrupt.h"
#include "app/system/progress.h"
#include "core/color.h"
#include "core/error.h"
#include "core/scene_formats.h"
#include "core/text.h"
#include "encoder/av/av.h"
#include "encoder/codec.h"
#include "parallel/loops.h"
#include "scene/load.h"
#include "scene/preparation/framing.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::app {
namespace {

/// Default frames: up to the last key.
FrameRange frames_of(const scene::Animation& animation, const core::FrameRate& rate) {
    if (animation.first_frame && animation.last_frame) return {*animation.first_frame, *animation.last_frame};
    // chosen: a film in which nothing moves lasts one second, which players show and nobody waits long for.
    const double seconds = animation.duration > 0 ? animation.duration : 1.0;
    const auto last = static_cast<std::int64_t>(std::llround(seconds * rate.hertz.value())) - 1;
    const std::int64_t first = animation.first_frame.value_or(0);
    return {first, animation.last_frame.value_or(std::max(first, last))};
}

void refuse_outside(const FrameRange& frames, const FrameRange& whole) {
    if (frames.first >= whole.first && frames.last <= whole.last) return;
    throw UsageError(
        fmt::format("--frames {}:{}: the film has frames {} to {}; choose among them, or hold its ends with --hold",
                    frames.first, frames.last, whole.first, whole.last));
}

/// Shots and range count in the file's rate; another rate keeps their times.
void change_rate(scene::Animation& animation, const core::FrameRate& from, const core::FrameRate& to) {
    if (from.hertz == to.hertz) return;
    const auto rescaled = [&](std::int64_t frame) {
        return static_cast<std::int64_t>(
            std::llround(static_cast<double>(frame) * to.hertz.value() / from.hertz.value()));
    };
    for (scene::Volume& volume : animation.volumes) {
        const std::int64_t first = volume.first_frame, files = std::ssize(volume.files);
        std::vector<std::filesystem::path> shown, more;
        for (std::int64_t n = rescaled(first); files > 1 && n < rescaled(first + files); ++n) {
            const double own = std::floor(static_cast<double>(n) * from.hertz.value() / to.hertz.value() + 1e-6);
            const std::size_t file = volume.file_at(static_cast<std::int64_t>(own));
            shown.push_back(volume.files[file]);
            if (!volume.more_files.empty()) more.push_back(volume.more_files[file]);
        }
        volume.first_frame = rescaled(first);
        if (shown.empty()) continue;
        volume.files = std::move(shown);
        volume.more_files = std::move(more);
    }
    for (scene::Shot& shot : animation.shots) shot.frame = rescaled(shot.frame);
    for (scene::Chapter& chapter : animation.chapters) chapter.frame = rescaled(chapter.frame);
    if (animation.first_frame) animation.first_frame = rescaled(*animation.first_frame);
    if (animation.last_frame)
        animation.last_frame = std::max(animation.first_frame.value_or(0), rescaled(*animation.last_frame + 1) - 1);
}

renderer::Settings rendering_settings(const RenderOptions& options, const scene::PictureFormat& format) {
    renderer::Settings settings;
    settings.format = format;
    settings.samples = options.samples;
    settings.indirect = options.indirect == "lightcuts" ? renderer::Indirect::lightcuts : renderer::Indirect::rays;
    settings.vpls = options.vpls;
    settings.clamp = options.clamp == "none" ? renderer::Clamp::none : renderer::Clamp::bounded;
    // chosen: of 1000 to 8000 clusters the least with which at 2 % no point stops early
    // (docs/measurements.md#lightcuts).
    settings.max_cut = 4000;
    settings.isa = options.isa.value_or(core::detect_isa());
    return settings;
}

int edge_samples_of(const RenderOptions& options, const RenderJob& film) {
    if (options.edge_samples) return *options.edge_samples;
    if (options.is_given("--samples") || options.samples != RenderOptions().samples) return 0;
    // fit: docs/measurements.md#edges
    return film.kind == OutputKind::film ? 16 : 64;
}

void settle_edges(RenderJob& film, const RenderOptions& options) {
    film.rendering.edge_samples = edge_samples_of(options, film);
    const bool by_hand = (options.edge_samples && !options.effort) || film.rendering.edge_samples == 0;
    const int most = effort_from(film.preview ? "low" : options.effort.value_or("default")).most_samples;
    film.rendering.most_samples = film.tolerance.coupled && !by_hand ? most : 0;
}

CouplingSettings coupling_settings(const RenderOptions& options, const ToleranceRequest& tolerance) {
    CouplingSettings settings;
    settings.strategy = options.masking == "quantised" ? perceptual::Strategy::quantised : perceptual::Strategy::warped;
    settings.fraction = tolerance.fraction;
    settings.loss = tolerance.loss;
    return settings;
}

ShapeWishes wishes_of(const RenderOptions& options, const scene::Animation& animation) {
    ShapeWishes wishes = shape_wishes(options.coding);
    if (options.size) wishes.size = *options.size;
    if (options.rate) wishes.rate = *options.rate;
    wishes.source = animation.source;
    if (animation.size) wishes.source_size = Size{animation.size->x, animation.size->y};
    if (animation.frame_rate) wishes.source_rate = core::frame_rate_from(*animation.frame_rate);
    wishes.source_display_aspect = animation.display_aspect;

    const std::size_t camera = animation.shots.empty() ? 0 : static_cast<std::size_t>(animation.shots.front().camera);
    const float framed = animation.cameras[camera].aspect;
    if (std::isfinite(framed) && framed > 0.01f && framed < 100)
        wishes.framed = core::Rational{std::lround(framed * 1000), 1000};
    // A preset takes the shape nearest to the scene's size or camera.
    if (options.coding.preset != nullptr && !wishes.source_display_aspect) {
        if (animation.size)
            wishes.source_display_aspect = core::Rational{animation.size->x, animation.size->y};
        else
            wishes.source_display_aspect = wishes.framed;
    }
    return wishes;
}

std::optional<float> exposure_of(const RenderOptions& options, const scene::Animation& animation) {
    return options.exposure ? options.exposure : animation.exposure;
}

void settle_display(RenderJob& film, const RenderOptions& options) {
    film.exposure = exposure_of(options, *film.animation);
    film.measures_exposure = !film.exposure;
    film.view = view_of(options, film.animation->view.value_or(core::View()));
    const bool beside = std::ranges::any_of(options.side_films, [](const SideFilmRequest& other) {
        return other.view && other.view->view.name == core::ViewName::pq;
    });
    if (!beside) check_peak(options, film.view);
    if (film.view.is_hdr() && film.kind == OutputKind::y4m)
        throw UsageError("--view " + core::text_of(film.view) +
                         ": such a stream has 8 bits; choose a film, .mp4 or .mkv");
}

void decide_passes(RenderJob& film, const RenderOptions& options) {
    renderer::Wanted& wanted = film.wanted;
    wanted.film = film.kind == OutputKind::film;
    wanted.developed = film.kind == OutputKind::y4m || film.kind == OutputKind::png;
    wanted.layers = options.layers.has_value();
    // Heatmaps of cuts, errors and records need layers.
    for (const auto& [subject, file, view] : options.side_films)
        wanted.layers = wanted.layers || (subject != "tolerance" && subject != "quantiser" && !view);
    wanted.indirect = options.vpls > 0;
    wanted.by_rays = options.indirect == "rays" && !film.preview;
    wanted.caustics = options.caustics == "on";
    const scene::Traits traits = scene::traits_of(*film.animation);
    film.plan = renderer::make_plan(traits, wanted);
    film.cache = choose_cache(options.cache, traits, options.indirect == "rays", film.tolerance.reference,
                              film.frame_count(), std::int64_t{film.format.width} * film.format.height);
    film.rendering.cache = film.cache.use;
    tell_samples(film);
}

void refuse_beside_truth(const RenderJob& film, const RenderOptions& options) {
    const auto refuse = [](const std::string& option, const char* why) {
        throw UsageError(option + ": with --tolerance truth " + why);
    };
    if (film.plan.runs(renderer::Pass::shutter)) refuse("--shutter", "every frame is an instant; say --shutter 0");
    if (film.plan.runs(renderer::Pass::lens)) refuse("--f-stop", "all is in focus; say --f-stop off");
    if (options.audit > 0) refuse("--audit", "there is nothing truer to hold the picture against");
    for (const auto& [subject, file, view] : options.side_films)
        if (subject != "quantiser" && subject != "error" && !view)
            refuse("--heatmap " + subject, "there are neither cuts nor records");
}

/// Draft settings without an option.
void settle_preview(RenderJob& film) {
    film.rendering.calibrate = false;
    film.coding.user_data = "draft: render2mpeg --preview";
}

}  // namespace

std::vector<Chunk> RenderJob::chunks() const {
    std::vector<Chunk> all = chunks_of(frames, coding.gop);
    if (!part) return all;
    EXPECTS(part->first <= part->last && part->last < all.size());
    const auto own = std::span(all).subspan(part->first, part->count());
    return {own.begin(), own.end()};
}

core::ToleranceMap RenderJob::tolerance_map() const {
    if (tolerance.reference) return core::ToleranceMap::reference();
    // Half a code value changes no black pixel. Without tolerance or exposure there is no floor.
    float floor = 0;
    if (exposure && tolerance.relative > 0) {
        floor = core::luminance(display().with_luma(glm::vec3(1), 16.5f));
    }
    return core::ToleranceMap::uniform(format.width, format.height, {floor, tolerance.relative});
}

bool RenderJob::is_transparent() const {
    const auto& materials = animation->materials;
    return animation->transparent || std::ranges::any_of(materials, &scene::Material::holdout);
}

bool RenderJob::has_alpha() const {
    const bool can = kind == OutputKind::film ? encoder::facts_of(coding.codec).has_alpha()
                                              : kind == OutputKind::png || kind == OutputKind::exr;
    return can && is_transparent();
}

namespace {

/// Whether a film beside the film has alpha.
bool has_alpha_beside(const RenderJob& film, const RenderOptions& options) {
    return film.is_transparent() && std::ranges::any_of(options.side_films, [](const SideFilmRequest& beside) {
               return beside.view && encoder::facts_of(beside.view->codec_in(beside.file)).has_alpha();
           });
}

}  // namespace

RenderJob without(const RenderJob& film, renderer::Pass effect) {
    RenderJob less = film;
    less.wanted.without = effect;
    less.plan = renderer::make_plan(scene::traits_of(*film.animation), less.wanted);
    return less;
}

renderer::Renderer renderer_of(const RenderJob& film, std::optional<renderer::Renderer::KnownLight> known) {
    std::optional<parallel::ThreadLimit> one_thread;
    if (film.images_in_turn) one_thread.emplace(1);
    renderer::Renderer renderer(*film.animation, film.rendering, film.plan, film.textures.get(), known);
    film.images->forget();
    return renderer;
}

void check_scene(const std::filesystem::path& input) {
    std::error_code error;
    if (std::filesystem::exists(input, error)) {
        if (const std::string why = not_a_scene(input); !why.empty()) throw core::Error("reading", input.string(), why);
        return;
    }
    const std::filesystem::path folder = input.has_parent_path() ? input.parent_path() : ".";
    if (std::filesystem::is_symlink(input, error))
        throw core::Error(
            "reading", input.string(),
            "it is a link to " + std::filesystem::read_symlink(input, error).string() + ", which is not there");
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
        if (entry.exists(error)) names.push_back(entry.path().filename().string());
    std::ranges::sort(names);
    const std::string before = (input.parent_path() / "").string();
    throw core::Error("reading", input.string(),
                      "there is no such file" + core::did_you_mean(input.filename().string(), names, before));
}

namespace {

/// The scene, with its images on demand.
void take(RenderJob& film, const std::shared_ptr<const scene::Animation>& animation) {
    film.animation = animation;
    film.images = std::make_shared<ImageReader>(animation);
    film.textures = std::make_shared<renderer::TextureStore>(
        *animation, [images = film.images](int image) { return images->take(image); });
}

/// The scene as its file has it. Throws core::Error.
std::shared_ptr<scene::Animation> load(const RenderOptions& options) {
    check_scene(options.input);
    const bool exports = core::scene_reader_of(options.input) == core::SceneReader::blender;
    tell_activity(exports ? "Blender exports the scene" : "reading the scene");
    try {
        return std::make_shared<scene::Animation>(scene::load(options.input, load_options_of(options)));
    } catch (const core::Error& error) {
        if (InterruptGuard::requested()) throw Interrupted(error.what());
        throw;
    }
}

/// Masters are not for the eye alone: they are lit as frames are, twice as finely.
void settle_tolerance(RenderJob& film, const RenderOptions& options) {
    const bool coded = film.kind == OutputKind::film;
    const encoder::CodecFacts& codec = encoder::facts_of(codec_of(options.coding, options.output));
    const bool master = coded && codec.master;
    film.tolerance = options.tolerance.value_or(master  ? fixed_tolerance(0.01f)
                                                : coded ? coupled_tolerance()
                                                        : fixed_tolerance(0.02f));
    film.tolerance.loss = options.loss.value_or(usual_loss);
    if (options.is_given("--loss") && film.tolerance.fraction)
        throw UsageError("--loss: " + options.as_said("--tolerance") + " says how far light errs; give one of both");
    film.coupling = coupling_settings(options, film.tolerance);
    if (film.tolerance.coupled && (!coded || master))
        throw UsageError(
            "--tolerance coupled: only films for viewers hide what could be coupled to; choose fixed=P% for " +
            (master ? std::string(codec.name) : options.output.string()));
}

/// Completes the labels of the film, or of those beside images, as the first of them can have them.
void label(RenderJob& film, const RenderOptions& options, const Shape& shape, scene::Animation& animation) {
    if (film.kind != OutputKind::film) {
        const auto beside =
            std::ranges::find_if(options.side_films, [](const SideFilmRequest& made) { return made.view.has_value(); });
        if (beside == options.side_films.end()) return;
        CodingOptions words;
        words.codec = beside->view->codec_in(beside->file);
        words.title = options.coding.title;
        words.timecode = options.coding.timecode;
        film.coding.labels = coding_settings(words, shape, film.frames.first, beside->file, beside->view->view).labels;
    }
    set_chapters(animation, options, film.frames, film.coding.labels);
}

/// The first codec of the film, if it is one, and of those made beside it that takes no odd sides; null: all do.
const encoder::CodecFacts* evens_sides(const std::optional<encoder::Codec>& codec, const RenderOptions& options) {
    std::vector<encoder::Codec> codecs;
    if (codec) codecs.push_back(*codec);
    for (const auto& [subject, file, view] : options.side_films)
        if (view) codecs.push_back(view->codec_in(file));
    const auto found = std::ranges::find_if(codecs, [](encoder::Codec c) { return encoder::facts_of(c).even_sides(); });
    return found == codecs.end() ? nullptr : &encoder::facts_of(*found);
}

/// The shape of one eye's pictures; of drafts they are of half the size, or the least that their codec takes.
Shape shape_of_eye(const RenderJob& film, const RenderOptions& options, scene::Animation& animation) {
    const Preset* preset = options.coding.preset;
    if (preset != nullptr) preset->check_output(options.output);
    ShapeWishes wishes = wishes_of(options, animation);
    Shape shape = settle_shape(wishes, preset);
    std::optional<encoder::Codec> codec;
    if (film.kind == OutputKind::film) codec = codec_of(options.coding, options.output);
    const Size even{shape.size.width + shape.size.width % 2, shape.size.height + shape.size.height % 2};
    const encoder::CodecFacts* evens = evens_sides(codec, options);
    if (evens != nullptr && area_of(even) > area_of(shape.size)) {
        animation.notes.push_back(fmt::format("{}x{}: films in {} are made with even sides, {}x{}", shape.size.width,
                                              shape.size.height, evens->name, even.width, even.height));
        wishes.size = even;
        shape = settle_shape(wishes, preset);
    }
    if (!film.preview || options.size || options.effort || preset != nullptr) return shape;
    // DNxHR has the matrix of 720 lines and more alone.
    const double least = codec == encoder::Codec::dnxhr ? 720.0 / shape.size.height : 0.0;
    wishes.size = scaled(shape.size, std::max(0.5, least), codec);
    return settle_shape(wishes, preset);
}

/// The shape of pictures that hold those of all eyes.
Shape shape_of_all(Shape of_eye, core::FramePacking packing) {
    const scene::PictureFormat all = packed({of_eye.size.width, of_eye.size.height}, packing);
    of_eye.size = {all.width, all.height};
    const bool is_square = of_eye.pixel_aspect.num == of_eye.pixel_aspect.den;
    if (packing != core::FramePacking::none && !is_square) of_eye.aspect_ratio_code = 0;
    return of_eye;
}

}  // namespace

RenderJob prepare(const RenderOptions& wanted) {
    const RenderOptions asked = with_effort(wanted), options = asked.preview ? preview_options(asked) : asked;
    RenderJob film;
    film.preview = options.preview;
    film.kind = options.output.empty() ? OutputKind::film : kind_of(options.output);
    settle_tolerance(film, options);

    const std::shared_ptr<scene::Animation> loaded = load(options);
    if (options.projection) set_projection(*loaded, *options.projection);
    const Shape shape = shape_of_eye(film, options, *loaded);
    film.rate = shape.rate;
    set_stereo(*loaded, options, shape.size);
    tell_shape(*loaded, shape.size);
    scene::fit_automatic_camera(*loaded,
                                static_cast<double>(shape.size.width) / shape.size.height * shape.pixel_aspect.value());
    if (loaded->frame_rate) change_rate(*loaded, core::frame_rate_from(*loaded->frame_rate), film.rate);
    change_scene(*loaded, options);
    film.exposure_samples = options.exposure_samples;
    const std::shared_ptr<const scene::Animation> animation = loaded;
    take(film, animation);
    if (!std::filesystem::is_directory(options.input) && !options.output.empty() &&
        std::filesystem::weakly_canonical(options.input) == std::filesystem::weakly_canonical(options.output))
        throw core::Error("writing", options.output.string(), "it is the input");

    // Fill the gaps: command line, animation file, defaults.
    const FrameRange whole = frames_of(*animation, film.rate);
    film.frames = options.frames.value_or(whole);
    // A still scene has any length.
    if (!options.hold && (animation->last_frame || animation->duration > 0)) refuse_outside(film.frames, whole);
    film.pixel_aspect = shape.pixel_aspect;
    const scene::PictureFormat of_eye{shape.size.width, shape.size.height,
                                      static_cast<float>(shape.pixel_aspect.value())};
    film.format = packed(of_eye, animation->stereo);
    film.rendering = rendering_settings(options, of_eye);
    const Shape of_all = shape_of_all(shape, animation->stereo);
    settle_display(film, options);
    film.audit = options.audit;

    film.rendering.transparent = animation->transparent;

    film.coding = coding_settings(options.coding, of_all, film.frames.first, options.output, film.view);
    if (film.kind == OutputKind::film) describe_view(*loaded, options, film.coding);
    label(film, options, of_all, *loaded);
    film.coding.grain = options.grain.value_or(animation->grain);
    film.coding.alpha = film.kind == OutputKind::film && film.has_alpha();
    film.rendering.mattes = options.layers || film.has_alpha() || has_alpha_beside(film, options);
    film.keyframes = keyframes_of(options.coding);
    film.two_passes = film.kind == OutputKind::film && two_passes(options.coding);
    film.disc = options.coding.preset != nullptr && options.coding.preset->disc;
    film.sound = sound_of(options.coding, animation->sound, options.output, film.frames, film.rate);
    if (film.kind == OutputKind::film) check_settings(film.coding);
    settle_edges(film, options);

    decide_passes(film, options);
    if (film.tolerance.truth) refuse_beside_truth(film, options);
    if (film.preview) settle_preview(film);
    return film;
}

RenderJob draft_of(const RenderJob& film) {
    const RenderOptions usual = preview_options({});
    RenderJob draft = film;
    draft.preview = true;
    draft.two_passes = false;
    draft.audit = 0;
    draft.allocations.clear();
    draft.tolerance = *usual.tolerance;
    draft.rendering.samples = usual.samples;
    draft.rendering.edge_samples = *usual.edge_samples;
    draft.rendering.most_samples = 0;
    draft.rendering.vpls = usual.vpls;
    draft.rendering.indirect = renderer::Indirect::lightcuts;
    draft.wanted.by_rays = false;
    draft.plan = renderer::make_plan(scene::traits_of(*draft.animation), draft.wanted);
    draft.rendering.cache = renderer::CacheUse::off;
    draft.cache = {};
    draft.coding.effort = encoder::Effort::fast;
    draft.coding.b_pictures = *usual.coding.b_pictures;
    draft.coding.quantiser = static_cast<int>(
        std::lround(encoder::quantiser_like(film.coding.codec, *usual.coding.quantiser / film.view.coarseness())));
    draft.coding.rate_control.mode = encoder::RateMode::constant_quantiser;
    settle_preview(draft);
    return draft;
}

RenderJob at_effort(const RenderJob& film, const Effort& effort, const RenderOptions& options) {
    RenderJob changed = film;
    if (film.tolerance.coupled && !options.loss) changed.tolerance.loss = effort.loss;
    if (!film.tolerance.coupled && !options.tolerance)
        changed.tolerance.relative = (encoder::facts_of(film.coding.codec).master ? 0.5f : 1.0f) * effort.fixed;
    changed.coupling.loss = changed.tolerance.loss;
    if (options.is_given("--samples") || options.edge_samples) return changed;
    changed.rendering.samples = std::min(film.rendering.samples, effort.samples);
    if (effort.edge_samples > 0)
        changed.rendering.edge_samples = std::min(film.rendering.edge_samples, effort.edge_samples);
    changed.rendering.most_samples = std::min(film.rendering.most_samples, effort.most_samples);
    return changed;
}

av::Sound sound_of(const CodingOptions& options, const std::optional<std::filesystem::path>& scenes,
                   const std::filesystem::path& output, const FrameRange& frames, const core::FrameRate& rate) {
    const bool none = options.audio && *options.audio == "none";
    if (none || !av::is_film(output) || (!options.audio && !scenes)) return {};
    if (!av::can_have_sound(output)) {
        if (!options.audio) return {};
        throw core::Error("--audio: " + output.string() + " has no sound; .mpg, .ts, .mkv, .webm, .mp4 and .mov have");
    }
    av::Sound sound;
    sound.file = options.audio ? std::filesystem::path(*options.audio) : *scenes;
    sound.offset = options.audio_offset - static_cast<double>(frames.first) / rate.hertz.value();
    sound.ac3 = options.preset != nullptr;
    sound.channels = probe_sound(sound.file);
    return sound;
}

}  // namespace render2mpeg::app
