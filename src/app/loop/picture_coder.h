#pragma once
// Plans and codes the pictures of a chunk.
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "app/loop/motion.h"
#include "app/loop/run_statistics.h"
#include "app/options/film.h"
#include "core/picture.h"
#include "core/plane.h"
#include "encoder/coder.h"
#include "encoder/look_ahead.h"
#include "encoder/quality_control.h"
#include "encoder/types.h"
#include "scene/model/animation.h"

namespace render2mpeg::app {

/// First frames of the animation's shots.
std::vector<std::int64_t> shots_of(const scene::Animation& animation);

/// Plans and codes the pictures of one chunk. Its time counts as encoding.
class PictureCoder {
  public:
    /// `allocations`: one per frame of the film, or none. `shots`: their first frames. `lights_change`: the change is
    /// measured. `ahead`: look-ahead for cuts, B pictures and missing motion; null: none. Throws as av::check() does.
    PictureCoder(const Film& film, const Chunk& chunk, std::span<const encoder::BitAllocation> allocations,
                 std::vector<std::int64_t> shots, RunStatistics& statistics, bool lights_change,
                 encoder::LookAhead* ahead = nullptr);

    /// First pictures as coded roughly (encoder::PictureFacts::trial).
    void expect(std::vector<encoder::FirstPassPicture> trial) { trial_ = std::move(trial); }
    /// How the next picture in display order will be coded. `pictures`: it and those that follow, as far as they are
    /// there already.
    encoder::PicturePlan plan(std::int64_t number, bool cut_before, Motion& motion,
                              std::span<const core::Picture* const> pictures = {});
    /// Codes the next of the planned pictures and returns those that became complete. Takes fields out of `motion`.
    std::vector<encoder::CodedPicture> code(const core::Picture& picture, const encoder::PicturePlan& plan,
                                            Motion& motion);
    /// Codes the pictures held back.
    std::vector<encoder::CodedPicture> flush();

  private:
    /// Pictures until another shot, a keyframe or the chunk's end.
    std::int64_t frames_left(std::int64_t number) const;
    /// Learns how much light has changed since the picture before. Gives its encoder::innovation where that is asked
    /// for and the picture before is there.
    core::Plane<float> compare_with_last(const core::Picture& picture, bool innovation, Motion& motion);
    encoder::PictureFacts facts_of(std::int64_t number, bool cut_before) const;
    /// Learns the quality by quantiser of a shot's first pictures, coded roughly.
    void try_quality(std::span<const core::Picture* const> pictures);
    /// Learns the quality reached by pictures.
    void judge(const std::vector<encoder::CodedPicture>& pictures);
    void look_ahead(encoder::PictureFacts& facts, std::int64_t number);

    Film film_;
    Chunk chunk_;
    std::span<const encoder::BitAllocation> allocations_;
    std::vector<std::int64_t> shots_;
    RunStatistics& statistics_;
    bool lights_change_;
    encoder::LookAhead* ahead_;
    core::Plane<float> latitude_;  ///< of a panorama: factors of macroblocks' quantisers; else empty
    std::unique_ptr<encoder::Coder> coder_;
    std::vector<encoder::FirstPassPicture> trial_;
    std::int64_t gop_start_ = 0;
    bool continues_ = false;                          ///< the picture planned last goes on from the one before
    core::Plane<std::uint8_t> last_luma_;             ///< of the picture coded last; empty: none in this chunk
    std::optional<double> light_change_;              ///< from the picture before that; none: not known
    std::optional<encoder::QualityControl> quality_;  ///< none: not asked for
    std::map<std::int64_t, core::Plane<std::uint8_t>> unjudged_;  ///< luma of pictures being coded
};

}  // namespace render2mpeg::app
