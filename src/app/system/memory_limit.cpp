#include "app/system/memory_limit.h"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string_view>

#include "core/error.h"

namespace render2mpeg::app {

OwnMemory own_memory() {
    std::uintmax_t resident = 0, writable = 0, peak = 0;
    if (std::FILE* statm = std::fopen("/proc/self/statm", "r")) {
        if (std::fscanf(statm, "%*u %ju %*u %*u %*u %ju", &resident, &writable) != 2) resident = writable = 0;
        std::fclose(statm);
    }
    // Not by getrusage(), which counts what the process was before it became this program.
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) std::sscanf(line.c_str(), "VmHWM: %ju", &peak);
    const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    return {resident * page, writable * page, std::max<std::uint64_t>(peak * 1024, resident * page)};
}

void expect_stack() {
    // chosen: an eighth of what Linux allows by default; 64 KiB crash.
    constexpr rlim_t least = rlim_t{1} << 20;
    rlimit stack{};
    if (getrlimit(RLIMIT_STACK, &stack) != 0 || stack.rlim_cur >= least) return;
    throw core::Error("stack: " + std::to_string(stack.rlim_cur / 1024) + " KiB are allowed (ulimit -s); at least " +
                      std::to_string(least / 1024) + " are needed");
}

std::uint64_t machine_memory() {
    return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

std::uint64_t memory_from(const std::string& text) {
    double number = 0;
    char unit = 0, more = 0;
    const int read = std::sscanf(text.c_str(), "%lf%c%c", &number, &unit, &more);
    constexpr std::string_view units = "KMGT";
    const std::size_t power = units.find(unit);
    // chosen: below 16 MiB no program starts; above an exbibyte no machine does.
    if (read == 2 && power != std::string_view::npos && number > 0) {
        for (std::size_t i = 0; i <= power; ++i) number *= 1024;
        if (number < 16.0 * 1024 * 1024)
            throw core::Error("memory " + text + ": no film is rendered in less than 16M; small ones take some 300M");
        if (number < 1e18) return static_cast<std::uint64_t>(number);
    }
    throw core::Error("memory " + text + ": expected a size such as 8G, 1.5G or 900M");
}

void hold_to(std::uint64_t limit, int threads) {
    // The system counts writable memory, with the unused part of heaps and stacks, now and of later threads. chosen:
    // 256 MiB of Embree's and TBB's, and 16 by thread, with which the smallest films that are reckoned to fit do (1, 2
    // and 8 threads; with half of it Embree does not start).
    const OwnMemory own = own_memory();
    constexpr std::uint64_t in_store = std::uint64_t{256} << 20, by_thread = std::uint64_t{16} << 20;
    limit += own.writable > own.resident ? own.writable - own.resident : 0;
    limit += in_store + by_thread * static_cast<std::uint64_t>(std::max(threads, 1));
#ifndef RENDER2MPEG_SANITIZED
    // Private memory alone: mapped files need no swap, and sanitizers map more than there is.
    const rlimit memory{limit, limit};
    setrlimit(RLIMIT_DATA, &memory);
#endif
}

void keep_freed_memory() {
    // From the heap whatever its size, and kept there. chosen: 1 GB, more than any picture takes.
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
}

}  // namespace render2mpeg::app
