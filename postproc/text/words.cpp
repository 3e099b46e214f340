#include "postproc/text/words.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <numeric>
#include <sstream>
#include <vector>

namespace batten::postproc {

namespace {

// Slips of the finger: as many wrong letters as a third of the word, but at least one.
constexpr std::size_t kLettersPerSlip = 3;

// Levenshtein's distance, one row at a time.
std::size_t wrong_letters(std::string_view from, std::string_view to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i] == to[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string escaped(std::string_view text,
                    std::initializer_list<std::pair<char, std::string_view>> replacements) {
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    const auto found =
        std::ranges::find(replacements, c, &std::pair<char, std::string_view>::first);
    safe += found == replacements.end() ? std::string_view(&c, 1) : found->second;
  }
  return safe;
}

std::string_view trimmed(std::string_view text, std::string_view blanks) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

std::string toml_quoted(std::string_view text) {
  std::ostringstream stream;
  const toml::value<std::string> value{std::string(text)};
  stream << toml::toml_formatter(
      value, toml::toml_formatter::default_flags & ~toml::format_flags::allow_literal_strings);
  return stream.str();
}

std::string plural(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string command_line_of(std::span<const std::string> arguments) {
  constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_./:+,@%=-";
  std::string text = "batten";
  for (const std::string& word : arguments) {
    text += ' ';
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) {
      text += word;
      continue;
    }
    text += "'" + escaped(word, {{'\'', "'\\''"}}) + "'";
  }
  return text;
}

std::string titled(std::string_view title, std::string_view text) {
  return fmt::format("  {:<14}{}\n", title, text);
}

std::string_view nearest_name(std::string_view text, std::span<const std::string_view> names) {
  std::string_view nearest;
  std::size_t fewest = std::max<std::size_t>(1, text.size() / kLettersPerSlip) + 1;
  for (const std::string_view name : names) {
    const std::size_t wrong = wrong_letters(text, name);
    if (wrong < fewest) {
      fewest = wrong;
      nearest = name;
    }
  }
  return nearest;
}

std::string suggestion(std::string_view text, std::span<const std::string_view> names) {
  const std::string_view nearest = nearest_name(text, names);
  return nearest.empty() ? "" : fmt::format(", did you mean '{}'?", nearest);
}

}  // namespace batten::postproc
