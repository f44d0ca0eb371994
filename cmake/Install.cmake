# What `cmake --install` puts where: bin/render2mpeg (src/app), <libdir>/render2mpeg/*.so (render2mpeg_module), and here the animations
# under share/render2mpeg and the documents under share/doc/render2mpeg.

# The program opens its modules when a film calls for them: whoever builds the program needs them too.
get_property(modules GLOBAL PROPERTY RENDER2MPEG_MODULES)
if(modules)
  add_dependencies(render2mpeg ${modules})
endif()

install(DIRECTORY animations DESTINATION ${CMAKE_INSTALL_DATADIR}/render2mpeg)
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} FILES_MATCHING PATTERN "*.md" PATTERN "*.json")
install(FILES cmake/render2mpeg.bash-completion DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME render2mpeg)
