#pragma once
// Counts and times of a run.
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "app/system/progress.h"
#include "core/binomial.h"
#include "core/error_histogram.h"
#include "core/numeric.h"
#include "encoder/types.h"
#include "parallel/lanes.h"
#include "renderer/renderer.h"

namespace render2mpeg::app {

enum class Stage { load, exposure, first_pass, see, preview, tolerate, shade, develop, encode, count };
inline constexpr std::array stage_names{"load",     "exposure", "first_pass", "see",   "preview",
                                        "tolerate", "shade",    "develop",    "encode"};

inline constexpr std::array stage_words{"reading",  "measuring the exposure", "first pass", "looking", "a rough look",
                                        "weighing", "gathering light",        "developing", "coding"};

/// Quotient of two counts; 0 without any.
template <class Part, class Whole>
double ratio_of(Part part, Whole whole) {
    return core::divide_or(static_cast<double>(part), static_cast<double>(whole), 0.0);
}

/// CPU seconds of processes that this one waited for.
double waited_seconds();
/// The same and this process, summed over threads.
double cpu_seconds();
/// Monotonic clock, seconds.
double clock_seconds();

/// Cache counts of one frame; all 0 without a cache.
struct RecordsEntry {
    std::uint64_t created = 0;
    std::uint64_t live = 0;  ///< held after it
    double served = 0;       ///< share of its gather points that they, or the frame before, lit
};

using StageSeconds = std::array<double, static_cast<std::size_t>(Stage::count)>;

/// What lighting a frame took, which is not found again where an earlier run lit it.
struct LightingCost {
    std::uint64_t shadow_rays = 0, gather_rays = 0, exposure_rays = 0, caustic_rays = 0;
    double direct_cut = 0, indirect_cut = 0;  ///< clusters per gather point
    RecordsEntry records;
    double share = 0;                 ///< of what coding hides that its light might err by; 0: not coupled
    double loss = -1;                 ///< of PSNR-Y by its light's noise, dB; below 0: not known
    double seconds = 0;               ///< CPU
    StageSeconds seconds_by_stage{};  ///< of these
};

struct FrameEntry {
    std::int64_t frame = 0;
    char type = '-';  ///< I, P, B; '-': not coded
    int quantiser = 0;
    double mean_quantiser = 0;  ///< of its macroblocks
    std::uint64_t bytes = 0;
    int planned_quantiser = 0;   ///< that it was rendered for
    int tries = 1;               ///< codings until the decoder's buffer could bring it in time
    bool minimal = false;        ///< only a picture without detail fitted
    std::uint64_t stuffing = 0;  ///< bytes
    std::int64_t fullness_before = 0, fullness_after = 0;  ///< of the buffer, bits
    encoder::MotionWork motion;                            ///< work of choosing its vectors
    double mse_y = 0, ssim_y = 1;                          ///< of the decoded picture against the rendered one
    double pumping = -1;  ///< from the decoded picture before (perceptual/pumping.h), code values; below 0: not known
    LightingCost cost;
};

/// Rate control, counts of pictures.
struct RateOutcome {
    std::uint64_t bytes = 0;     ///< of all coded pictures
    std::uint64_t stuffing = 0;  ///< of these
    int requantised = 0;         ///< coded more than once to fit the buffer
    int minimal = 0;             ///< of these, without any detail
    int off_plan = 0;            ///< with another quantiser than they were rendered for
};

struct QuantiserRange {
    double mean = 0;       ///< of all macroblocks
    int min = 0, max = 0;  ///< of the pictures
    int finest = 0;        ///< how many pictures have quantiser 1
    int coarsest = 0;      ///< and how many 31
};

/// What pictures lost by the noise of their light; 0 pictures: not known.
struct LightLossFound {
    int pictures = 0;
    double loss = 0;   ///< dB of PSNR-Y, mean
    double share = 0;  ///< of what coding hides that light might err by, mean of all frames
};

/// Errors of audited pixels against unclustered light and the truth.
struct Audit {
    /// Relative errors of luminance, over the absolute tolerance where that is larger.
    core::ErrorHistogram errors;
    std::uint64_t over = 0;  ///< pixels whose error exceeds their tolerance
    renderer::ErrorSplit split;
    double seconds = 0;  ///< CPU

    double share_over() const { return ratio_of(over, errors.count()); }
    /// Share of all pixels that it is at most, with 95 % confidence: audited ones are drawn independently.
    double most_over() const { return core::most_share(over, errors.count(), 0.95); }
};

/// Bits of some pictures, coded by the film's quantiser with its grain and without.
struct GrainBits {
    double pictures = 0;  ///< 0: not measured
    double with = 0, without = 0;
};

struct RunStatistics {
    StageSeconds seconds{};  ///< CPU, summed over threads
    double wall = 0;
    double earlier_cpu = 0, earlier_wall = 0;  ///< of the runs that this one goes on from; `wall` has it in it
    StageSeconds earlier_seconds{};            ///< likewise, in `seconds`
    std::vector<FrameEntry> frames;
    int brightest_luma = 0;  ///< code value
    core::LightLevel light;
    GrainBits grain;
    renderer::Statistics rendering;
    Audit audit;
    /// CPU by row of the plan; rows without time of their own have 0.
    std::array<double, static_cast<std::size_t>(renderer::Pass::count)> pass_seconds{};

    double& of(Stage stage) { return seconds[static_cast<std::size_t>(stage)]; }
    double of(Stage stage) const { return seconds[static_cast<std::size_t>(stage)]; }
    double& of(renderer::Pass pass) { return pass_seconds[static_cast<std::size_t>(pass)]; }
    double of(renderer::Pass pass) const { return pass_seconds[static_cast<std::size_t>(pass)]; }
    /// Means over the film; PSNR from the mean squared error, +infinity without loss.
    double psnr_y() const;
    double ssim_y() const;
    /// RMS over pictures where it is known; none: nowhere.
    std::optional<double> pumping() const;
    RateOutcome rate_outcome() const;
    QuantiserRange quantisers() const;
    LightLossFound light_loss() const;
    double mean_direct_cut() const { return ratio_of(rendering.direct_clusters, rendering.gather_points); }
    double mean_indirect_cut() const { return ratio_of(rendering.indirect_clusters, rendering.gather_points); }
};

struct Rendered {
    RunStatistics statistics;
    std::filesystem::path film;
    std::uint64_t bytes = 0;
};

/// Adds the CPU time of its scope to a sum, a stage, or a row of the plan: its lane's (parallel/lanes.h).
class StageTimer {
  public:
    explicit StageTimer(double& sum) : sum_(sum) {}
    /// Other processes read files.
    StageTimer(RunStatistics& statistics, Stage stage) : sum_(statistics.of(stage)), waits_(stage == Stage::load) {
        tell_activity(stage_words[static_cast<std::size_t>(stage)]);
    }
    StageTimer(RunStatistics& statistics, renderer::Pass pass) : StageTimer(statistics.of(pass)) {}
    ~StageTimer() { sum_ += now() - start_; }
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;

  private:
    double now() const { return parallel::lane_seconds() + (waits_ ? waited_seconds() : 0.0); }

    double& sum_;
    bool waits_ = false;
    double start_ = now();
};

/// Sets the CPU time of the entry that its scope adds.
class FrameTimer {
  public:
    explicit FrameTimer(RunStatistics& statistics)
        : statistics_(statistics), frames_before_(statistics.frames.size()), before_(statistics.seconds) {}
    ~FrameTimer() {
        if (statistics_.frames.size() == frames_before_) return;
        LightingCost& cost = statistics_.frames.back().cost;
        cost.seconds = parallel::lane_seconds() - start_;
        for (std::size_t i = 0; i < before_.size(); ++i) cost.seconds_by_stage[i] = statistics_.seconds[i] - before_[i];
    }
    FrameTimer(const FrameTimer&) = delete;
    FrameTimer& operator=(const FrameTimer&) = delete;

  private:
    RunStatistics& statistics_;
    std::size_t frames_before_;
    StageSeconds before_;
    double start_ = parallel::lane_seconds();
};

/// Adds the CPU time of `work` to `sum`.
template <class Work>
auto timed(double& sum, Work&& work) {
    const StageTimer timer(sum);
    return work();
}
template <class Part, class Work>
auto timed(RunStatistics& statistics, Part part, Work&& work) {
    const StageTimer timer(statistics, part);
    return work();
}

/// Sum over two parts of one film; the earlier part's times become `earlier_cpu` and `earlier_wall`.
RunStatistics sum_of(const RunStatistics& earlier, const RunStatistics& later);

/// The statistics plus all counts of the renderer.
RunStatistics totals_of(const RunStatistics& statistics, const renderer::Renderer& renderer);

/// Statistics in full precision, for a later run.
nlohmann::json json_of(const RunStatistics& statistics);

/// The renderer's counts, and the members of an entry, by name.
nlohmann::json json_of(const renderer::Statistics& counts);
nlohmann::json json_of(const FrameEntry& entry);

/// Reads json_of(): sums are replaced, frames added. Throws std::exception for anything else.
void restore(RunStatistics& statistics, const nlohmann::json& written);

}  // namespace render2mpeg::app
