#pragma once
// What `tune` tries and finds: the search for a quality, a rate or a time.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/experiments/target.h"
#include "app/experiments/trial.h"

namespace render2mpeg::app {

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
