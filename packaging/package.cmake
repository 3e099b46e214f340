# Debian packages by CPack: `cpack --config build/release/CPackConfig.cmake -B build/release/packages`.
#
#   batten          the program, its manual page, completions and documents
#   libbatten-dev   the library, its header, and what find_package(batten) reads
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME batten)
set(CPACK_PACKAGE_VENDOR "Batten")
set(BATTEN_PACKAGE_CONTACT "Batten authors <batten@users.noreply.invalid>" CACHE STRING
    "Who a package says is to be asked")
set(CPACK_PACKAGE_CONTACT "${BATTEN_PACKAGE_CONTACT}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON) # what the binary needs is read from it
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME batten)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION
"smooth CNC programs made of short lines
 Batten takes a CNC program that a CAM system wrote as thousands of short G01
 lines, bends smooth curves through them within a tolerance, and writes the
 program again as arcs or lines that the control runs without braking at every
 vertex. It then reads its own output back and proves that the new path is
 nowhere further from the old one than allowed.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libbatten-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libfmt-dev, libtbb-dev, libtomlplusplus-dev, libgmp-dev, libmpfr-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
"smooth CNC programs made of short lines (library)
 The static library of Batten with its header and CMake files: read, smooth
 and verify CNC programs from other programs.")

# What Debian's policy asks of every package: copyright, and the changes compressed.
foreach(component_and_package "runtime;batten" "development;libbatten-dev")
  list(GET component_and_package 0 component)
  list(GET component_and_package 1 package)
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/debian/copyright
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
  find_program(BATTEN_GZIP gzip)
  mark_as_advanced(BATTEN_GZIP)
  if(BATTEN_GZIP)
    execute_process(COMMAND ${BATTEN_GZIP} -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md
      OUTPUT_FILE ${PROJECT_BINARY_DIR}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)
    install(FILES ${PROJECT_BINARY_DIR}/changelog.gz
            DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
  endif()
endforeach()

include(CPack)
