# The target `tidy` of Clang's builds: clang-tidy over the libraries and the program, on all
# processors, with nothing compiled. It is there where clang-tidy is.
find_program(BATTEN_RUN_CLANG_TIDY run-clang-tidy)
mark_as_advanced(BATTEN_RUN_CLANG_TIDY)
if(BATTEN_RUN_CLANG_TIDY AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  set(tidy_options -quiet -p ${PROJECT_BINARY_DIR})
  # Templates are read where they are used: most of the time went into those of the libraries that
  # nobody uses. All of ours are used.
  list(APPEND tidy_options -extra-arg=-fdelayed-template-parsing)
  # The analyser follows a function through twenty thousand states in place of 225,000: of all its time
  # most went into the last of them. The preset `tidy` lets it have all.
  list(APPEND tidy_options -extra-arg=-Xclang -extra-arg=-analyzer-config
                           -extra-arg=-Xclang -extra-arg=max-nodes=20000)
  # The analyser mistakes how CGAL's number type Mpzf gives back its memory; it is given another one.
  list(APPEND tidy_options -extra-arg=-DCGAL_DO_NOT_USE_MPZF)
  if(BATTEN_BUILD_AT_ONCE)
    list(APPEND tidy_options -checks=-bugprone-suspicious-include,-misc-unused-using-decls)
  endif()
  add_custom_target(tidy
    COMMAND ${BATTEN_RUN_CLANG_TIDY} ${tidy_options} "^(?!.*/page_files\\.cpp$)" # is not there yet
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    USES_TERMINAL
    VERBATIM)
endif()
