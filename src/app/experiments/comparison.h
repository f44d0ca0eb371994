#pragma once
// Rows of `compare`.
#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/experiments/ffmpeg_program.h"
#include "app/experiments/foreign_film.h"
#include "app/experiments/trial.h"

namespace render2mpeg::app {

struct Times {
    std::vector<double> light, code;
};

/// Median, and spread: (largest - least) / median, 0 where that is 0.
double median(std::vector<double> seconds);
double spread(const std::vector<double>& seconds);

/// One way from a scene to a film, by quantiser.
struct Way {
    std::string name;
    std::string how;                                           ///< the command, or what stands for it
    std::vector<std::pair<std::string, std::string>> options;  ///< of `render`, for its light and GOPs
    std::optional<FfmpegWay> ffmpeg;                           ///< none: our own encoder
    std::vector<Trial> rows;                                   ///< times are the runs' medians
    std::vector<Times> times;                                  ///< of each row
};

/// Results of `compare`.
struct Comparison {
    std::vector<Chunk> windows;
    int references = 0;
    double reference_seconds = 0;  ///< CPU for light, each
    std::size_t light_points = 0;
    std::string ffmpeg;  ///< its version
    int runs = 1;
    /// Coupled; fixed 2 % with our encoder at the film's GOPs and at free ones; with ffmpeg as usual, strongest, and
    /// strongest with free GOPs.
    std::vector<Way> ways;
    std::optional<ForeignFilm> foreign;
    std::string render;     ///< the command that makes the film to take; empty: none is known
    bool complete = false;  ///< false: interrupted
};
inline constexpr std::size_t coupled_way = 0, fixed_way = 1, free_way = 2, usual_way = 3, strongest_way = 4,
                             strongest_free_way = 5;
/// Pictures of a GOP by default, as in the strongest command for short ones.
inline constexpr int short_gop = 15;
/// Pictures of a free GOP, as in the strongest command (docs/measurements.md).
inline constexpr int free_gop = 60;

/// Pairs of ways: the first against the second.
inline constexpr std::array<std::pair<std::size_t, std::size_t>, 6> held_against{{{coupled_way, usual_way},
                                                                                  {fixed_way, usual_way},
                                                                                  {coupled_way, strongest_way},
                                                                                  {fixed_way, strongest_way},
                                                                                  {coupled_way, strongest_free_way},
                                                                                  {free_way, strongest_free_way}}};

/// Difference at equal quality, per cent; NaN without common quality.
struct Difference {
    double psnr_y = 0, ssim_y = 0, psnr_hvs_m = 0;  ///< of bits, at equal quality by each
    double seconds = 0;                             ///< CPU for light, motion and coding, at equal PSNR-Y
};
Difference difference_of(const Way& way, const Way& from);

/// Cost of a way at equal quality, for the whole film.
struct WayCost {
    std::size_t way = 0;
    double bits = 1;            ///< over those of coupled light, at equal PSNR-Y
    double clock = 0, cpu = 0;  ///< seconds, at the quantiser of the row that was asked for
};
/// Costs of the ways with coupled light's GOPs, from the fewest bits on. `row`: of each way.
std::vector<WayCost> way_costs(const Comparison& found, std::int64_t frames, std::size_t row);
/// The recommended one (cheapest_alike), to within a hundredth of the bits.
std::optional<std::size_t> recommended(const std::vector<WayCost>& costs);

/// Bits of the coupled film over a foreign one's at its PSNR-Y; NaN where ours does not reach it.
double bits_beside(const Comparison& found);

/// Row of the coupled way with the nearest quantiser.
std::size_t row_of(const Comparison& found, int quantiser);

/// The result in a sentence; empty where it is not complete.
std::string sentence_of(const Comparison& found);
/// The recommended way with its time and size; likewise.
std::string answer_of(const Comparison& found, std::int64_t frames, int quantiser);

/// Lines of at most 80 columns, each with its end.
std::string compare_heading(const RenderJob& film, const Comparison& found);
std::string way_heading();
std::string way_row(const std::string& name, const Trial& trial);
std::string difference_table(const Comparison& found);
/// Medians and spreads; empty for one run.
std::string time_table(const Comparison& found);
/// The film of another renderer; empty where there is none.
std::string foreign_lines(const Comparison& found);

/// "-12.3 %", or "-" where it is not known.
std::string change_text(double per_cent);

/// All results (docs/choosing.md).
nlohmann::json compare_json(const RenderJob& film, const Comparison& found, const std::string& command);

/// The same as a page with plots, and report_json_of() it.
void write_compare_report(const std::filesystem::path& html, const RenderJob& film, const Comparison& found,
                          const std::string& command);

}  // namespace render2mpeg::app
