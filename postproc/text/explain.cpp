#include "postproc/text/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <sstream>

#include "gcode/state/reason.h"
#include "postproc/text/words.h"

namespace batten::postproc {
namespace {

// Columns of the text, a little less than a terminal of 80.
constexpr std::size_t kColumns = 78;

// Broken between words, every line with the same indent.
std::string wrapped(std::string_view text, std::size_t indent) {
  std::string lines;
  std::string line;
  const auto flush = [&] {
    if (!line.empty()) lines += std::string(indent, ' ') + line + "\n";
    line.clear();
  };
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (indent + line.size() + 1 + word.size() > kColumns) flush();
    if (!line.empty()) line += ' ';
    line += word;
  }
  flush();
  return lines;
}

// Up to the end of the first sentence. A stop within brackets or an abbreviation ends none.
std::string_view first_sentence(std::string_view text) {
  int brackets = 0;
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    if (text[i] == '(') ++brackets;
    if (text[i] == ')') --brackets;
    if (brackets == 0 && text[i] == '.' && text[i + 1] == ' ') return text.substr(0, i + 1);
  }
  return text;
}

struct Explained {
  std::string_view group;  // its title
  std::string id;
  std::string what;  // it is
  std::string text;
  std::string advice;
  bool can_be_allowed = false;
};

constexpr std::string_view kMessages = "\nMessages about a program:";

// Markdown without its marks; a bracket that only names another page goes.
std::string plain(const std::string& cell) {
  static const std::regex page(R"( \(\[[^\]]*\]\([^)]*\)\))");
  std::string text = std::regex_replace(cell, page, "");
  std::erase(text, '`');
  return std::string(trimmed(text));
}

// The rows of the page that tell of messages (id, severity, what it means, what to do) and of
// violations (id, what it is, what to do); a row may have several ids.
void add_rows_of_page(std::vector<Explained>& all) {
  bool violations = false;
  std::istringstream page{std::string(diagnostics_page())};
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) violations = line.starts_with("## Violations");
    if (!line.starts_with("| `")) continue;
    std::vector<std::string> cells;
    std::istringstream row(line.substr(1));
    for (std::string cell; std::getline(row, cell, '|');) cells.push_back(plain(cell));
    if (cells.size() != (violations ? 3 : 4)) continue;
    std::istringstream ids(cells.front());
    for (std::string id; ids >> id;) {
      std::erase(id, ',');
      const Explained violation = {"\nViolations found by batten verify:", id,
                                   "a violation found by batten verify", cells[1], cells[2]};
      const Explained message = {kMessages, id,
                                 fmt::format("a message about a program ({})", cells[1]), cells[2],
                                 cells.back()};
      all.push_back(violations ? violation : message);
    }
  }
}

// Group after group.
const std::vector<Explained>& all_explained() {
  static const std::vector<Explained> made = [] {
    std::vector<Explained> all;
    for (const auto& each : gcode::reason::explanations()) {
      all.push_back({"Why blocks are kept as they are:", std::string(each.id),
                     "why blocks are kept as they are", std::string(each.text),
                     std::string(each.advice), each.can_be_allowed});
    }
    add_rows_of_page(all);
    return all;
  }();
  return made;
}

}  // namespace

std::vector<std::string_view> explained_ids() {
  std::vector<std::string_view> ids;
  for (const Explained& each : all_explained()) ids.push_back(each.id);
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

std::string explanation_of(std::string_view id) {
  std::string text;
  for (const Explained& each : all_explained()) {
    if (each.id != id) continue;
    text += fmt::format("{}{}: {}\n{}  What to do:\n{}", text.empty() ? "" : "\n", id, each.what,
                        wrapped(each.text, 2), wrapped(each.advice, 4));
    if (each.can_be_allowed) {
      text += fmt::format("    batten smooth .. --allow {} lifts this rule.\n", id);
    }
  }
  return text;
}

std::string_view advice_on(std::string_view id) {
  for (const Explained& each : all_explained()) {
    if (each.id == id && each.group == kMessages) return each.advice;
  }
  return {};
}

std::string all_explanations() {
  std::string text;
  std::string_view group;
  for (const Explained& each : all_explained()) {
    if (each.group != group) text += fmt::format("{}\n", each.group);
    group = each.group;
    text += fmt::format("  {:<24} {}\n", each.id, first_sentence(each.text));
  }
  return text;
}

}  // namespace batten::postproc
