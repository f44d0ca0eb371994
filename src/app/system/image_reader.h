#pragma once
// A scene's images, decoded by probes that hand their pixels over.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "image/image.h"
#include "image/stored_image.h"
#include "scene/isolation/probe.h"
#include "scene/model/animation.h"

namespace render2mpeg::app {

/// Numbers of the images on surfaces and sky.
std::set<int> images_of(const scene::Animation& film);

/// Processes side by side, and bytes of memory for each of them, and for one alone on a second try.
struct ImageProbes {
    std::size_t at_once = 1;
    std::uintmax_t share = 0, alone = 0;
};

/// One under --memory, which probes inherit; else one per thread, sharing the machine's memory.
ImageProbes image_probes(bool held_to_limit);

/// Reads a scene's images in probes, which hand their pixels over in shared memory. Without a program for probes, here.
/// Thread-safe.
class ImageReader {
  public:
    explicit ImageReader(std::shared_ptr<const scene::Animation> film) : film_(std::move(film)) {}

    /// Reads all images, some side by side. Throws core::Error where a library is missing, crashes, hangs or takes all
    /// memory; other refusals are told by take(). Whether nobody interrupted.
    bool read_ahead(const ImageProbes& probes);

    /// Reads the headers alone, where that has not been done. Throws as read_ahead(); refused images have no pixels.
    std::map<int, image::ImageHeader> headers();

    /// One image, which is read now unless it was read ahead and not taken yet. Throws core::Error.
    image::StoredImage take(int image);

    /// Drops what nobody took.
    void forget();

  private:
    struct Read {
        image::StoredImage image;
        std::string refusal;  ///< or empty
    };
    struct Group;

    bool read(const std::vector<int>& images, const ImageProbes& probes, bool headers_alone);
    std::vector<int> finish(std::unique_ptr<Group> group, bool refuses);
    void take_answers(Group& group, std::size_t count);
    image::StoredImage read_here(int image) const;

    std::shared_ptr<const scene::Animation> film_;
    std::mutex mutex_;
    std::map<int, Read> held_;
    std::map<int, image::ImageHeader> headers_;
};

/// Reads the images of standard input for an ImageReader; '.' for each. "headers": these alone.
std::string read_probed_images(const std::vector<std::string>& words, const scene::BeginLimits& begin_limits);

/// Decodes sound in a probe. Returns av::Sound::channels. Throws core::Error.
int probe_sound(const std::filesystem::path& file);

scene::ProbeLimits film_limits(const std::filesystem::path& film);

}  // namespace render2mpeg::app
