#include "gcode/siemens/variables.h"

#include "gcode/siemens/value.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

// The place behind a string, brackets or a value that starts here; the next character otherwise.
std::size_t after_part(std::string_view text, std::size_t at) {
  if (text[at] == '"') {
    const std::size_t end = text.find('"', at + 1);
    return end == std::string_view::npos ? text.size() : end + 1;
  }
  if (text[at] == '[' || text[at] == '(') {
    return after_siemens_brackets(text, at).value_or(text.size());
  }
  return at + 1;
}

}  // namespace

// The name is the last one before a comma, an = or the end: words of the type stand before it.
void add_declared_names(std::string_view declaration, SiemensVariables& variables) {
  std::string name;
  bool in_value = false;
  const auto end_of_name = [&] {
    if (!name.empty()) variables.insert(name);
    name.clear();
  };
  for (std::size_t at = 0; at < declaration.size();) {
    const char c = declaration[at];
    if (c == ';') break;
    if (c == ',') {
      if (!in_value) end_of_name();
      in_value = false;
    } else if (c == '=') {
      end_of_name();
      in_value = true;
    } else if (!in_value && (is_letter(c) || c == '_')) {
      const std::size_t end = after_siemens_name(declaration, at);
      name.clear();
      for (std::size_t i = at; i < end; ++i) name.push_back(upper(declaration[i]));
      at = end;
      continue;
    }
    at = after_part(declaration, at);
  }
  if (!in_value) end_of_name();
}

}  // namespace batten::gcode
