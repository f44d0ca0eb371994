#pragma once
// Takes the times of loops for LoopRecord.
#include <cstddef>
#include <functional>

namespace render2mpeg::parallel {

/// Whether a loop that begins here is to be recorded: a record lives, of this thread, and no task of it runs.
bool is_recorded();

/// Runs a loop of `count` tasks by run(body) and records it.
void record(std::size_t count, const char* file, int line,
            const std::function<void(const std::function<void(std::size_t)>&)>& run,
            const std::function<void(std::size_t)>& body);

}  // namespace render2mpeg::parallel
