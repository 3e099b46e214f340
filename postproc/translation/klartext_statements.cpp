#include "postproc/translation/klartext_statements.h"

#include "gcode/klartext/statement.h"
#include "gcode/number_format.h"
#include "postproc/translation/translation.h"

namespace batten::postproc {
namespace {

std::optional<double> plain_value(std::string_view digits) {
  const auto number = gcode::read_number(digits);
  return number ? std::optional(number->value) : std::nullopt;
}

}  // namespace

std::optional<CalledTool> called_tool(std::string_view statement) {
  if (gcode::klartext_kind(statement) != gcode::KlartextKind::kToolCall) return std::nullopt;
  gcode::KlartextTokens tokens(statement);
  (void)tokens.next();  // TOOL
  (void)tokens.next();  // CALL
  CalledTool called;
  std::string_view token = tokens.next();
  if (const auto number = plain_value(token)) {
    called.number = number;
    token = tokens.next();
  }
  if (!gcode::is_same_word(token, "Z")) return std::nullopt;
  token = tokens.next();
  if (token.starts_with('S') || token.starts_with('s')) {
    called.speed = plain_value(token.substr(1));
    if (!called.speed) return std::nullopt;
    token = tokens.next();
  }
  const bool feed = token.starts_with('F') || token.starts_with('f');
  if (feed && plain_value(token.substr(1))) token = tokens.next();
  return token.empty() ? std::optional(called) : std::nullopt;
}

bool draws_blank(std::string_view statement) {
  gcode::KlartextTokens tokens(statement);
  const bool blank = gcode::is_same_word(tokens.next(), "BLK");
  return blank && gcode::is_same_word(tokens.next(), "FORM");
}

bool ends_tilting(std::string_view statement) {
  gcode::KlartextTokens tokens(statement);
  for (const std::string_view word : {"PLANE", "RESET", "STAY"}) {
    if (!gcode::is_same_word(tokens.next(), word)) return false;
  }
  return tokens.next().empty();
}

std::string_view statement_of(const gcode::Program& program, const gcode::Block& block) {
  const std::string_view text = program.source.text();
  const gcode::KlartextParts parts = gcode::klartext_parts(text, block.span);
  return parts.continues ? std::string_view() : program.source.text(parts.content);
}

std::optional<int> datum_of_remark(std::string_view comment) {
  for (int offset = 54; offset <= 59; ++offset) {
    if (comment == datum_remark(offset)) return offset;
  }
  return std::nullopt;
}

}  // namespace batten::postproc
