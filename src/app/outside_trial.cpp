#include "app/outside_trial.h"

#include <deque>
#include <memory>
#include <set>
#include <string>
#include <system_error>

#include "app/memory.h"
#include "image/image.h"
#include "parallel/loops.h"
#include "scene/child_trial.h"

namespace render2mpeg::app {
namespace {

/// chosen: the largest image that is read takes 48 bytes for each of its pixels (docs/fits/memory.md) and some ten
/// seconds; what it is stored in tells neither.
constexpr scene::TrialLimits image_limits{(std::uintmax_t{1} << 30) + 48 * std::uintmax_t{image::max_pixels}, 60, 600};

}  // namespace

void try_images(const scene::Animation& film) {
    const std::set<int> images = images_of(film);
    if (images.empty()) return;
    image::open_decoders();
    const auto at_once = static_cast<std::size_t>(parallel::thread_count());
    std::deque<std::unique_ptr<scene::ChildTrial>> running;
    const auto await_first = [&] {
        running.front()->told();
        running.pop_front();
    };
    for (const int i : images) {
        if (running.size() >= at_once) await_first();
        const scene::ImageSource& source = film.images[static_cast<std::size_t>(i)];
        running.push_back(std::make_unique<scene::ChildTrial>(source.name, image_limits, [&](const scene::TakeTurns&) {
            image::read_image(source.path, source.bytes, source.name);
            return std::string();
        }));
    }
    while (!running.empty()) await_first();
}

scene::TrialLimits film_limits(const std::filesystem::path& film) {
    // chosen: 2 GiB and 60 bytes for each of the file's hold the largest pictures and what is told of each; how long it
    // takes nobody can say.
    std::error_code failure;
    const std::uintmax_t size = std::filesystem::file_size(film, failure);
    return {(std::uintmax_t{2} << 30) + 60 * (failure ? 0 : size), 0, 0};
}

}  // namespace render2mpeg::app
