#include "postproc/stream/unit_evidence.h"

#include <gtest/gtest.h>

#include <string>

namespace batten::postproc {
namespace {

using gcode::Units;

struct EvidenceCase {
  std::string text;
  Units likely;
  std::string why;  // a part of it
};

class UnitEvidenceOf : public testing::TestWithParam<EvidenceCase> {};

TEST_P(UnitEvidenceOf, IsWhatTheNumbersAndTheCommentsSay) {
  const auto& [text, likely, why] = GetParam();
  const UnitEvidence evidence = unit_evidence(text);
  EXPECT_EQ(evidence.likely, likely) << evidence.why;
  EXPECT_NE(evidence.why.find(why), std::string::npos) << evidence.why;
}

INSTANTIATE_TEST_SUITE_P(
    EachKind, UnitEvidenceOf,
    testing::Values(EvidenceCase{"G0 X180.5 Y20.\nG1 Z-2. F1200\n", Units::kMillimetre,
                                 "coordinates up to 180.5, feeds up to 1200"},
                    EvidenceCase{"G0 X2.1255 Y-1.0331\nG1 Z-.1250 F30.\n", Units::kInch,
                                 "feeds up to 30, four decimals"},
                    EvidenceCase{"(UNITS: MM)\nG1 X2.1255 Y1.2345 F30\n", Units::kUnknown,
                                 "a comment says 'UNITS: MM'"},
                    EvidenceCase{"; Units = Inches\nG1 X2.125 Y1.234 F100\n", Units::kInch,
                                 "a comment says 'Units = Inches'"},
                    EvidenceCase{"(mm or inch)\nG1 X180.5 F1200\n", Units::kMillimetre, ""},
                    // A tool, not a unit.
                    EvidenceCase{"(HAMMER)\nG1 X20.5 F100\n", Units::kUnknown,
                                 "three decimals or fewer"},
                    EvidenceCase{"G1 X5 Y5 F100\n", Units::kUnknown, ""},
                    // Least increments say nothing of the size.
                    EvidenceCase{"G1 X10000 Y25000 F100\n", Units::kUnknown, ""},
                    EvidenceCase{"", Units::kUnknown, ""}));

TEST(UnitEvidence, IsAddedToTheErrorAlone) {
  gcode::Diagnostics found = {{gcode::Severity::kWarning, "other", {}, "other"},
                              {gcode::Severity::kError, "units-missing", {}, "no G20"}};
  EXPECT_TRUE(tell_unit_evidence("G1 X180.5 F1200\n", found));
  EXPECT_EQ(found[0].message, "other");
  EXPECT_NE(found[1].message.find(kSpeaksForMillimetres), std::string::npos) << found[1].message;
  found.pop_back();
  EXPECT_FALSE(tell_unit_evidence("G1 X180.5 F1200\n", found));
}

TEST(UnitEvidence, GivesTheCommandAgain) {
  EXPECT_EQ(commands_with_units("batten smooth a.nc", Units::kInch),
            "  batten smooth a.nc --units inch\n");
  EXPECT_EQ(commands_with_units("batten smooth a.nc", Units::kUnknown),
            "  batten smooth a.nc --units mm\n  batten smooth a.nc --units inch\n");
}

}  // namespace
}  // namespace batten::postproc
