# Slow, obviously right versions, and the tests that hold the product against them.
include(${CMAKE_CURRENT_LIST_DIR}/path_tracer.cmake)
add_library(render2mpeg_truth_cases STATIC ${CMAKE_CURRENT_LIST_DIR}/lamp_cases.cpp ${CMAKE_CURRENT_LIST_DIR}/material_cases.cpp
                                              ${CMAKE_CURRENT_LIST_DIR}/path_cases.cpp ${CMAKE_CURRENT_LIST_DIR}/specular_cases.cpp)
target_link_libraries(render2mpeg_truth_cases PUBLIC render2mpeg_path_tracer render2mpeg_test_scenes)
render2mpeg_test(reference SANITIZED_BY_ALL SPARE "OwnPathsTruthSlow" OPENS_MODULES LIBS render2mpeg_truth_cases render2mpeg_test_stages)
