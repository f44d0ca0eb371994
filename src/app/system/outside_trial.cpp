#include "app/system/outside_trial.h"

#include <unistd.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include "app/system/interrupt.h"
#include "app/system/shown_images.h"
#include "image/image.h"
#include "parallel/loops.h"
#include "scene/isolation/child_trial.h"

namespace render2mpeg::app {
namespace {

/// chosen: the largest image that is read takes 48 bytes for each of its pixels (docs/fits/memory.md) and some ten
/// seconds; what it is stored in tells neither.
constexpr scene::TrialLimits image_limits{(std::uintmax_t{1} << 30) + 48 * std::uintmax_t{image::max_pixels}, 60, 600};

/// One image in the trying.
struct ImageTrial {
    ImageTrial(const scene::ImageSource& image, std::uintmax_t memory)
        : source(&image),
          trial(image.name, {memory, image_limits.seconds, image_limits.clock_seconds}, [&](const scene::TakeTurns&) {
              image::read_image(image.path, image.bytes, image.name);
              return std::string();
          }) {}

    const scene::ImageSource* source;
    scene::ChildTrial trial;
};

}  // namespace

ImageTrials image_trials(bool held_to_limit) {
    if (held_to_limit) return {1, image_limits.memory, image_limits.memory};
    const std::size_t threads = static_cast<std::size_t>(std::max(1, parallel::thread_count()));
    const auto machine =
        static_cast<std::uintmax_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uintmax_t>(sysconf(_SC_PAGESIZE));
    // chosen: half of the machine for all of them, the other for what runs beside (1/4..1).
    const std::uintmax_t alone = std::min(image_limits.memory, machine);
    return {threads, std::min(alone, machine / 2 / threads), alone};
}

bool try_images(const scene::Animation& film, const ImageTrials& trials) {
    const std::set<int> images = images_of(film);
    if (images.empty()) return true;
    image::open_decoders();
    std::deque<std::unique_ptr<ImageTrial>> running;
    std::vector<const scene::ImageSource*> large;
    const auto await_first = [&] {
        const std::unique_ptr<ImageTrial> first = std::move(running.front());
        running.pop_front();
        try {
            first->trial.told();
        } catch (const scene::OutOfMemory&) {
            if (trials.share >= trials.alone) throw;
            large.push_back(first->source);
        }
    };
    for (const int i : images) {
        if (running.size() >= trials.at_once) await_first();
        if (InterruptGuard::requested()) return false;
        running.push_back(std::make_unique<ImageTrial>(film.images[static_cast<std::size_t>(i)], trials.share));
    }
    while (!running.empty()) await_first();
    for (const scene::ImageSource* source : large) {
        if (InterruptGuard::requested()) return false;
        ImageTrial(*source, trials.alone).trial.told();
    }
    return !InterruptGuard::requested();
}

scene::TrialLimits film_limits(const std::filesystem::path& film) {
    // chosen: 2 GiB and 60 bytes for each of the file's hold the largest pictures and what is told of each; how long it
    // takes nobody can say.
    std::error_code failure;
    const std::uintmax_t size = std::filesystem::file_size(film, failure);
    return {(std::uintmax_t{2} << 30) + 60 * (failure ? 0 : size), 0, 0};
}

}  // namespace render2mpeg::app
