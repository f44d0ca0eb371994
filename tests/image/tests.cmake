# OpenEXR itself is the foreign reader of what we write.
find_package(PkgConfig REQUIRED)
pkg_check_modules(OpenEXR REQUIRED IMPORTED_TARGET OpenEXR>=3.1)
render2mpeg_test(image OPENS_MODULES LIBS render2mpeg_image PkgConfig::OpenEXR)
