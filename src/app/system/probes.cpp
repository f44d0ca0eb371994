#include "app/system/probes.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <deque>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "app/system/interrupt.h"
#include "core/error.h"
#include "image/image.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// chosen: the largest image takes 48 bytes a pixel (docs/measurements.md#memory) and some ten seconds.
constexpr scene::ProbeLimits image_limits{(std::uintmax_t{1} << 30) + 48 * std::uintmax_t{image::max_pixels}, 60, 600};

using nlohmann::json;
using Sources = std::vector<const scene::ImageSource*>;

std::vector<std::uint8_t> packed(std::span<const scene::ImageSource* const> sources) {
    json images = json::array();
    for (const scene::ImageSource* source : sources) {
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(source->bytes.data());
        images.push_back({source->path.native(), source->name, json::binary({bytes, bytes + source->bytes.size()})});
    }
    return json::to_msgpack(images);
}

scene::ProbeLimits limits_with(std::uintmax_t memory) {
    return {memory, image_limits.seconds, image_limits.clock_seconds};
}

struct ImageProbe {
    ImageProbe(Sources images, const scene::ProbeLimits& taken)
        : sources(std::move(images)),
          limits(taken),
          probe(limits, {"images"}, std::as_bytes(std::span<const std::uint8_t>(packed(sources)))) {}

    Sources sources;
    scene::ProbeLimits limits;
    scene::Probe probe;
};

/// Waits for a probe, and starts others for its remaining images. Images short of memory go to `large`, or are refused
/// where that is null.
void finish(std::unique_ptr<ImageProbe> probe, Sources* large) {
    while (probe) {
        scene::ProbeEnd end = probe->probe.end(InterruptGuard::requested);
        // A point for each image, then the error.
        const std::size_t done = std::min(end.text.find_first_not_of('.'), end.text.size());
        if (end.how == scene::ProbeEnd::How::given_up || done >= probe->sources.size()) return;
        const scene::ImageSource* const last = probe->sources[done];
        try {
            scene::text_of(std::move(end), last->name, probe->limits);
        } catch (const scene::OutOfMemory&) {
            if (large == nullptr) throw;
            large->push_back(last);
        }
        const Sources rest(probe->sources.begin() + static_cast<std::ptrdiff_t>(done) + 1, probe->sources.end());
        const scene::ProbeLimits limits = probe->limits;
        probe = rest.empty() ? nullptr : std::make_unique<ImageProbe>(rest, limits);
    }
}

}  // namespace

std::set<int> images_of(const scene::Animation& film) {
    std::set<int> images;
    for (const scene::Object& object : film.objects) {
        const scene::Material& m = film.materials[static_cast<std::size_t>(object.material)];
        for (const auto& [use, name] : scene::texture_uses)
            if ((m.*use).present()) images.insert((m.*use).image);
    }
    if (film.sky.image >= 0) images.insert(film.sky.image);
    return images;
}

ImageProbes image_probes(bool held_to_limit) {
    if (held_to_limit) return {1, image_limits.memory, image_limits.memory};
    const std::size_t threads = static_cast<std::size_t>(std::max(1, parallel::thread_count()));
    const auto machine =
        static_cast<std::uintmax_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uintmax_t>(sysconf(_SC_PAGESIZE));
    // chosen: half of the machine for all of them, the other for what runs beside (1/4..1).
    const std::uintmax_t alone = std::min(image_limits.memory, machine);
    return {threads, std::min(alone, machine / 2 / threads), alone};
}

bool probe_images(const scene::Animation& film, const ImageProbes& probes) {
    if (!scene::Probe::is_possible()) return !InterruptGuard::requested();
    Sources sources, large;
    for (const int i : images_of(film)) sources.push_back(&film.images[static_cast<std::size_t>(i)]);
    // chosen: opening the libraries takes a process 0.3 s, as long as some sixteen small images (4..16).
    constexpr std::size_t images_of_one = 16;
    const std::size_t count = std::min(probes.at_once, (sources.size() + images_of_one - 1) / images_of_one);
    std::deque<std::unique_ptr<ImageProbe>> running;
    for (std::size_t p = 0; p < count; ++p) {
        Sources own;
        for (std::size_t i = p; i < sources.size(); i += count) own.push_back(sources[i]);
        running.push_back(std::make_unique<ImageProbe>(std::move(own), limits_with(probes.share)));
    }
    for (; !running.empty(); running.pop_front())
        finish(std::move(running.front()), probes.share < probes.alone ? &large : nullptr);
    for (const scene::ImageSource* source : large)
        finish(std::make_unique<ImageProbe>(Sources{source}, limits_with(probes.alone)), nullptr);
    return !InterruptGuard::requested();
}

std::string read_probed_images(const scene::BeginLimits& begin_limits) {
    image::open_decoders();
    for (const json& source : json::from_msgpack(std::cin)) {
        const std::vector<std::uint8_t>& bytes = source.at(2).get_binary();
        begin_limits();
        try {
            image::read_image(source.at(0).get<std::string>(), std::as_bytes(std::span(bytes)),
                              source.at(1).get<std::string>());
        } catch (const core::Error&) {
            if (errno == ENOMEM) throw;
        }
        scene::write_from_probe(".");
    }
    return {};
}

void probe_sound(const std::filesystem::path& file) {
    std::error_code failure;
    if (!std::filesystem::is_regular_file(file, failure))
        throw core::Error("reading", file.string(), "there is no such file");
    if (!scene::Probe::is_possible()) return;
    scene::read_in_probe({"sound", file.string()}, file.string(), film_limits(file), InterruptGuard::requested);
}

scene::ProbeLimits film_limits(const std::filesystem::path& film) {
    // chosen: 2 GiB and 60 bytes per byte of the file hold the largest pictures and their records; the time is unknown.
    std::error_code failure;
    const std::uintmax_t size = std::filesystem::file_size(film, failure);
    return {(std::uintmax_t{2} << 30) + 60 * (failure ? 0 : size), 0, 0};
}

}  // namespace render2mpeg::app
