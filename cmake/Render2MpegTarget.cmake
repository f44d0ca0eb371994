# What every target of ours is compiled with.
#
# -ffp-contract=off: a fused multiply-add rounds once where two operations round twice, so that letting the compiler
# choose would make the film depend on the instruction set. -ffast-math is never used (docs/model/determinism.md).
# -fno-trapping-math: nobody asks for floating-point exceptions, so a conditional may be computed on both sides, and loops become vector
# code; no bit of any result changes.
add_library(render2mpeg_options INTERFACE)
target_compile_options(render2mpeg_options INTERFACE -ffp-contract=off -fno-math-errno -fno-trapping-math -Wall -Wextra -Wshadow -Wnon-virtual-dtor)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # g++ 12 warns of overlapping copies in "text" + std::string(...), which are none (GCC bug 105651, mended in 13).
  target_compile_options(render2mpeg_options INTERFACE -Wno-restrict)
endif()
if(RENDER2MPEG_UNITY GREATER 1)
  # Of sources compiled as one these warn of what lies in another one; the dev preset compiles each alone.
  target_compile_options(render2mpeg_options INTERFACE -Wno-shadow -Wno-subobject-linkage)
endif()
target_include_directories(render2mpeg_options INTERFACE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})
# LLVM's linker, where it is installed: it takes a tenth of the time of GNU's for what the sanitizers instrument. It is looked for each time,
# and the build depends on it: without it, or with another, a build folder configures anew.
include(CheckLinkerFlag)
unset(RENDER2MPEG_HAS_LLD CACHE)
check_linker_flag(CXX -fuse-ld=lld RENDER2MPEG_HAS_LLD)
if(RENDER2MPEG_HAS_LLD)
  target_link_options(render2mpeg_options INTERFACE -fuse-ld=lld)
  find_program(RENDER2MPEG_LLD ld.lld)
  mark_as_advanced(RENDER2MPEG_LLD)
  if(RENDER2MPEG_LLD)
    set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${RENDER2MPEG_LLD})
  endif()
endif()
if(RENDER2MPEG_WERROR)
  target_compile_options(render2mpeg_options INTERFACE -Werror)
endif()
if(RENDER2MPEG_SANITIZE)
  # What a sanitizer finds ends the program: a report that a test survives is a report nobody reads.
  set(instrumented -fsanitize=${RENDER2MPEG_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  if(RENDER2MPEG_SANITIZE MATCHES "address")
    # What the first three look for the address sanitizer meets too, when the memory is touched; they are a fifth of the build's time.
    # Alignment is a quarter of the rest: x86 reads numbers anywhere, and traps at vectors that it does not.
    list(APPEND instrumented -fno-sanitize=null,vptr,object-size,alignment)
  endif()
  if(RENDER2MPEG_SANITIZE MATCHES "address|thread")
    # More address space is reserved than there is memory, and what is not instrumented (below) must know it, too.
    target_compile_definitions(render2mpeg_options INTERFACE RENDER2MPEG_SANITIZED)
  endif()
  # Targets with the property RENDER2MPEG_NOT_INSTRUMENTED are only linked with the sanitizers.
  target_compile_options(
    render2mpeg_options INTERFACE "$<$<NOT:$<BOOL:$<TARGET_PROPERTY:RENDER2MPEG_NOT_INSTRUMENTED>>>:${instrumented}>")
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # The sanitizers' own code makes g++ doubt what std::regex has set (its manual says that this happens).
    target_compile_options(render2mpeg_options INTERFACE -Wno-maybe-uninitialized)
  endif()
  target_link_options(render2mpeg_options INTERFACE -fsanitize=${RENDER2MPEG_SANITIZE})
endif()

# What most sources read before their first line of ours: a third to two thirds of a build's time, unless it is compiled once
# (RENDER2MPEG_PRECOMPILE). The dev preset has each source read it by itself, and so finds what one forgot to include.
set(RENDER2MPEG_COMMON_HEADERS <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <limits> <map> <memory> <numeric>
    <optional> <set> <span> <string> <string_view> <utility> <vector> <glm/glm.hpp>)

# render2mpeg_unity(VARIABLE COUNT SOURCES...): what is compiled for these sources: COUNT of one folder at a time as one source that includes
# them, since reading headers and making the same templates takes most of a source's time. Sources with options of their own stay alone.
# Without unity (RENDER2MPEG_UNITY below 2) COUNT counts for nothing.
function(render2mpeg_unity variable count)
  set(compiled "")
  set(batch "")
  set(number 0)
  set(folder "")
  foreach(source IN LISTS ARGN)
    get_source_file_property(options ${source} COMPILE_OPTIONS)
    get_source_file_property(definitions ${source} COMPILE_DEFINITIONS)
    if(options OR definitions OR RENDER2MPEG_UNITY LESS 2)
      list(APPEND compiled ${source})
      set(joins FALSE)
    else()
      set(joins TRUE)
    endif()
    get_filename_component(here ${source} DIRECTORY)
    list(LENGTH batch members)
    if(batch AND joins AND (NOT here STREQUAL folder OR members GREATER_EQUAL count))
      render2mpeg_write_unity(file ${number} "${folder}" ${batch})
      list(APPEND compiled ${file})
      math(EXPR number "${number} + 1")
      set(batch "")
    endif()
    if(joins)
      set(folder ${here})
      list(APPEND batch ${source})
    endif()
  endforeach()
  if(batch)
    render2mpeg_write_unity(file ${number} "${folder}" ${batch})
    list(APPEND compiled ${file})
  endif()
  set(${variable} ${compiled} PARENT_SCOPE)
endfunction()

# Includes are written from an include root, so that a compiler cache knows them in any checkout.
function(render2mpeg_write_unity variable number folder)
  set(text "")
  foreach(source IN LISTS ARGN)
    file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR} ${source})
    string(APPEND text "#include \"${name}\"\n")
  endforeach()
  get_filename_component(room ${folder} NAME)
  set(file ${CMAKE_CURRENT_BINARY_DIR}/unity/${number}_${room}.cpp)
  file(CONFIGURE OUTPUT ${file} CONTENT "${text}" @ONLY)
  set(${variable} ${file} PARENT_SCOPE)
endfunction()

# render2mpeg_library(NAME [PUBLIC libs...] [PRIVATE libs...] [EXCEPT files...] [ROOMS rooms...] [HEADERS headers...] [HEADERS_OF name]
# [HOT patterns...] [COLD rooms...] [IS_COLD]): every *.cpp of the current folder and of its rooms (folders one below; not module/,
# which is opened on demand) as a static library render2mpeg_NAME with our options.
# ROOMS: only of these rooms. HEADERS: what many of its sources read beside the common headers. HEADERS_OF: the same as that library's.
# HOT: files, or patterns of them, with innermost loops: optimised in full in every build, and each compiled alone.
# COLD: rooms in which no frame spends its time: optimised little in a release, which takes a third of their compiling away; IS_COLD: all of it.
function(render2mpeg_library name)
  cmake_parse_arguments(ARG "IS_COLD" "HEADERS_OF" "PUBLIC;PRIVATE;EXCEPT;ROOMS;HEADERS;HOT;COLD" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp ${CMAKE_CURRENT_SOURCE_DIR}/*/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/module/[^/]*$")
  if(ARG_ROOMS)
    list(JOIN ARG_ROOMS "|" rooms)
    list(FILTER sources INCLUDE REGEX "/(${rooms})/[^/]*$")
  endif()
  foreach(file IN LISTS ARG_EXCEPT)
    list(REMOVE_ITEM sources ${CMAKE_CURRENT_SOURCE_DIR}/${file})
  endforeach()
  if(NOT sources)
    add_library(render2mpeg_${name} INTERFACE)
    target_link_libraries(render2mpeg_${name} INTERFACE $<BUILD_INTERFACE:render2mpeg_options> ${ARG_PUBLIC} ${ARG_PRIVATE})
    return()
  endif()
  foreach(pattern IN LISTS ARG_HOT)
    file(GLOB hot CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${pattern})
    if(NOT hot)
      message(FATAL_ERROR "${CMAKE_CURRENT_SOURCE_DIR} has no ${pattern}")
    endif()
    set_source_files_properties(${hot} PROPERTIES COMPILE_OPTIONS -O3)
    if(NOT CMAKE_BUILD_TYPE STREQUAL "Release")
      # g++ 12 crashes on headers that were compiled with less.
      set_source_files_properties(${hot} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
  render2mpeg_unity(sources ${RENDER2MPEG_UNITY} ${sources})
  foreach(room IN LISTS ARG_COLD)
    set(cold ${sources})
    list(FILTER cold INCLUDE REGEX "/unity/[0-9]+_${room}[.]cpp$|/${room}/[^/]*$")
    set_source_files_properties(${cold} PROPERTIES COMPILE_OPTIONS $<$<CONFIG:Release>:-O1> SKIP_PRECOMPILE_HEADERS ON)
  endforeach()
  add_library(render2mpeg_${name} STATIC ${sources})
  target_link_libraries(render2mpeg_${name} PUBLIC $<BUILD_INTERFACE:render2mpeg_options> ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  if(ARG_IS_COLD)
    target_compile_options(render2mpeg_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  if(RENDER2MPEG_PRECOMPILE STREQUAL "all")
    if(ARG_HEADERS_OF)
      target_precompile_headers(render2mpeg_${name} REUSE_FROM render2mpeg_${ARG_HEADERS_OF})
    elseif(ARG_HEADERS OR name STREQUAL "core")
      target_precompile_headers(render2mpeg_${name} PRIVATE ${RENDER2MPEG_COMMON_HEADERS} ${ARG_HEADERS})
    else()
      target_precompile_headers(render2mpeg_${name} REUSE_FROM render2mpeg_core)
    endif()
  endif()
endfunction()

# render2mpeg_module(NAME SOURCES... [PRIVATE libs...] [IS_COLD]): a shared object render2mpeg_NAME.so that is opened on demand, for
# outside libraries that are dear to start; its sources are compiled as one. It lies in <build>/modules and installs to <libdir>/render2mpeg.
function(render2mpeg_module name)
  cmake_parse_arguments(ARG "IS_COLD" "" "SOURCES;PRIVATE" ${ARGN})
  list(TRANSFORM ARG_SOURCES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE sources)
  if(RENDER2MPEG_UNITY GREATER 1)
    render2mpeg_write_unity(sources ${name} ${CMAKE_CURRENT_SOURCE_DIR}/module ${sources})
  endif()
  add_library(render2mpeg_${name} MODULE ${sources})
  if(ARG_IS_COLD)
    target_compile_options(render2mpeg_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  set_target_properties(render2mpeg_${name} PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/modules)
  target_link_libraries(render2mpeg_${name} PRIVATE render2mpeg_options ${ARG_PRIVATE})
  install(TARGETS render2mpeg_${name} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/render2mpeg)
  set_property(GLOBAL APPEND PROPERTY RENDER2MPEG_MODULES render2mpeg_${name})
endfunction()
