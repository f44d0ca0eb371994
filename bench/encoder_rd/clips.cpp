#include "encoder_rd/clips.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <memory>
#include <utility>

#include "app/job/automatic_exposure.h"
#include "app/job/render_job.h"
#include "app/loop/pipeline.h"
#include "app/options/option_text.h"
#include "core/error.h"
#include "encoder/av/y4m.h"
#include "encoder/av/y4m_reader.h"
#include "encoder_rd/crowd.h"
#include "encoder_rd/exact_motion.h"
#include "encoder_rd/foreign.h"
#include "encoder_rd/textures.h"
#include "renderer/renderer.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::bench {
namespace {

namespace fs = std::filesystem;

constexpr int film_frames = 60, small_film_frames = 30;
constexpr const char* small_size = "320x176";

int length_of(const ClipRequest& request) {
    return request.small ? small_film_frames : film_frames;
}

const fs::path& here() {
    static const fs::path folder = fs::path(RENDER2MPEG_SOURCE_DIR) / "bench/encoder_rd";
    return folder;
}
fs::path animations() {
    return fs::path(RENDER2MPEG_SOURCE_DIR) / "animations";
}

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw core::Error("reading", file.string(), "no such file");
    return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> films_in(const fs::path& folder) {
    std::vector<std::string> names;
    if (fs::is_directory(folder))
        for (const auto& entry : fs::directory_iterator(folder))
            if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

/// Textures are painted once for every version of the code that paints them.
fs::path texture(const fs::path& cache, const std::string& name) {
    ContentHash code;
    code.add_file(here() / "textures.cpp");
    const fs::path folder = cache / ("textures-" + code.text()), file = folder / (name + ".png");
    fs::create_directories(folder);
    if (!fs::exists(file)) write_texture(folder, name);
    return file;
}

/// Where a clip's film is written down; a clip may also be named by its file, or by the folder of its `film.json`.
fs::path film_of(const std::string& name) {
    for (const fs::path& file :
         {here() / (name + ".json"), here() / "special" / (name + ".json"), here() / "scenes" / (name + ".json"),
          here() / "test" / (name + ".json"), here() / "test" / "scenes" / (name + ".json"),
          animations() / name / "film.json", fs::path(name), fs::path(name) / "film.json"})
        if (fs::is_regular_file(file)) return fs::absolute(file).lexically_normal();
    throw core::Error("clip " + name + ": there is no such film");
}

/// What a clip is called in tables.
std::string title_of(const fs::path& film) {
    return (film.filename() == "film.json" ? film.parent_path() : film.stem()).filename().string();
}

/// Puts a film into a folder of its own with all that it mentions: paths out of it are refused by the loader.
void assemble(const ClipRequest& request, const fs::path& folder) {
    fs::remove_all(folder);
    fs::create_directories(folder);
    const std::string film = text_of(film_of(request.name));
    // A film of a real scene says in its first line which file of SCENES it builds on.
    const std::string mark = "// SCENES/";
    if (film.starts_with(mark)) {
        if (request.scenes.empty())
            throw core::Error("clip " + request.name + " is made of a real scene: say with --scenes where those are");
        const fs::path scene = request.scenes / film.substr(mark.size(), film.find('\n') - mark.size());
        fs::copy(scene.parent_path(), folder, fs::copy_options::recursive);
    }
    // One that is a folder brings along what lies in it.
    if (const fs::path file = film_of(request.name); file.filename() == "film.json") {
        const fs::path own = file.parent_path(), cache = fs::absolute(request.cache).lexically_normal();
        if (std::mismatch(own.begin(), own.end(), cache.begin(), cache.end()).first == own.end())
            throw core::Error("clip " + request.name + ": --cache lies within its folder");
        fs::copy(own, folder, fs::copy_options::recursive);
    }
    std::ofstream(folder / "film.json") << film;
    if (film.find("\"plaster.png\"") != std::string::npos)
        for (const char* name : {"floor.png", "plaster.png", "carpet.png"})
            fs::copy_file(animations() / "still_room" / name, folder / name, fs::copy_options::skip_existing);
    for (const std::string& name : texture_names())
        if (film.find('"' + name + ".png\"") != std::string::npos && !fs::exists(folder / (name + ".png")))
            fs::copy_file(texture(request.cache, name), folder / (name + ".png"));
    if (film.find("\"crowd.gltf\"") != std::string::npos) write_crowd(animations() / "character", folder);
    if (film.find("\"figure.gltf\"") != std::string::npos)
        fs::copy(animations() / "character", folder, fs::copy_options::recursive | fs::copy_options::skip_existing);
}

/// The film as `render` makes it where no option says more.
app::RenderJob render_job_of(const fs::path& folder, const ClipRequest& request) {
    app::RenderOptions options;
    options.input = folder;
    options.output = folder / "film.m2v";
    if (request.small) options.size = app::size_from(small_size);
    app::RenderJob film = app::prepare(options);
    film.frames.last = std::min<std::int64_t>(film.frames.last, film.frames.first + length_of(request) - 1);
    return film;
}

/// Writes pictures as they are lit.
class Writing : public app::LoopObserver {
  public:
    explicit Writing(av::Y4mWriter& out) : out_(out) {}
    void lit(const app::LitFrame& frame) override { out_.write(frame.picture); }

  private:
    av::Y4mWriter& out_;
};

void render(app::RenderJob film, const std::string& name, const fs::path& file) {
    if (!film.exposure) film.exposure = app::measure_exposure(film);
    renderer::Renderer renderer = app::renderer_of(film);
    av::Y4mWriter out(file, film.format.width, film.format.height, film.rate);
    Writing writing(out);
    app::RunStatistics statistics;
    std::int64_t done = 0;
    for (const app::Chunk& chunk : app::chunks_of(film.frames, film.coding.gop))
        app::render_chunk(film, renderer, chunk, writing, statistics, [&] {
            fmt::print(stderr, "\rrendering {}: {} of {}", name, ++done, film.frame_count());
            return true;
        });
    fmt::print(stderr, "\n");
    out.finish();
}

}  // namespace

void ContentHash::add(const std::string& bytes) {
    for (const char c : bytes) value_ = (value_ ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    value_ = (value_ ^ 0x1ffu) * 0x100000001b3u;  // where one piece ends and the next begins counts too
}

void ContentHash::add_file(const fs::path& file) {
    add(text_of(file));
}

std::string ContentHash::text() const {
    return fmt::format("{:016x}", value_);
}

std::vector<std::string> clips_of_set(ClipSet set) {
    if (set == ClipSet::fit) return films_in(here());
    if (set == ClipSet::fit_foreign) return {"testsrc", "mandelbrot", "pan", "film", "shake", "slides"};
    if (set == ClipSet::test_foreign) return {"zoom", "grain", "gradients", "life", "cuts"};
    std::vector<std::string> names = films_in(here() / "test");
    for (const char* animation : {"character", "colonnade", "cornell", "many_lamps", "mirror_and_glass"})
        names.emplace_back(animation);
    return names;
}

std::vector<std::string> scene_clips(ClipSet set) {
    if (set == ClipSet::fit) return films_in(here() / "scenes");
    return set == ClipSet::test ? films_in(here() / "test" / "scenes") : std::vector<std::string>{};
}

namespace {

/// Reads the clip's pictures from its file.
void read_pictures(Clip& clip, int frames) {
    av::Y4mReader reader(clip.y4m);
    ContentHash content;
    for (std::int64_t n = 0; n < std::min<std::int64_t>(frames, reader.frames()); ++n) {
        core::Picture& picture = clip.pictures.emplace_back(reader.read(n));
        picture.number = n;
        for (const auto* plane : {&picture.y, &picture.cb, &picture.cr})
            content.add({reinterpret_cast<const char*>(plane->row(0)), plane->size()});
    }
    clip.content = content.text();
}

/// A clip that ffmpeg makes: without motion.
Clip make_foreign_clip(const ClipRequest& request) {
    const std::string size = request.small ? small_size : "1280x720";
    const auto painted = [&](const std::string& name) { return texture(request.cache, name).string(); };
    const std::vector<std::string> command = foreign_source(request.name, size, painted);
    ContentHash made_from;
    for (const std::string& word : command) made_from.add(word);
    made_from.add(std::to_string(length_of(request)));
    Clip clip;
    clip.name = request.name;
    clip.y4m = request.cache / (request.name + "-" + made_from.text() + ".y4m");
    if (!fs::exists(clip.y4m)) write_foreign(command, length_of(request), clip.y4m);
    read_pictures(clip, request.frames);
    return clip;
}

}  // namespace

Clip make_clip(const ClipRequest& request) {
    if (is_foreign(request.name)) return make_foreign_clip(request);
    // Name the film by what it is made from.
    const std::string name = title_of(film_of(request.name));
    const fs::path staging = request.cache / fmt::format("{}.{}", name, getpid());
    assemble(request, staging);
    ContentHash made_from;
    made_from.add(fmt::format("{} frames", length_of(request)));
    if (request.small) made_from.add(small_size);
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(staging))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) {
        made_from.add(fs::relative(file, staging).string());
        made_from.add_file(file);
    }

    // Render it unless it was.
    const fs::path folder = request.cache / (name + "-" + made_from.text());
    fs::create_directories(folder);
    if (fs::exists(folder / "scene"))
        fs::remove_all(staging);
    else
        fs::rename(staging, folder / "scene");
    app::RenderJob film = render_job_of(folder / "scene", request);
    Clip clip;
    clip.name = name;
    clip.y4m = folder / "frames.y4m";
    if (!fs::exists(clip.y4m)) render(film, clip.name, clip.y4m);

    clip.lights_change = scene::traits_of(*film.animation).lights_change;
    read_pictures(clip, request.frames);
    const auto motion = std::make_shared<ExactMotion>(std::move(film), folder / "motion");
    clip.motion = [motion](std::int64_t picture, std::int64_t reference) -> const core::MotionField& {
        return motion->between(picture, reference);
    };
    return clip;
}

}  // namespace render2mpeg::bench
