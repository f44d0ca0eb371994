# Slow, obviously right versions, and the tests that hold the product against them.
add_library(render2mpeg_path_tracer STATIC ${CMAKE_CURRENT_SOURCE_DIR}/reference/path_tracer.cpp
                                            ${CMAKE_CURRENT_SOURCE_DIR}/reference/scattering.cpp)
target_link_libraries(render2mpeg_path_tracer PUBLIC render2mpeg_renderer)
render2mpeg_test(reference LIBS render2mpeg_path_tracer render2mpeg_test_stages)
