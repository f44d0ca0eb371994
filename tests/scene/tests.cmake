render2mpeg_test(scene LIBS render2mpeg_scene)
