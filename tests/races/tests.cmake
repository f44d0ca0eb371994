# What scripts/test builds and runs under the thread sanitizer: loops and lanes, light and its records, and films of two chunks at once.
# Elsewhere most of these tests are those of their parts.
if(RENDER2MPEG_SANITIZE MATCHES "thread")
  set(RENDER2MPEG_UNITY 1)  # their parts' programs have the names of sources that are compiled as one
  render2mpeg_test(races
    SOURCES ${CMAKE_CURRENT_SOURCE_DIR}/parallel/loops_test.cpp ${CMAKE_CURRENT_SOURCE_DIR}/parallel/lanes_test.cpp
            ${CMAKE_CURRENT_SOURCE_DIR}/renderer/final_gather_test.cpp ${CMAKE_CURRENT_SOURCE_DIR}/renderer/irradiance_cache_test.cpp
    LIBS render2mpeg_renderer render2mpeg_test_stages)
  unset(RENDER2MPEG_UNITY)
  # Of the program only what makes films.
  find_package(fmt REQUIRED)
  add_executable(race_render ${CMAKE_CURRENT_SOURCE_DIR}/races/render.cpp ${PROJECT_SOURCE_DIR}/src/app/commands/render.cpp
                             ${PROJECT_SOURCE_DIR}/src/app/commands/render_stream.cpp)
  target_link_libraries(race_render PRIVATE render2mpeg_options render2mpeg_film fmt::fmt nlohmann_json::nlohmann_json)
  target_link_options(race_render PRIVATE -Wl,--version-script=${CMAKE_CURRENT_SOURCE_DIR}/races/exports.map)
  add_dependencies(race_render render2mpeg_exr_module)
  add_dependencies(test_races race_render)
endif()
