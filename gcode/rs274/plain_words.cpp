#include "gcode/rs274/plain_words.h"

#include <cstdint>

#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

const char* behind_blanks(const char* at, const char* end) {
  while (at != end && is_blank(*at)) ++at;
  return at;
}

// Behind the words of the line, and the blanks behind them; nullptr where one is of another kind.
// `at`, `end`: places in the text that begins at `text`.
const char* read_words(const char* text, const char* at, const char* end,
                       std::vector<Word>& words) {
  const auto place = [text](const char* where) { return static_cast<std::uint32_t>(where - text); };
  const char* behind_word = nullptr;
  at = behind_blanks(at, end);
  while (at != end && is_letter(*at)) {
    const char letter = upper(*at);
    // An E right behind a number may be an exponent, an O begins no word.
    if (letter == 'O' || (letter == 'E' && at == behind_word)) return nullptr;
    ReadNumber number;
    behind_word = read_plain_number(at + 1, end, number);
    if (behind_word == nullptr) return nullptr;
    Word& word = words.emplace_back();
    word.letter = letter;
    word.decimals = static_cast<std::uint8_t>(number.decimals);
    word.has_point = number.has_point;
    word.value = number.value;
    word.span = {place(at), place(behind_word)};
    at = behind_blanks(behind_word, end);
  }
  return at;
}

// Nothing for a CR that no LF follows: it ends a line too, but is looked for in another way.
std::optional<std::size_t> behind_line_end(std::string_view text, std::size_t at) {
  if (at == text.size()) return at;
  if (text[at] == '\n') return at + 1;
  if (text[at] == '\r' && at + 1 < text.size() && text[at + 1] == '\n') return at + 2;
  return std::nullopt;
}

}  // namespace

std::optional<LineBounds> read_plain_words(std::string_view text, std::size_t begin,
                                           std::vector<Word>& words) {
  const std::size_t words_before = words.size();
  const char* const end_of_text = text.data() + text.size();
  const char* const stop = read_words(text.data(), text.data() + begin, end_of_text, words);
  if (stop != nullptr) {
    const auto text_end = static_cast<std::size_t>(stop - text.data());
    if (const auto end = behind_line_end(text, text_end)) {
      return LineBounds{static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(text_end),
                        static_cast<std::uint32_t>(*end)};
    }
  }
  words.resize(words_before);
  return std::nullopt;
}

namespace {

std::string_view without_digits(std::string_view line) {
  while (!line.empty() && (is_digit(line.front()) || is_blank(line.front()))) line.remove_prefix(1);
  return line;
}

bool says_nothing(std::string_view line) {
  if (line.empty() || line.front() == '%' || line.front() == '(' || line.front() == ';') {
    return true;
  }
  const bool of_program = upper(line.front()) == 'O' && line.size() > 1 && is_digit(line[1]);
  if (!of_program) return false;
  const std::string_view rest = without_digits(line.substr(1));
  return rest.empty() || rest.front() == '(';
}

bool begins_with_g(std::string_view line) {
  if (upper(line.front()) == 'N') line = without_digits(line.substr(1));
  return line.size() > 1 && upper(line[0]) == 'G' && is_digit(line[1]);
}

}  // namespace

std::optional<SourceSpan> plain_beginning(const SourceText& source) {
  const std::string_view text = source.text();
  LineCursor lines(text);
  while (const auto line = lines.next()) {
    const SourceSpan span{begin_of_content(text, *line), line->text_end};
    const std::string_view said = source.text(span);
    if (says_nothing(said)) continue;
    return begins_with_g(said) ? std::optional(span) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace batten::gcode
