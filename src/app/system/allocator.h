#pragma once
// Tunes the allocator to keep freed memory.
namespace render2mpeg::app {

/// Lets this process keep memory that it has freed. Planes of pictures come and go with every frame; given back to the
/// system each time, every 4 KB of them cost a fault when they are wanted again: a third of the eye's time. For
/// programs, at their start.
void keep_freed_memory();

}  // namespace render2mpeg::app
