// What is said of forms before they are made must hold for them.
#include "postproc/smooth/selection/candidate_bounds.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "postproc/runs/run_path.h"
#include "postproc/smooth/curve_forms.h"
#include "postproc/smooth/methods/run_curve.h"
#include "postproc/smooth/selection/selection.h"
#include "tests/support/one_run.h"

namespace batten::postproc {
namespace {

// A run with its fair curve, and lines along that.
class Lines {
 public:
  explicit Lines(const std::string& text)
      : run_(text),
        options_(options_for("linuxcnc")),
        context_(run_.context()),
        task_{run_.run(), context_, options_},
        times_(context_, *options_.machine) {
    const std::vector<TimedPiece> motions =
        timed_pieces(run_.run(), 0, run_.run().points.size() - 1);
    so_far_.facts.times = times_.of_run(motions);
    CurveRequest request;
    request.tolerance = 0.008;
    request.limits = limits_of(*options_.machine, 3000);
    curve_ = fair_curve(run_.run().points, request);
    if (!curve_) return;
    bends_.emplace(curve_->curve);
    so_far_.facts.noise = curve_->noise;
    so_far_.facts.error = chord_error(run_.run(), *curve_, request.rounding);
    bounds_.emplace(task_, times_, so_far_);
  }

  [[nodiscard]] const CandidateBounds& bounds() const { return bounds_.value(); }
  [[nodiscard]] LinesAhead ahead(double deviation) const { return {*bends_, deviation}; }

  [[nodiscard]] Candidate made(double deviation) const {
    PlanOptions plan{options_.target, options_.machine};
    plan.max_deviation = deviation;
    const geometry::MarkedPieces pieces(curve_->curve);
    const OutputPlan lines = plan_lines(run_.run(), *curve_, pieces, plan);
    Candidate c = make_candidate(task_, times_, lines, so_far_.facts.times).value();
    c.error = bounds().known(lines.error);
    return c;
  }

  // Whether `choose` puts the first of them first.
  [[nodiscard]] bool is_chosen(const Candidate& first, const Candidate& second) const {
    SmoothedRun both = so_far_;
    both.candidates = {first, second};
    const Selection selection = choose(both, context_, options_);
    return !selection.order.empty() && selection.order.front() == 0;
  }

 private:
  OneRun run_;
  SmoothOptions options_;
  RunContext context_;
  RunTask task_;
  RunTimes times_;
  SmoothedRun so_far_;
  std::optional<geometry::SmoothCurve> curve_;
  std::optional<CurvatureProfile> bends_;
  std::optional<CandidateBounds> bounds_;
};

std::vector<std::string> programs() {
  std::vector<std::string> all = {circle_program(40), circle_program(400), circle_program(2000)};
  for (const double height : {0.05, 0.5, 4.0}) {
    for (const double length : {6.0, 40.0, 300.0}) {
      all.push_back(wave_program({.lines = 600, .height = height, .length = length}));
      all.push_back(wave_program({.lines = 600, .height = height, .length = length, .feed = 300}));
    }
  }
  return all;
}

TEST(CandidateBounds, SayOnlyOfLinesThatAreChosenThatTheyBeatFinerOnes) {
  int beaten = 0;
  int not_beaten = 0;
  for (const std::string& text : programs()) {
    const Lines lines(text);
    for (const auto& [coarse, fine] : {std::pair{0.004, 0.002}, {0.004, 0.001}, {0.002, 0.0008}}) {
      const Candidate few = lines.made(coarse);
      const bool beats = lines.bounds().beats_finer(few, coarse, lines.ahead(fine));
      ++(beats ? beaten : not_beaten);
      if (!beats) continue;
      EXPECT_TRUE(lines.is_chosen(few, lines.made(fine))) << coarse << " and " << fine << "\n"
                                                          << text.substr(0, 200);
    }
  }
  EXPECT_GE(beaten, 5);
  EXPECT_GE(not_beaten, 5);
}

// Twice as near, a form may be preferred for that alone.
TEST(CandidateBounds, LetAFormLiveThatIsMuchNearer) {
  const Lines lines(wave_program());
  const Candidate made = lines.made(0.004);
  EXPECT_FALSE(lines.bounds().beats_form(made, made.error / 10, 1000));
}

TEST(CandidateBounds, KnowNoFormBetterThanTheCurve) {
  const Lines noisy(wave_program({.height = 0.5, .length = 40, .noise = 0.003, .decimals = 4}));
  const double noise = noisy.bounds().facts().noise;
  ASSERT_GT(noise, 0.001);
  EXPECT_GT(noisy.bounds().known(0), 0.2 * noise);
  EXPECT_EQ(noisy.bounds().known(0), noisy.bounds().known(0.1 * noise));
  EXPECT_EQ(noisy.bounds().known(2 * noise), 2 * noise);
}

// Chords of a millimetre are 30 um away from where the wave bends most, and at 300 mm/min no corner
// costs time: nothing within 10 um could be faster or smaller, or nearer in as few blocks.
TEST(CandidateBounds, GiveUpARunOfCoarseChords) {
  const auto wave = [](double step) {
    return wave_program({.lines = 100, .step = step, .height = 2, .length = 18, .feed = 300});
  };
  EXPECT_TRUE(Lines(wave(1)).bounds().is_hopeless());
  EXPECT_FALSE(Lines(wave(0.1)).bounds().is_hopeless());
}

}  // namespace
}  // namespace batten::postproc
