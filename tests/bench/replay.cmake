find_package(fmt REQUIRED)

add_executable(bench_replay ${CMAKE_CURRENT_LIST_DIR}/replay.cpp)
target_link_libraries(bench_replay PRIVATE render2mpeg_options render2mpeg_app fmt::fmt)
