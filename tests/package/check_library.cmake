# Does a program that uses the installed library build and work? Installs this build into a folder of
# its own, builds api/example against it, and smooths a sample.
#
#   cmake -D BUILD=<build folder> -D ROOT=<the project> -D SCRATCH=<folder> -D COMPILER=<c++>
#         -P tests/package/check_library.cmake
cmake_minimum_required(VERSION 3.25)

function(must_run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(NOT result EQUAL 0)
    string(JOIN " " command ${ARGN})
    message(FATAL_ERROR "${command}\nended with ${result}:\n${said}")
  endif()
  set(said "${said}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${SCRATCH})
must_run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${SCRATCH}/installed)

# What a user is promised to find there.
foreach(file bin/batten include/batten/batten.h share/doc/batten/copyright)
  if(NOT EXISTS ${SCRATCH}/installed/${file})
    message(FATAL_ERROR "not installed: ${file}")
  endif()
endforeach()
foreach(pattern share/man/man1/batten.1* share/bash-completion/completions/batten
        share/zsh/vendor-completions/_batten lib*/libbatten.a lib/*/libbatten.a)
  file(GLOB found ${SCRATCH}/installed/${pattern})
  list(APPEND all_found ${found})
endforeach()
list(LENGTH all_found count)
if(NOT count EQUAL 4)
  message(FATAL_ERROR "expected manual page, two completions and the library, found: ${all_found}")
endif()

must_run(${CMAKE_COMMAND} -S ${ROOT}/api/example -B ${SCRATCH}/example
         -D CMAKE_PREFIX_PATH=${SCRATCH}/installed -D CMAKE_CXX_COMPILER=${COMPILER})
must_run(${CMAKE_COMMAND} --build ${SCRATCH}/example)

execute_process(
  COMMAND ${SCRATCH}/example/smooth_file ${ROOT}/samples/noisy_line_arc/program.ngc 0.05
  RESULT_VARIABLE result OUTPUT_FILE ${SCRATCH}/smooth.ngc ERROR_VARIABLE said)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "the example ends with ${result}:\n${said}")
endif()
# Curve words are read where the target has them: there is no proof without. (G64 P is a word of
# LinuxCNC.)
file(READ ${ROOT}/samples/noisy_line_arc/program.ngc program)
string(REGEX REPLACE "G64 P[^\n]*" "" program "${program}")
file(WRITE ${SCRATCH}/program.mpf "${program}")
execute_process(
  COMMAND ${SCRATCH}/example/smooth_file ${SCRATCH}/program.mpf 0.05 siemens curves
  RESULT_VARIABLE result OUTPUT_VARIABLE poly ERROR_VARIABLE error)
if(NOT result EQUAL 0 OR NOT poly MATCHES "POLY PO")
  message(FATAL_ERROR "the example for siemens ends with ${result}:\n${error}${poly}")
endif()
execute_process(
  COMMAND ${SCRATCH}/installed/bin/batten time ${SCRATCH}/smooth.ngc --machine linuxcnc --json -
  OUTPUT_VARIABLE times COMMAND_ERROR_IS_FATAL ANY)
string(JSON seconds GET "${times}" time_s)
string(SUBSTRING "${seconds}" 0 5 seconds)
if(NOT said MATCHES "the whole program: ${seconds}[0-9]* s")
  message(FATAL_ERROR "the library does not say ${seconds} s:\n${said}")
endif()
# The program of the command line says of it what the library said.
must_run(${SCRATCH}/installed/bin/batten verify ${ROOT}/samples/noisy_line_arc/program.ngc
         ${SCRATCH}/smooth.ngc --tolerance 0.05)
must_run(${SCRATCH}/installed/bin/batten smooth ${ROOT}/samples/noisy_line_arc/program.ngc
         --target linuxcnc --tolerance 0.05 -o ${SCRATCH}/same.ngc --progress off)
file(SHA256 ${SCRATCH}/smooth.ngc of_library)
file(SHA256 ${SCRATCH}/same.ngc of_program)
if(NOT of_library STREQUAL of_program)
  message(FATAL_ERROR "the library and the program write different bytes")
endif()
file(REMOVE_RECURSE ${SCRATCH})
