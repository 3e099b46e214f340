#include "gcode/siemens/block_names.h"

#include <cmath>

#include "gcode/siemens/block.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

std::string in_capitals(std::string_view text) {
  std::string capitals;
  for (const char c : text) capitals.push_back(upper(c));
  return capitals;
}

}  // namespace

std::string siemens_name(std::string_view source, const SiemensToken& token) {
  if (token.kind == SiemensTokenKind::kName) {
    std::string name = in_capitals(source.substr(token.name.begin, token.name.size()));
    return name == "CR" ? std::string() : name;
  }
  if (token.letter == 'D') return "D";
  if (token.kind != SiemensTokenKind::kWord || token.letter != 'G' ||
      is_common_siemens_g(token.number.value)) {
    return {};
  }
  const double code = token.number.value;
  constexpr double kGreatestCode = 999;
  const bool whole = code >= 0 && code <= kGreatestCode && code == std::floor(code);
  return whole ? "G" + std::to_string(static_cast<int>(code)) : "G?";
}

std::vector<SiemensName> siemens_names_in(std::string_view source, SourceSpan block) {
  std::vector<SiemensName> names;
  SiemensLexer lexer(source, block);
  for (;;) {
    const SiemensToken token = lexer.next();
    if (token.kind == SiemensTokenKind::kEnd || token.kind == SiemensTokenKind::kComment) break;
    std::string name = token.kind == SiemensTokenKind::kLabel
                           ? in_capitals(source.substr(token.span.begin, token.span.size()))
                           : siemens_name(source, token);
    if (!name.empty()) names.push_back({std::move(name), token.span});
  }
  return names;
}

}  // namespace batten::gcode
