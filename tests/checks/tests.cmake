render2mpeg_test(checks NOT_SANITIZED)
target_sources(test_checks PRIVATE
  ${CMAKE_CURRENT_SOURCE_DIR}/checks/tree.cpp
  ${CMAKE_CURRENT_SOURCE_DIR}/checks/layers.cpp
  ${CMAKE_CURRENT_SOURCE_DIR}/checks/citations.cpp
  ${CMAKE_CURRENT_SOURCE_DIR}/checks/sizes.cpp
  ${CMAKE_CURRENT_SOURCE_DIR}/checks/style.cpp)
