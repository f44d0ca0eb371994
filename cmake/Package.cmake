# `cpack -G DEB` in a build folder makes a package for the Debian release that it runs on.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The render2mpeg authors <render2mpeg@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_DESCRIPTION "Light is computed as finely as the film's coding and the eye let it be seen,
and motion goes to the encoder as it is. Scenes are .blend files, glTF,
animation files and what Assimp reads; films are MPEG-2, H.264, HEVC and AV1.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
# The encoder as a library of its own is not in it.
set(CPACK_COMPONENTS_ALL Unspecified)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# Whoever upgrades from 12 to 13 gets the package of 13: ~deb12 is less than ~deb13. Unnumbered suites have no such word.
cmake_host_system_information(RESULT release QUERY DISTRIB_VERSION_ID)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
if(release)
  string(APPEND CPACK_DEBIAN_PACKAGE_RELEASE "~deb${release}")
endif()
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS blender)
# `compare` codes with it.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS ffmpeg)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian_files.cmake)
include(CPack)
