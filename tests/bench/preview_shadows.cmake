# Shadows of a draft's lattice by rays, imperfect shadow maps and occluding spheres: bench_preview_shadows
add_executable(bench_preview_shadows ${CMAKE_CURRENT_LIST_DIR}/preview_shadows.cpp)
if(NOT TARGET render2mpeg_mover_scenes)
  add_library(render2mpeg_mover_scenes STATIC ${CMAKE_CURRENT_LIST_DIR}/mover_scenes.cpp)
  target_link_libraries(render2mpeg_mover_scenes PUBLIC render2mpeg_options render2mpeg_test_scenes)
endif()
target_link_libraries(bench_preview_shadows PRIVATE render2mpeg_mover_scenes render2mpeg_options render2mpeg_renderer fmt::fmt)
