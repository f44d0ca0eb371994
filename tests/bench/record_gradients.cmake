find_package(fmt REQUIRED)

add_executable(bench_record_gradients ${CMAKE_CURRENT_LIST_DIR}/record_gradients.cpp ${CMAKE_CURRENT_LIST_DIR}/record_gradients_fits.cpp ${CMAKE_CURRENT_LIST_DIR}/record_gradients_frame.cpp
               ${CMAKE_CURRENT_LIST_DIR}/record_gradients_light.cpp
               ${CMAKE_CURRENT_LIST_DIR}/record_gradients_report.cpp)
target_link_libraries(bench_record_gradients PRIVATE render2mpeg_options render2mpeg_app fmt::fmt)
