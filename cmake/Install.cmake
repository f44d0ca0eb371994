# What `cmake --install` puts where: bin/render2mpeg (src/app), <libdir>/render2mpeg/*.so (render2mpeg_module), and here the scripts that
# Blender runs beside those, the animations under share/render2mpeg, the documents under share/doc/render2mpeg, manual pages and what shells complete.

# The program opens its modules when a film calls for them: whoever builds the program needs them too.
get_property(modules GLOBAL PROPERTY RENDER2MPEG_MODULES)
if(modules)
  add_dependencies(render2mpeg ${modules})
endif()

# The scripts that Blender runs lie beside the modules, and are found like them.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/modules)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/blender ${PROJECT_BINARY_DIR}/modules/blender SYMBOLIC)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/src/app/farm/templates ${PROJECT_BINARY_DIR}/modules/farm SYMBOLIC)
install(DIRECTORY src/app/farm/templates/ DESTINATION ${CMAKE_INSTALL_LIBDIR}/render2mpeg/farm)
install(DIRECTORY blender DESTINATION ${CMAKE_INSTALL_LIBDIR}/render2mpeg
        FILES_MATCHING PATTERN "*.py" PATTERN "blender/render2mpeg" EXCLUDE)

# Blender's extension as a zip, in a static repository that a Blender can be told of by its file: address.
find_package(Python3 3.11 REQUIRED COMPONENTS Interpreter)
set(extension ${PROJECT_BINARY_DIR}/extension)
file(GLOB parts CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/blender/render2mpeg/*.py ${PROJECT_SOURCE_DIR}/blender/render2mpeg/*.toml)
add_custom_command(OUTPUT ${extension}/index.json
                   COMMAND ${CMAKE_COMMAND} -E rm -rf ${extension}
                   COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/scripts/extension ${extension}
                   DEPENDS ${parts} ${PROJECT_SOURCE_DIR}/scripts/extension ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/blender/GPL-3.0-or-later.txt ${PROJECT_SOURCE_DIR}/CMakeLists.txt
                   COMMENT "Writing the extension for Blender" VERBATIM)
add_custom_target(extension ALL DEPENDS ${extension}/index.json)
add_dependencies(render2mpeg extension)
install(DIRECTORY ${extension}/ DESTINATION ${CMAKE_INSTALL_LIBDIR}/render2mpeg/extension)

# Manual pages and completion are made from what the program's --help says.
set(shell ${PROJECT_BINARY_DIR}/shell)
add_custom_command(OUTPUT ${shell}/render2mpeg.fish
                   COMMAND ${CMAKE_COMMAND} -E rm -rf ${shell}
                   COMMAND ${PROJECT_SOURCE_DIR}/cmake/shell_pages.sh $<TARGET_FILE:render2mpeg> ${shell}
                   DEPENDS render2mpeg ${PROJECT_SOURCE_DIR}/cmake/shell_pages.sh
                   COMMENT "Writing manual pages and completion" VERBATIM)
add_custom_target(shell_pages ALL DEPENDS ${shell}/render2mpeg.fish)
install(DIRECTORY ${shell}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 FILES_MATCHING PATTERN "*.1")
install(FILES ${shell}/render2mpeg.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME render2mpeg)
install(FILES ${shell}/_render2mpeg DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
install(FILES ${shell}/render2mpeg.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)

# Documents keep their places beside each other, so that their links lead on; links to what is not installed become plain text.
install(DIRECTORY animations DESTINATION ${CMAKE_INSTALL_DATADIR}/render2mpeg)
install(FILES README.md CHANGELOG.md SECURITY.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES cmake/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs
        FILES_MATCHING PATTERN "*.md" PATTERN "*.json" PATTERN "*.svg" PATTERN "*.png" PATTERN "*.jpg" PATTERN "*.webp")
install(CODE "set(folder \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DOCDIR}\")")
install(SCRIPT cmake/unlink_documents.cmake)
