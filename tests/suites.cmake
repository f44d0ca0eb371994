# Read by ctest, with `program`, `name`, `launcher`, `costs`, `cpu`, `spare`, `by_all`, `blender` (and where that is set
# `socket` and `served`) and `environment` set: the tests of one program, as they
# are now. Each suite is one test, in one process: most of what small tests take is the start of a process and of the libraries it opens, and
# what a suite makes once serves all its tests. Tests whose name, or whose suite's, ends in Slow are one each, and labelled `slow`; a suite
# whose name ends in TogetherSlow is one again, for the sake of what it makes once.
# Where RENDER2MPEG_TEST_DRAW is set (scripts/test sets it to the commit), slow tests run in an order drawn by it, and those that begin after
# RENDER2MPEG_TEST_BUDGET CPU seconds are left out; `costs` lists them and they do not match `kept`.
# Programs that this run does not build may be old.
if(by_all AND DEFINED ENV{RENDER2MPEG_TEST_WITHOUT_BY_ALL})
  return()
endif()
if(NOT EXISTS "${program}")
  add_test(${name}_NOT_BUILT ${name}_NOT_BUILT)
  return()
endif()
execute_process(COMMAND "${program}" --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${program} does not list its tests: ${failed}")
endif()

# What every change can break, and no other test finds: bytes that depend on threads, what is lost by a kill, buffers that overflow.
set(kept "Thread|SameBytes|HasTheBytes|TheSame|OneRun|Kill|Resum|Signal|Stop|Interrupt|LitFrames|KeepsThose|WorkFolder|Buffer|DvdStreams")

# CPU seconds of each test at the last release: the longest begin first, so that none is left alone at the end.
if(EXISTS "${costs}")
  file(STRINGS "${costs}" rows REGEX "^${name}[.]")
  foreach(row IN LISTS rows)
    if(row MATCHES "^([^,]+),([0-9.]+)")
      set("cost_of_${CMAKE_MATCH_1}" "${CMAKE_MATCH_2}")
    endif()
  endforeach()
endif()

# One test: what it is called, its label, its tests by gtest's filter. It may take `cpu` seconds of a processor, whatever the machine's
# other work; the clock ends only what waits for ever.
macro(add_suite shown label filter)
  set(drawn "")
  if(DEFINED ENV{RENDER2MPEG_TEST_DRAW} AND "${label}" STREQUAL slow AND DEFINED "cost_of_${shown}" AND NOT "${shown}" MATCHES "${kept}")
    set(drawn --drawn)
  endif()
  add_test("${shown}" "${launcher}" ${drawn} "${shown}" "${cpu}" "${program}" "--gtest_filter=${filter}")
  set(labels ${label})
  if(spare AND "${shown}" MATCHES "${spare}")
    list(APPEND labels spare)
  endif()
  set_tests_properties("${shown}" PROPERTIES LABELS "${labels}" TIMEOUT 1500 ENVIRONMENT "${environment}")
  if(blender AND "${shown}" MATCHES "${blender}")
    # They wait for one Blender, so that one at a time is enough.
    set_tests_properties("${shown}" PROPERTIES FIXTURES_REQUIRED blender RESOURCE_LOCK blender ENVIRONMENT
                         "${environment};RENDER2MPEG_TEST_BLENDER=${socket};RENDER2MPEG_BLENDER=${served}")
  endif()
  if(drawn)
    string(SHA1 lot "$ENV{RENDER2MPEG_TEST_DRAW}${shown}")
    string(SUBSTRING "${lot}" 0 6 lot)
    math(EXPR lot "0x${lot}")
    set_tests_properties("${shown}" PROPERTIES COST "0.${lot}" SKIP_RETURN_CODE 77)
  else()
    # Before all that are drawn, and in their own order; new ones may be long.
    if(NOT DEFINED "cost_of_${shown}" AND "${label}" STREQUAL slow)
      set("cost_of_${shown}" 90)
    endif()
    set_tests_properties("${shown}" PROPERTIES COST "1${cost_of_${shown}}")
  endif()
  # One test alone: in a suite another's skip would hide failures.
  if("${label}" STREQUAL slow AND NOT "${filter}" MATCHES "[*]$")
    set_tests_properties("${shown}" PROPERTIES SKIP_REGULAR_EXPRESSION "\\[  SKIPPED \\]")
  endif()
endmacro()

# A line is a suite with a point at its end, or a test indented, both with a comment where they have a parameter.
string(REPLACE ";" " " listed "${listed}")
string(REGEX REPLACE " +#[^\n]*" "" listed "${listed}")
string(REPLACE "\n" ";" listed "${listed}")
set(suite "")
set(added "")  # the suite that was added last
foreach(line IN LISTS listed)
  string(STRIP "${line}" test)
  if(line MATCHES "^[^ ].*[.]$")
    set(suite "${line}")
    string(REGEX REPLACE "[.]$" "" whole "${name}.${suite}")
    continue()
  elseif(NOT line MATCHES "^  [^ ]" OR test MATCHES "^DISABLED_")
    continue()
  endif()
  if("${suite}" MATCHES "TogetherSlow[.]$")
    if(NOT suite STREQUAL added)
      set(added "${suite}")
      add_suite("${whole}" slow "${suite}*")
    endif()
  elseif("${suite}${test}" MATCHES "Slow([./]|$)")
    add_suite("${name}.${suite}${test}" slow "${suite}${test}")
  elseif(NOT suite STREQUAL added)
    set(added "${suite}")
    add_suite("${whole}" fast "${suite}*-*Slow:*Slow/*")
  endif()
endforeach()
