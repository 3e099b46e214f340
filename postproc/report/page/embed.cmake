# Puts the files of the report's page into a .cpp, as text.
#
#   cmake -D PAGE=<this folder> -D OUTPUT=page_files.cpp -P embed.cmake

# In the order in which they build on each other.
set(SCRIPTS data.js format.js tool_path.js charts.js runs.js summary.js kinds.js page.js)

# A raw string that no file of the page can end by chance; refused if one does.
function(literal file result)
  file(READ "${PAGE}/${file}" text)
  string(FIND "${text}" ")batten_page\"" end)
  if(NOT end EQUAL -1)
    message(FATAL_ERROR "${file} holds the end mark of the literal that it is put into")
  endif()
  # Compilers need not take longer literals than 65535 characters.
  string(LENGTH "${text}" length)
  if(length GREATER 65000)
    message(FATAL_ERROR "${file} is ${length} bytes long, at most 65000: cut it into two files")
  endif()
  set(${result} "R\"batten_page(${text})batten_page\"" PARENT_SCOPE)
endfunction()

literal(page.html page)
literal(page.css style)
set(scripts "")
foreach(script IN LISTS SCRIPTS)
  literal(${script} text)
  string(APPEND scripts "  script += ${text};\n")
endforeach()

file(WRITE "${OUTPUT}" "// Made by postproc/report/page/embed.cmake.
#include \"postproc/report/page_files.h\"

namespace batten::postproc {

std::string_view page_template() { return ${page}; }

std::string_view page_style() { return ${style}; }

std::string page_script() {
  std::string script;
${scripts}  return script;
}

}  // namespace batten::postproc
")
