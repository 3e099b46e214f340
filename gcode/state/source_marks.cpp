#include "gcode/state/source_marks.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "gcode/state/code_table.h"
#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

bool has(std::span<const Word> words, std::string_view letters) {
  return std::ranges::any_of(words, [letters](const Word& word) {
    return letters.find(word.letter) != std::string_view::npos;
  });
}

std::optional<SourceMark> mark_of_g(int code, std::span<const Word> words) {
  switch (code) {
    case 640:
      return has(words, "PQ") ? std::optional(SourceMark::kBlendTolerance) : std::nullopt;
    case 52:
    case 53:
      // G5.3 P is the smoothing of another control, G5.3 alone ends a spline.
      return code == 53 && has(words, "P") ? std::nullopt
                                           : std::optional(SourceMark::kUniformNurbs);
    case 51:
      return has(words, "Q") ? std::optional(SourceMark::kHighSpeedMode) : std::nullopt;
    case 50:
      return has(words, "P") && !has(words, "XYZIJ") ? std::optional(SourceMark::kHighSpeedMode)
                                                     : std::nullopt;
    case 1870:
      return SourceMark::kHaasSmoothness;
    case 1300:
    case 1310:
      return SourceMark::kSuperNurbs;
    default:
      return std::nullopt;
  }
}

// Mills have other uses for these codes, but without a temperature.
bool is_heater_word(int code, std::span<const Word> words) {
  constexpr std::array kCodes = {1040, 1090, 1400, 1900};
  return std::ranges::find(kCodes, code) != kCodes.end() && has(words, "S");
}

bool contains_one_of(std::string_view text, std::span<const std::string_view> parts) {
  return std::ranges::any_of(
      parts, [&](std::string_view part) { return text.find(part) != std::string_view::npos; });
}

std::optional<SourceMark> mark_of_text(ParseStatus opacity, std::string_view line) {
  const std::string text = in_capitals(without_blanks(line));
  constexpr std::array<std::string_view, 9> kSubWords = {
      "SUB", "CALL", "ENDSUB", "RETURN", "ENDIF", "ENDWHILE", "REPEAT", "BREAK", "DO"};
  constexpr std::array<std::string_view, 3> kMacroWords = {"GOTO", "WHILE[", "END"};
  if (text.starts_with('$')) return SourceMark::kDollarLine;
  if (text.starts_with('#') && text.size() > 1 && is_letter(text[1])) {
    return SourceMark::kHashCommand;
  }
  if (text.find("#<") != std::string::npos) return SourceMark::kNamedParameters;
  if (opacity != ParseStatus::kFlow) return std::nullopt;
  const std::size_t word = text.starts_with('N') ? text.find_first_not_of("0123456789", 1) : 0;
  const std::string_view rest =
      word == std::string::npos ? std::string_view() : std::string_view(text).substr(word);
  if (rest.starts_with('O')) {
    return contains_one_of(rest, kSubWords) ? std::optional(SourceMark::kSubWords) : std::nullopt;
  }
  return contains_one_of(rest, kMacroWords) ? std::optional(SourceMark::kMacroFlow) : std::nullopt;
}

class Marker {
 public:
  explicit Marker(const Program& program) : program_(program) {}

  std::vector<FoundMark> run() {
    for (const Block& block : program_.blocks) {
      const std::span<const Word> words = program_.words_of(block);
      for (const Word& word : words) look_at(word, words);
      if (block.opacity != ParseStatus::kNone && block.opacity != ParseStatus::kProgramMark) {
        note(mark_of_text(block.opacity, program_.source.text(block.span)), block.span);
      }
    }
    return std::move(found_);
  }

 private:
  void look_at(const Word& word, std::span<const Word> words) {
    if (word.letter == 'G') {
      note(mark_of_g(code_of(word), words), word.span);
    } else if (word.letter == 'M' && is_heater_word(code_of(word), words)) {
      note(SourceMark::kHeaterWords, word.span);
    }
  }

  void note(std::optional<SourceMark> found, SourceSpan where) {
    if (!found || (seen_ & mark(*found)) != 0) return;
    seen_ |= mark(*found);
    found_.push_back({*found, where});
  }

  const Program& program_;
  SourceMarks seen_ = 0;
  std::vector<FoundMark> found_;
};

}  // namespace

std::string_view describe(SourceMark mark) {
  // In the order of the marks.
  constexpr std::array<std::string_view, 11> kTexts = {
      "O words with sub, call, if, while (LinuxCNC)",
      "a named parameter (LinuxCNC)",
      "G64 with a tolerance (LinuxCNC)",
      "G5.2 or G5.3 (LinuxCNC)",
      "IF, GOTO, WHILE of macro B (FANUC and controls like it)",
      "G5.1 Q or G5 P (FANUC and controls like it)",
      "G187 (Haas)",
      "G130 or G131 (Okuma)",
      "the temperature of a heater (3D printers)",
      "a line that starts with $ (grbl)",
      "a command such as #HSC (Beckhoff, ISG, Fagor)"};
  return kTexts.at(static_cast<std::size_t>(mark));
}

std::vector<FoundMark> source_marks(const Program& program) {
  // IF and GOTOF are words of Siemens programs too.
  if (program.language != Language::kRs274) return {};
  return Marker(program).run();
}

}  // namespace batten::gcode
