# What Debian wants of a package's files before they are packed: compressed manual pages, a changelog in its form, a list of what it holds. The
# commit's time is the time of all, so that the same commit gives the same bytes; $SOURCE_DATE_EPOCH is another.
if(NOT DEFINED ENV{SOURCE_DATE_EPOCH})
  execute_process(COMMAND git -C ${CMAKE_CURRENT_LIST_DIR} log -1 --format=%ct OUTPUT_VARIABLE time OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(time)
    set(ENV{SOURCE_DATE_EPOCH} ${time})
  else()
    string(TIMESTAMP time "%s" UTC)
    set(ENV{SOURCE_DATE_EPOCH} ${time})
  endif()
endif()
file(GLOB_RECURSE files ${CPACK_TEMPORARY_DIRECTORY}/*.1)
list(FILTER files INCLUDE REGEX "/man1/")
file(GLOB_RECURSE changes ${CPACK_TEMPORARY_DIRECTORY}/CHANGELOG.md)
get_filename_component(folder "${changes}" DIRECTORY)
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${folder}/changelog.Debian "render2mpeg (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) stable; urgency=medium

  * See CHANGELOG.md.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
execute_process(COMMAND gzip -9nf ${files} ${folder}/changelog.Debian COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_CURRENT_LIST_DIR}/spdx.sh ${CPACK_PACKAGE_VERSION} OUTPUT_FILE ${folder}/render2mpeg.spdx COMMAND_ERROR_IS_FATAL ANY)
