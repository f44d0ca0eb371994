# Volumes' files are made by OpenVDB itself, apart since its headers take long to compile: twice as long for the sanitizers, whose matter is
# how they are read.
add_library(render2mpeg_test_vdb STATIC EXCLUDE_FROM_ALL ${CMAKE_CURRENT_SOURCE_DIR}/scene/vdb_file.cpp)
target_link_libraries(render2mpeg_test_vdb PUBLIC render2mpeg_core render2mpeg_openvdb)
set_target_properties(render2mpeg_test_vdb PROPERTIES RENDER2MPEG_NOT_INSTRUMENTED ON)

# Compressed meshes are made with the libraries' own encoders.
find_package(meshoptimizer CONFIG REQUIRED)
render2mpeg_test(scene LIBS render2mpeg_scene render2mpeg_test_scenes meshoptimizer::meshoptimizer render2mpeg_draco
                 render2mpeg_test_vdb)

# What the tests of probes start, and what other tests' models are probed with.
add_executable(probe_readings ${CMAKE_CURRENT_SOURCE_DIR}/scene/probe_readings.cpp)
target_link_libraries(probe_readings PRIVATE render2mpeg_options render2mpeg_scene)
if(TARGET test_scene)
  add_dependencies(test_scene probe_readings render2mpeg)
endif()
