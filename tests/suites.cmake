# Read by ctest, with `program`, `name`, `longest`, `without` and `environment` set: the tests of one program, as they are now.
# Each suite is one test, in one process: most of what small tests take is the start of a process and of the libraries it opens, and
# what a suite makes once serves all its tests. Tests whose name, or whose suite's, ends in Slow are one each, and labelled `slow`.
if(NOT EXISTS "${program}")
  add_test(${name}_NOT_BUILT ${name}_NOT_BUILT)
  return()
endif()
execute_process(COMMAND "${program}" --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${program} does not list its tests: ${failed}")
endif()

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
  elseif(NOT line MATCHES "^  [^ ]" OR test MATCHES "^DISABLED_")
    continue()
  elseif("${suite}${test}" MATCHES "Slow([./]|$)")
    add_test("${name}.${suite}${test}" "${program}" "--gtest_filter=${suite}${test}")
    set_tests_properties("${name}.${suite}${test}" PROPERTIES LABELS slow TIMEOUT 600 ENVIRONMENT "${environment}"
                         SKIP_REGULAR_EXPRESSION "\\[  SKIPPED \\]")
  elseif(NOT suite STREQUAL added)
    set(added "${suite}")
    string(REGEX REPLACE "[.]$" "" shown "${name}.${suite}")
    add_test("${shown}" "${program}" "--gtest_filter=${suite}*-*Slow:*Slow/*:${without}")
    set_tests_properties("${shown}" PROPERTIES LABELS fast TIMEOUT ${longest} ENVIRONMENT "${environment}")
  endif()
endforeach()
