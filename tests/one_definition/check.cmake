# No type name stands twice in the headers of one folder: all of a folder's types are in one
# namespace, where two classes of one name are an error that no compiler or linker reports, and that
# mixes up the functions of both.
#
#   cmake -D ROOT=<the project> -P tests/one_definition/check.cmake
#
# Ends with an error that lists every name with its headers.
cmake_minimum_required(VERSION 3.25)

set(types_read 0)
set(twice "")
foreach(folder geometry gcode postproc)
  file(GLOB_RECURSE headers RELATIVE ${ROOT} ${ROOT}/${folder}/*.h)
  foreach(header IN LISTS headers)
    # Top-level definitions start at the first column; declarations end right behind the name.
    file(STRINGS ${ROOT}/${header} lines
         REGEX "^(struct|class|enum class) [A-Z][A-Za-z0-9]*( final)?( :[^;]*)?( {.*)?$")
    # Sub-namespaces are spaces of their own.
    file(STRINGS ${ROOT}/${header} space REGEX "^namespace ")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^(struct|class|enum class) ([A-Za-z0-9]+).*" "\\2" name "${line}")
      math(EXPR types_read "${types_read} + 1")
      string(MAKE_C_IDENTIFIER "where_${space}_${name}" key)
      if(DEFINED ${key})
        string(APPEND twice "\n  ${name}: ${${key}} and ${header}")
      endif()
      set(${key} ${header})
    endforeach()
  endforeach()
endforeach()

if(types_read EQUAL 0)
  message(FATAL_ERROR "one definition: no types below '${ROOT}'")
endif()
if(twice)
  message(FATAL_ERROR "types with two definitions:${twice}")
endif()
message(STATUS "one definition of each of ${types_read} types")
