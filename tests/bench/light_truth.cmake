find_package(fmt REQUIRED)

include(${PROJECT_SOURCE_DIR}/tests/reference/path_tracer.cmake)
if(NOT TARGET render2mpeg_mover_scenes)
  add_library(render2mpeg_mover_scenes STATIC ${CMAKE_CURRENT_LIST_DIR}/mover_scenes.cpp)
  target_link_libraries(render2mpeg_mover_scenes PUBLIC render2mpeg_options render2mpeg_test_scenes)
endif()
add_executable(bench_light_truth ${CMAKE_CURRENT_LIST_DIR}/light_truth.cpp)
target_link_libraries(bench_light_truth PRIVATE render2mpeg_options render2mpeg_app render2mpeg_path_tracer render2mpeg_mover_scenes fmt::fmt)
