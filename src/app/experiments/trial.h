#pragma once
// Lights and codes sample windows of a film as chunks of their own.
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "app/experiments/reference_cache.h"
#include "app/experiments/windows.h"
#include "app/loop/forecast.h"
#include "app/loop/glare_filter.h"
#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"
#include "app/system/error_histogram.h"
#include "perceptual/metrics.h"

namespace render2mpeg::app {

/// A frame by reference light.
struct Truth {
    core::Plane<glm::vec3> light;  ///< radiance
    core::Picture picture;
    std::vector<glm::ivec2> gathering;  ///< pixels that have anything to gather
    /// To the frame before, and the change along it; none where that has no truth.
    std::optional<core::MotionField> to_previous;
    double change = 0;
};

/// One quantiser, or a --quality between quantisers.
struct Coarseness {
    int quantiser = 4;
    std::optional<double> quality;
    std::optional<int> gop;  ///< pictures; none: the film's

    Coarseness(int code = 4) : quantiser(code) {}
    static Coarseness of_quality(double quality) {
        Coarseness coarseness;
        coarseness.quality = quality;
        return coarseness;
    }
    void apply_to(encoder::Settings& coding) const;
};

/// The middle (frame_view.h) of the last reference frame.
struct SampleFrame {
    std::int64_t frame = 0;
    core::Picture truth, lit, decoded;
    core::Plane<float> error;      ///< of luminance over what it should be, or over half a code value
    core::Plane<float> tolerance;  ///< likewise
};

/// Results of one way to light and code the windows: costs over all frames, errors and quality over reference frames.
struct Trial {
    ToleranceRequest tolerance;
    int quantiser = 4;
    std::optional<double> quality;  ///< it was coded by this instead
    int frames = 0;
    double seconds = 0;        ///< CPU per frame for light, with what coupling it to its coding takes
    double rays = 0;           ///< shadow rays and gather rays per gather point
    double cut = 0;            ///< clusters per gather point
    double capped = 0;         ///< share of the gather points that the largest cut stopped
    std::uint64_t points = 0;  ///< gathered for; 0: nothing is lit
    ErrorHistogram errors;     ///< of luminance over what it should be, or over half a code value where that is more
    std::uint64_t over = 0;    ///< pixels that err by more than their tolerance
    std::uint64_t over_twice = 0;  ///< by more than twice of it
    perceptual::FilmQuality lit;   ///< before coding, against the truth
    perceptual::FilmQuality decoded;
    double flicker = 0;  ///< what decoded pairs change along motion more than the truth; code values, mean
    double shown_masked = 0, shown_masked_there = 0;  ///< mean, as `shown` and `shown_there`; 0 where nobody asked
    double masked_error = 0;  ///< of the decoded pictures, mean; code values squared (perceptual/metrics.h)
    double bytes = 0;         ///< per frame
    double surplus = 0;       ///< of them for I pictures that windows begin with and the film, of longer GOPs, has not
    int requantised = 0;      ///< pictures that the decoder's buffer had no room for at their quantiser
    double code_seconds = 0;  ///< CPU per frame for coding, and for motion where that is not searched for
    double cpu = 0;           ///< seconds per frame of the film, of all of it (film_by)
    double clock = 0;         ///< likewise on the clock
    std::shared_ptr<const SampleFrame> sample_frame;  ///< null without references
    perceptual::FilmQuality shown;                    ///< decoded, against the pictures as they were lit: of all frames
    perceptual::FilmQuality shown_there;              ///< the same of those that a truth is known of

    double share_over() const;
    double share_over_twice() const;
    double bytes_in_film() const { return bytes - surplus; }  ///< per frame
    double psnr_hvs_m() const { return perceptual::psnr(masked_error); }
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

struct ReferenceStanding {
    int done = 0, parts = 0;  ///< of all of them
    double seconds = 0;       ///< that they took, by the clock

    double seconds_left() const { return done > 0 ? seconds / done * (parts - done) : 0.0; }
};

/// Lights and codes a film's windows in several ways. All results but times are deterministic.
class Trials {
  public:
    /// Plain quantisers replace the film's rate control. `references` of every window; 0: no errors are known.
    Trials(const RenderJob& film, std::vector<Chunk> windows, int references = 1);

    /// Windows of another film of the same scene and size, such as a draft; fills in `cpu`, `clock`, `bytes`, `surplus`
    /// and quality. None where `frame_done` said false.
    std::optional<Trial> run_other(const RenderJob& film, const std::function<bool()>& frame_done) const;

    /// Measures masked errors of all frames, which takes time (Trial::shown_masked).
    void mask_all() { masks_all_ = true; }
    /// Lets Trial::shown be that of the worst tenth of the frames.
    void judge_worst_tenth() { worst_tenth_ = true; }
    void keep_references_in(const ReferenceCache& cache) { cache_ = cache; }

    /// Lights the references in parts; `part_done` may end it by returning false. Returns whether all are lit.
    bool light_references(const std::function<bool(const ReferenceStanding&)>& part_done);

    /// Takes the references of other trials of the same windows, of other light points or samples.
    void take_references(const Trials& other);

    /// After light_references() only. None where `frame_done` said false. Frames are kept in `keep` unless null.
    std::optional<Trial> run(const ToleranceRequest& tolerance, const Coarseness& coarseness,
                             const std::function<bool()>& frame_done, LitWindows* keep = nullptr);

    /// The same light, coded otherwise, as run() would with a fixed tolerance.
    Trial coded_again(const LitWindows& lit, const Coarseness& coarseness) const;

    /// Codes one window, hands over the decoded pictures (numbered from 0) and returns bytes and CPU seconds.
    struct Coded {
        double bytes = 0, seconds = 0;
        GopStarts starts;     ///< none: not known
        int requantised = 0;  ///< pictures that a buffer had no room for at first
    };
    using Codec = std::function<Coded(const Chunk& window, const std::vector<const core::Picture*>& pictures,
                                      const std::function<void(const core::Picture&)>& decoded)>;
    Trial coded_by(const Codec& codec, const LitWindows& lit, const Coarseness& coarseness) const;

    const std::vector<Chunk>& windows() const { return windows_; }
    const RenderJob& film() const { return film_; }
    int frames() const;  ///< of all windows
    /// Memory for references, and for frames where they are kept.
    double bytes_held(bool keeps_frames) const;
    int references() const { return static_cast<int>(truths_.size()); }
    double reference_seconds() const;  ///< CPU per reference
    const std::map<std::int64_t, Truth>& truths() const { return truths_; }
    const renderer::Statistics& statistics() const { return renderer_.statistics(); }

  private:
    class Judge;

    void set_times(Trial& trial, const FrameSample& sample) const;
    Trial pooled(Trial trial) const {
        if (worst_tenth_) trial.shown = trial.shown.worst_tenth();
        return trial;
    }

    bool light_parts(const scene::Snapshot& world, const renderer::PlacedFrame& placed, int left,
                     ReferenceStanding& standing, const std::function<bool(const ReferenceStanding&)>& part_done,
                     KeptReference& reference);
    /// Lights one reference; `left` are to come, it included.
    bool light_reference(std::int64_t frame, int left, ReferenceStanding& standing,
                         const std::function<bool(const ReferenceStanding&)>& part_done);

    RenderJob film_;
    std::vector<Chunk> windows_;
    renderer::Renderer renderer_;
    float half_code_ = 0;  ///< luminance
    std::map<std::int64_t, Truth> truths_;
    double reference_seconds_ = 0;
    int references_ = 1;  ///< of each window
    ReferenceCache cache_;
    bool masks_all_ = false, worst_tenth_ = false;
    RunStatistics shown_statistics_;
    std::unique_ptr<GlareFilter> shown_;  ///< of references; made with the first
};

struct Quality {
    double psnr_y = 0, ssim_y = 0;  ///< dB, +infinity where nothing differs; 1 likewise
    double psnr_hvs_m = 0;          ///< dB, likewise
};

/// Quality against reference light: coding errors of all pictures (`shown`), plus the error that light adds on the
/// reference frames (`decoded` against `there`).
Quality with_light(const Quality& shown, const Quality& there, const Quality& decoded);

/// Quality of the sample, against references where there are any, else against its lit pictures. PSNR-HVS-M needs
/// Trials::mask_all.
Quality quality_of(const Trial& trial, bool against_references);

}  // namespace render2mpeg::app
