# Who may include whom: geometry <- gcode <- postproc, never back; CGAL and CLI11 each in the
# few files that need it, so that nothing else pays for them or comes to depend on them.
#
#   cmake -D ROOT=<the project> -P tests/include_rule/check.cmake
#
# Ends with an error that lists every include that breaks the rule.
cmake_minimum_required(VERSION 3.25)

set(may_include_geometry "geometry")
set(may_include_gcode "geometry|gcode")
set(may_include_postproc "geometry|gcode|postproc")
set(where_cgal "^geometry/(path_distance|tolerance_band)[^/]*\\.cpp$")
set(where_cli11 "^postproc/cli/cli[^/]*\\.cpp$")

# Sets `complaint` when `file` (from the root) may not include `header`, given with its quotes
# or angle brackets.
function(judge file header)
  set(complaint "" PARENT_SCOPE)
  string(REGEX MATCH "^[^/]+" folder ${file})
  if(header MATCHES "^\"" AND NOT header MATCHES "^\"(${may_include_${folder}})/")
    string(REPLACE "|" ", " allowed ${may_include_${folder}})
    set(complaint "${folder} may include, from the root, only: ${allowed}" PARENT_SCOPE)
  elseif(header MATCHES "^<(geometry|gcode|postproc)/")
    set(complaint "our own headers stand in quotes" PARENT_SCOPE)
  elseif(header MATCHES "^[<\"]CGAL/" AND NOT file MATCHES "${where_cgal}")
    set(complaint "CGAL belongs in geometry/distance/path_distance*.cpp and tolerance_band*.cpp" PARENT_SCOPE)
  elseif(header MATCHES "^[<\"]CLI/" AND NOT file MATCHES "${where_cli11}")
    set(complaint "CLI11 belongs in postproc/cli/cli*.cpp" PARENT_SCOPE)
  endif()
endfunction()

set(files_read 0)
set(breaches "")
foreach(folder geometry gcode postproc)
  file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/${folder}/*.h ${ROOT}/${folder}/*.cpp)
  foreach(file IN LISTS files)
    math(EXPR files_read "${files_read} + 1")
    file(STRINGS ${ROOT}/${file} lines REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
    foreach(line IN LISTS lines)
      string(REGEX MATCH "[<\"][^>\"]+[>\"]" header ${line})
      judge(${file} ${header})
      if(complaint)
        string(APPEND breaches "\n  ${file}: ${header}: ${complaint}")
      endif()
    endforeach()
  endforeach()
endforeach()

if(files_read EQUAL 0)
  message(FATAL_ERROR "include rule: no sources below '${ROOT}'")
endif()
if(breaches)
  message(FATAL_ERROR "include rule broken:${breaches}")
endif()
message(STATUS "include rule kept by ${files_read} files")
