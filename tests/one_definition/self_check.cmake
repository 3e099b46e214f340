# Does the check see a second definition?
#
#   cmake -D SCRATCH=<folder to use> -P tests/one_definition/self_check.cmake
cmake_minimum_required(VERSION 3.25)

# `other`: what geometry/b.h says besides a.h's `struct Fit {};`
function(plant other expected)
  file(REMOVE_RECURSE ${SCRATCH})
  file(WRITE ${SCRATCH}/geometry/a.h "namespace batten::geometry {\nstruct Fit {};\n}\n")
  file(WRITE ${SCRATCH}/geometry/b.h "${other}")
  execute_process(
    COMMAND ${CMAKE_COMMAND} -D ROOT=${SCRATCH} -P ${CMAKE_CURRENT_LIST_DIR}/check.cmake
    RESULT_VARIABLE result OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(expected STREQUAL "FOUND" AND (result EQUAL 0 OR NOT said MATCHES "Fit: geometry/a.h and"))
    message(SEND_ERROR "not found: ${other}")
  elseif(expected STREQUAL "KEPT" AND NOT result EQUAL 0)
    message(SEND_ERROR "found where there is none: ${other}: ${said}")
  endif()
endfunction()

plant("namespace batten::geometry {\nstruct Fit {\n  int n;\n};\n}\n" FOUND)
plant("namespace batten::geometry {\nclass Fit : public Base {\n};\n}\n" FOUND)
plant("namespace batten::geometry {\nstruct Fit;\n}\n" KEPT)
plant("namespace batten::geometry {\nstruct Fitting {};\n}\n" KEPT)
plant("namespace batten::geometry::inner {\nstruct Fit {};\n}\n" KEPT)
