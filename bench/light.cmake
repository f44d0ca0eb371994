add_executable(bench_light ${CMAKE_CURRENT_LIST_DIR}/light.cpp)
target_link_libraries(bench_light PRIVATE render2mpeg_test_stages benchmark::benchmark)
