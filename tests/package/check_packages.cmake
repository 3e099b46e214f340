# Are the Debian packages as Debian's policy wants them, as far as it can be asked in seconds?
#
#   cmake -D BUILD=<build folder> -D ROOT=<the project> -D SCRATCH=<folder> -P tests/package/check_packages.cmake
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${SCRATCH})
file(MAKE_DIRECTORY ${SCRATCH})
execute_process(COMMAND ${CMAKE_CPACK_COMMAND} -G DEB --config ${BUILD}/CPackConfig.cmake -B ${SCRATCH}
  RESULT_VARIABLE result OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "cpack ends with ${result}:\n${said}")
endif()

function(read_package name)
  file(GLOB package ${SCRATCH}/${name}_*.deb)
  if(NOT package)
    message(FATAL_ERROR "no package ${name}")
  endif()
  execute_process(COMMAND dpkg-deb --field ${package} OUTPUT_VARIABLE fields COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND dpkg-deb --contents ${package} OUTPUT_VARIABLE files COMMAND_ERROR_IS_FATAL ANY)
  set(fields "${fields}" PARENT_SCOPE)
  set(files "${files}" PARENT_SCOPE)
endfunction()

function(must_match text pattern what)
  if(NOT "${text}" MATCHES "${pattern}")
    message(FATAL_ERROR "${what}: expected '${pattern}' in\n${text}")
  endif()
endfunction()

function(must_not_match text pattern what)
  if("${text}" MATCHES "${pattern}")
    message(FATAL_ERROR "${what}: '${CMAKE_MATCH_0}' in\n${text}")
  endif()
endfunction()

foreach(name batten libbatten-dev)
  read_package(${name})
  must_match("${fields}" "Maintainer: [^\n]+ <[^\n]+@[^\n]+>" "${name}")
  must_match("${fields}" "Description: [^\n]+\n [^\n]+" "${name} needs a long description")
  must_match("${files}" "\\./usr/share/doc/${name}/copyright\n" "${name}")
  must_match("${files}" "\\./usr/share/doc/${name}/changelog\\.gz\n" "${name}")
  # Owned by root, writable for nobody else, nothing outside /usr.
  must_not_match("${files}" "\n[^ ]+ (root/[a-z]*[^o][a-z]+|[^r][a-z]+/)[^\n]*" "${name} owner")
  must_not_match("${files}" "\n[-d]....w[^\n]*|\n[-d].......w[^\n]*" "${name} rights")
  must_not_match("${files}" " \\./(usr/local|etc|home|tmp)[^\n]*" "${name} place")
endforeach()

read_package(batten)
must_match("${files}" "-rwxr-xr-x[^\n]* \\./usr/bin/batten\n" "batten")
must_match("${files}" "\\./usr/share/man/man1/batten\\.1\\.gz\n" "batten")
must_match("${fields}" "Depends: [^\n]*libc6[^\n]*" "batten")
must_match("${fields}" "Depends: [^\n]*libtbb12[^\n]*" "batten")
must_not_match("${fields}" "Depends: [^\n]*-dev[^\n]*" "batten")

# All that the README leads to, below its own folder.
file(READ ${ROOT}/README.md readme)
# A list is not split within brackets, so they go first.
string(REGEX MATCHALL "\\]\\([^)#]+" links "${readme}")
string(REPLACE "](" "" links "${links}")
foreach(link IN LISTS links)
  if(NOT link MATCHES "^https?:")
    string(REGEX REPLACE "/$" "" link "${link}")
    if(NOT EXISTS ${ROOT}/${link})
      message(FATAL_ERROR "README.md leads to ${link}, which is not there")
    endif()
    string(REPLACE "." "\\." pattern "${link}")
    must_match("${files}" " \\./usr/share/doc/batten/${pattern}/?\n" "batten, for a link of the README")
  endif()
endforeach()

read_package(libbatten-dev)
must_match("${files}" "\\./usr/include/batten/batten\\.h\n" "libbatten-dev")
must_match("${files}" "libbatten\\.a\n" "libbatten-dev")
must_match("${files}" "cmake/batten/batten-config\\.cmake\n" "libbatten-dev")
must_match("${fields}" "Depends: [^\n]*libfmt-dev[^\n]*" "libbatten-dev")
file(REMOVE_RECURSE ${SCRATCH})
