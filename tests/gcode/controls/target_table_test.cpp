#include "gcode/control/target_table.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <regex>
#include <set>
#include <sstream>

#include "gcode/control/profiled_dialect.h"
#include "gcode/controls/built_in.h"
#include "gcode/controls/row_dialect.h"
#include "gcode/state/modal_state.h"
#include "tests/support/dialect_arcs.h"
#include "tests/support/places.h"

namespace batten::gcode {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(TargetTable, OfADialectWithThatTableIsTheSame) {
  for (const Dialect* each : dialects()) {
    const TargetTable table = table_of(*each);
    EXPECT_TRUE(table_of(*each->with_values(table)) == table) << each->name();
  }
}

TEST(TargetTable, ChangesShowInTheAdaptedDialect) {
  for (const Dialect* each : dialects()) {
    SCOPED_TRACE(each->name());
    TargetTable table = table_of(*each);
    table.name = "mine";
    table.places = {2, 3};
    table.decimal_point = true;
    table.max_line_length = 60;
    table.planes = {false, true, false};
    table.arc_form = ArcForm::kRadius;
    table.max_sweep_deg = 90;
    const auto mine = each->with_values(table);
    EXPECT_EQ(mine->name(), "mine");
    EXPECT_EQ(mine->coordinates(Units::kMillimetre).decimals, 2);
    EXPECT_EQ(mine->coordinates(Units::kInch).decimals, 3);
    EXPECT_TRUE(mine->coordinates(Units::kInch).always_point);
    EXPECT_TRUE(mine->feeds(Units::kInch).always_point);
    EXPECT_EQ(mine->max_line_length(), 60U);
    EXPECT_FALSE(mine->takes_arcs_in(Plane::kXY));
    EXPECT_TRUE(mine->takes_arcs_in(Plane::kZX));
    EXPECT_EQ(mine->arc_form(), ArcForm::kRadius);
    EXPECT_NEAR(mine->max_arc_sweep(), std::numbers::pi / 2, 1e-12);
  }
}

TEST(TargetTable, KeepsTheRulesOfTheDialect) {
  for (const Dialect* each : dialects()) {
    SCOPED_TRACE(each->name());
    const auto same = each->with_values(table_of(*each));
    EXPECT_EQ(same->line_length("G1 X1 (c) Y2"), each->line_length("G1 X1 (c) Y2"));
    EXPECT_EQ(same->comment("slot 2"), each->comment("slot 2"));
    EXPECT_EQ(same->comment("a!b?$"), each->comment("a!b?$"));
    EXPECT_EQ(same->curves(), each->curves());
    EXPECT_EQ(same->known_marks(), each->known_marks());
    for (const int code : {10, 200, 210, 980}) {
      EXPECT_EQ(same->other_meaning(code), each->other_meaning(code)) << code;
      EXPECT_EQ(same->cannot_say('G', code), each->cannot_say('G', code)) << code;
    }
  }
}

// A virtual function that a later change adds to Dialect must reach the base of a profile.
TEST(ProfiledDialect, AnswersEveryQuestionOfADialect) {
  const fs::path folder = fs::path(BATTEN_SOURCE_DIR) / "gcode" / "control";
  const std::string asked = text_of(folder / "dialect.h");
  const std::string answered =
      text_of(folder / "target_table.h") + text_of(folder / "profiled_dialect.h");
  const std::regex question(R"(virtual [^;{]*?(\w+)\()");
  int found = 0;
  for (std::sregex_iterator at(asked.begin(), asked.end(), question), end; at != end; ++at) {
    const std::string name = (*at)[1];
    if (name == "Dialect" || name == "with_values") continue;
    ++found;
    EXPECT_TRUE(std::regex_search(answered, std::regex("\\b" + name + R"(\([^;{]*override)")))
        << name << " is not answered by ProfiledDialect or TableValues";
  }
  EXPECT_GT(found, 15);
}

TEST(CommentIn, SaysTextInEachStyle) {
  EXPECT_EQ(comment_in(CommentStyle::kParentheses, "slot 2"), "(slot 2)");
  EXPECT_EQ(comment_in(CommentStyle::kSemicolon, "slot 2"), "; slot 2");
  EXPECT_EQ(comment_in(CommentStyle::kNone, "slot 2"), "");
}

TEST(CommentIn, SaysNothingThatActsOrEndsEarly) {
  for (const std::string text : {"a)b", "MSG, go", "two\nlines", "\xC3\xA4", "debug,#1"}) {
    for (const CommentStyle style : {CommentStyle::kParentheses, CommentStyle::kSemicolon}) {
      EXPECT_EQ(comment_in(style, text), "") << text;
    }
  }
}

TEST(CountedBytes, LeaveOutWhatTheControlDoesNotKeep) {
  EXPECT_EQ(counted_bytes("G1 X1 (c) Y2 ; d", LineCount::kAll), 16U);
  EXPECT_EQ(counted_bytes("G1 X1 (c) Y2 ; d", LineCount::kWithoutComments), 10U);
  EXPECT_EQ(counted_bytes("G1 X1 (c) Y2 ; d", LineCount::kWithoutBlanksAndComments), 6U);
}

// By hand: a chord of 1 mm leaves a circle of 5 mm by 5 (1 - cos 0.1) = 0.02498 mm.
TEST(ChordError, IsTheHeightOfTheSegment) {
  EXPECT_NEAR(chord_error({.longest = 1}, 5), 0.0249792, 1e-6);
  EXPECT_EQ(chord_error({}, 5), 0);
  EXPECT_EQ(chord_error({.error = 0.01}, 5), 0.01);
  // 72 chords of a circle of 5 mm are 0.436 mm each: 5 (1 - cos(pi / 72)) = 0.00476 mm.
  EXPECT_NEAR(chord_error({.longest = 1, .shortest = 0.1, .per_circle = 72}, 5), 0.0047595, 1e-6);
  // A small circle has the shortest chords, a large one the longest.
  EXPECT_NEAR(chord_error({.longest = 1, .shortest = 0.1, .per_circle = 72}, 0.2), 0.0062174, 1e-6);
  EXPECT_NEAR(chord_error({.longest = 1, .shortest = 0.1, .per_circle = 72}, 100), 0.00125, 1e-6);
}

TEST(RowDialect, RefusesTheWordsOfItsRow) {
  EXPECT_TRUE(named_dialect("grbl").cannot_say('M', 60));
  EXPECT_FALSE(named_dialect("grbl").cannot_say('M', 30));
  EXPECT_TRUE(named_dialect("grbl").cannot_say('H', 10));
  EXPECT_TRUE(named_dialect("okuma").cannot_say('G', 540));
  EXPECT_FALSE(named_dialect("haas").cannot_say('G', 540));
}

// --- byte for byte -----------------------------------------------------------------------------

// A contour with a line, arcs in three planes, a helix, a feed change and a comment, restored at
// the end. What the target cannot say as an arc is a line.
std::string contour(const Dialect& dialect, Units units) {
  using geometry::Point3;
  using geometry::Vector3;
  ModalState before = cutting_in(units);
  before.motion = MotionMode::kRapid;
  const double mm = millimetres_per(units);
  Writer out(dialect, {before, {Point3::Zero(), {true, true, true}}}, "\n");
  out.use_coordinates(dialect.arc_ends(units));
  out.line_to(mm * Point3(1.5, 0, 0), *before.feed);
  const auto arc = [&](const Point3& center, const Vector3& axis, double sweep, double rise) {
    const geometry::Arc wanted =
        arc_round(out.state().position.mm, mm * center, axis, sweep, mm * rise);
    if (!out.arc_to(wanted, *before.feed / 2)) out.line_to(wanted.end, *before.feed / 2);
  };
  arc({1.5, 0.75, 0}, Vector3::UnitZ(), std::numbers::pi / 3, 0);
  const std::string comment = dialect.comment("second wall");
  if (!comment.empty()) out.copy_line(comment);
  arc({1.5, 0.75, 0}, Vector3::UnitZ(), std::numbers::pi / 7, -0.125);
  arc({2, 2, -1}, Vector3::UnitY(), -1.0, 0);
  arc({0, 0.25, 0}, Vector3::UnitX(), 0.5, 0);
  out.line_to(mm * Point3(1.0 / 3, -2.0 / 3, 1), *before.feed);
  out.restore(cutting_in(units));
  return out.text();
}

TEST(Contours, AreByteForByteTheCases) {
  for (const Dialect* each : dialects()) {
    for (const auto& [units, file] : {std::pair(Units::kMillimetre, "contour_mm.nc"),
                                      std::pair(Units::kInch, "contour_inch.nc")}) {
      const fs::path expected =
          fs::path(BATTEN_SOURCE_DIR) / "tests" / "cases" / std::string(each->name()) / file;
      EXPECT_EQ(contour(*each, units), text_of(expected)) << expected;
    }
  }
}

}  // namespace
}  // namespace batten::gcode
