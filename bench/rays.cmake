# Rays and seeing: bench_rays [--benchmark_filter=...]
add_executable(bench_rays ${CMAKE_CURRENT_SOURCE_DIR}/rays.cpp)
target_link_libraries(bench_rays PRIVATE render2mpeg_options render2mpeg_renderer render2mpeg_test_scenes benchmark::benchmark)
