find_package(PkgConfig REQUIRED)
pkg_check_modules(hard_cases_libavcodec REQUIRED IMPORTED_TARGET libavcodec libavutil)
pkg_check_modules(hard_cases_libmpeg2 REQUIRED IMPORTED_TARGET libmpeg2)
file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/hard_cases/*.cpp)
list(FILTER sources EXCLUDE REGEX "_test[.]cpp$")
# About every second case in every way: those whose names end in the alphabet's first half.
render2mpeg_test(hard_cases SPARE "InEveryWaySlow/.*[a-m]$" SOURCES ${sources}
  LIBS render2mpeg_app render2mpeg_test_scenes PkgConfig::hard_cases_libavcodec
       PkgConfig::hard_cases_libmpeg2)
