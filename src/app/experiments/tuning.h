#pragma once
// What `tune` tries and finds: the search for a quality, a rate or a time.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/experiments/quality.h"
#include "app/experiments/trial.h"

namespace render2mpeg::app {

/// What `tune` is asked to reach.
struct Target {
    enum class Kind {
        psnr,     ///< dB of luma
        ssim,     ///< of luma
        bitrate,  ///< bits per second of pictures
        size,     ///< bytes of the file, at most
        time,     ///< seconds on the clock, at most
    };
    Kind kind = Kind::psnr;
    double value = 0;
    bool worst_tenth = false;  ///< of the pictures: theirs is the quality that is meant

    bool is_quality() const { return kind == Kind::psnr || kind == Kind::ssim; }
    bool is_rate() const { return kind == Kind::bitrate || kind == Kind::size; }
};

/// How far from a target is near enough: of a quality in its own unit, of a rate as a share of it.
inline constexpr double near_psnr = 0.1, near_ssim = 0.002, near_rate = 0.02;

/// "42 dB PSNR-Y", "0.98 SSIM", "2000 kb/s", "1.20 MB", "1:30:00": what was asked for.
std::string target_text(const Target& target);
/// A value of the target's kind as people read it; none: "-".
std::string figure_text(Target::Kind kind, double value);

/// What a film's pictures come to in the target's kind. Of a size: bits per second, too.
double value_of(const Target& target, const Trial& trial, double pictures_per_second, bool against_references);

/// Where a value lies on a scale on which films' figures rise evenly with --quality: decibels, or the logarithm of a
/// rate. Finite for all values.
double even_figure(const Target& target, double value);
/// By how much that rises for each unit of quality, about.
double even_slope(const Target& target);
/// Whether a value says that nothing is lost at all, so that no coding could be better.
bool is_lossless(const Target& target, double value);
/// Whether a value is as near as is asked for, or within `share` of that.
bool is_near(const Target& target, double value, double share = 1);

/// One try of the sample.
struct Probe {
    std::string setting;  ///< "63.4", "coupled=0.5, 1 sample"
    Trial trial;
    double value = 0;  ///< in the target's kind
    bool lit = true;   ///< false: light of another probe, coded again
};

/// The film that was made in the end, beside what its sample had promised. PSNRs are +infinity where nothing differs.
struct WholeFilm {
    std::int64_t frames = 0;
    double bytes = 0;     ///< of the file
    double bit_rate = 0;  ///< of pictures, per second
    double seconds = 0;   ///< on the clock, to make it
    double psnr_y = 0;    ///< decoded against the pictures as they were lit
    double ssim_y = 0;    ///< likewise
    int references = 0;   ///< frames that say what light adds; 0: none is known
    Quality reference;    ///< decoded against light by every light point (with_light)
};

/// What became of the search.
enum class Found {
    near,     ///< the target is met
    between,  ///< it lies between two settings that are neighbours; the better one is taken
    beyond,   ///< no setting reaches it
    stopped,  ///< interrupted
};

/// All that `tune` finds out.
struct Tuning {
    Target target;
    std::vector<Chunk> windows;
    int references = 0;  ///< frames lit by every light point; 0: quality is against the pictures as they were lit
    double reference_seconds = 0;  ///< CPU, each
    std::vector<Probe> probes;
    Found found = Found::stopped;
    std::optional<std::size_t> chosen;                         ///< of the probes
    std::vector<std::pair<std::string, std::string>> options;  ///< of `render` that it comes to: name and value
    std::optional<std::string> command;                        ///< to paste; none where nothing is to be rendered
    std::optional<WholeFilm> film;

    bool against_references() const { return references > 0; }
};

/// Called with each probe as it comes.
using LogProbe = std::function<void(const Probe&)>;

/// Finds the quality for a PSNR, an SSIM or a bit rate (bits per second in `target`, which for a size is what its
/// pictures may have). Light that is coupled to its coding is lit for a first guess, coded again and again until that
/// meets the target, and lit anew for what was found: until one that was lit for its own coding meets it. Fills
/// `tuning` but for its command.
void tune_coding(Trials& trials, const Target& target, bool quiet, Tuning& tuning, const LogProbe& log);

/// Loosens tolerance, samples and light points step by step until the film takes no more than the target's seconds;
/// `once` are those that it takes beside its frames. Quality is held against the references of the film as asked for.
void tune_time(Trials& trials, const RenderOptions& asked, double once, bool quiet, Tuning& tuning,
               const LogProbe& log);

}  // namespace render2mpeg::app
