# What scripts/test builds and runs under the thread sanitizer: loops and lanes, light and its records, and films of two chunks at once.
# Elsewhere most of these tests are those of their parts.
if(RENDER2MPEG_SANITIZE MATCHES "thread")
  set(RENDER2MPEG_UNITY 1)  # their parts' programs have the names of sources that are compiled as one
  render2mpeg_test(races
    SOURCES ${CMAKE_CURRENT_SOURCE_DIR}/parallel/loops_test.cpp ${CMAKE_CURRENT_SOURCE_DIR}/parallel/lanes_test.cpp
            ${CMAKE_CURRENT_SOURCE_DIR}/renderer/final_gather_test.cpp ${CMAKE_CURRENT_SOURCE_DIR}/renderer/irradiance_cache_test.cpp
    LIBS render2mpeg_renderer render2mpeg_test_stages)
  unset(RENDER2MPEG_UNITY)
  add_dependencies(test_races render2mpeg)
endif()
