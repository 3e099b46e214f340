// What the words of G4 mean on each kind of control, and that what is said is read back.
#include "gcode/state/dwell.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "gcode/reading/parser.h"

namespace batten::gcode {
namespace {

std::optional<std::int32_t> ms_of(const std::string& block, DwellForm form) {
  Diagnostics found;
  const Program program = parse(SourceText("test.nc", block + "\n"), found);
  return dwell_ms(program.words_of(program.blocks.front()), form);
}

struct UnitCase {
  const char* block;
  // Milliseconds by form, in the order of DwellForm; 0: not certain.
  std::int32_t unknown, seconds_p, seconds_x, fanuc, by_point, seconds_f;
};

TEST(Dwell, IsReadInTheUnitOfItsControl) {
  const UnitCase kCases[] = {
      {"G4 P2", 0, 2000, 0, 2, 2, 0},
      {"G4 P2.", 0, 2000, 0, 0, 2000, 0},
      {"N10 G04 P0.5", 0, 500, 0, 0, 500, 0},
      {"G4 X2", 0, 0, 2000, 0, 0, 0},
      {"G4 X2.", 2000, 0, 2000, 2000, 0, 0},
      {"G4 F2", 0, 0, 0, 0, 0, 2000},
      {"G4 S2", 0, 0, 0, 0, 0, 0},
      {"G4 U2.", 0, 0, 0, 0, 0, 0},
  };
  for (const UnitCase& each : kCases) {
    SCOPED_TRACE(each.block);
    const std::int32_t expected[] = {each.unknown, each.seconds_p, each.seconds_x,
                                     each.fanuc,   each.by_point,  each.seconds_f};
    for (int form = 0; form < 6; ++form) {
      EXPECT_EQ(ms_of(each.block, static_cast<DwellForm>(form)).value_or(0), expected[form])
          << form;
    }
  }
}

TEST(Dwell, IsAloneAndAWholeNumberOfMillisecondsUpToAnHour) {
  for (const char* block :
       {"G4", "G4 P1 X1", "G4 P1 P2", "G4 P1 M8", "G4 G4 P1", "G4 P1 G1 X1", "P1", "G4 P[1+1]",
        "G4.1 P1", "G4 P0", "G4 P-1", "G4 P0.0015", "G4 P3600.001"}) {
    EXPECT_EQ(ms_of(block, DwellForm::kSecondsP), std::nullopt) << block;
  }
  EXPECT_EQ(ms_of("P1 G4", DwellForm::kSecondsP), 1000);
  EXPECT_EQ(ms_of("G4 P0.001", DwellForm::kSecondsP), 1);
  EXPECT_EQ(ms_of("G4 P3600", DwellForm::kSecondsP), 3600000);
}

TEST(Dwell, IsReadBackAsItWasSaid) {
  EXPECT_EQ(dwell_block(1500, DwellForm::kSecondsP), "G4 P1.5");
  EXPECT_EQ(dwell_block(2000, DwellForm::kSecondsP), "G4 P2");
  EXPECT_EQ(dwell_block(2000, DwellForm::kSecondsByPoint), "G4 P2.");
  EXPECT_EQ(dwell_block(10, DwellForm::kSecondsXOrMsP), "G4 X0.01");
  EXPECT_EQ(dwell_block(1, DwellForm::kSecondsF), "G4 F0.001");
  EXPECT_EQ(dwell_block(1500, DwellForm::kUnknown), "");
  std::mt19937 random(4);
  std::uniform_int_distribution<std::int32_t> any(1, kLongestDwellMs);
  for (int i = 0; i < 1000; ++i) {
    const std::int32_t ms = i < 100 ? i + 1 : any(random);
    for (int form = 1; form < 6; ++form) {
      const auto of = static_cast<DwellForm>(form);
      EXPECT_EQ(ms_of(dwell_block(ms, of), of), ms) << dwell_block(ms, of);
    }
  }
}

}  // namespace
}  // namespace batten::gcode
