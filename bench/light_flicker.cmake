find_package(fmt REQUIRED)

if(NOT TARGET render2mpeg_mover_scenes)
  add_library(render2mpeg_mover_scenes STATIC ${CMAKE_CURRENT_LIST_DIR}/mover_scenes.cpp)
  target_link_libraries(render2mpeg_mover_scenes PUBLIC render2mpeg_options render2mpeg_test_scenes)
endif()
add_executable(bench_light_flicker ${CMAKE_CURRENT_LIST_DIR}/light_flicker.cpp)
target_link_libraries(bench_light_flicker PRIVATE render2mpeg_options render2mpeg_mover_scenes render2mpeg_test_stages fmt::fmt)
