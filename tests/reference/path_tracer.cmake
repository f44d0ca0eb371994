# The path tracer of tests and benchmarks.
if(NOT TARGET render2mpeg_path_tracer)
  add_library(render2mpeg_path_tracer STATIC ${CMAKE_CURRENT_LIST_DIR}/path_tracer.cpp ${CMAKE_CURRENT_LIST_DIR}/fog.cpp
                                              ${CMAKE_CURRENT_LIST_DIR}/lamps.cpp
                                              ${CMAKE_CURRENT_LIST_DIR}/scattering.cpp ${CMAKE_CURRENT_LIST_DIR}/surfaces.cpp
                                              ${CMAKE_CURRENT_LIST_DIR}/texels.cpp)
  target_link_libraries(render2mpeg_path_tracer PUBLIC render2mpeg_renderer)
endif()
