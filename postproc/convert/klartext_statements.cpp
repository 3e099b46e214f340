#include "postproc/convert/klartext_statements.h"

#include <algorithm>
#include <cmath>

#include "gcode/klartext/statement.h"
#include "gcode/state/dwell.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::postproc {
namespace {

std::optional<double> plain_value(std::string_view digits) {
  const auto number = gcode::read_number(digits);
  return number ? std::optional(number->value) : std::nullopt;
}

// The words behind `CYCL DEF 9.0`; nothing where the statement is another.
std::optional<gcode::KlartextTokens> behind_cycle_part(std::string_view statement,
                                                       std::string_view part) {
  gcode::KlartextTokens tokens(statement);
  for (const std::string_view word : {std::string_view("CYCL"), std::string_view("DEF"), part}) {
    if (!gcode::is_same_word(tokens.next(), word)) return std::nullopt;
  }
  return tokens;
}

std::optional<std::int32_t> whole_ms(std::optional<double> seconds) {
  if (!seconds) return std::nullopt;
  constexpr double kMsPerSecond = 1000;
  constexpr double kRounding = 1e-6;
  const double ms = std::round(*seconds * kMsPerSecond);
  const bool fits = ms >= 1 && ms <= gcode::kLongestDwellMs;
  if (!fits || std::abs(*seconds * kMsPerSecond - ms) > kRounding) return std::nullopt;
  return static_cast<std::int32_t>(ms);
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

bool defines_stock(std::string_view statement) {
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

std::optional<std::int32_t> dwell_begun_in(const gcode::Program& program, std::uint32_t block) {
  if (block + 1 >= program.blocks.size()) return std::nullopt;
  const gcode::Block& first = program.blocks[block];
  const gcode::Block& second = program.blocks[block + 1];
  for (const gcode::Block* each : {&first, &second}) {
    if (each->opacity != gcode::ParseStatus::kForeign || each->block_delete) return std::nullopt;
  }
  if (!behind_cycle_part(statement_of(program, first), "9.0")) return std::nullopt;
  auto words = behind_cycle_part(statement_of(program, second), "9.1");
  if (!words) return std::nullopt;
  const std::string_view label = words->next();
  const std::string_view seconds = words->next();
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (std::ranges::any_of(label, is_digit) || !words->next().empty()) return std::nullopt;
  return whole_ms(plain_value(seconds));
}

std::string_view statement_of(const gcode::Program& program, const gcode::Block& block) {
  const std::string_view text = program.source.text();
  const gcode::KlartextParts parts = gcode::klartext_parts(text, block.span);
  return parts.continues ? std::string_view() : program.source.text(parts.content);
}

std::string datum_remark(int work_offset) {
  return "G" + std::to_string(work_offset) + ": its datum is active";
}

std::optional<int> datum_of_remark(std::string_view comment) {
  for (int offset = 54; offset <= 59; ++offset) {
    if (comment == datum_remark(offset)) return offset;
  }
  return std::nullopt;
}

}  // namespace batten::postproc
