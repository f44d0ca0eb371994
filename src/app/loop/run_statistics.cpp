#include "app/loop/run_statistics.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "perceptual/metrics.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

/// Rule for the sum of a counter over two parts of one film.
enum class How { added, largest, apart };

/// One row: a counter under the name of its member. `s`: what it is of, or two of a kind.
#define ADDED(member) visit(#member, How::added, s.member...);
#define ROWS(row, ...) NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(row, __VA_ARGS__))

template <class Visit, class... Entries>
void each_member(Visit&& visit, Entries&... s) {
    using enum How;
    ROWS(ADDED, frame, type, quantiser, mean_quantiser, bytes, planned_quantiser, tries, minimal, stuffing)
    ROWS(ADDED, fullness_before, fullness_after, mse_y, ssim_y, pumping)
    visit("vectors_tried_exact", added, s.motion.evaluations.exact...);
    visit("vectors_tried_predicted", added, s.motion.evaluations.predicted...);
    visit("vectors_tried_searched", added, s.motion.evaluations.searched...);
    visit("vectors_chosen_exact", added, s.motion.chosen.exact...);
    visit("vectors_chosen_predicted", added, s.motion.chosen.predicted...);
    visit("vectors_chosen_searched", added, s.motion.chosen.searched...);
    visit("searches", added, s.motion.searches...);
    visit("shadow_rays", added, s.cost.shadow_rays...);
    visit("gather_rays", added, s.cost.gather_rays...);
    visit("exposure_rays", added, s.cost.exposure_rays...);
    visit("caustic_rays", added, s.cost.caustic_rays...);
    visit("direct_cut", added, s.cost.direct_cut...);
    visit("indirect_cut", added, s.cost.indirect_cut...);
    visit("records_created", added, s.cost.records.created...);
    visit("records_live", added, s.cost.records.live...);
    visit("records_served", added, s.cost.records.served...);
    visit("light_share", added, s.cost.share...);
    visit("light_loss", added, s.cost.loss...);
    visit("seconds", added, s.cost.seconds...);
    visit("seconds_by_stage", added, s.cost.seconds_by_stage...);
}

template <class Visit, class... Counts>
void each_count(Visit&& visit, Counts&... s) {
    using enum How;
    ROWS(ADDED, primary_rays, shadow_rays, gather_rays, photon_rays, specular_rays, air_rays, exposure_rays)
    ROWS(ADDED, exposed_pixels, caustic_rays, caustic_photons, caustic_landings, caustic_pairs, caustic_doubts)
    ROWS(ADDED, gather_points, capped_points, true_paths, true_pixels, capped_pixels, direct_clusters)
    ROWS(ADDED, indirect_clusters, non_finite, luminance, photon_energy, photon_energy_lost, frames_calibrated)
    ROWS(ADDED, calibrated_pixels, calibration_seconds, sky_seconds, layer_seconds)
    visit("first_non_finite", apart, s.first_non_finite...);
    visit("band_points", added, s.bands.points...);
    visit("band_clusters", added, s.bands.clusters...);
    visit("clamped_energy", apart, s.clamped_energy...);
    visit("direct_points", apart, s.direct_points...);
    visit("indirect_points", apart, s.indirect_points...);
    visit("least_error_scale", apart, s.least_error_scale...);
    visit("largest_error_scale", largest, s.largest_error_scale...);
    visit("mean_error_scale", apart, s.mean_error_scale...);
    visit("records_created", added, s.cache.created...);
    visit("records_known", added, s.cache.known...);
    visit("records_served", added, s.cache.served...);
    visit("records_most", largest, s.cache.most...);
    visit("hair_rays", added, s.hair.rays...);
}

template <class Visit, class... Sums>
void each_sum(Visit&& visit, Sums&... s) {
    using enum How;
    ROWS(ADDED, seconds, pass_seconds)
    visit("wall", added, s.earlier_wall...);
    visit("cpu", added, s.earlier_cpu...);
    visit("brightest_luma", largest, s.brightest_luma...);
    visit("max_cll", largest, s.light.most...);
    visit("max_fall", largest, s.light.mean...);
    visit("grain_pictures", added, s.grain.pictures...);
    visit("grain_with", added, s.grain.with...);
    visit("grain_without", added, s.grain.without...);
    visit("audit_over", added, s.audit.over...);
    visit("audit_seconds", added, s.audit.seconds...);
}

template <class Visit, class... Sums>
void each_split_sum(Visit&& visit, Sums&... s) {
    ROWS(ADDED, pixels, paths, blocks, followed, light, dark_light)
    for (std::size_t c = 0; c < renderer::cause_count; ++c) {
        const std::string cause(renderer::cause_names[c]);
#define OF_CAUSE(member) visit((cause + "_" #member).c_str(), How::added, s.causes[c].member...);
        ROWS(OF_CAUSE, difference, difference_squares, dark_difference, dark_difference_squares, squares)
        ROWS(OF_CAUSE, square_squares, block_squares, block_square_squares, flicker_squares, flicker_square_squares)
#undef OF_CAUSE
    }
}

#undef ROWS
#undef ADDED

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

LightLossFound RunStatistics::light_loss() const {
    LightLossFound found;
    double shares = 0, lit = 0;
    for (const FrameEntry& frame : frames) {
        shares += frame.cost.share;
        lit += frame.cost.share > 0 ? 1 : 0;
        if (frame.cost.loss < 0) continue;
        found.loss += frame.cost.loss;
        ++found.pictures;
    }
    found.loss = ratio_of(found.loss, found.pictures);
    found.share = ratio_of(shares, lit);
    return found;
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
    sum.of(renderer::Pass::develop) = sum.of(Stage::develop) - sum.of(renderer::Pass::glare);
    sum.of(renderer::Pass::encode) = sum.of(Stage::encode);
    return sum;
}

json json_of(const renderer::Statistics& counts) {
    json written;
    each_count(Writer{written}, counts);
    return written;
}

json json_of(const FrameEntry& entry) {
    json written;
    each_member(Writer{written}, entry);
    return written;
}

json json_of(const RunStatistics& statistics) {
    json written, frames = json::array();
    each_sum(Writer{written}, statistics);
    if (statistics.audit.errors.count() > 0) {
        written["audit_errors"] = statistics.audit.errors.counts();
        each_split_sum(Writer{written["audit_split"]}, statistics.audit.split.sums());
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
        each_split_sum(Reader{written.at("audit_split")}, statistics.audit.split.sums());
    each_count(Reader{written.at("rendering")}, statistics.rendering);
    for (const json& frame : written.at("frames")) each_member(Reader{frame}, statistics.frames.emplace_back());
}

}  // namespace render2mpeg::app
