find_package(fmt REQUIRED)

add_executable(bench_record_lobes ${CMAKE_CURRENT_LIST_DIR}/record_lobes.cpp ${CMAKE_CURRENT_LIST_DIR}/record_lobe_stage.cpp ${CMAKE_CURRENT_LIST_DIR}/record_lobe_trials.cpp ${CMAKE_CURRENT_LIST_DIR}/lobe_harmonics.cpp)
target_link_libraries(bench_record_lobes PRIVATE render2mpeg_options render2mpeg_app fmt::fmt)
