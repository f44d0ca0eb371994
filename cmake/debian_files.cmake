# What Debian wants of a package's files before they are packed: compressed manual pages, and a changelog in its form.
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
