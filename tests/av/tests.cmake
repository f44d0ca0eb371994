render2mpeg_test(av LIBS render2mpeg_av)
