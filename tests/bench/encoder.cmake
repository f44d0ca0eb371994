find_package(CLI11 CONFIG REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)

add_executable(bench_encoder_speed ${CMAKE_CURRENT_LIST_DIR}/encoder_speed.cpp ${CMAKE_CURRENT_LIST_DIR}/encoder_clip.cpp)
target_link_libraries(bench_encoder_speed PRIVATE render2mpeg_options render2mpeg_encoder render2mpeg_parallel benchmark::benchmark)

file(GLOB encoder_rd_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/encoder_rd/*.cpp)
add_executable(bench_encoder_rd ${CMAKE_CURRENT_LIST_DIR}/encoder_rd.cpp ${encoder_rd_sources})
target_include_directories(bench_encoder_rd PRIVATE ${CMAKE_CURRENT_LIST_DIR})
target_compile_definitions(bench_encoder_rd PRIVATE RENDER2MPEG_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
target_link_libraries(bench_encoder_rd PRIVATE render2mpeg_options render2mpeg_app fmt::fmt nlohmann_json::nlohmann_json CLI11::CLI11)
# Films are decoded, and images read, by modules that are opened on demand.
add_dependencies(bench_encoder_rd render2mpeg_av_module render2mpeg_image_module)

add_executable(bench_encoder_rates ${CMAKE_CURRENT_LIST_DIR}/encoder_rates.cpp ${CMAKE_CURRENT_LIST_DIR}/encoder_clip.cpp)
target_link_libraries(bench_encoder_rates PRIVATE render2mpeg_options render2mpeg_encoder render2mpeg_parallel)
