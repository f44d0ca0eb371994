# The encoder as a library of its own (docs/encoder-library.md): `cmake --install BUILD --component encoder --prefix DIR` puts there what
# find_package(render2mpeg_encoder) finds. It needs TBB and GLM, and no other library.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/render2mpeg_encoder)
foreach(part IN ITEMS encoder core parallel)
  add_library(render2mpeg::${part} ALIAS render2mpeg_${part})
  set_target_properties(render2mpeg_${part} PROPERTIES EXPORT_NAME ${part})
  target_compile_features(render2mpeg_${part} PUBLIC cxx_std_20)
  target_include_directories(render2mpeg_${part} INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/render2mpeg>)
endforeach()

install(TARGETS render2mpeg_encoder render2mpeg_core render2mpeg_parallel EXPORT render2mpeg_encoder
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT encoder)
install(EXPORT render2mpeg_encoder FILE render2mpeg_encoderTargets.cmake NAMESPACE render2mpeg:: DESTINATION ${package_dir}
        COMPONENT encoder)

# Headers keep the names that they include each other by.
file(GLOB encoder_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/encoder/*.h)
file(GLOB core_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/core/*.h)
install(FILES ${encoder_headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/render2mpeg/encoder COMPONENT encoder)
install(FILES ${core_headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/render2mpeg/core COMPONENT encoder)
install(FILES ${PROJECT_SOURCE_DIR}/src/parallel/loops.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/render2mpeg/parallel COMPONENT encoder)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/render2mpeg_encoderConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/render2mpeg_encoderConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/render2mpeg_encoderConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/render2mpeg_encoderConfig.cmake ${PROJECT_BINARY_DIR}/render2mpeg_encoderConfigVersion.cmake
        DESTINATION ${package_dir} COMPONENT encoder)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/encoder/example DESTINATION ${CMAKE_INSTALL_DATADIR}/render2mpeg/encoder COMPONENT encoder)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/docs/encoder-library.md DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT encoder)
