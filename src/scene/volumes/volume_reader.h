#pragma once
// Reads volumes' files as a film comes to them.
#include <list>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "scene/isolation/probe.h"
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Grids of a volume: those in memory, or of one of its files, which a probe reads first. Adds to `notes`. Throws
/// core::Error.
std::shared_ptr<const VolumeGrids> read_volume(const Volume& volume, std::size_t file, std::vector<std::string>& notes);

/// Box and bytes of a volume: of its grids in memory, or of its files, of which at most 16 are looked at, evenly.
/// Throws core::Error where read_volume() would for what these files' heads say.
VolumeOutline outline_of(const Volume& volume);

/// Grids of a film's volumes; holds two files of each at most. Thread-safe.
class VolumeReader {
  public:
    /// `animation` outlives it.
    explicit VolumeReader(const Animation& animation);

    /// Grids of Animation::volumes[volume]. Throws core::Error.
    std::shared_ptr<const VolumeGrids> grids(std::size_t volume, std::size_t file);

    /// A line each about what was not as it should be, until now.
    std::set<std::string> notes() const;

  private:
    struct Held {
        std::mutex reading;
        std::list<std::pair<std::filesystem::path, std::shared_ptr<const VolumeGrids>>> files;  ///< the latest first
    };

    const Animation& animation_;
    std::vector<std::unique_ptr<Held>> held_;
    mutable std::mutex notes_mutex_;
    std::set<std::string> notes_;  ///< each once, however often its file is read
};

/// What a probe does for read_volume(): the grids go to standard input, a file in memory.
std::string read_probed_volume(const std::vector<std::string>& words, const BeginLimits& begin_limits);

/// What a probe does for outline_of().
std::string read_probed_outlines(const std::vector<std::string>& words, const BeginLimits& begin_limits);

}  // namespace render2mpeg::scene
