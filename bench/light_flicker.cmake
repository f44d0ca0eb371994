find_package(fmt REQUIRED)

add_executable(bench_light_flicker ${CMAKE_CURRENT_LIST_DIR}/light_flicker.cpp ${CMAKE_CURRENT_LIST_DIR}/mover_scenes.cpp)
target_link_libraries(bench_light_flicker PRIVATE render2mpeg_options render2mpeg_test_scenes render2mpeg_test_stages fmt::fmt)
