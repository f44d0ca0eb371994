# Installs the build to a folder, moves that folder, and uses the program there as a user would.
cmake_minimum_required(VERSION 3.25)

set(work ${BUILD}/install_test)
set(prefix ${work}/moved)
include(${CMAKE_CURRENT_LIST_DIR}/work.cmake)

function(expect_file path)
  if(NOT EXISTS ${path})
    message(FATAL_ERROR "${path} is missing")
  endif()
  file(SIZE ${path} bytes)
  if(bytes EQUAL 0)
    message(FATAL_ERROR "${path} is empty")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/first)
file(RENAME ${work}/first ${prefix})

# What a distribution expects is there, and no build folder shows through.
expect_file(${prefix}/${DOCDIR}/README.md)
expect_file(${prefix}/${DOCDIR}/LICENSE)
expect_file(${prefix}/${DOCDIR}/docs/model/README.md)
expect_file(${prefix}/${MANDIR}/man1/render2mpeg.1)
expect_file(${prefix}/${MANDIR}/man1/render2mpeg-render.1)
expect_file(${prefix}/${DATADIR}/zsh/vendor-completions/_render2mpeg)
expect_file(${prefix}/${DATADIR}/fish/vendor_completions.d/render2mpeg.fish)
expect_file(${prefix}/${DATADIR}/bash-completion/completions/render2mpeg)
file(GLOB modules ${prefix}/${LIBDIR}/render2mpeg/*.so)
list(LENGTH modules count)
if(count LESS 2)
  message(FATAL_ERROR "${count} modules installed in ${prefix}/${LIBDIR}/render2mpeg, of at least 2")
endif()
set(ENV{RENDER2MPEG_MODULES})
set(program ${prefix}/${BINDIR}/render2mpeg)
run(${program} --version)
if(NOT output MATCHES "render2mpeg [0-9]+[.][0-9]+")
  message(FATAL_ERROR "--version says: ${output}")
endif()

# A film needs FFmpeg's module, pictures need OpenImageIO's.
set(scene ${prefix}/${DATADIR}/render2mpeg/animations/still_room)
run(${program} render ${scene} --size 64x48 --frames 0:1 --vpls 64 --samples 1 --quiet -o film.mpg)
expect_file(${work}/film.mpg)
run(${program} render ${scene} --size 64x48 --frames 0:1 --vpls 64 --samples 1 --quiet -o frames.%04d.png)
expect_file(${work}/frames.0001.png)

file(REMOVE_RECURSE ${work})
