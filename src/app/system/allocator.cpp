#include "app/system/allocator.h"

#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace render2mpeg::app {

void keep_freed_memory() {
#ifdef __GLIBC__
    // From the heap whatever its size, and kept there. chosen: 1 GB, more than any picture takes.
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

}  // namespace render2mpeg::app
