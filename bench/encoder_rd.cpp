// Rate against quality of our encoder and of ffmpeg's, over films rendered by this program with exact motion.
//
//   bench_encoder_rd --help
//
// A is ffmpeg's plain command, B the strongest that is known for GOPs of 15, C the strongest with free GOPs. Ours:
// `quality` and `fast`, `eye` (tuned to what is seen), `free` (GOPs of 60), `unaided` (without exact motion), `search`
// (a full search instead), as `encode` codes; `lit` as `render` does; `constant` holds a quality, of 80 at quantiser 2,
// 60 at 4, 40 at 8, 20 at 16.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>

#include "core/error.h"
#include "encoder_rd/clips.h"
#include "encoder_rd/codecs.h"
#include "encoder_rd/report.h"
#include "parallel/loops.h"

namespace render2mpeg::bench {
namespace {

struct Options {
    std::vector<std::string> clips;  ///< empty: those of `set`
    std::string set = "test";
    std::vector<std::string> codecs = {"quality", "fast", "eye", "free", "A", "B", "C"};
    std::vector<int> quantisers = {2, 4, 8, 16};
    int frames = 60;
    int threads = 1;
    std::filesystem::path cache = "build/bench-cache";
    std::filesystem::path scenes;
    std::string json, svg;
    bool small = false, render_only = false, check_metrics = false, points = false;
};

const std::map<std::string, ClipSet> clip_sets = {{"fit", ClipSet::fit},
                                                  {"fit-foreign", ClipSet::fit_foreign},
                                                  {"test", ClipSet::test},
                                                  {"test-foreign", ClipSet::test_foreign}};

/// The clips asked for.
std::vector<std::string> clips_of(const Options& o) {
    if (!o.clips.empty()) return o.clips;
    const auto set = clip_sets.find(o.set);
    if (set == clip_sets.end()) throw core::Error("--set " + o.set + ": there is no such set");
    std::vector<std::string> names = clips_of_set(set->second);
    if (o.scenes.empty()) return names;
    for (const std::string& name : scene_clips(set->second)) names.push_back(name);
    return names;
}

std::string known_codecs() {
    std::string names;
    for (const OwnCodec& codec : own_codecs()) names += codec.name + " ";
    for (const FfmpegCodec& codec : ffmpeg_codecs()) names += codec.name + " ";
    return names;
}

void add_options(CLI::App& app, Options& o) {
    std::string clips, scenes;
    for (const auto& [set, kind] : clip_sets) {
        for (const std::string& name : clips_of_set(kind)) clips += name + " ";
        for (const std::string& name : scene_clips(kind)) scenes += name + " ";
    }
    app.add_option("--set", o.set, "fit, fit-foreign, test or test-foreign")->capture_default_str();
    app.add_option("--clips", o.clips, "Instead of a set; of " + clips + "and, with --scenes, " + scenes)
        ->delimiter(',');
    app.add_flag("--small", o.small, "320x176, 30 pictures");
    app.add_option("--codecs", o.codecs, "Of " + known_codecs())->delimiter(',')->capture_default_str();
    app.add_option("--quantisers", o.quantisers, "At least two")->delimiter(',')->check(CLI::Range(1, 31));
    app.add_option("--frames", o.frames, "The first so many of 60")->check(CLI::Range(1, 60))->capture_default_str();
    app.add_option("--threads", o.threads, "For rendering; encoders are timed with one")->capture_default_str();
    app.add_option("--cache", o.cache, "Folder of rendered films and ffmpeg's results")->capture_default_str();
    app.add_option("--scenes", o.scenes, "Folder of real scenes, as for real_scenes.sh")->check(CLI::ExistingDirectory);
    app.add_option("--json", o.json, "File for all points and differences");
    app.add_option("--svg", o.svg, "Folder for one plot per clip");
    app.add_flag("--render-only", o.render_only, "Fill the cache with films and end");
    app.add_flag("--check-metrics", o.check_metrics, "Compare our PSNR and SSIM with those of ffmpeg's filters");
    app.add_flag("--points", o.points, "Print every point too");
}

void measure(const Options& o, const Clip& clip, std::vector<Curve>& curves) {
    const auto wanted = [&](const std::string& name) {
        return std::find(o.codecs.begin(), o.codecs.end(), name) != o.codecs.end();
    };
    std::vector<OwnCodec> own;
    for (const OwnCodec& codec : own_codecs())
        if (wanted(codec.name)) own.push_back(codec);
    const auto results = code_with_ours(clip, own, o.quantisers);
    for (std::size_t i = 0; i < own.size(); ++i) curves.push_back({clip.name, own[i].name, results[i]});
    for (const FfmpegCodec& codec : ffmpeg_codecs()) {
        if (!wanted(codec.name)) continue;
        Curve& curve = curves.emplace_back(Curve{clip.name, codec.name, {}});
        for (const int q : o.quantisers) curve.points.push_back(code_with_ffmpeg(clip, codec, q, o.cache));
    }
}

int run(const Options& o) {
    std::vector<Curve> curves;
    for (const std::string& name : clips_of(o)) {
        Clip clip;
        {
            const parallel::ThreadLimit rendering(o.threads);
            clip = make_clip({name, o.cache, o.scenes, o.frames, o.small});
        }
        if (o.render_only) continue;
        const parallel::ThreadLimit one(1);
        if (o.check_metrics) {
            fmt::print("{}: our PSNR and SSIM are within {:.4f} dB of ffmpeg's filters\n", name,
                       difference_of_metrics(clip, ffmpeg_codecs()[0], 8, o.cache));
            continue;
        }
        fmt::print(stderr, "measuring {}\n", name);
        measure(o, clip, curves);
    }
    if (curves.empty()) return 0;
    if (o.points) fmt::print("{}\n{}\n", points_text(curves), deviations(curves));
    fmt::print("{}", table(curves));
    if (!o.json.empty()) write_json(o.json, curves);
    if (!o.svg.empty()) write_plots(o.svg, curves);
    return 0;
}

}  // namespace
}  // namespace render2mpeg::bench

int main(int argc, char** argv) {
    using namespace render2mpeg;
    CLI::App app("Rate against quality of our encoder and of ffmpeg's");
    bench::Options options;
    bench::add_options(app, options);
    CLI11_PARSE(app, argc, argv);
    try {
        return bench::run(options);
    } catch (const core::Error& error) {
        fmt::print(stderr, "bench_encoder_rd: {}\n", error.what());
        return 1;
    }
}
