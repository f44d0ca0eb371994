find_package(PkgConfig REQUIRED)
pkg_check_modules(bench_libavcodec REQUIRED IMPORTED_TARGET libavcodec libavutil)

add_executable(bench_encoder_speed ${CMAKE_CURRENT_LIST_DIR}/encoder_speed.cpp ${CMAKE_CURRENT_LIST_DIR}/encoder_clip.cpp)
target_link_libraries(bench_encoder_speed PRIVATE render2mpeg_options render2mpeg_encoder render2mpeg_parallel benchmark::benchmark)

add_executable(bench_encoder_rd ${CMAKE_CURRENT_LIST_DIR}/encoder_rd.cpp ${CMAKE_CURRENT_LIST_DIR}/encoder_clip.cpp)
target_link_libraries(bench_encoder_rd PRIVATE render2mpeg_options render2mpeg_encoder render2mpeg_parallel PkgConfig::bench_libavcodec)
