#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/motion_field.h"
#include "core/picture.h"

namespace render2mpeg::bench {

/// Pictures to be coded, and exact motion between any two of them.
struct Clip {
    std::string name;
    std::string content;  ///< hash of the pictures, in hexadecimal
    std::filesystem::path y4m;
    std::vector<core::Picture> pictures;
    bool lights_change = false;  ///< lamps are keyed
    /// From a picture to a reference; it lives until another picture is asked for. Not for several threads. Empty:
    /// nothing is known of motion.
    std::function<const core::MotionField&(std::int64_t picture, std::int64_t reference)> motion;
};

/// What is asked for of a clip.
struct ClipRequest {
    std::string name;              ///< of clips_of_set() or scene_clips(), or an animation file
    std::filesystem::path cache;   ///< folder of rendered films
    std::filesystem::path scenes;  ///< folder of real scenes; empty: none
    int frames = 60;               ///< the first of the film's, 2..60
    bool small = false;            ///< 320x176 and 30 pictures instead of the film's own size and 60
};

/// What clips are for: the encoder's constants are chosen on the fit set and judged on the test set. Each has rendered
/// films (with exact motion) and foreign ones (ffmpeg's own sources, without).
enum class ClipSet { fit, fit_foreign, test, test_foreign };

/// Names of a set's clips that need nothing but this repository, and ffmpeg for the foreign ones.
std::vector<std::string> clips_of_set(ClipSet set);
/// Names of those that need SCENES.
std::vector<std::string> scene_clips(ClipSet set);

/// The clip's pictures: from the cache where it has them, else rendered (some CPU minutes) and kept. Rendered pictures
/// are named by a hash of all that they are made from but for this program's code. Throws core::Error.
Clip make_clip(const ClipRequest& request);

/// FNV-1a over bytes, in hexadecimal. [FNV]
class ContentHash {
  public:
    void add(const std::string& bytes);
    void add_file(const std::filesystem::path& file);
    std::string text() const;

  private:
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace render2mpeg::bench
