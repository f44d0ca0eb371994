find_package(fmt REQUIRED)

add_executable(bench_delta_cuts ${CMAKE_CURRENT_LIST_DIR}/delta_cuts.cpp)
target_link_libraries(bench_delta_cuts PRIVATE render2mpeg_options render2mpeg_app fmt::fmt)
