#include "app/loop/run_statistics_json.h"

#include <nlohmann/json.hpp>
#include <string>

namespace render2mpeg::app {
namespace {

using nlohmann::json;

/// Names every member of an entry, for writing and reading alike.
template <class Entry, class Visit>
void each_member(Entry& e, Visit&& visit) {
    visit("frame", e.frame);
    visit("type", e.type);
    visit("quantiser", e.quantiser);
    visit("mean_quantiser", e.mean_quantiser);
    visit("bytes", e.bytes);
    visit("planned_quantiser", e.planned_quantiser);
    visit("tries", e.tries);
    visit("minimal", e.minimal);
    visit("stuffing", e.stuffing);
    visit("fullness_before", e.fullness_before);
    visit("fullness_after", e.fullness_after);
    visit("vectors_tried_exact", e.motion.evaluations.exact);
    visit("vectors_tried_predicted", e.motion.evaluations.predicted);
    visit("vectors_tried_searched", e.motion.evaluations.searched);
    visit("vectors_chosen_exact", e.motion.chosen.exact);
    visit("vectors_chosen_predicted", e.motion.chosen.predicted);
    visit("vectors_chosen_searched", e.motion.chosen.searched);
    visit("searches", e.motion.searches);
    visit("mse_y", e.mse_y);
    visit("ssim_y", e.ssim_y);
    visit("pumping", e.pumping);
    visit("shadow_rays", e.shadow_rays);
    visit("direct_cut", e.direct_cut);
    visit("indirect_cut", e.indirect_cut);
    visit("records_created", e.records.created);
    visit("records_live", e.records.live);
    visit("records_served", e.records.served);
    visit("seconds", e.seconds);
}

template <class Counts, class Visit>
void each_count(Counts& s, Visit&& visit) {
    visit("primary_rays", s.primary_rays);
    visit("shadow_rays", s.shadow_rays);
    visit("gather_rays", s.gather_rays);
    visit("photon_rays", s.photon_rays);
    visit("specular_rays", s.specular_rays);
    visit("air_rays", s.air_rays);
    visit("exposure_rays", s.exposure_rays);
    visit("exposed_pixels", s.exposed_pixels);
    visit("caustic_rays", s.caustic_rays);
    visit("caustic_photons", s.caustic_photons);
    visit("caustic_landings", s.caustic_landings);
    visit("caustic_pairs", s.caustic_pairs);
    visit("caustic_doubts", s.caustic_doubts);
    visit("gather_points", s.gather_points);
    visit("capped_points", s.capped_points);
    visit("true_paths", s.true_paths);
    visit("true_pixels", s.true_pixels);
    visit("capped_pixels", s.capped_pixels);
    visit("direct_clusters", s.direct_clusters);
    visit("indirect_clusters", s.indirect_clusters);
    visit("non_finite", s.non_finite);
    visit("first_non_finite", s.first_non_finite);
    visit("band_points", s.bands.points);
    visit("band_clusters", s.bands.clusters);
    visit("clamped_energy", s.clamped_energy);
    visit("luminance", s.luminance);
    visit("photon_energy", s.photon_energy);
    visit("photon_energy_lost", s.photon_energy_lost);
    visit("direct_points", s.direct_points);
    visit("indirect_points", s.indirect_points);
    visit("least_error_scale", s.least_error_scale);
    visit("largest_error_scale", s.largest_error_scale);
    visit("mean_error_scale", s.mean_error_scale);
    visit("frames_calibrated", s.frames_calibrated);
    visit("calibrated_pixels", s.calibrated_pixels);
    visit("calibration_seconds", s.calibration_seconds);
    visit("sky_seconds", s.sky_seconds);
    visit("layer_seconds", s.layer_seconds);
    visit("records_created", s.cache.created);
    visit("records_served", s.cache.served);
    visit("records_at_record", s.cache.at_record);
    visit("records_held_out", s.cache.held_out);
    visit("records_missed", s.cache.missed);
    visit("records_most", s.cache.most);
}

/// Sums over the film so far.
template <class Sums, class Visit>
void each_sum(Sums& l, Visit&& visit) {
    visit("seconds", l.seconds);
    visit("pass_seconds", l.pass_seconds);
    visit("wall", l.earlier_wall);
    visit("cpu", l.earlier_cpu);
    visit("brightest_luma", l.brightest_luma);
    visit("audit_over", l.audit.over);
    visit("audit_seconds", l.audit.seconds);
}

/// Errors against the truth, by cause.
template <class Sums, class Visit>
void each_split_sum(Sums& s, Visit&& visit) {
    visit("pixels", s.pixels);
    visit("paths", s.paths);
    visit("light", s.light);
    visit("dark_light", s.dark_light);
    for (std::size_t c = 0; c < s.causes.size(); ++c) {
        auto& cause = s.causes[c];
        const auto sum = [&](const char* name, auto& value) {
            visit((std::string(renderer::cause_names[c]) + "_" + name).c_str(), value);
        };
        sum("difference", cause.difference);
        sum("difference_squares", cause.difference_squares);
        sum("dark_difference", cause.dark_difference);
        sum("dark_difference_squares", cause.dark_difference_squares);
        sum("squares", cause.squares);
        sum("square_squares", cause.square_squares);
    }
}

/// Writes each member that it is shown.
struct Writer {
    json& to;
    template <class Value>
    void operator()(const char* name, const Value& value) const {
        to[name] = value;
    }
};

/// Reads each member that it is shown; throws json::exception where one is missing or of another kind.
struct Reader {
    const json& from;
    template <class Value>
    void operator()(const char* name, Value& value) const {
        from.at(name).get_to(value);
    }
};

}  // namespace

json json_of(const RunStatistics& statistics, std::size_t first_frame) {
    json written, rendering, frames = json::array();
    each_sum(statistics, Writer{written});
    if (statistics.audit.errors.count() > 0) {
        written["audit_errors"] = statistics.audit.errors.counts();
        each_split_sum(statistics.audit.split.sums(), Writer{written["audit_split"]});
    }
    each_count(statistics.rendering, Writer{rendering});
    written["rendering"] = rendering;
    for (std::size_t i = first_frame; i < statistics.frames.size(); ++i) {
        json frame;
        each_member(statistics.frames[i], Writer{frame});
        frames.push_back(frame);
    }
    written["frames"] = frames;
    return written;
}

void restore(RunStatistics& statistics, const json& written) {
    each_sum(statistics, Reader{written});
    statistics.audit.errors.restore(written.value("audit_errors", std::vector<std::uint64_t>()));
    if (written.contains("audit_split"))
        each_split_sum(statistics.audit.split.sums(), Reader{written.at("audit_split")});
    each_count(statistics.rendering, Reader{written.at("rendering")});
    for (const json& frame : written.at("frames")) each_member(statistics.frames.emplace_back(), Reader{frame});
}

}  // namespace render2mpeg::app
