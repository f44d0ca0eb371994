render2mpeg_test(core LIBS render2mpeg_core)
