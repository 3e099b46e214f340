// What keeps cutting moves, in words.
#include "postproc/report/kept_report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "gcode/state/reason.h"

namespace batten::postproc {
namespace {

KeptCauses one_cause(double length_mm) {
  KeptCauses kept;
  kept.all = {.moves = 100, .length_mm = 100};
  kept.causes.resize(1);
  kept.causes[0].reason = gcode::reason::kCutterCompensation;
  kept.causes[0].line = 5;
  kept.causes[0].first_line = 7;
  kept.causes[0].text = "G41 D1";
  kept.causes[0].times = 1;
  kept.causes[0].cut = {.moves = 30, .length_mm = length_mm};
  return kept;
}

TEST(KeptReport, SaysWhichShareIsKeptSinceWhichBlock) {
  KeptCauses kept = one_cause(93.12);
  EXPECT_EQ(cause_text(kept, kept.causes[0]),
            "93.1 % of the cutting length, since line 5 'G41 D1' (cutter-compensation)");
  kept.causes[0].times = 4;
  EXPECT_EQ(cause_text(kept, kept.causes[0]),
            "93.1 % of the cutting length, since line 5 'G41 D1' and 3 more (cutter-compensation)");
  kept.causes[0].line = 0;
  EXPECT_EQ(cause_text(kept, kept.causes[0]),
            "93.1 % of the cutting length, first in line 7 'G41 D1' (cutter-compensation)");
  kept.all.without_length = 1;
  EXPECT_TRUE(cause_text(kept, kept.causes[0]).starts_with("30.0 % of the cutting moves, "));
  kept = one_cause(0.01);
  EXPECT_TRUE(cause_text(kept, kept.causes[0]).starts_with("less than 0.1 % of "));
}

TEST(KeptReport, IsBriefInATable) {
  EXPECT_EQ(cause_in_brief(one_cause(93.12)), "93 % cutter-compensation, line 5");
  EXPECT_EQ(cause_in_brief(one_cause(9)), "");
  EXPECT_EQ(cause_in_brief({}), "");
}

TEST(KeptReport, IsAsMuchForPrograms) {
  const Json json = kept_json(one_cause(40));
  EXPECT_EQ(json["moves"], 100);
  const Json& cause = json["causes"][0];
  EXPECT_EQ(cause["id"], "cutter-compensation");
  EXPECT_EQ(cause["line"], 5);
  EXPECT_EQ(cause["block"], "G41 D1");
  EXPECT_EQ(cause["share"], 0.4);
  EXPECT_FALSE(cause["advice"].get<std::string>().empty());
}

}  // namespace
}  // namespace batten::postproc
