# Does the include rule see what it is there for? Plants one file after the other in a small
# tree of its own and asks check.cmake about it.
#
#   cmake -D SCRATCH=<folder to use> -P tests/include_rule/self_check.cmake
cmake_minimum_required(VERSION 3.25)

# `expected`: a part of the complaint, or KEPT.
function(plant file include expected)
  file(REMOVE_RECURSE ${SCRATCH})
  file(WRITE ${SCRATCH}/geometry/point.h "#pragma once\n#include <vector>\n")
  file(WRITE ${SCRATCH}/${file} "// planted\n#include ${include}\n")
  execute_process(
    COMMAND ${CMAKE_COMMAND} -D ROOT=${SCRATCH} -P ${CMAKE_CURRENT_LIST_DIR}/check.cmake
    RESULT_VARIABLE result OUTPUT_VARIABLE said ERROR_VARIABLE said)
  string(REGEX REPLACE "[ \n]+" " " said "${said}") # cmake wraps long messages
  if(expected STREQUAL "KEPT" AND NOT result EQUAL 0)
    message(SEND_ERROR "${file} may include ${include}, but: ${said}")
  elseif(NOT expected STREQUAL "KEPT" AND (result EQUAL 0 OR NOT said MATCHES "${expected}"))
    message(SEND_ERROR "${file} must not include ${include} (${expected}), but: ${said}")
  endif()
endfunction()

plant(geometry/fitting/fair/fair.cpp [["geometry/basic/point.h"]] KEPT)
plant(gcode/state/motion.h [["geometry/basic/point.h"]] KEPT)
plant(postproc/report/text.cpp [["gcode/state/motion.h"]] KEPT)
plant(geometry/distance/path_distance.cpp [[<CGAL/Lazy_exact_nt.h>]] KEPT)
plant(geometry/band/tolerance_band_outline.cpp [[<CGAL/Lazy_exact_nt.h>]] KEPT)
plant(postproc/cli/cli_smooth.cpp [[<CLI/CLI.hpp>]] KEPT)

plant(geometry/fitting/fair/fair.cpp [["gcode/state/motion.h"]] "geometry may include")
plant(geometry/fitting/fair/fair.cpp [["postproc/options/options.h"]] "geometry may include")
plant(gcode/reading/parser.cpp [["postproc/options/options.h"]] "gcode may include")
plant(gcode/dialects/grbl.cpp [["postproc/options/options.h"]] "gcode may include")
plant(gcode/dialects/grbl.cpp [["../dialect.h"]] "gcode may include")
plant(postproc/runs/section.h [["tests/support/paths.h"]] "postproc may include")
plant(gcode/reading/parser.cpp [[<postproc/options/options.h>]] "in quotes")
plant(geometry/fitting/fair/fair.cpp [[<CGAL/Lazy_exact_nt.h>]] "CGAL belongs")
plant(geometry/distance/path_distance.h [[<CGAL/Lazy_exact_nt.h>]] "CGAL belongs")
plant(postproc/proof/verification.cpp [[<CGAL/Lazy_exact_nt.h>]] "CGAL belongs")
plant(postproc/options/options.cpp [[<CLI/CLI.hpp>]] "CLI11 belongs")
plant(postproc/cli/cli.h [[<CLI/CLI.hpp>]] "CLI11 belongs")

file(REMOVE_RECURSE ${SCRATCH})
