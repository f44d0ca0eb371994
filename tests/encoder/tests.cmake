find_package(PkgConfig REQUIRED)
pkg_check_modules(encoder_test_libavcodec REQUIRED IMPORTED_TARGET libavcodec libavutil)
pkg_check_modules(encoder_test_libmpeg2 REQUIRED IMPORTED_TARGET libmpeg2)
render2mpeg_test(encoder LIBS render2mpeg_encoder render2mpeg_parallel PkgConfig::encoder_test_libavcodec
                              PkgConfig::encoder_test_libmpeg2)
