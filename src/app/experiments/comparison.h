#pragma once
// Rows of `compare`.
#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/experiments/trial_command.h"

namespace render2mpeg::app {

/// A way to code with ffmpeg.
struct FfmpegWay {
    std::string name;
    std::string options;  ///< `{q}`: the quantiser; `{L}`: its Lagrange factor, 118 q; `{g}`: pictures of a GOP
    std::string encoder = "mpeg2video";
};

/// One way from a scene to a film, by quantiser.
struct Way {
    std::string name;
    std::string how;                  ///< the command, or what stands for it
    std::string tolerance;            ///< of `render`
    std::optional<FfmpegWay> ffmpeg;  ///< none: our own encoder
    std::vector<Trial> rows;
};

/// Results of `compare`.
struct Comparison {
    std::string ffmpeg;  ///< its version
    /// Coupled; fixed 2 % with our encoder, with ffmpeg as usual and with its strongest command.
    std::vector<Way> ways;
    std::string render;     ///< the command that makes the film to take; empty: none is known
    bool complete = false;  ///< false: interrupted
};
inline constexpr std::size_t coupled_way = 0, fixed_way = 1, usual_way = 2, strongest_way = 3;

/// Options of `render` for a way's film, or for its pictures where ffmpeg codes them. `quantiser`: in the codec's
/// scale.
Choices choices_of(const Way& way, encoder::Codec codec, int quantiser);

/// Pairs of ways: the first against the second.
inline constexpr std::array<std::pair<std::size_t, std::size_t>, 4> held_against{
    {{coupled_way, usual_way}, {fixed_way, usual_way}, {coupled_way, strongest_way}, {fixed_way, strongest_way}}};

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
/// Costs of the ways, from the fewest bits on. `row`: of each way.
std::vector<WayCost> way_costs(const Comparison& found, std::int64_t frames, std::size_t row);
/// The recommended one (cheapest_alike), to within a hundredth of the bits.
std::optional<std::size_t> recommended(const std::vector<WayCost>& costs);

/// Row of the coupled way with the nearest quantiser.
std::size_t row_of(const Comparison& found, int quantiser);

/// The result in a sentence; empty where it is not complete.
std::string sentence_of(const Comparison& found);
/// The recommended way with its time and size; likewise.
std::string answer_of(const Comparison& found, std::int64_t frames, int quantiser);

/// Lines of at most 80 columns, each with its end.
std::string difference_table(const Comparison& found);

/// "-12.3 %", or "-" where it is not known.
std::string change_text(double per_cent);

/// All results (docs/json.md), and what a page shows besides.
nlohmann::json compare_json(const RenderJob& film, const Comparison& found);
nlohmann::json compare_page(const RenderJob& film, const Comparison& found);

/// Columns of `compare`, in 80 characters.
extern const TrialColumns compare_columns;
inline constexpr int compare_name_width = 22;
/// "ffmpeg, strongest,  8"
std::string row_name(const Way& way, const Trial& trial);

}  // namespace render2mpeg::app
