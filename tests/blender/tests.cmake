# One Blender serves all tests that need no Blender of their own, and another one what they call meanwhile: a start takes seconds.
set(RENDER2MPEG_BLENDER_SOCKET ${PROJECT_BINARY_DIR}/blender.socket)
set(RENDER2MPEG_SERVED_BLENDER ${CMAKE_CURRENT_SOURCE_DIR}/blender/served)
foreach(way begin end)
  add_test(NAME blender.${way}s COMMAND ${RENDER2MPEG_SERVED_BLENDER} --${way} ${RENDER2MPEG_BLENDER_SOCKET} ${PROJECT_BINARY_DIR}/blender.log)
endforeach()
set_tests_properties(blender.begins PROPERTIES LABELS slow TIMEOUT 300 FIXTURES_SETUP blender)
set_tests_properties(blender.ends PROPERTIES LABELS slow TIMEOUT 300 FIXTURES_CLEANUP blender)
