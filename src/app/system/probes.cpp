#include "app/system/probes.h"

#include <cstdint>
#include <system_error>

#include "app/system/interrupt.h"
#include "core/error.h"

namespace render2mpeg::app {

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
