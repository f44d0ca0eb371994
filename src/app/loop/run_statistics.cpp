#include "app/loop/run_statistics.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>
#include <numeric>
#include <type_traits>

#include "core/numeric.h"
#include "perceptual/metrics.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

/// Rule for the sum of a counter over two parts of one film.
enum class How { added, largest, apart };

/// Lists the members of an entry, for writing and reading.
template <class Entry, class Visit>
void each_member(Entry& e, Visit&& visit) {
    using enum How;
    visit("frame", added, e.frame);
    visit("type", added, e.type);
    visit("quantiser", added, e.quantiser);
    visit("mean_quantiser", added, e.mean_quantiser);
    visit("bytes", added, e.bytes);
    visit("planned_quantiser", added, e.planned_quantiser);
    visit("tries", added, e.tries);
    visit("minimal", added, e.minimal);
    visit("stuffing", added, e.stuffing);
    visit("fullness_before", added, e.fullness_before);
    visit("fullness_after", added, e.fullness_after);
    visit("vectors_tried_exact", added, e.motion.evaluations.exact);
    visit("vectors_tried_predicted", added, e.motion.evaluations.predicted);
    visit("vectors_tried_searched", added, e.motion.evaluations.searched);
    visit("vectors_chosen_exact", added, e.motion.chosen.exact);
    visit("vectors_chosen_predicted", added, e.motion.chosen.predicted);
    visit("vectors_chosen_searched", added, e.motion.chosen.searched);
    visit("searches", added, e.motion.searches);
    visit("mse_y", added, e.mse_y);
    visit("ssim_y", added, e.ssim_y);
    visit("pumping", added, e.pumping);
    visit("shadow_rays", added, e.shadow_rays);
    visit("direct_cut", added, e.direct_cut);
    visit("indirect_cut", added, e.indirect_cut);
    visit("records_created", added, e.records.created);
    visit("records_live", added, e.records.live);
    visit("records_served", added, e.records.served);
    visit("seconds", added, e.seconds);
}

/// Lists the renderer's counts, of one run or of two.
template <class Visit, class... Counts>
void each_count(Visit&& visit, Counts&... s) {
    using enum How;
    visit("primary_rays", added, s.primary_rays...);
    visit("shadow_rays", added, s.shadow_rays...);
    visit("gather_rays", added, s.gather_rays...);
    visit("photon_rays", added, s.photon_rays...);
    visit("specular_rays", added, s.specular_rays...);
    visit("air_rays", added, s.air_rays...);
    visit("exposure_rays", added, s.exposure_rays...);
    visit("exposed_pixels", added, s.exposed_pixels...);
    visit("caustic_rays", added, s.caustic_rays...);
    visit("caustic_photons", added, s.caustic_photons...);
    visit("caustic_landings", added, s.caustic_landings...);
    visit("caustic_pairs", added, s.caustic_pairs...);
    visit("caustic_doubts", added, s.caustic_doubts...);
    visit("gather_points", added, s.gather_points...);
    visit("capped_points", added, s.capped_points...);
    visit("true_paths", added, s.true_paths...);
    visit("true_pixels", added, s.true_pixels...);
    visit("capped_pixels", added, s.capped_pixels...);
    visit("direct_clusters", added, s.direct_clusters...);
    visit("indirect_clusters", added, s.indirect_clusters...);
    visit("non_finite", added, s.non_finite...);
    visit("first_non_finite", apart, s.first_non_finite...);
    visit("band_points", added, s.bands.points...);
    visit("band_clusters", added, s.bands.clusters...);
    visit("clamped_energy", apart, s.clamped_energy...);
    visit("luminance", added, s.luminance...);
    visit("photon_energy", added, s.photon_energy...);
    visit("photon_energy_lost", added, s.photon_energy_lost...);
    visit("direct_points", apart, s.direct_points...);
    visit("indirect_points", apart, s.indirect_points...);
    visit("least_error_scale", apart, s.least_error_scale...);
    visit("largest_error_scale", largest, s.largest_error_scale...);
    visit("mean_error_scale", apart, s.mean_error_scale...);
    visit("frames_calibrated", added, s.frames_calibrated...);
    visit("calibrated_pixels", added, s.calibrated_pixels...);
    visit("calibration_seconds", added, s.calibration_seconds...);
    visit("sky_seconds", added, s.sky_seconds...);
    visit("layer_seconds", added, s.layer_seconds...);
    visit("records_created", added, s.cache.created...);
    visit("records_known", added, s.cache.known...);
    visit("records_served", added, s.cache.served...);
    visit("records_most", largest, s.cache.most...);
    visit("hair_rays", added, s.hair.rays...);
}

template <class Visit, class... Sums>
void each_sum(Visit&& visit, Sums&... l) {
    using enum How;
    visit("seconds", added, l.seconds...);
    visit("pass_seconds", added, l.pass_seconds...);
    visit("wall", added, l.earlier_wall...);
    visit("cpu", added, l.earlier_cpu...);
    visit("brightest_luma", largest, l.brightest_luma...);
    visit("audit_over", added, l.audit.over...);
    visit("audit_seconds", added, l.audit.seconds...);
}

template <class Sums, class Visit>
void each_split_sum(Sums& s, Visit&& visit) {
    visit("pixels", How::added, s.pixels);
    visit("paths", How::added, s.paths);
    visit("blocks", How::added, s.blocks);
    visit("followed", How::added, s.followed);
    visit("light", How::added, s.light);
    visit("dark_light", How::added, s.dark_light);
    for (std::size_t c = 0; c < s.causes.size(); ++c) {
        auto& cause = s.causes[c];
        const auto sum = [&](const char* name, auto& value) {
            visit((std::string(renderer::cause_names[c]) + "_" + name).c_str(), How::added, value);
        };
        sum("difference", cause.difference);
        sum("difference_squares", cause.difference_squares);
        sum("dark_difference", cause.dark_difference);
        sum("dark_difference_squares", cause.dark_difference_squares);
        sum("squares", cause.squares);
        sum("square_squares", cause.square_squares);
        sum("block_squares", cause.block_squares);
        sum("block_square_squares", cause.block_square_squares);
        sum("flicker_squares", cause.flicker_squares);
        sum("flicker_square_squares", cause.flicker_square_squares);
    }
}

struct Writer {
    json& to;
    template <class Value>
    void operator()(const char* name, How, const Value& value) const {
        to[name] = value;
    }
};

/// Throws json::exception where a member is missing or of another kind.
struct Reader {
    const json& from;
    template <class Value>
    void operator()(const char* name, How, Value& value) const {
        from.at(name).get_to(value);
    }
};

struct Adder {
    template <class Value>
    void operator()(const char*, How how, Value& sum, const Value& earlier) const {
        if constexpr (std::is_arithmetic_v<Value>) {
            if (how != How::apart)
                sum = how == How::largest ? std::max(sum, earlier) : static_cast<Value>(sum + earlier);
        } else if constexpr (!std::is_same_v<Value, std::string>) {
            for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += earlier[i];
        }
    }
};

renderer::Statistics sum_of(const renderer::Statistics& earlier, const renderer::Statistics& later) {
    renderer::Statistics sum = later;
    each_count(Adder{}, sum, earlier);
    if (!earlier.first_non_finite.empty()) sum.first_non_finite = earlier.first_non_finite;
    if (later.image_notes.empty()) sum.image_notes = earlier.image_notes;

    // Means are weighted by what was lit; without later frames the earlier ones stay.
    const auto frames = static_cast<double>(earlier.frames_calibrated),
               all = static_cast<double>(sum.frames_calibrated);
    sum.mean_error_scale += core::divide_or(frames, all, 0.0) * (earlier.mean_error_scale - later.mean_error_scale);
    if (earlier.frames_calibrated > 0 && later.frames_calibrated > 0)
        sum.least_error_scale = std::min(earlier.least_error_scale, later.least_error_scale);
    else if (earlier.frames_calibrated > 0)
        sum.least_error_scale = earlier.least_error_scale;
    sum.clamped_energy = core::divide_or(
        earlier.clamped_energy * earlier.luminance + later.clamped_energy * later.luminance, sum.luminance, 0.0);
    if (later.gather_points == 0) {
        sum.direct_points = earlier.direct_points;
        sum.indirect_points = earlier.indirect_points;
    }
    return sum;
}

}  // namespace

double waited_seconds() {
    rusage ended{};
    getrusage(RUSAGE_CHILDREN, &ended);
    return static_cast<double>(ended.ru_utime.tv_sec + ended.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(ended.ru_utime.tv_usec + ended.ru_stime.tv_usec);
}

double cpu_seconds() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec) + waited_seconds();
}

double clock_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double Audit::share_over() const {
    return core::divide_or(static_cast<double>(over), static_cast<double>(errors.count()), 0.0);
}

double RunStatistics::psnr_y() const {
    double sum = 0;
    for (const FrameEntry& entry : frames) sum += entry.mse_y;
    return perceptual::psnr(core::divide_or(sum, static_cast<double>(frames.size()), 0.0));
}

double RunStatistics::ssim_y() const {
    double sum = 0;
    for (const FrameEntry& entry : frames) sum += entry.ssim_y;
    return core::divide_or(sum, static_cast<double>(frames.size()), 1.0);
}

std::optional<double> RunStatistics::pumping() const {
    double squares = 0, pictures = 0;
    for (const FrameEntry& entry : frames)
        if (entry.pumping >= 0) {
            squares += entry.pumping * entry.pumping;
            ++pictures;
        }
    if (pictures == 0) return std::nullopt;
    return std::sqrt(squares / pictures);
}

RateOutcome RunStatistics::rate_outcome() const {
    RateOutcome outcome;
    for (const FrameEntry& entry : frames) {
        outcome.bytes += entry.bytes;
        outcome.stuffing += entry.stuffing;
        outcome.requantised += entry.tries > 1 ? 1 : 0;
        outcome.minimal += entry.minimal ? 1 : 0;
        outcome.off_plan += entry.quantiser != entry.planned_quantiser ? 1 : 0;
    }
    return outcome;
}

QuantiserRange RunStatistics::quantisers() const {
    QuantiserRange range;
    for (const FrameEntry& entry : frames) {
        range.mean += entry.mean_quantiser;
        range.min = range.min == 0 ? entry.quantiser : std::min(range.min, entry.quantiser);
        range.max = std::max(range.max, entry.quantiser);
        range.finest += entry.quantiser == 1 ? 1 : 0;
        range.coarsest += entry.quantiser == 31 ? 1 : 0;
    }
    range.mean = core::divide_or(range.mean, static_cast<double>(frames.size()), 0.0);
    return range;
}

double RunStatistics::mean_direct_cut() const {
    return core::divide_or(static_cast<double>(rendering.direct_clusters), static_cast<double>(rendering.gather_points),
                           0.0);
}

double RunStatistics::mean_indirect_cut() const {
    return core::divide_or(static_cast<double>(rendering.indirect_clusters),
                           static_cast<double>(rendering.gather_points), 0.0);
}

RunStatistics sum_of(const RunStatistics& earlier, const RunStatistics& later) {
    RunStatistics sum = earlier;
    each_sum(Adder{}, sum, later);
    sum.frames.insert(sum.frames.end(), later.frames.begin(), later.frames.end());
    sum.rendering = sum_of(earlier.rendering, later.rendering);
    sum.audit.errors.add(later.audit.errors);
    sum.audit.split.add(later.audit.split);
    return sum;
}

RunStatistics totals_of(const RunStatistics& statistics, const renderer::Renderer& renderer) {
    RunStatistics sum = statistics;
    sum.rendering = sum_of(statistics.rendering, renderer.statistics());
    for (std::size_t i = 0; i < sum.pass_seconds.size(); ++i)
        sum.pass_seconds[i] += renderer.seconds(static_cast<renderer::Pass>(i));
    sum.pass_seconds[static_cast<std::size_t>(renderer::Pass::develop)] =
        sum.stage_seconds(Stage::develop) - sum.pass_seconds[static_cast<std::size_t>(renderer::Pass::glare)];
    sum.pass_seconds[static_cast<std::size_t>(renderer::Pass::encode)] = sum.stage_seconds(Stage::encode);
    return sum;
}

json json_of(const renderer::Statistics& counts) {
    json written;
    each_count(Writer{written}, counts);
    return written;
}

json json_of(const FrameEntry& entry) {
    json written;
    each_member(entry, Writer{written});
    return written;
}

json json_of(const RunStatistics& statistics) {
    json written, frames = json::array();
    each_sum(Writer{written}, statistics);
    if (statistics.audit.errors.count() > 0) {
        written["audit_errors"] = statistics.audit.errors.counts();
        each_split_sum(statistics.audit.split.sums(), Writer{written["audit_split"]});
    }
    written["rendering"] = json_of(statistics.rendering);
    for (const FrameEntry& entry : statistics.frames) frames.push_back(json_of(entry));
    written["frames"] = frames;
    return written;
}

void restore(RunStatistics& statistics, const json& written) {
    each_sum(Reader{written}, statistics);
    statistics.audit.errors.restore(written.value("audit_errors", std::vector<std::uint64_t>()));
    if (written.contains("audit_split"))
        each_split_sum(statistics.audit.split.sums(), Reader{written.at("audit_split")});
    each_count(Reader{written.at("rendering")}, statistics.rendering);
    for (const json& frame : written.at("frames")) each_member(statistics.frames.emplace_back(), Reader{frame});
}

}  // namespace render2mpeg::app
