#pragma once
// The search of `tune` for a quality, a rate or a time.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/experiments/trial_command.h"

namespace render2mpeg::app {

/// Searches the --quality (0..100) at which a rising figure meets a target: by false position, and by halves in the
/// end. The figure rises in steps, since quantisers are integers.
class QualitySearch {
  public:
    struct Known {
        double quality = 0, figure = 0;
    };

    explicit QualitySearch(double target) : target_(target) {}

    /// Result of a probe of another quality; figures are finite.
    void add(double quality, double figure);

    /// Next probe, a multiple of `step`; none where nothing is known, the target lies between neighbours, or beyond 0
    /// and 100.
    std::optional<double> next() const;

    /// Nearest to the target; after add() only.
    const Known& nearest() const;
    /// Coarsest with at least the target.
    std::optional<Known> coarsest_above() const;
    /// Finest with at most the target.
    std::optional<Known> finest_below() const;
    const std::vector<Known>& known() const { return known_; }

    /// chosen: a change of quantisers by 0.35 % rounds few pictures' otherwise, and one decimal is few enough to be
    /// typed (0.02..0.5).
    static constexpr double step = 0.1;

  private:
    double target_;
    std::vector<Known> known_;  ///< by quality
};

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

/// Tolerance of a target: of quality in its own unit, of rate as a share.
inline constexpr double near_psnr = 0.1, near_ssim = 0.002, near_rate = 0.02;

/// "42 dB PSNR-Y", "0.98 SSIM", "2000 kb/s", "1.20 MB", "1:30:00".
std::string target_text(const Target& target);
/// A value in the target's unit; none: "-".
std::string figure_text(Target::Kind kind, double value);

/// A trial's value in the target's unit; for sizes, bits per second.
double value_of(const Target& target, const Trial& trial);

/// A value on a scale that is even in --quality: decibels, or the logarithm of a rate. Finite for all values.
double even_figure(const Target& target, double value);
/// Its usual rise per unit of quality.
double even_slope(const Target& target);
bool is_lossless(const Target& target, double value);
/// Whether a value is near enough, or within `share` of that.
bool is_near(const Target& target, double value, double share = 1);

struct Probe : Tried {
    double value = 0;  ///< in the target's kind
    bool lit = true;   ///< false: light of another probe, coded again
};

/// The film that was made; PSNRs may be +infinity.
struct WholeFilm {
    std::int64_t frames = 0;
    double bytes = 0;     ///< of the file
    double bit_rate = 0;  ///< of pictures, per second
    double seconds = 0;   ///< on the clock, to make it
    double psnr_y = 0;    ///< decoded against the pictures as they were lit
    double ssim_y = 0;    ///< likewise
    Quality reference;    ///< with what light adds on the sample (with_light)
    double setting = 0;   ///< its --quality, where that is what is looked for
};

enum class Found {
    near,     ///< the target is met
    between,  ///< it lies between two settings that are neighbours; the better one is taken
    beyond,   ///< no setting reaches it
    stopped,  ///< interrupted
};

/// Results of `tune`.
struct Tuning {
    Target target;
    std::vector<Probe> probes;
    Found found = Found::stopped;
    std::optional<std::size_t> chosen;   ///< of the probes
    Choices options;                     ///< the result
    std::vector<std::string> command{};  ///< `render` with these options; none where nothing is to be rendered
    std::optional<WholeFilm> film;
};

using LogProbe = std::function<void(const Probe&)>;

/// Finds the quality for a PSNR, an SSIM or a bit rate. Coupled light is made for a first guess, coded again until that
/// meets the target, and lit anew for the quality found.
void tune_coding(Trials& trials, const Target& target, bool quiet, Tuning& tuning, const LogProbe& log);

/// Loosens tolerance, samples and light points until the film takes no more than the target's seconds; `once` are spent
/// beside its frames. `film`: of the trials, coded as asked.
void tune_time(Trials& trials, const RenderJob& film, double once, bool quiet, Tuning& tuning, const LogProbe& log);

}  // namespace render2mpeg::app
