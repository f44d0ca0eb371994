add_executable(bench_visibility ${CMAKE_CURRENT_LIST_DIR}/visibility.cpp)
target_link_libraries(bench_visibility PRIVATE render2mpeg_app benchmark::benchmark)
