# Read by ctest, with `program`, `name`, `longest` and `environment` set: the tests of one program, as they are now.
# Each suite is one test, in one process: most of what small tests take is the start of a process and of the libraries it opens, and
# what a suite makes once serves all its tests. Suites whose name ends in Slow are labelled `slow`, and each of their tests is one.
# RENDER2MPEG_LEAVE_OUT: gtest's patterns of tests that are not run, with colons between them.
if(NOT EXISTS "${program}")
  add_test(${name}_NOT_BUILT ${name}_NOT_BUILT)
  return()
endif()
set(left_out "$ENV{RENDER2MPEG_LEAVE_OUT}")
execute_process(COMMAND "${program}" --gtest_list_tests "--gtest_filter=*-${left_out}" OUTPUT_VARIABLE listed RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${program} does not list its tests: ${failed}")
endif()

# A line is a suite with a point at its end, or a test indented, both with a comment where they have a parameter.
string(REPLACE ";" " " listed "${listed}")
string(REGEX REPLACE " +#[^\n]*" "" listed "${listed}")
string(REPLACE "\n" ";" listed "${listed}")
set(suite "")
foreach(line IN LISTS listed)
  if(line MATCHES "^[^ ].*[.]$")
    set(suite "${line}")
    if(NOT suite MATCHES "Slow[.]$")
      string(REGEX REPLACE "[.]$" "" shown "${name}.${suite}")
      add_test("${shown}" "${program}" "--gtest_filter=${suite}*-${left_out}")
      set_tests_properties("${shown}" PROPERTIES LABELS fast TIMEOUT ${longest} ENVIRONMENT "${environment}")
    endif()
  elseif(line MATCHES "^  [^ ]" AND suite MATCHES "Slow[.]$" AND NOT line MATCHES "DISABLED_")
    string(STRIP "${line}" line)
    add_test("${name}.${suite}${line}" "${program}" "--gtest_filter=${suite}${line}-${left_out}")
    set_tests_properties("${name}.${suite}${line}" PROPERTIES LABELS slow TIMEOUT 600 ENVIRONMENT "${environment}"
                         SKIP_REGULAR_EXPRESSION "\\[  SKIPPED \\]")
  endif()
endforeach()
