# Makes the Debian package, unpacks it, and looks at it as a user would.
cmake_minimum_required(VERSION 3.25)

if(NOT DPKG_DEB OR NOT SHLIBDEPS)
  message("skipped: dpkg-deb and dpkg-shlibdeps (package dpkg-dev) are not both installed")
  return()
endif()
set(work ${BUILD}/package_test)
set(root ${work}/root)
file(REMOVE_RECURSE ${work})
file(MAKE_DIRECTORY ${work})

function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${work} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN}: ${status}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

run(${CPACK} -G DEB --config ${BUILD}/CPackConfig.cmake -B ${work})
file(GLOB package ${work}/render2mpeg_*.deb)
run(${DPKG_DEB} --extract ${package} ${root})
run(${DPKG_DEB} --field ${package} Depends)
foreach(library IN ITEMS libc6 libstdc\\+\\+6 libembree libtbb libassimp libdraco libmeshoptimizer libfmt libopenimageio libopenexr libavcodec libavformat)
  if(NOT output MATCHES "${library}")
    message(FATAL_ERROR "the package does not depend on ${library}: ${output}")
  endif()
endforeach()
if(output MATCHES "-dev")
  message(FATAL_ERROR "the package depends on what only building needs: ${output}")
endif()

foreach(path IN ITEMS bin/render2mpeg lib/render2mpeg/render2mpeg_av_module.so lib/render2mpeg/render2mpeg_image_module.so
                      lib/render2mpeg/render2mpeg_exr_module.so lib/render2mpeg/render2mpeg_draco_module.so lib/render2mpeg/blender/export_film.py lib/render2mpeg/extension/index.json
                      share/man/man1/render2mpeg.1 share/man/man1/render2mpeg-render.1 share/man/man1/render2mpeg-encode.1
                      share/bash-completion/completions/render2mpeg share/zsh/vendor-completions/_render2mpeg
                      share/fish/vendor_completions.d/render2mpeg.fish share/doc/render2mpeg/copyright
                      share/doc/render2mpeg/README.md share/render2mpeg/animations/cornell)
  if(NOT EXISTS ${root}/usr/${path})
    message(FATAL_ERROR "the package lacks /usr/${path}")
  endif()
endforeach()
if(EXISTS ${root}/usr/include)
  message(FATAL_ERROR "the package holds what the encoder's library is built with")
endif()

# Links and pictures of the documents lead to what is there.
file(GLOB_RECURSE documents ${root}/usr/share/doc/*.md)
set(count 0)
foreach(document IN LISTS documents)
  get_filename_component(here ${document} DIRECTORY)
  file(READ ${document} text)
  string(REPLACE "](" "@LINK@(" text "${text}")  # CMake's lists count brackets
  string(REGEX MATCHALL "@LINK@\\([^)# :]+" links "${text}")
  foreach(link IN LISTS links)
    string(REPLACE "@LINK@(" "" target "${link}")
    math(EXPR count "${count} + 1")
    if(NOT EXISTS ${here}/${target})
      message(FATAL_ERROR "${document} leads to ${target}, which is not there")
    endif()
  endforeach()
endforeach()
if(count LESS 50)
  message(FATAL_ERROR "only ${count} links in the documents")
endif()

set(ENV{RENDER2MPEG_MODULES})
run(${root}/usr/bin/render2mpeg render ${root}/usr/share/render2mpeg/animations/still_room --size 64x48 --frames 0:1 --vpls 64 --samples 1
    --quiet -o film.mpg)
run(${root}/usr/bin/render2mpeg info film.mpg)
file(REMOVE_RECURSE ${work})
