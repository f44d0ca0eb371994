// What the coupled loop saves and costs, against a fixed tolerance of 2 % at the same quantiser and stopping rule.
//
//   bench_coupled [--pairs N] [--quantisers 1,8,24] [--shares default,1,0.3] [--keep-references DIR] [--name NAME]
//                 [--draws N] SCENE [render options]
//
// One line of JSON per film. Quality is of the decoded film against frames lit without clustering and not coded: pairs
// of adjacent frames, lit once and kept in the folder. `loss` is what the coupled film has less than the fixed one.
// With several draws every film, the fixed one too, is made as often, each time with other representatives of the same
// light points, and all figures are means; `_error` is the standard error of such a mean, of differences between films
// of one draw.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <optional>
#include <sstream>

#include "app/job/automatic_exposure.h"
#include "app/options/option_text.h"
#include "app/options/options.h"
#include "app/system/memory_limit.h"
#include "bench/coupled_films.h"
#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg::bench {
namespace {

std::vector<std::string> parts_of(const std::string& list) {
    std::vector<std::string> parts;
    std::istringstream stream(list);
    for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
    return parts;
}

/// One film with each draw of representatives.
using Draws = std::vector<Outcome>;

double mean(const Draws& films, double Outcome::*value) {
    double sum = 0;
    for (const Outcome& film : films) sum += film.*value;
    return sum / static_cast<double>(films.size());
}

/// Standard error of the mean of what `films` have less than `fixed`, draw by draw; 0 where one draw tells nothing.
double error_of(const Draws& films, const Draws& fixed, double Outcome::*value) {
    const double middle = mean(fixed, value) - mean(films, value), count = static_cast<double>(films.size());
    double squares = 0;
    for (std::size_t i = 0; i < films.size(); ++i) {
        const double off = fixed[i].*value - films[i].*value - middle;
        squares += off * off;
    }
    return count > 1 ? std::sqrt(squares / (count * (count - 1))) : 0.0;
}

void print(const std::string& name, int quantiser, const std::string& tolerance, const Draws& films, const Draws& fixed,
           std::int64_t frames) {
    const auto of = [&](double Outcome::*value) { return mean(films, value); };
    const auto usual = [&](double Outcome::*value) { return mean(fixed, value); };
    const auto gain = [&](double Outcome::*value) { return usual(value) / of(value); };
    const auto loss = [&](double Outcome::*value) { return usual(value) - of(value); };
    const auto per_frame = [&](double seconds) { return seconds / static_cast<double>(frames); };
    fmt::print(
        R"({{"scene":"{}","q":{},"tolerance":"{}","draws":{},"shade_s":{:.4f},"all_speedup":{:.3f},"gather_s":{:.4f},"speedup":{:.3f},"ray_ratio":{:.3f},"preview_share":{:.4f},)"
        R"("tolerate_ms":{:.3f},"cut":{:.5f},"capped":{:.5f},"error_scale":{:.3f},"tol_rel":{:.4f},"tol_luma":{:.3f},"over":{:.5f},)"
        R"("kbytes":{:.1f},"bytes_ratio":{:.4f},)",
        name, quantiser, tolerance, films.size(), per_frame(of(&Outcome::shade_seconds)), gain(&Outcome::shade_seconds),
        per_frame(of(&Outcome::gather_seconds)), gain(&Outcome::gather_seconds), gain(&Outcome::rays),
        of(&Outcome::preview_seconds) / of(&Outcome::shade_seconds), 1e3 * per_frame(of(&Outcome::tolerate_seconds)),
        of(&Outcome::cut), of(&Outcome::capped), of(&Outcome::error_scale), of(&Outcome::tolerance),
        of(&Outcome::tolerance_luma), of(&Outcome::over), of(&Outcome::bytes) / 1024, 1 / gain(&Outcome::bytes));
    fmt::print(
        R"("psnr_y":{:.3f},"loss_db":{:.4f},"chroma_loss":{:.4f},"ssim_loss":{:.5f},"hvsm":{:.3f},"hvsm_loss":{:.4f},)"
        R"("light_mse":{:.4f},"flicker":{:.4f},"fixed_flicker":{:.4f},"pumping":{:.4f},"fixed_pumping":{:.4f},)",
        of(&Outcome::psnr_y), loss(&Outcome::psnr_y), loss(&Outcome::psnr_c), loss(&Outcome::ssim), of(&Outcome::hvs_m),
        loss(&Outcome::hvs_m), of(&Outcome::light_mse), of(&Outcome::flicker), usual(&Outcome::flicker),
        of(&Outcome::pumping), usual(&Outcome::pumping));
    fmt::print(
        R"("loss_error":{:.4f},"hvsm_error":{:.4f},"ssim_error":{:.5f},"bytes_error":{:.4f},"flicker_error":{:.4f},"pumping_error":{:.4f}}})"
        "\n",
        error_of(films, fixed, &Outcome::psnr_y), error_of(films, fixed, &Outcome::hvs_m),
        error_of(films, fixed, &Outcome::ssim), error_of(films, fixed, &Outcome::bytes) / usual(&Outcome::bytes),
        error_of(films, fixed, &Outcome::flicker), error_of(films, fixed, &Outcome::pumping));
    std::fflush(stdout);
}

int run(int argc, char** argv) {
    // Take our own options out; the rest is a command line of `render`.
    int pairs = 2, draws = 1;
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
        else if (word == "--draws" && i + 1 < argc)
            draws = std::max(1, std::atoi(argv[++i]));
        else if (value != nullptr && i + 1 < argc)
            *value = argv[++i];
        else
            rest.push_back(word);
    }
    rest.insert(rest.end(), {"-o", "bench.m2v"});
    const app::CommandLine line = app::parse(rest);
    if (line.exit_code) return *line.exit_code;
    const parallel::ThreadLimit threads(line.render.threads);

    app::RenderOptions options = line.render;
    options.tolerance = app::fixed_tolerance(0.02f);
    app::RenderJob film = app::prepare(options);
    if (!film.exposure) film.exposure = app::measure_exposure(film);
    if (name.empty()) name = options.input.stem().string();
    const Stage stage = stage_of(film, pairs, references);
    std::vector<LitFilm> fixed;
    for (int draw = 0; draw < draws; ++draw) {
        film.rendering.draw = static_cast<std::uint64_t>(draw);
        fixed.emplace_back(film, stage);
    }
    for (const std::string& quantiser : parts_of(quantisers)) {
        const int q = std::atoi(quantiser.c_str());
        Draws usual;
        for (const LitFilm& one : fixed) usual.push_back(one.coded(q));
        print(name, q, "fixed", usual, usual, film.frame_count());
        for (const std::string& share : parts_of(shares)) {
            app::RenderJob loop = film;
            loop.tolerance = app::tolerance_from(share == "default" ? "coupled" : "coupled=" + share);
            loop.coupling.fraction = loop.tolerance.fraction;
            loop.coding.quantiser = q;
            Draws coupled;
            for (int draw = 0; draw < draws; ++draw) {
                loop.rendering.draw = static_cast<std::uint64_t>(draw);
                coupled.push_back(made(loop, stage));
            }
            print(name, q, share, coupled, usual, film.frame_count());
        }
    }
    return 0;
}

}  // namespace
}  // namespace render2mpeg::bench

int main(int argc, char** argv) {
    render2mpeg::app::keep_freed_memory();  // as the program does
    try {
        return render2mpeg::bench::run(argc, argv);
    } catch (const render2mpeg::core::Error& error) {
        std::cerr << error.what() << "\n";
        return 1;
    }
}
