# The encoder's benchmark must not rot: its parts are tested, and its whole way on a tiny film.
if(NOT TARGET render2mpeg_encoder_rd)
  add_subdirectory(${PROJECT_SOURCE_DIR}/bench/encoder_rd ${PROJECT_BINARY_DIR}/bench/encoder_rd)
endif()
render2mpeg_test(bench NOT_SANITIZED LIBS render2mpeg_encoder_rd OPENS_MODULES)
