#include "gcode/controls/row_dialect.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace batten::gcode {

RowDialect::RowDialect(TargetRow row) : TableValues(row.table), row_(std::move(row)) {}

std::size_t RowDialect::line_length(std::string_view line) const {
  return counted_bytes(line, row_.line_count);
}

std::string_view RowDialect::arc_complaint(const geometry::Arc& printed, Units units) const {
  return row_.arc_rule(printed, units, table());
}

std::string_view RowDialect::other_meaning(int g_code) const {
  const auto found = std::ranges::find(row_.other_meanings, g_code, &OtherMeaning::g_code);
  return found == row_.other_meanings.end() ? std::string_view() : found->text;
}

std::string RowDialect::comment(std::string_view text) const {
  if (text.find_first_of(row_.not_in_comments) != std::string_view::npos) return {};
  return TableValues::comment(text);
}

bool RowDialect::cannot_say(char letter, int number) const {
  std::string_view rest = row_.refused;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    const std::string_view word = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (word.front() != letter) continue;
    if (word.size() == 1) return true;
    const auto refused = read_number(word.substr(1));
    if (refused && std::lround(refused->value * 10) == number) return true;
  }
  return false;
}

std::unique_ptr<const Dialect> RowDialect::with_values(const TargetTable& table) const {
  TargetRow row = row_;
  row.table = table;
  return std::make_unique<RowDialect>(std::move(row));
}

std::size_t counted_bytes(std::string_view line, LineCount count) {
  if (count == LineCount::kAll) return line.size();
  std::size_t kept = 0;
  bool in_parentheses = false;
  for (const char c : line) {
    if (in_parentheses) {
      in_parentheses = c != ')';
    } else if (c == ';') {
      break;
    } else if (c == '(') {
      in_parentheses = true;
    } else if (count == LineCount::kWithoutComments || static_cast<unsigned char>(c) > ' ') {
      ++kept;
    }
  }
  return kept;
}

}  // namespace batten::gcode
