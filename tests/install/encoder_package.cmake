# Installs the encoder alone, builds the example against the installed package as a stranger would, and runs it.
cmake_minimum_required(VERSION 3.25)

set(work ${BUILD}/encoder_package_test)
include(${CMAKE_CURRENT_LIST_DIR}/work.cmake)

run(${CMAKE_COMMAND} --install ${BUILD} --component encoder --prefix ${work}/first)
file(RENAME ${work}/first ${work}/moved)

# The package tells of no folder of the build or the source, and of no library but TBB and GLM.
file(GLOB_RECURSE scripts ${work}/moved/*.cmake)
foreach(script IN LISTS scripts)
  file(READ ${script} text)
  foreach(trace IN ITEMS ${BUILD} ${SOURCE} embree OpenImageIO OpenEXR libav assimp fmt:: nlohmann)
    string(FIND "${text}" "${trace}" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${script} mentions ${trace}")
    endif()
  endforeach()
endforeach()

run(${CMAKE_COMMAND} -S ${work}/moved/${DATADIR}/render2mpeg/encoder/example -B ${work}/build -G ${GENERATOR} -D CMAKE_PREFIX_PATH=${work}/moved
    -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_BUILD_TYPE=Release -D "CMAKE_CXX_FLAGS=-Wall -Wextra -Wshadow -Werror")
run(${CMAKE_COMMAND} --build ${work}/build)

# It needs none of the program's libraries.
run(ldd ${work}/build/moving_pictures)
foreach(library IN ITEMS embree OpenImageIO OpenEXR avcodec avformat assimp)
  if(output MATCHES "${library}")
    message(FATAL_ERROR "the example drags in ${library}:\n${output}")
  endif()
endforeach()

# What it writes is a film: every picture decodes, here and with a second decoder.
run(${work}/build/moving_pictures film.m2v 40)
if(NOT output MATCHES "Main Profile at Main Level" OR NOT output MATCHES "40 pictures, ([0-9]+) bytes")
  message(FATAL_ERROR "the example says: ${output}")
endif()
if(CMAKE_MATCH_1 GREATER 600000)  # 15 kB a picture; exact motion takes less than half of it
  message(FATAL_ERROR "${CMAKE_MATCH_1} bytes for 40 pictures: the motion was of no use")
endif()
run(ffmpeg -v error -xerror -err_detect explode -i film.m2v -f framemd5 frames.md5)
file(STRINGS ${work}/frames.md5 frames REGEX "^[0-9]")
list(LENGTH frames count)
if(NOT count EQUAL 40 OR NOT output STREQUAL "")
  message(FATAL_ERROR "${count} of 40 pictures decode: ${output}")
endif()
run(mpeg2dec -o null film.m2v)

file(REMOVE_RECURSE ${work})
