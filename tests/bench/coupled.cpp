// What the coupled loop saves and costs, against a fixed tolerance of 2 % at the same quantiser and stopping rule.
//
//   bench_coupled [--pairs N] [--quantisers 1,8,24] [--shares default,1,0.3] [--keep-references DIR] [--name NAME]
//                 [--always-intra] SCENE [render options]
//
// One line of JSON per film. Quality is of the decoded film against frames lit without clustering and not coded: pairs
// of adjacent frames, lit once and kept in the folder. `loss` is what the coupled film has less than the fixed one.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <optional>
#include <sstream>

#include "app/keep_memory.h"
#include "app/options.h"
#include "core/error.h"
#include "parallel/loops.h"
#include "tests/bench/coupled_films.h"

namespace render2mpeg::bench {
namespace {

std::vector<std::string> parts_of(const std::string& list) {
    std::vector<std::string> parts;
    std::istringstream stream(list);
    for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
    return parts;
}

void print(const std::string& name, int quantiser, const std::string& tolerance, const Outcome& o, const Outcome& fixed,
           std::int64_t frames) {
    const auto per_frame = [&](double seconds) { return seconds / static_cast<double>(frames); };
    fmt::print(
        R"({{"scene":"{}","q":{},"tolerance":"{}","shade_s":{:.4f},"all_speedup":{:.3f},"gather_s":{:.4f},"speedup":{:.3f},"ray_ratio":{:.3f},"preview_share":{:.4f},)"
        R"("tolerate_ms":{:.3f},"cut":{:.5f},"capped":{:.5f},"caution":{:.3f},"tol_rel":{:.4f},"tol_luma":{:.3f},"over":{:.5f},)"
        R"("kbytes":{:.1f},"bytes_ratio":{:.4f},)",
        name, quantiser, tolerance, per_frame(o.shade_seconds), fixed.shade_seconds / o.shade_seconds,
        per_frame(o.gather_seconds), fixed.gather_seconds / o.gather_seconds, fixed.rays / o.rays,
        o.preview_seconds / o.shade_seconds, 1e3 * per_frame(o.tolerate_seconds), o.cut, o.capped, o.caution,
        o.tolerance, o.tolerance_luma, o.over, o.bytes / 1024, o.bytes / fixed.bytes);
    fmt::print(
        R"("psnr_y":{:.3f},"loss_db":{:.4f},"chroma_loss":{:.4f},"ssim_loss":{:.5f},"hvsm":{:.3f},"hvsm_loss":{:.4f},)"
        R"("light_mse":{:.4f},"flicker":{:.4f},"fixed_flicker":{:.4f},"pumping":{:.4f},"fixed_pumping":{:.4f}}})"
        "\n",
        o.psnr_y, fixed.psnr_y - o.psnr_y, fixed.psnr_c - o.psnr_c, fixed.ssim - o.ssim, o.hvs_m, fixed.hvs_m - o.hvs_m,
        o.light_mse, o.flicker, fixed.flicker, o.pumping, fixed.pumping);
    std::fflush(stdout);
}

int run(int argc, char** argv) {
    // Take our own options out; the rest is a command line of `render`.
    int pairs = 2;
    bool always_intra = false;
    std::string quantisers = "2,8,16", shares = "default,1", references = "bench_references", name;
    std::vector<std::string> rest{"render2mpeg", "render"};
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        std::string* value = word == "--quantisers"        ? &quantisers
                             : word == "--shares"          ? &shares
                             : word == "--keep-references" ? &references
                             : word == "--name"            ? &name
                                                           : nullptr;
        if (word == "--pairs" && i + 1 < argc)
            pairs = std::max(1, std::atoi(argv[++i]));
        else if (word == "--always-intra")
            always_intra = true;
        else if (value != nullptr && i + 1 < argc)
            *value = argv[++i];
        else
            rest.push_back(word);
    }
    rest.insert(rest.end(), {"-o", "bench.m2v"});
    std::vector<char*> words;
    for (std::string& word : rest) words.push_back(word.data());
    const app::CommandLine line = app::parse(static_cast<int>(words.size()), words.data());
    if (line.exit_code) return *line.exit_code;
    const parallel::ThreadLimit threads(line.render.threads);

    app::RenderOptions options = line.render;
    options.tolerance = "fixed=2%";
    app::Production film = app::prepare(options);
    if (!film.exposure) film.exposure = app::measure_exposure(film);
    if (name.empty()) name = options.input.stem().string();
    const Stage stage = stage_of(film, pairs, references);
    const LitFilm fixed(film, stage);
    for (const std::string& quantiser : parts_of(quantisers)) {
        const int q = std::atoi(quantiser.c_str());
        const Outcome base = fixed.coded(q);
        print(name, q, "fixed", base, base, film.frame_count());
        for (const std::string& share : parts_of(shares)) {
            app::Production loop = film;
            loop.tolerance = app::tolerance_from(share == "default" ? "coupled" : "coupled=" + share);
            loop.coupling.share = loop.tolerance.share;
            loop.coding.quantiser = q;
            loop.coupling.always_intra = always_intra;
            print(name, q, share, made(loop, stage), base, film.frame_count());
        }
    }
    return 0;
}

}  // namespace
}  // namespace render2mpeg::bench

int main(int argc, char** argv) {
    render2mpeg::app::keep_memory();  // as the program does
    try {
        return render2mpeg::bench::run(argc, argv);
    } catch (const render2mpeg::core::Error& error) {
        std::cerr << error.what() << "\n";
        return 1;
    }
}
