find_package(fmt REQUIRED)

add_executable(bench_light_curves ${CMAKE_CURRENT_LIST_DIR}/light_curves.cpp)
target_link_libraries(bench_light_curves PRIVATE render2mpeg_options render2mpeg_app fmt::fmt)
