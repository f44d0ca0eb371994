#include <cstddef>

#include "fuzz/targets.h"

/// One target as libFuzzer runs it: RENDER2MPEG_FUZZ_TARGET is its name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    render2mpeg::fuzz::RENDER2MPEG_FUZZ_TARGET({data, size});
    return 0;
}
