#include "postproc/options/options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gcode/controls/built_in.h"
#include "gcode/state/own_words.h"
#include "gcode/state/reason.h"

namespace batten::postproc {
namespace {

SmoothOptions good_options() {
  SmoothOptions options;
  options.target = gcode::find_control("linuxcnc");
  options.machine = find_machine("linuxcnc");
  return options;
}

bool mentions(const std::vector<std::string>& problems, std::string_view text) {
  for (const std::string& problem : problems) {
    if (problem.find(text) != std::string::npos) return true;
  }
  return false;
}

// What a control reads in its own way counts for its own programs alone.
TEST(ReadOptions, AreThoseOfTheControlThatTheProgramWasWrittenFor) {
  SmoothOptions options = good_options();
  options.target = gcode::find_control("philips");
  const gcode::ReadOptions own = read_options_of(options);
  EXPECT_TRUE(own.centers_follow_distance);
  ASSERT_NE(own.own_words, nullptr);
  for (const char* zero : {"G51", "G52"}) {
    const gcode::OwnWord* word = own.own_words->find(zero);
    ASSERT_NE(word, nullptr) << zero;
    EXPECT_FALSE(word->effect.keeps_place);
  }
  options.source = gcode::SourceKind::kFanuc;
  EXPECT_FALSE(read_options_of(options).centers_follow_distance);
  EXPECT_EQ(read_options_of(options).own_words, nullptr);
  options.source = gcode::SourceKind::kAuto;
  options.convert = true;
  EXPECT_EQ(read_options_of(options).own_words, nullptr);
}

TEST(Options, HaveNoProblemsByDefault) { EXPECT_TRUE(problems_of(good_options()).empty()); }

TEST(Options, AreToldOfAllProblemsAtOnce) {
  SmoothOptions options;
  options.tolerance_mm = -1;
  options.keep_corners_deg = 200;
  options.allowed = {"no-such-reason"};
  options.threads = -2;
  const auto problems = problems_of(options);
  EXPECT_EQ(problems.size(), 6u);
  for (const char* option :
       {"--target", "--machine", "--tolerance", "--keep-corners", "--allow", "--threads"}) {
    EXPECT_TRUE(mentions(problems, option)) << option;
  }
}

struct BadOption {
  const char* name;
  void (*spoil)(SmoothOptions&);
  const char* message;
};

TEST(Options, ThatAreWrongAreNamedWithWhatWasFound) {
  const BadOption kBad[] = {
      {"ToleranceZero", [](SmoothOptions& o) { o.tolerance_mm = 0; }, "0 mm"},
      {"ToleranceNotANumber",
       [](SmoothOptions& o) { o.tolerance_mm = std::numeric_limits<double>::quiet_NaN(); },
       "--tolerance"},
      {"ToleranceInMicrometres", [](SmoothOptions& o) { o.tolerance_mm = 25; }, "micrometres"},
      {"ToleranceBelowThePrintedDecimals", [](SmoothOptions& o) { o.tolerance_mm = 1e-9; },
       "decimals of target"},
      {"NoCorner", [](SmoothOptions& o) { o.keep_corners_deg = 0; }, "--keep-corners"},
      {"SmoothSeamOnOneSide",
       [](SmoothOptions& o) {
         o.seam = geometry::Seam::kSmooth;
         o.side = geometry::Side::kLeft;
       },
       "--seam"},
      {"SmoothSeamByAMethodThatLeavesIt",
       [](SmoothOptions& o) {
         o.seam = geometry::Seam::kSmooth;
         o.method = Method::kGuoLiteral;
       },
       "--seam: --method guo-literal"},
      {"SmoothSeamOfNothing",
       [](SmoothOptions& o) {
         o.seam = geometry::Seam::kSmooth;
         o.method = Method::kNone;
       },
       "--seam: --method none"},
      {"RuleThatIsNeverLifted", [](SmoothOptions& o) { o.allowed = {"cutter-compensation"}; },
       "cannot be lifted"},
      {"TooManyThreads", [](SmoothOptions& o) { o.threads = 100000; }, "--threads"}};
  for (const BadOption& bad : kBad) {
    SmoothOptions options = good_options();
    bad.spoil(options);
    const auto problems = problems_of(options);
    EXPECT_EQ(problems.size(), 1u) << bad.name;
    EXPECT_TRUE(mentions(problems, bad.message)) << bad.name;
  }
}

TEST(Options, TakeEveryRuleThatCanBeLiftedAndNoOther) {
  int liftable = 0;
  for (const auto& explanation : gcode::reason::explanations()) {
    SmoothOptions options = good_options();
    options.allowed = {std::string(explanation.id)};
    EXPECT_EQ(problems_of(options).empty(), explanation.can_be_allowed) << explanation.id;
    liftable += explanation.can_be_allowed ? 1 : 0;
  }
  EXPECT_GT(liftable, 0);
}

TEST(ToleranceShares, AddUpToLessThanTheTolerance) {
  for (const gcode::Control& target : gcode::controls()) {
    for (const auto units : {gcode::Units::kMillimetre, gcode::Units::kInch}) {
      for (const auto& form : forms()) {
        for (const double tolerance : {0.0005, 0.005, 0.01, 0.1, 1.0}) {
          SmoothOptions options = good_options();
          options.target = &target;
          options.output = form.value;
          options.tolerance_mm = tolerance;
          const ToleranceShares shares = share_tolerance(options, units);
          SCOPED_TRACE(testing::Message() << target.name << " " << form.name << " " << tolerance);
          EXPECT_GT(shares.rounding, 0);
          if (shares.smoothing > 0) {
            EXPECT_LE(shares.smoothing + shares.form + shares.rounding, tolerance);
            EXPECT_NEAR(shares.smoothing, 2 * shares.form, 1e-12);
          } else {
            EXPECT_GE(shares.rounding, 0.9 * tolerance);
            EXPECT_EQ(shares.form, 0);
          }
        }
      }
    }
  }
}

// Half a step on each of three axes: d decimals of a unit of u mm move a place by
// u * 10^-d / 2 * sqrt(3) at the most.
TEST(ToleranceShares, RoundingIsHalfAStepOnThreeAxes) {
  SmoothOptions options = good_options();
  options.output = Form::kLines;
  const int mm = place_format(*options.target, gcode::Units::kMillimetre).decimals;
  const int inch = place_format(*options.target, gcode::Units::kInch).decimals;
  EXPECT_NEAR(share_tolerance(options, gcode::Units::kMillimetre).rounding,
              0.8660254037844386 * std::pow(10, -mm), 1e-12);
  EXPECT_NEAR(share_tolerance(options, gcode::Units::kInch).rounding,
              0.8660254037844386 * 25.4 * std::pow(10, -inch), 1e-12);
}

TEST(ToleranceShares, ArcsRoundTheirCentresToo) {
  SmoothOptions options = good_options();
  options.output = Form::kLines;
  const double lines = share_tolerance(options, gcode::Units::kMillimetre).rounding;
  for (const Form form : {Form::kArcs, Form::kAuto}) {
    options.output = form;
    EXPECT_GT(share_tolerance(options, gcode::Units::kMillimetre).rounding, lines);
  }
}

TEST(ToleranceShares, MoreDecimalsInTheRunLoseLessByRounding) {
  SmoothOptions options = good_options();
  options.output = Form::kLines;
  const ToleranceShares usual = share_tolerance(options, gcode::Units::kMillimetre);
  const ToleranceShares fine = share_tolerance(options, gcode::Units::kMillimetre, 6);
  EXPECT_NEAR(fine.rounding, 0.8660254037844386e-6, 1e-15);
  EXPECT_GT(fine.smoothing, usual.smoothing);
}

TEST(ToleranceShares, UnknownUnitsCountAsMillimetres) {
  const SmoothOptions options = good_options();
  EXPECT_EQ(share_tolerance(options, gcode::Units::kUnknown).rounding,
            share_tolerance(options, gcode::Units::kMillimetre).rounding);
}

}  // namespace
}  // namespace batten::postproc
