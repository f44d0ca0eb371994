# Checks the SPDX document ${spdx}: its head, and that each package has a version and a relationship. Their number is in ${parts}.
file(STRINGS ${spdx} lines)
foreach(tag IN ITEMS "SPDXVersion: SPDX-2[.]3" "DataLicense: CC0-1[.]0" "SPDXID: SPDXRef-DOCUMENT" "DocumentName: [^;]+" "DocumentNamespace: https://[^;]+"
                     "Creator: [^;]+" "Created: [0-9-]+T[0-9:]+Z" "Relationship: SPDXRef-DOCUMENT DESCRIBES SPDXRef-render2mpeg"
                     "Relationship: SPDXRef-render2mpeg STATIC_LINK SPDXRef-libglm-dev")
  if(NOT ";${lines};" MATCHES ";${tag};")
    message(FATAL_ERROR "${spdx} lacks ${tag}")
  endif()
endforeach()
foreach(tag IN ITEMS PackageName PackageVersion PackageDownloadLocation FilesAnalyzed Relationship)
  file(STRINGS ${spdx} rows REGEX "^${tag}: [^ ]")
  list(LENGTH rows count_of_${tag})
  if(NOT count_of_${tag} EQUAL count_of_PackageName)
    message(FATAL_ERROR "${spdx} has ${count_of_${tag}} lines ${tag} for ${count_of_PackageName} packages")
  endif()
endforeach()
file(STRINGS ${spdx} ids REGEX "^SPDXID: SPDXRef-[A-Za-z0-9.-]+$")
list(REMOVE_DUPLICATES ids)
list(LENGTH ids count_of_ids)
math(EXPR parts "${count_of_ids} - 1")  # the document has one, too
if(NOT parts EQUAL count_of_PackageName)
  message(FATAL_ERROR "${spdx} has ${parts} identifiers for ${count_of_PackageName} packages")
endif()
