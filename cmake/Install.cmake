# What `cmake --install` puts where: bin/render2mpeg, <libdir>/render2mpeg/*.so (render2mpeg_module does that), the animations under
# share/render2mpeg and the documents under share/doc/render2mpeg.

# The program opens its modules when a film calls for them: whoever builds the program needs them too.
get_property(modules GLOBAL PROPERTY RENDER2MPEG_MODULES)
if(TARGET render2mpeg)
  if(modules)
    add_dependencies(render2mpeg ${modules})
  endif()
  install(TARGETS render2mpeg RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

install(DIRECTORY animations DESTINATION ${CMAKE_INSTALL_DATADIR}/render2mpeg)
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} FILES_MATCHING PATTERN "*.md" PATTERN "*.json")
