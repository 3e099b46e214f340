// What is said about the band of a tolerance around a run.
#include "postproc/runs/band_notes.h"

#include <gtest/gtest.h>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "postproc/runs/run_grouping.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

// The notes on all runs of a program; lines count from 1.
struct Noted {
  explicit Noted(const std::string& text, double tolerance = 0.01) : source("band.nc", text) {
    gcode::Diagnostics ignored;
    const gcode::Program program = gcode::parse(source, ignored);
    const gcode::Interpretation meaning = gcode::interpret(program, {}, ignored);
    for (const Section& section : group_runs(program, meaning, {})) {
      for (gcode::Diagnostic& note : band_notes(program, meaning, section, tolerance)) {
        notes.push_back(std::move(note));
      }
    }
  }
  [[nodiscard]] std::uint32_t line(std::size_t i) const {
    return source.place_of(notes[i].where.begin).line;
  }

  gcode::SourceText source;
  gcode::Diagnostics notes;
};

// Out along X, round a pocket and along X again, beside the first line.
std::string hairpin(double apart) {
  return fmt::format(
      "G21 G90 G17\nG0 X0 Y0 Z5\nG1 Z-1 F300\nG1 X10 F1000\nX20\nY5\nX0\nY{0:.4f}\nX10\nX19\n"
      "G0 Z5\nM2\n",
      apart);
}

TEST(BandNotes, TellWhereTwoPartsOfARunAreNearerThanTwiceTheTolerance) {
  const Noted noted(hairpin(0.015));
  ASSERT_FALSE(noted.notes.empty());
  const gcode::Diagnostic& note = noted.notes[0];
  EXPECT_EQ(note.id, "band-overlap");
  EXPECT_EQ(note.severity, gcode::Severity::kNote);
  EXPECT_NE(note.message.find("0.0150 mm"), std::string::npos) << note.message;
  EXPECT_NE(note.message.find("0.01 mm"), std::string::npos) << note.message;
  EXPECT_GE(noted.line(0), 4u);
  EXPECT_LE(noted.line(0), 10u);
}

TEST(BandNotes, SayNothingOfPartsThatAreFurtherApartOrNotFlat) {
  EXPECT_TRUE(Noted(hairpin(0.021)).notes.empty());
  EXPECT_FALSE(Noted(hairpin(0.021), 0.0106).notes.empty());
  EXPECT_TRUE(Noted(replaced(hairpin(0.015), "X20\n", "X20 Z-1.5\n")).notes.empty());
}

// Half a circle in chords, tighter than the tolerance, between two lines.
TEST(BandNotes, TellWhereTheRunBendsMoreTightlyThanTheBandIsWide) {
  std::string text = "G21 G90 G17\nG0 X0 Y0 Z5\nG1 Z-1 F300\nG1 X10 F1000\n";
  const double radius = 0.05;
  for (int i = 1; i <= 8; ++i) {
    const double angle = 3.14159265358979 * i / 8;
    text += fmt::format("X{:.4f} Y{:.4f}\n", 10 + radius * std::sin(angle),
                        radius * (1 - std::cos(angle)));
  }
  text += "X0\nG0 Z5\nM2\n";
  const Noted tight(text, 0.1);
  ASSERT_FALSE(tight.notes.empty());
  const gcode::Diagnostic& note = tight.notes.back();
  EXPECT_EQ(note.id, "band-cusp");
  EXPECT_NE(note.message.find("to the left"), std::string::npos) << note.message;
  EXPECT_GE(tight.line(tight.notes.size() - 1), 5u);
  EXPECT_LE(tight.line(tight.notes.size() - 1), 12u);
  EXPECT_TRUE(Noted(text, 0.02).notes.empty()) << "the bend is wider than that";
}

TEST(BandNotes, ArePartOfWhatSmoothSays) {
  const SmoothResult result = smoothed(hairpin(0.015), options_for("linuxcnc"));
  ASSERT_FALSE(result.diagnostics.empty());
  EXPECT_EQ(result.diagnostics[0].id, "band-overlap");
}

TEST(BandNotes, OfManyRunsAreCountedBeyondFifty) {
  const gcode::Diagnostic note{gcode::Severity::kNote, "band-overlap", {}, "near"};
  BandNoteTally tally;
  gcode::Diagnostics found;
  tally.add(std::vector<gcode::Diagnostics>(kMostBandNotes, {note}), found);
  tally.tell_rest(found);
  EXPECT_EQ(found.size(), kMostBandNotes);
  tally.add(std::vector<gcode::Diagnostics>(10, {note}), found);
  tally.tell_rest(found);
  ASSERT_EQ(found.size(), kMostBandNotes + 1);
  EXPECT_NE(found.back().message.find("10 more"), std::string::npos) << found.back().message;
}

}  // namespace
}  // namespace batten::postproc
