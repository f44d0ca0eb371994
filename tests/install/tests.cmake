# An installed tree that was moved still finds its modules: renders with the installed program after renaming the prefix.
add_test(NAME install.MovedTreeStillRenders
         COMMAND render2mpeg_cpu_seconds install.MovedTreeStillRenders 0 ${CMAKE_COMMAND} -D BUILD=${PROJECT_BINARY_DIR} -D BINDIR=${CMAKE_INSTALL_BINDIR} -D LIBDIR=${CMAKE_INSTALL_LIBDIR}
                 -D DATADIR=${CMAKE_INSTALL_DATADIR} -D DOCDIR=${CMAKE_INSTALL_DOCDIR} -D MANDIR=${CMAKE_INSTALL_MANDIR}
                 -P ${CMAKE_CURRENT_SOURCE_DIR}/install/moved_tree.cmake)
set_tests_properties(install.MovedTreeStillRenders PROPERTIES LABELS slow TIMEOUT 1500)

# The README's two commands: what scripts/demo builds is all that is installed.
add_test(NAME install.WhatTheDemoBuildsCanBeInstalled
         COMMAND render2mpeg_cpu_seconds install.WhatTheDemoBuildsCanBeInstalled 0 ${CMAKE_COMMAND} -D BUILD=${PROJECT_BINARY_DIR} -D SOURCE=${PROJECT_SOURCE_DIR} -D NINJA=${CMAKE_MAKE_PROGRAM}
                 -P ${CMAKE_CURRENT_SOURCE_DIR}/install/demo_targets.cmake)
set_tests_properties(install.WhatTheDemoBuildsCanBeInstalled PROPERTIES LABELS fast TIMEOUT 1500)

# The encoder alone, as a library: the example is built against the installed package, and its film decodes.
add_test(NAME install.TheEncoderIsALibraryOfItsOwn
         COMMAND render2mpeg_cpu_seconds install.TheEncoderIsALibraryOfItsOwn 0 ${CMAKE_COMMAND} -D BUILD=${PROJECT_BINARY_DIR} -D SOURCE=${PROJECT_SOURCE_DIR} -D COMPILER=${CMAKE_CXX_COMPILER}
                 -D DATADIR=${CMAKE_INSTALL_DATADIR} -D GENERATOR=${CMAKE_GENERATOR}
                 -P ${CMAKE_CURRENT_SOURCE_DIR}/install/encoder_package.cmake)
set_tests_properties(install.TheEncoderIsALibraryOfItsOwn PROPERTIES LABELS slow TIMEOUT 1500)

# The Debian package: what it holds, what it depends on, that links of its documents lead on, and that its program renders.
find_program(RENDER2MPEG_DPKG_DEB dpkg-deb)
find_program(RENDER2MPEG_SHLIBDEPS dpkg-shlibdeps)
mark_as_advanced(RENDER2MPEG_DPKG_DEB RENDER2MPEG_SHLIBDEPS)
add_test(NAME install.ADebianPackageHoldsAllAndRenders
         COMMAND render2mpeg_cpu_seconds install.ADebianPackageHoldsAllAndRenders 0 ${CMAKE_COMMAND} -D BUILD=${PROJECT_BINARY_DIR} -D SOURCE=${PROJECT_SOURCE_DIR} -D CPACK=${CMAKE_CPACK_COMMAND}
                 -D DPKG_DEB=${RENDER2MPEG_DPKG_DEB} -D SHLIBDEPS=${RENDER2MPEG_SHLIBDEPS}
                 -P ${CMAKE_CURRENT_SOURCE_DIR}/install/debian_package.cmake)
set_tests_properties(install.ADebianPackageHoldsAllAndRenders PROPERTIES LABELS slow TIMEOUT 1500 SKIP_REGULAR_EXPRESSION "skipped: ")

# The tarball: unpacked elsewhere, the program runs on the libraries that lie beside it, and their licences are told.
find_program(RENDER2MPEG_PATCHELF patchelf)
mark_as_advanced(RENDER2MPEG_PATCHELF)
add_test(NAME install.ATarballRunsOnItsOwnLibraries
         COMMAND render2mpeg_cpu_seconds install.ATarballRunsOnItsOwnLibraries 0 ${CMAKE_COMMAND} -D BUILD=${PROJECT_BINARY_DIR} -D SOURCE=${PROJECT_SOURCE_DIR} -D PATCHELF=${RENDER2MPEG_PATCHELF}
                 -P ${CMAKE_CURRENT_SOURCE_DIR}/install/tarball.cmake)
set_tests_properties(install.ATarballRunsOnItsOwnLibraries PROPERTIES LABELS slow TIMEOUT 1500 SKIP_REGULAR_EXPRESSION "skipped: ")
# What a release is refused for, in a clone.
add_test(NAME install.AReleaseIsRefusedUnlessItsVersionIsTold
         COMMAND render2mpeg_cpu_seconds install.AReleaseIsRefusedUnlessItsVersionIsTold 0 ${CMAKE_COMMAND} -D BUILD=${PROJECT_BINARY_DIR} -D SOURCE=${PROJECT_SOURCE_DIR} -P ${CMAKE_CURRENT_SOURCE_DIR}/install/release.cmake)
set_tests_properties(install.AReleaseIsRefusedUnlessItsVersionIsTold PROPERTIES LABELS fast TIMEOUT 1500 SKIP_REGULAR_EXPRESSION "skipped: ")

# These install the same build folder, and installing writes there.
set_tests_properties(install.MovedTreeStillRenders install.TheEncoderIsALibraryOfItsOwn install.ADebianPackageHoldsAllAndRenders
                     install.ATarballRunsOnItsOwnLibraries PROPERTIES RESOURCE_LOCK install)
