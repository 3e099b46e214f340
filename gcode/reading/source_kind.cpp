#include "gcode/reading/source_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "gcode/control/control.h"
#include "gcode/reading/foreign_file.h"
#include "gcode/rs274/plain_words.h"
#include "gcode/siemens/names.h"
#include "gcode/text/characters.h"
#include "gcode/text/line_cursor.h"
#include "gcode/text/source_parts.h"

namespace batten::gcode {
namespace {

constexpr SourceMarks kMacroB = mark(SourceMark::kMacroFlow) | mark(SourceMark::kHighSpeedMode);

constexpr std::array kFamilies = {
    SourceFamily{SourceKind::kNgc, "ngc", "LinuxCNC", "linuxcnc", Language::kRs274,
                 mark(SourceMark::kSubWords) | mark(SourceMark::kNamedParameters) |
                     mark(SourceMark::kBlendTolerance) | mark(SourceMark::kUniformNurbs),
                 false, DwellForm::kSecondsP},
    SourceFamily{SourceKind::kFanuc, "fanuc", "FANUC", "fanuc", Language::kRs274, kMacroB, true,
                 DwellForm::kSecondsXOrMsP},
    SourceFamily{SourceKind::kHaas, "haas", "Haas", "haas", Language::kRs274,
                 kMacroB | mark(SourceMark::kHaasSmoothness), true, DwellForm::kSecondsByPoint},
    SourceFamily{SourceKind::kGrbl, "grbl", "grbl", "grbl", Language::kRs274,
                 mark(SourceMark::kDollarLine), false, DwellForm::kSecondsP},
    SourceFamily{SourceKind::kSiemens, "siemens", "Siemens Sinumerik", "siemens",
                 Language::kSiemens, 0, false, DwellForm::kSecondsF},
    SourceFamily{SourceKind::kHeidenhain, "heidenhain", "Heidenhain Klartext", "heidenhain",
                 Language::kKlartext, 0},
};

bool has_siemens_names(const SourceText& source) {
  bool found = false;
  for_each_part(source, [&](SourceSpan part) {
    const std::string_view text = source.text(part);
    LineCursor lines(text);
    while (const auto line = lines.next()) {
      found = has_siemens_name(text.substr(line->begin, line->text_end - line->begin));
      if (found) return false;
    }
    return true;
  });
  return found;
}

const SourceFamily* family_of(SourceKind kind) {
  const auto* found = std::ranges::find(kFamilies, kind, &SourceFamily::kind);
  return found == kFamilies.end() ? nullptr : found;
}

std::string_view option_for(Language language) {
  return language == Language::kSiemens    ? "--source siemens"
         : language == Language::kKlartext ? "--source heidenhain"
                                           : "--source ngc, fanuc, haas or grbl";
}

}  // namespace

std::span<const SourceFamily> source_families() { return kFamilies; }

std::string_view control_of(SourceKind kind) {
  const SourceFamily* family = family_of(kind);
  return family == nullptr ? "" : family->control;
}

std::optional<Language> source_language(const SourceText& source, SourceKind kind,
                                        std::optional<Language> target, Diagnostics& found) {
  if (const std::string_view is = foreign_kind_of(source.text()); !is.empty()) {
    found.push_back({Severity::kError,
                     "not-a-program",
                     {},
                     fmt::format("the file is {}; expected a program of a control", is)});
    return std::nullopt;
  }
  const std::vector<LanguageMark> marks = language_marks(source);
  if (const SourceFamily* family = family_of(kind)) {
    const auto other = std::ranges::find_if(
        marks, [&](const LanguageMark& each) { return each.language != family->language; });
    if (other == marks.end()) return family->language;
    found.push_back(
        {Severity::kError, "source-contradicted", other->where,
         fmt::format("found {}, so this is a program in {}; expected one for {} "
                     "(--source {})",
                     other->evidence, describe(other->language), family->controls, family->name)});
    return std::nullopt;
  }
  // Many programs for Siemens controls are plain words that both languages have. The plainer
  // reading copies what it does not know.
  if (marks.empty()) {
    const bool klartext = target == Language::kKlartext && !plain_beginning(source);
    const bool siemens = target == Language::kSiemens && has_siemens_names(source);
    return klartext ? Language::kKlartext : siemens ? Language::kSiemens : Language::kRs274;
  }
  if (marks.size() == 1) return marks.front().language;
  found.push_back(
      {Severity::kError, "source-ambiguous", marks[1].where,
       fmt::format("found {}, as in a program in {}, and before it {}, as in one in {}; say {} or "
                   "{}, when the other mark is out of the program",
                   marks[1].evidence, describe(marks[1].language), marks[0].evidence,
                   describe(marks[0].language), option_for(marks[1].language),
                   option_for(marks[0].language))});
  return std::nullopt;
}

Decimals decimals_read(SourceKind kind, const Control* target, Language language,
                       const std::optional<Decimals>& declared) {
  if (language != Language::kRs274) return {};
  if (declared) return *declared;
  const SourceFamily* family = family_of(kind);
  const bool may_imply = family != nullptr ? family->may_imply_decimals
                                           : target != nullptr && may_imply_decimals(*target);
  return {.pointless = may_imply ? PointlessNumbers::kUndeclared : PointlessNumbers::kUnits};
}

DwellForm dwells_of(SourceKind kind) {
  const SourceFamily* family = family_of(kind);
  return family != nullptr ? family->dwells : DwellForm::kUnknown;
}

std::string_view why_not_implied(SourceKind kind, const Control* target) {
  const SourceFamily* family = family_of(kind);
  if (family != nullptr && !family->may_imply_decimals) {
    return "programs for this source have no such numbers";
  }
  if (target != nullptr && !may_imply_decimals(*target)) {
    return "this target takes X5 for 5 mm, and blocks are copied to it";
  }
  if (family == nullptr && target == nullptr) return "say --source fanuc or haas";
  return {};
}

void tell_of_contradictions(const Program& program, SourceKind kind, Diagnostics& found) {
  const SourceFamily* family = family_of(kind);
  if (family == nullptr) return;
  for (const FoundMark& each : source_marks(program)) {
    if ((family->marks & mark(each.mark)) != 0) continue;
    found.push_back({Severity::kError, "source-contradicted", each.where,
                     fmt::format("{}: not in a program for {} (--source {})", describe(each.mark),
                                 family->controls, family->name)});
  }
}

namespace {

constexpr std::array<std::string_view, 7> kSiemensTypes = {"REAL",   "INT",  "BOOL", "CHAR",
                                                           "STRING", "AXIS", "FRAME"};

// Takes the next word (letters, digits and _) off the front of the line.
std::string_view next_word(std::string_view& line) {
  line = without_blanks_before(line);
  std::size_t length = 0;
  while (is_name_character(char_at(line, length))) ++length;
  const std::string_view word = line.substr(0, length);
  line.remove_prefix(length);
  return word;
}

bool is_number(std::string_view word) {
  return !word.empty() && word.find_first_not_of("0123456789") == std::string_view::npos;
}

// A line that may be one has one of these letters: 1 for them, 0 for others. Asked without a
// branch, so that the compiler asks many at once.
constexpr unsigned char is_letter_of_mark(char c) {
  const auto small = static_cast<unsigned char>(c | ('a' - 'A'));
  return (c == '%' ? 1 : 0) | (c == ';' ? 1 : 0) | (small == 'b' ? 1 : 0) | (small == 'd' ? 1 : 0);
}

// Whether any of so many characters is one.
constexpr std::size_t kStretch = 64;
bool has_letter_of_mark(const char* stretch) {
  unsigned char any = 0;
  for (std::size_t i = 0; i < kStretch; ++i) {
    any = static_cast<unsigned char>(any | is_letter_of_mark(stretch[i]));
  }
  return any != 0;
}

// The first of them at or behind `at`; the end of the text where there is none. Most of a long
// program has none.
std::size_t find_letter_of_mark(std::string_view text, std::size_t at) {
  while (text.size() - at >= kStretch && !has_letter_of_mark(text.data() + at)) at += kStretch;
  while (at < text.size() && is_letter_of_mark(text[at]) == 0) ++at;
  return at;
}

// Most of the others are seen to be none at their first letter.
bool may_be_mark(std::string_view line) {
  std::size_t at = upper(char_at(line, 0)) == 'N' ? 1 : 0;
  while (is_digit(char_at(line, at)) || is_blank(char_at(line, at))) ++at;
  return is_letter_of_mark(char_at(line, at)) != 0;
}

std::size_t begin_of_line(std::string_view text, std::size_t at) {
  while (at > 0 && text[at - 1] != '\n' && text[at - 1] != '\r') --at;
  return at;
}

void add_marks_of(const SourceText& source, SourceSpan part, std::vector<LanguageMark>& marks) {
  const std::string_view part_text = source.text(part);
  LineCursor lines(part_text);
  for (std::size_t at = find_letter_of_mark(part_text, 0); at < part_text.size();) {
    lines.go_to(begin_of_line(part_text, at));
    const auto line = lines.next();
    if (!line) {
      return;
    }
    at = find_letter_of_mark(part_text, line->end);
    const SourceSpan span{begin_of_content(part_text, *line) + part.begin,
                          line->text_end + part.begin};
    const std::string_view text = source.text(span);
    if (!may_be_mark(text)) {
      continue;
    }
    const auto found = language_of_line(text);
    if (!found || std::ranges::count(marks, found->language, &LanguageMark::language) > 0) continue;
    marks.push_back({found->language, found->evidence, span});
  }
}

}  // namespace

std::optional<LanguageEvidence> language_of_line(std::string_view line) {
  for (const std::string_view mark : {"%_N_", ";$PATH"}) {
    if (line.starts_with(mark)) return LanguageEvidence{Language::kSiemens, mark};
  }
  std::string_view first = next_word(line);
  if (is_number(first) ||
      (first.size() > 1 && upper(first[0]) == 'N' && is_number(first.substr(1)))) {
    first = next_word(line);
  }
  const std::string_view second = next_word(line);
  if (is_same_word(first, "BEGIN") && is_same_word(second, "PGM")) {
    return LanguageEvidence{Language::kKlartext, "BEGIN PGM"};
  }
  if (is_same_word(first, "DEF") && std::ranges::count(kSiemensTypes, in_capitals(second)) > 0) {
    return LanguageEvidence{Language::kSiemens, "DEF with a type"};
  }
  return std::nullopt;
}

std::vector<LanguageMark> language_marks(const SourceText& source) {
  std::vector<LanguageMark> marks;
  for_each_part(source, [&](SourceSpan part) {
    add_marks_of(source, part, marks);
    return true;
  });
  return marks;
}

}  // namespace batten::gcode
