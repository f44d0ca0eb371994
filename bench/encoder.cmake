find_package(CLI11 CONFIG REQUIRED)
find_package(fmt REQUIRED)

add_executable(bench_encoder_speed ${CMAKE_CURRENT_LIST_DIR}/encoder_speed.cpp ${CMAKE_CURRENT_LIST_DIR}/encoder_clip.cpp)
target_link_libraries(bench_encoder_speed PRIVATE render2mpeg_options render2mpeg_encoder render2mpeg_parallel benchmark::benchmark)

if(NOT TARGET render2mpeg_encoder_rd)
  add_subdirectory(${CMAKE_CURRENT_LIST_DIR}/encoder_rd ${PROJECT_BINARY_DIR}/bench/encoder_rd)
endif()
add_executable(bench_encoder_rd ${CMAKE_CURRENT_LIST_DIR}/encoder_rd.cpp)
target_link_libraries(bench_encoder_rd PRIVATE render2mpeg_encoder_rd fmt::fmt CLI11::CLI11)

add_executable(bench_encoder_rates ${CMAKE_CURRENT_LIST_DIR}/encoder_rates.cpp ${CMAKE_CURRENT_LIST_DIR}/encoder_clip.cpp)
target_link_libraries(bench_encoder_rates PRIVATE render2mpeg_options render2mpeg_encoder render2mpeg_parallel)
