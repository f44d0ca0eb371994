file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/checks/*.cpp)
list(FILTER sources EXCLUDE REGEX "_test[.]cpp$")
render2mpeg_test(checks NOT_SANITIZED SOURCES ${sources})
