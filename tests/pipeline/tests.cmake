render2mpeg_test(pipeline SANITIZED_BY_ALL BLENDER "[.](Films/)?Blend(er)?[A-Z][A-Za-z]*Slow|CyclesFramesSlow|BesideCycles.*Slow|LiveWindow|BlendOfANewerBlender" STARTS_PROGRAMS OPENS_MODULES LIBS render2mpeg_app render2mpeg_test_stages nlohmann_json::nlohmann_json)
if(TARGET test_pipeline)
  add_dependencies(test_pipeline render2mpeg shell_pages)
endif()
