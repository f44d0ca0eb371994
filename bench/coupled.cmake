find_package(fmt REQUIRED)

add_executable(bench_coupled ${CMAKE_CURRENT_LIST_DIR}/coupled.cpp ${CMAKE_CURRENT_LIST_DIR}/coupled_stage.cpp
               ${CMAKE_CURRENT_LIST_DIR}/coupled_films.cpp)
target_link_libraries(bench_coupled PRIVATE render2mpeg_app fmt::fmt)
