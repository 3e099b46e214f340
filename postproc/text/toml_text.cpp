#include "postproc/text/toml_text.h"

#include <toml++/toml.h>

#include <sstream>

namespace batten::postproc {

std::string toml_quoted(std::string_view text) {
  std::ostringstream stream;
  const toml::value<std::string> value{std::string(text)};
  stream << toml::toml_formatter(
      value, toml::toml_formatter::default_flags & ~toml::format_flags::allow_literal_strings);
  return stream.str();
}

}  // namespace batten::postproc
