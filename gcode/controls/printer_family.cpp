// Firmware of 3D printers that also runs routers: Marlin, RepRapFirmware, Klipper, Smoothieware.
// Facts: docs/controllers/printer_family.md.
#include <array>
#include <span>
#include <utility>

#include "gcode/controls/built_in.h"
#include "gcode/controls/row_dialect.h"
#include "gcode/curves/g5_curve.h"

namespace batten::gcode {
namespace {

// What an ordinary build refuses or gives another meaning.
constexpr std::string_view kRefused =
    "G40 G43 G49 G54 G55 G56 G57 G58 G59 G80 G94 M1 M2 M3 M4 M5 M6 M8 M9 M30 S T H";

TargetRow row_of(TargetTable table, LineCount count, std::string_view not_in_comments = {},
                 std::span<const OtherMeaning> meanings = {}) {
  TargetRow row{std::move(table), count, not_in_comments, &unchecked_arc_rule, meanings};
  row.known_marks = mark(SourceMark::kHeaterWords);
  row.refused = kRefused;
  return row;
}

// As grbl: 32-bit numbers (doubles on Klipper and RepRapFirmware's faster boards), steps of a few
// micrometres, a serial line.
TargetTable printer_table(std::string_view name, std::string_view description) {
  TargetTable table;
  table.name = name;
  table.description = description;
  table.places = {3, 4};
  table.arc_ends = {3, 4};
  table.centers = {4, 5};
  table.max_radius = 1000;
  table.max_sweep_deg = 180;
  table.machine = "router";
  return table;
}

constexpr std::array kMarlinMeanings = {
    OtherMeaning{200,
                 "read only by builds with inch support; others run the numbers as "
                 "millimetres. Post the program in millimetres"}};

// One command to a line: a plane word would take the arc's place, so arcs in G17 alone.
TargetRow marlin() {
  TargetTable table = printer_table(
      "marlin",
      "Marlin: arcs and helices in G17 where its own chords are fine enough; millimetres");
  table.planes = {true, false, false};
  table.comments = CommentStyle::kSemicolon;
  table.repeats_words = true;
  // 96 bytes with terminator; a sender adds up to 14 for N1234567 and *123.
  table.max_line_length = 80;
  table.chords = {.longest = 1, .shortest = 0.1, .per_circle = 72};
  TargetRow row = row_of(table, LineCount::kAll, {}, kMarlinMeanings);
  row.curves = &chopped_g5();
  return row;
}

TargetRow reprapfirmware() {
  TargetTable table =
      printer_table("reprapfirmware",
                    "RepRapFirmware 3: arcs and helices in G17, G18, G19 where its own "
                    "chords are fine enough");
  table.comments = CommentStyle::kSemicolon;
  table.repeats_words = true;
  table.max_line_length = 255;
  table.chords = {.error = 0.005};
  return row_of(table, LineCount::kWithoutComments, "{}\"");
}

constexpr std::array kKlipperMeanings = {
    OtherMeaning{200, "refused: Klipper runs millimetres only. Post the program in millimetres"}};

// G18 and G19 came late, and their directions are not those of other controls: G17 alone.
TargetRow klipper() {
  TargetTable table = printer_table(
      "klipper",
      "Klipper: lines; arcs in G17 where [gcode_arcs] is set up and fine enough; millimetres");
  table.planes = {true, false, false};
  table.comments = CommentStyle::kSemicolon;
  table.repeats_words = true;
  table.chords = {.longest = 1};  // [gcode_arcs] resolution
  return row_of(table, LineCount::kAll, {}, kKlipperMeanings);
}

TargetRow smoothieware() {
  TargetTable table = printer_table(
      "smoothieware",
      "Smoothieware: arcs and helices in G17, G18, G19 where its own chords are fine enough");
  table.repeats_words = true;
  table.max_line_length = 120;     // its buffer was not read; no line of ours needs more
  table.chords = {.error = 0.01};  // mm_max_arc_error
  return row_of(table, LineCount::kAll);
}

}  // namespace

std::span<const Dialect* const> printer_family() {
  static const RowDialect kMarlin(marlin());
  static const RowDialect kReprap(reprapfirmware());
  static const RowDialect kKlipper(klipper());
  static const RowDialect kSmoothie(smoothieware());
  static const std::array<const Dialect*, 4> kAll = {&kMarlin, &kReprap, &kKlipper, &kSmoothie};
  return kAll;
}

}  // namespace batten::gcode
