render2mpeg_test(image LIBS render2mpeg_image)
