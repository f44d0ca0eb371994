#pragma once
// Names for whole settings of light, from a draft to the finest.
#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "app/options/options.h"

namespace render2mpeg::app {

/// What --effort stands for, where no option says more.
struct Effort {
    const char* name;
    float fraction = 1;      ///< of the tolerance that films are lit with
    float fixed = 0.02f;     ///< tolerance of frames
    int samples = 4;         ///< eye samples of a pixel
    int edge_samples = 0;    ///< of pixels with edges; 0: as many as films and frames have
    int most_samples = 256;  ///< of pixels whose edges could show all the same
};

/// The efforts that are lit as films are, beside the draft. chosen: low loosens in the order of `tune --max-time`; high
/// has half the tolerance and four times the edges' samples (docs/choosing.md has what they cost and lose).
inline constexpr std::array efforts{Effort{"low", 4, 0.08f, 1, 4, 0}, Effort{"default"},
                                    Effort{"high", 0.5f, 0.01f, 4, 64, 256}};

/// Throws UsageError for a name that is none.
const Effort& effort_from(const std::string& name);

/// The options with what their --effort stands for: `draft` is that of --preview in the film's own size.
RenderOptions with_effort(const RenderOptions& options);

/// Photons that light the anchors of each frame of a draft. chosen: 4 per anchor, of 4 and 8: 0 to 0.1 dB less.
inline constexpr std::uint64_t preview_photons = 4 * 2048;

/// The options of `--preview` with what a draft takes where they say nothing: coarse light, few samples, quick coding
/// (docs/pictures.md). Throws UsageError, naming the option, for what a draft does not have.
RenderOptions preview_options(const RenderOptions& options);

}  // namespace render2mpeg::app
