#pragma once
// Lights and codes sample windows of a film as chunks of their own.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "app/estimate/forecast.h"
#include "app/experiments/installed_metrics.h"
#include "app/job/render_job.h"
#include "app/loop/glare_filter.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"
#include "core/error_histogram.h"
#include "perceptual/metrics.h"

namespace render2mpeg::app {

/// A frame by reference light.
struct ReferenceFrame {
    core::Plane<glm::vec3> light;  ///< radiance
    core::Picture picture;
    std::vector<glm::ivec2> gathering;  ///< pixels that have anything to gather
    /// Pixels whose truth at their gather points is known: code values of luma beyond reference light, by either half.
    struct TruePixel {
        glm::ivec2 place{0};
        std::array<double, 2> beyond{};
    };
    std::vector<TruePixel> truth;
    std::vector<float> rows{};  ///< weights of rows, as of perceptual::mean_squared_error

    /// Mean squared error of a picture against the truth, where some of that is known: against reference light
    /// everywhere, and what the truth changes of it there. Noise of paths is not in it.
    double mean_squared_error(const core::Plane<std::uint8_t>& luma) const;
};

/// The middle frames of each shot, where there are cuts and no more than eight shots; else as middle_windows().
std::vector<Chunk> windows_by_shot(const RenderJob& film, const SampleExtent& sample);

/// Coding of a film with one quantiser, or by --quality.
RenderJob at_quantiser(RenderJob film, int quantiser);
RenderJob at_quality(RenderJob film, double quality);

/// The middle (frame_view.h) of the last reference frame.
struct SampleFrame {
    std::int64_t frame = 0;
    core::Picture reference, lit, decoded;
    core::Plane<float> error;      ///< of luminance over what it should be, or over half a code value
    core::Plane<float> tolerance;  ///< likewise
};

/// Quality of decoded pictures.
struct Quality {
    double psnr_y = 0, ssim_y = 0;  ///< dB, +infinity where nothing differs; 1 likewise
    double psnr_hvs_m = 0;          ///< dB, likewise
};

/// Results of one way to light and code the windows: costs over all frames, errors over reference frames.
struct Trial {
    int quantiser = 4;
    std::optional<double> quality;  ///< it was coded by this instead
    int frames = 0;
    double seconds = 0;           ///< CPU per frame for light, with what coupling it to its coding takes
    double rays = 0;              ///< shadow rays and gather rays per gather point
    double cut = 0;               ///< clusters per gather point
    double capped = 0;            ///< share of the gather points that the largest cut stopped
    std::uint64_t points = 0;     ///< gathered for; 0: nothing is lit
    core::ErrorHistogram errors;  ///< of luminance over what it should be, or over half a code value where that is more
    std::uint64_t over = 0;       ///< pixels that err by more than their tolerance
    std::uint64_t over_twice = 0;  ///< by more than twice of it
    perceptual::FilmQuality lit;   ///< of reference frames before coding
    perceptual::FilmQuality decoded;
    InstalledQuality installed;  ///< of decoded reference frames, against the reference
    double masked_error = 0;     ///< of decoded reference frames, mean; code values squared (perceptual/metrics.h)
    perceptual::FilmQuality shown, shown_there;  ///< decoded against the pictures as lit: all frames, and references
    double shown_masked = 0, shown_masked_there = 0;  ///< likewise; 0 where not requested
    bool has_references = false;
    double bytes = 0;         ///< per frame of the windows
    double film_bytes = 0;    ///< per frame of the film (film_by)
    double bit_rate = 0;      ///< of that, per second
    int requantised = 0;      ///< pictures that the decoder's buffer had no room for at their quantiser
    double code_seconds = 0;  ///< CPU per frame for coding, and for motion where that is not searched for
    double cpu = 0;           ///< seconds per frame of the film, of all of it (film_by)
    double clock = 0;         ///< likewise on the clock
    std::shared_ptr<const SampleFrame> sample_frame;  ///< null without references

    double share_over() const { return ratio_of(over, errors.count()); }
    double share_over_twice() const { return ratio_of(over_twice, errors.count()); }
    /// Coding errors of all frames, plus the error that light adds on reference frames where there are any.
    /// PSNR-HVS-M needs Trials::mask_all.
    Quality film_quality() const;
    Quality film_quality(const Quality& shown_all) const;  ///< for a film's own coding errors
};

/// Frames that were lit once, to be coded in several ways.
struct LitWindows {
    struct Shown {
        core::Picture picture;
        core::Visible visible;
    };
    Trial light;
    std::map<std::int64_t, Shown> frames;
};

/// Pixels of the reference frames found by unbiased paths (docs/model/truth.md).
struct PathTruth {
    static constexpr double percent = 3;  ///< of a pixel's luminance that its standard error is to have

    std::uint64_t pixels = 0, of = 0;  ///< of those that gather anything
    double seconds = 0;                ///< CPU for a pixel
    double share = 0;                  ///< of all pixels, that gather anything
    double psnr_y = 0;                 ///< dB of reference light at its gather points, at least
};

/// Lights and codes a film's windows in several ways. All results but times are deterministic.
class Trials {
  public:
    /// Plain quantisers replace the film's rate control. `references` of every window; 0: no errors are known.
    Trials(const RenderJob& film, std::vector<Chunk> windows, int references = 1);

    /// Measures masked errors of all frames, which takes time (Trial::shown_masked).
    void mask_all() { masks_all_ = true; }
    /// Asks other programs (Trial::installed), where they are installed.
    void ask_installed_metrics() { installed_.emplace(); }
    const std::optional<InstalledMetrics>& installed() const { return installed_; }
    /// Lets Trial::shown be that of the worst tenth of the frames.
    void judge_worst_tenth() { worst_tenth_ = true; }

    /// Lights the references until an interrupt, or until `one_done` returns false after one. Returns whether all are
    /// lit. `expected` is told about the seconds that all take, where some tiles of the first can tell.
    bool light_references(const std::function<void(double)>& expected, const std::function<bool()>& one_done);
    int wanted_references() const { return references_of_window_ * static_cast<int>(windows_.size()); }
    /// Finds the truth of one pixel in sixteen of the references by paths, or of so many in all: PSNR-Y of trials is
    /// against it from then on. None where shutter or lens blur them. Needs light_references().
    void find_truth(std::size_t most);
    const std::optional<PathTruth>& truth() const { return truth_; }

    /// Lights and codes the windows with the settings of `film`, of the same scene and size. Needs light_references().
    /// None where `frame_done` said false. Frames are kept in `keep` unless null.
    std::optional<Trial> run(const RenderJob& film, const std::function<bool()>& frame_done,
                             LitWindows* keep = nullptr);

    /// The same light, coded as `film` says.
    Trial coded_again(const LitWindows& lit, RenderJob film) const;

    /// Codes one window, hands over the decoded pictures (numbered from 0) and returns bytes and CPU seconds.
    struct Coded {
        double bytes = 0, seconds = 0;
        int requantised = 0;  ///< pictures that a buffer had no room for at first
    };
    using Codec = std::function<Coded(const Chunk& window, const std::vector<const core::Picture*>& pictures,
                                      const std::function<void(const core::Picture&)>& decoded)>;
    Trial coded_by(const Codec& codec, const LitWindows& lit, const RenderJob& film) const;

    const std::vector<Chunk>& windows() const { return windows_; }
    const RenderJob& film() const { return film_; }
    /// Before the first trial: PSNR-Y of panoramas counts by solid angle.
    void weigh_by_solid_angle();
    /// PSNR-Y is by solid angle: the pictures are panoramas.
    bool are_weighted() const { return !rows_.empty(); }
    int frames() const;  ///< of all windows
    /// Memory for references, and for frames where they are kept.
    double bytes_held(bool keeps_frames) const;
    int references() const { return static_cast<int>(references_.size()); }
    double reference_seconds() const;  ///< CPU per reference
    const renderer::Statistics& statistics() const { return renderer_.statistics(); }

  private:
    class Judge;

    renderer::PlacedFrame reference_frame(const scene::Snapshot& world);
    core::Plane<glm::vec3> gathered(const scene::Snapshot& world, const renderer::PlacedFrame& placed);
    double expected_seconds(const scene::Snapshot& world, const renderer::PlacedFrame& placed);
    void light_reference(std::int64_t frame, const std::function<void(double)>& expected);

    RenderJob film_;
    std::vector<float> rows_{};  ///< their weights; empty: all count alike
    std::vector<Chunk> windows_;
    renderer::Renderer renderer_;
    float half_code_ = 0;  ///< luminance
    std::map<std::int64_t, ReferenceFrame> references_;
    std::optional<PathTruth> truth_;
    double reference_seconds_ = 0;
    int references_of_window_ = 1;
    bool masks_all_ = false, worst_tenth_ = false;
    std::optional<InstalledMetrics> installed_;
    RunStatistics shown_statistics_;
    std::unique_ptr<GlareFilter> shown_;  ///< of references; made with the first
};

/// Quality of all pictures: coding errors of all (`shown`), plus the error that light adds on the reference frames
/// (`decoded` against `there`).
Quality with_light(const Quality& shown, const Quality& there, const Quality& decoded);

}  // namespace render2mpeg::app
