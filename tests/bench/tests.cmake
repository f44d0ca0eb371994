# The encoder's benchmark must not rot: its parts are tested, and its whole way on a tiny film.
if(NOT TARGET render2mpeg_encoder_rd)
  add_subdirectory(${PROJECT_SOURCE_DIR}/bench/encoder_rd ${PROJECT_BINARY_DIR}/bench/encoder_rd)
endif()
render2mpeg_test(bench NOT_SANITIZED LIBS render2mpeg_encoder_rd OPENS_MODULES)

# What films are held against Cycles by.
find_program(RENDER2MPEG_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
add_test(NAME bench.BesideCycles COMMAND render2mpeg_cpu_seconds bench.BesideCycles 0 ${RENDER2MPEG_PYTHON} -W error ${CMAKE_CURRENT_SOURCE_DIR}/bench/beside_cycles_test.py)
set_tests_properties(bench.BesideCycles PROPERTIES LABELS fast TIMEOUT 1500)
