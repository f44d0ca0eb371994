find_package(fmt REQUIRED)

if(NOT TARGET render2mpeg_mover_scenes)
  add_library(render2mpeg_mover_scenes STATIC ${CMAKE_CURRENT_LIST_DIR}/mover_scenes.cpp)
  target_link_libraries(render2mpeg_mover_scenes PUBLIC render2mpeg_options render2mpeg_test_scenes)
endif()
if(NOT TARGET render2mpeg_bench_subject)
  add_library(render2mpeg_bench_subject STATIC ${CMAKE_CURRENT_LIST_DIR}/subject.cpp)
  target_link_libraries(render2mpeg_bench_subject PUBLIC render2mpeg_options render2mpeg_app render2mpeg_mover_scenes fmt::fmt)
endif()
add_executable(bench_shadow_proxies ${CMAKE_CURRENT_LIST_DIR}/shadow_proxies.cpp ${CMAKE_CURRENT_LIST_DIR}/occluding_spheres.cpp
                                    ${CMAKE_CURRENT_LIST_DIR}/imperfect_shadow_maps.cpp)
target_link_libraries(bench_shadow_proxies PRIVATE render2mpeg_bench_subject fmt::fmt)
