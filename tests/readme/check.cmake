# Is the README's example what the program really says? Runs the command that stands after `$ `
# and compares what it says with the lines below it.
#
#   cmake -D BATTEN=<binary> -D ROOT=<the project> -D SCRATCH=<folder> -P tests/readme/check.cmake
#
# With -D UPDATE=ON the README gets the new lines instead.
cmake_minimum_required(VERSION 3.25)

file(READ ${ROOT}/README.md readme)
if(NOT readme MATCHES "\n```\n([$] build/release/batten (smooth [^\n]*) -o ([^ \n]+))\n([^`]*)```\n")
  message(FATAL_ERROR "README.md has no example of the form: $ build/release/batten smooth .. -o FILE")
endif()
set(command_line "${CMAKE_MATCH_1}")
set(output ${CMAKE_MATCH_3})
set(shown "${CMAKE_MATCH_4}")
separate_arguments(words UNIX_COMMAND "${CMAKE_MATCH_2}")

file(MAKE_DIRECTORY ${SCRATCH})
execute_process(
  COMMAND ${BATTEN} ${words} -o ${SCRATCH}/example.ngc --force --progress off
  WORKING_DIRECTORY ${ROOT} RESULT_VARIABLE result OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "the README's example ends with ${result}:\n${said}")
endif()
string(REPLACE ${SCRATCH}/example.ngc ${output} said "${said}")

if(UPDATE)
  string(REPLACE "${command_line}\n${shown}" "${command_line}\n${said}" readme "${readme}")
  file(WRITE ${ROOT}/README.md "${readme}")
elseif(NOT said STREQUAL shown)
  message(FATAL_ERROR "the README shows\n${shown}\nbut the program says\n${said}\n"
                      "(tests/readme/check.cmake tells how to renew it)")
endif()
