#pragma once
// Names for whole settings of light.
#include <array>
#include <cstdint>
#include <string>

#include "app/options/options.h"

namespace render2mpeg::app {

struct Effort {
    const char* name;
    float fraction = 1;      ///< of the tolerance that films are lit with
    float fixed = 0.02f;     ///< tolerance of frames
    int samples = 4;         ///< eye samples of a pixel
    int edge_samples = 0;    ///< of pixels with edges; 0: as many as films and frames have
    int most_samples = 256;  ///< of pixels whose edges could show all the same
};

/// Efforts beside the draft. chosen: low loosens in the order of `tune --max-time`; high has half the tolerance and
/// four times the edges' samples (docs/choosing.md).
inline constexpr std::array efforts{Effort{"low", 4, 0.08f, 1, 4, 0}, Effort{"default"},
                                    Effort{"high", 0.5f, 0.01f, 4, 64, 256}};

const Effort& effort_from(const std::string& name);

/// Options with --effort applied; `draft` is --preview in the film's own size.
RenderOptions with_effort(const RenderOptions& options);

/// Photons of each frame of a draft. chosen: 4 per anchor, of 4 and 8: 0 to 0.1 dB less.
inline constexpr std::uint64_t preview_photons = 4 * 2048;

/// Options with a draft's coarse light, few samples and quick coding where none are given (docs/pictures.md). Throws
/// UsageError, naming an option that drafts do not have.
RenderOptions preview_options(const RenderOptions& options);

}  // namespace render2mpeg::app
