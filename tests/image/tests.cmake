# OpenEXR itself is the foreign reader of what we write.
find_package(PkgConfig REQUIRED)
pkg_check_modules(OpenEXR REQUIRED IMPORTED_TARGET OpenEXR>=3.1)
render2mpeg_test(image OPENS_MODULES LIBS render2mpeg_image PkgConfig::OpenEXR)
if(TARGET test_image)
  # OpenEXR's flags define _REENTRANT, with which no headers fit that were compiled without.
  set_target_properties(test_image PROPERTIES DISABLE_PRECOMPILE_HEADERS ON)
endif()
