render2mpeg_test(farm STARTS_PROGRAMS OPENS_MODULES LIBS render2mpeg_app nlohmann_json::nlohmann_json)
if(TARGET test_farm)
  add_dependencies(test_farm render2mpeg)
endif()
