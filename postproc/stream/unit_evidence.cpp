#include "postproc/stream/unit_evidence.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "gcode/state/modal_state.h"
#include "gcode/text/characters.h"
#include "gcode/text/line_cursor.h"
#include "gcode/text/number_format.h"

namespace batten::postproc {
namespace {

using gcode::Units;

constexpr std::string_view kUnitsMissing = "units-missing";

// What stands in a program, as far as it tells.
struct UnitFigures {
  double greatest_place = 0;  // of X, Y, Z with a point or below 1000 without one
  double greatest_feed = 0;
  std::size_t places = 0;
  std::size_t places_of_four_decimals = 0;  // or more
  std::size_t places_with_point = 0;
  std::string millimetre_comment;
  std::string inch_comment;
};

bool is_word_in(std::string_view text, std::string_view word) {
  for (std::size_t at = text.find(word); at != std::string_view::npos;
       at = text.find(word, at + 1)) {
    const bool begins = at == 0 || !gcode::is_letter(text[at - 1]);
    const bool ends = !gcode::is_letter(gcode::char_at(text, at + word.size()));
    if (begins && ends) return true;
  }
  return false;
}

class FigureReader {
 public:
  explicit FigureReader(UnitFigures& figures) : figures_(figures) {}

  void read_line(std::string_view line) {
    for (std::size_t at = 0; at < line.size();) {
      const char c = line[at];
      if (c == ';') return read_comment(line.substr(at));
      if (c == '(') {
        const std::size_t end = std::min(line.find(')', at), line.size());
        read_comment(line.substr(at, end - at));
        at = end + 1;
      } else {
        at = gcode::is_letter(c) ? read_word(line, at) : at + 1;
      }
    }
  }

 private:
  void read_comment(std::string_view comment) {
    const std::string text = gcode::in_capitals(comment);
    const auto note = [&](std::string& into, std::initializer_list<std::string_view> words) {
      const bool says =
          std::ranges::any_of(words, [&](std::string_view word) { return is_word_in(text, word); });
      if (says && into.empty()) into = shown(comment);
    };
    note(figures_.millimetre_comment,
         {"MM", "MILLIMETER", "MILLIMETERS", "MILLIMETRE", "MILLIMETRES", "METRIC"});
    note(figures_.inch_comment, {"INCH", "INCHES", "IMPERIAL", "IPM"});
  }

  static std::string shown(std::string_view comment) {
    constexpr std::size_t kMost = 40;
    const std::size_t begin = comment.find_first_not_of("(; \t");
    std::string_view text = comment.substr(std::min(begin, comment.size()));
    text = text.substr(0, kMost);
    while (!text.empty() && (gcode::is_blank(text.back()) || text.back() == '\r')) {
      text.remove_suffix(1);
    }
    return std::string(text);
  }

  // The place behind it.
  std::size_t read_word(std::string_view line, std::size_t at) {
    const char letter = gcode::upper(line[at]);
    const std::size_t begin = gcode::after_blanks(line, at + 1);
    std::size_t end = begin;
    while (end < line.size() && (gcode::is_digit(line[end]) || line[end] == '.' ||
                                 line[end] == '-' || line[end] == '+')) {
      ++end;
    }
    const auto number = gcode::read_number(line.substr(begin, end - begin));
    if (!number) return std::max(end, at + 1);
    const double size = std::abs(number->value);
    if (letter == 'F') {
      figures_.greatest_feed = std::max(figures_.greatest_feed, size);
    } else if (letter >= 'X' && letter <= 'Z') {
      note_place(*number, size);
    }
    return end;
  }

  void note_place(const gcode::ReadNumber& number, double size) {
    // X10000 may be ten least increments.
    constexpr double kGreatestWithoutPoint = 1000;
    if (!number.has_point && size >= kGreatestWithoutPoint) return;
    figures_.greatest_place = std::max(figures_.greatest_place, size);
    ++figures_.places;
    if (number.has_point) ++figures_.places_with_point;
    if (number.decimals >= 4) ++figures_.places_of_four_decimals;
  }

  UnitFigures& figures_;
};

UnitFigures unit_figures(std::string_view text) {
  UnitFigures figures;
  FigureReader reader(figures);
  gcode::LineCursor lines(text);
  while (const auto line = lines.next()) {
    reader.read_line(text.substr(line->begin, line->text_end - line->begin));
  }
  return figures;
}

// How strongly each speaks; a comment that names a unit outweighs all numbers together.
constexpr double kByComment = 4;
constexpr double kBySize = 1.5;
constexpr double kByFeed = 1.5;
constexpr double kByDecimals = 1;
constexpr double kClear = 1.5;

constexpr double kLongInches = 60;  // a coordinate of more is rare on a mill in inches
constexpr double kShortInches = 12;
constexpr double kFastInches = 300;  // and so is a feed of more inches a minute
constexpr double kSlowMillimetres = 60;

}  // namespace

UnitEvidence unit_evidence(std::string_view text) {
  const UnitFigures figures = unit_figures(text);
  double millimetres = 0;
  double inches = 0;
  std::vector<std::string> why;
  const auto speaks = [&why](double& unit, double weight, std::string what) {
    unit += weight;
    why.push_back(std::move(what));
  };
  if (!figures.millimetre_comment.empty()) {
    speaks(millimetres, kByComment, fmt::format("a comment says '{}'", figures.millimetre_comment));
  }
  if (!figures.inch_comment.empty()) {
    speaks(inches, kByComment, fmt::format("a comment says '{}'", figures.inch_comment));
  }
  const std::string size = fmt::format("coordinates up to {:g}", figures.greatest_place);
  const bool four_decimals = figures.places_with_point > 0 &&
                             figures.places_of_four_decimals * 2 > figures.places_with_point;
  if (figures.greatest_place > kLongInches) {
    speaks(millimetres, kBySize, size);
  } else if (figures.places > 0 && figures.greatest_place < kShortInches && four_decimals) {
    speaks(inches, kBySize, size);
  }
  const std::string feed = fmt::format("feeds up to {:g}", figures.greatest_feed);
  if (figures.greatest_feed > kFastInches) {
    speaks(millimetres, kByFeed, feed);
  } else if (figures.greatest_feed > 0 && figures.greatest_feed < kSlowMillimetres) {
    speaks(inches, kByFeed, feed);
  }
  if (four_decimals) {
    speaks(inches, kByDecimals, "four decimals");
  } else if (figures.places_with_point > 0) {
    speaks(millimetres, kByDecimals, "three decimals or fewer");
  }
  UnitEvidence evidence;
  if (std::abs(millimetres - inches) >= kClear) {
    evidence.likely = millimetres > inches ? Units::kMillimetre : Units::kInch;
  }
  evidence.why = fmt::format("{}", fmt::join(why, ", "));
  return evidence;
}

bool tell_unit_evidence(std::string_view text, gcode::Diagnostics& found) {
  for (gcode::Diagnostic& each : found) {
    if (each.id != kUnitsMissing) continue;
    const UnitEvidence evidence = unit_evidence(text);
    const std::string_view speaks = evidence.likely == Units::kMillimetre ? kSpeaksForMillimetres
                                    : evidence.likely == Units::kInch
                                        ? kSpeaksForInches
                                        : "its numbers do not say which";
    each.message += fmt::format("; {}{}", speaks,
                                evidence.why.empty() ? "" : fmt::format(" ({})", evidence.why));
    return true;
  }
  return false;
}

std::string commands_with_units(std::string_view command_line, gcode::Units likely) {
  const auto with = [&](std::string_view units) {
    return fmt::format("  {} --units {}\n", command_line, units);
  };
  if (likely == Units::kMillimetre) return with("mm");
  if (likely == Units::kInch) return with("inch");
  return with("mm") + with("inch");
}

}  // namespace batten::postproc
