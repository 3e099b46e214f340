// Controls of machining centres that read ISO programs: Haas, Mazak (EIA), Okuma OSP, Brother,
// Hurco (ISNC), Fagor, NUM. Facts: docs/controllers/machining_centers.md.
#include <array>
#include <span>
#include <utility>

#include "gcode/controls/built_in.h"
#include "gcode/controls/row_dialect.h"

namespace batten::gcode {
namespace {

// Least increments of 0.001 mm and 0.0001 in: more digits are cut off or an alarm. The point is
// always written, since X5 may be 5 increments. Half turns at the most, as posts write them.
TargetTable machining_center_table(std::string_view name, std::string_view description) {
  TargetTable table;
  table.name = name;
  table.description = description;
  table.places = {3, 4};
  table.arc_ends = {3, 4};
  table.centers = {3, 4};
  table.decimal_point = true;
  table.max_sweep_deg = 180;
  table.max_radius = 1000;
  table.max_line_length = 80;  // unknown for all of them; no line of ours needs more
  return table;
}

constexpr SourceMarks kMacro = mark(SourceMark::kMacroFlow);
constexpr SourceMarks kFanucLike = kMacro | mark(SourceMark::kHighSpeedMode);

TargetRow row_of(TargetTable table, SourceMarks marks, std::span<const std::string_view> smoothing,
                 std::string_view refused = {}) {
  TargetRow row{std::move(table)};
  row.known_marks = marks;
  row.smoothing_words = smoothing;
  row.refused = refused;
  row.may_imply_decimals = true;  // where the table writes the point always
  return row;
}

constexpr std::array<std::string_view, 3> kHaasSmoothing = {
    "before-run = [\"G187 P3 E{tolerance}\"]  # P1 to P3: which is rough and which fine is told in",
    "after-run = [\"G187\"]                    # both orders; E: corner rounding. Ask your manual",
    "(bare G187: back to setting 191 and 85)"};

TargetRow haas() {
  TargetRow row =
      row_of(machining_center_table(
                 "haas", "Haas: arcs and helices in G17, G18, G19; decimal point always"),
             kMacro | mark(SourceMark::kHaasSmoothness), kHaasSmoothing);
  row.dwell_form = DwellForm::kSecondsByPoint;
  return row;
}

constexpr std::array<std::string_view, 2> kMazakSmoothing = {
    "before-run = [\"G61.1\"]  # geometry compensation; from memory, ask your manual",
    "after-run = [\"G64\"]"};

TargetRow mazak() {
  return row_of(machining_center_table(
                    "mazak", "Mazak EIA: arcs and helices in G17, G18, G19; decimal point always"),
                kFanucLike, kMazakSmoothing);
}

constexpr std::array<std::string_view, 2> kOkumaSmoothing = {
    "before-run = [\"G131 F5000 J1 E{tolerance}\"]  # its numbers are the machine builder's",
    "after-run = [\"G130\"]"};

TargetRow okuma() {
  return row_of(machining_center_table(
                    "okuma", "Okuma OSP: arcs and helices in G17, G18, G19; decimal point always"),
                // G54 to G59 are tool lengths there, work offsets are G15 H.
                mark(SourceMark::kSuperNurbs), kOkumaSmoothing,
                "G43 G49 G54 G55 G56 G57 G58 G59 H");
}

constexpr std::array<std::string_view, 2> kBrotherSmoothing = {
    "before-run = [\"M262\"]  # M260 series, high accuracy; from memory, ask your manual",
    "after-run = [\"M269\"]"};

TargetRow brother() {
  return row_of(
      machining_center_table(
          "brother", "Brother Speedio: arcs and helices in G17, G18, G19; decimal point always"),
      kFanucLike, kBrotherSmoothing);
}

// ISNC takes I J K as offsets, BNC as places: R is the same in both.
TargetTable arcs_by_radius(TargetTable table) {
  table.arc_form = ArcForm::kRadius;
  table.max_sweep_deg = 90;
  return table;
}

constexpr std::array<std::string_view, 2> kHurcoSmoothing = {
    "before-run = [\"G5.3 P10\"]  # quality, P10 fine to P35; seen in posts alone",
    "after-run = [\"G5.3 P35\"]"};

TargetRow hurco() {
  return row_of(
      arcs_by_radius(machining_center_table(
          "hurco", "Hurco: arcs by R and helices in G17, G18, G19; decimal point always")),
      kMacro, kHurcoSmoothing);
}

// Tool lengths come with D.
constexpr std::string_view kLengthByD = "G43 G49 H";

constexpr std::array kFagorMeanings = {
    OtherMeaning{200, "no inch word on Fagor, whose units are G70 and G71"},
    OtherMeaning{210, "no millimetre word on Fagor, whose units are G70 and G71"}};

TargetRow fagor() {
  TargetTable table = machining_center_table(
      "fagor", "Fagor 8055 to 8070: arcs and helices in G17, G18, G19; G70 and G71");
  table.decimal_point = false;
  TargetRow row = row_of(table, mark(SourceMark::kHashCommand), {}, kLengthByD);
  row.other_meanings = kFagorMeanings;
  return row;
}

constexpr std::array kNumMeanings = {
    OtherMeaning{200, "no inch word on NUM (polar programming), whose units are G70 and G71"},
    OtherMeaning{210,
                 "no millimetre word on NUM (axes of programming), whose units are G70 and "
                 "G71"}};

// I J K are places under G90 there, offsets to the reader: R says the same to both.
TargetRow num() {
  TargetTable table = arcs_by_radius(
      machining_center_table("num", "NUM: arcs by R and helices in G17, G18, G19; G70 and G71"));
  table.decimal_point = false;
  TargetRow row = row_of(table, 0, {}, kLengthByD);
  row.other_meanings = kNumMeanings;
  return row;
}

}  // namespace

std::span<const Dialect* const> machining_center_family() {
  static const RowDialect kHaas(haas());
  static const RowDialect kMazak(mazak());
  static const RowDialect kOkuma(okuma());
  static const RowDialect kBrother(brother());
  static const RowDialect kHurco(hurco());
  static const RowDialect kFagor(fagor());
  static const RowDialect kNum(num());
  static const std::array<const Dialect*, 7> kAll = {&kHaas,  &kMazak, &kOkuma, &kBrother,
                                                     &kHurco, &kFagor, &kNum};
  return kAll;
}

}  // namespace batten::gcode
