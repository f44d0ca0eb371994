add_executable(bench_observer ${CMAKE_CURRENT_LIST_DIR}/observer.cpp)
target_link_libraries(bench_observer PRIVATE render2mpeg_app benchmark::benchmark)
