#include "postproc/stream/misread_arcs.h"

#include <gtest/gtest.h>

#include <string>

#include "gcode/controls/built_in.h"
#include "tests/support/interpreted.h"

namespace batten::postproc {
namespace {

constexpr const char* kCircles =
    "G21 G17 G90 G94\nG0 X100.1 Y50.3\nG2 I1 J0 F100\nG3 I30 J0\nG2 I0.5 J0\nG2 I0 J2\n";

gcode::Diagnostics notes_for(const char* target, const std::string& text) {
  const tests::Interpreted read(text);
  return note_misread_arcs(read.program, read.read, *gcode::find_control(target));
}

TEST(MisreadArcsOfAProgram, AreNotedOnceWithTheLinesOfOthers) {
  const tests::Interpreted read(kCircles);
  const auto notes = notes_for("grbl", kCircles);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].id, "arc-misread");
  EXPECT_EQ(notes[0].severity, gcode::Severity::kNote);
  EXPECT_EQ(read.program.source.text(notes[0].where), "G2 I1 J0 F100");
  EXPECT_EQ(notes[0].message,
            "grbl may take this arc of radius 1 mm and 360 degrees for no motion: rounding decides; "
            "expected two half circles; the same in lines 5, 6");
}

TEST(MisreadArcsOfAProgram, AreNoneForControlsThatRunThem) {
  EXPECT_TRUE(notes_for("linuxcnc", kCircles).empty());
  EXPECT_TRUE(notes_for("grblhal", kCircles).empty());
  EXPECT_TRUE(notes_for("grbl", "G21 G17 G90 G94\nG0 X0 Y0\nG2 X2 Y0 I1 J0 F100\n").empty());
}

}  // namespace
}  // namespace batten::postproc
