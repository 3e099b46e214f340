// A run between moves that stay is timed where it is.
#include "postproc/smooth/kept_neighbours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include "postproc/machine/program_time/program_time.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/smooth/run_smoother.h"
#include "postproc/smooth/selection/candidate_bounds.h"
#include "postproc/smooth/selection/run_times.h"
#include "tests/support/engraved_letters.h"
#include "tests/support/one_run.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

double seconds(const std::string& text, const Machine& machine) {
  const ReadText read(text);
  return time_program(read.program, read.meaning, machine, {}).seconds.sum();
}

// The control goes on from a plunge into the run behind it, into lines otherwise than into arcs.
TEST(KeptNeighbours, LetTimesOfRunsChangeAsThatOfTheProgramDoes) {
  for (const char* target : {"linuxcnc", "marlin", "haas", "siemens"}) {
    SCOPED_TRACE(target);
    SmoothOptions options = options_for(target);
    options.output = Form::kLines;
    const SmoothResult result = smoothed(letters(), options);
    EXPECT_GT(rewritten_runs(result), 5U);
    EXPECT_NEAR(result.runs_after_s - result.runs_before_s,
                seconds(result.text, *options.machine) - seconds(letters(), *options.machine),
                2e-3);
  }
}

// The joints with them may be passed faster than by the run as it is: without that the bound would
// rule out what is that fast. A percent is left for joints that the control rounds in the run.
TEST(KeptNeighbours, LetNoFormWinMoreThanTheBoundKnows) {
  const ReadText read(letters());
  const ProgramPart part{read.program, read.meaning, {}};
  const SmoothOptions options = options_for("linuxcnc");
  const PartRuns runs = find_runs(part, options);
  std::size_t faster = 0;
  for (const RunState& work : runs.works) {
    const auto& run = std::get<postproc::Run>(runs.sections[work.section].content);
    EXPECT_FALSE(work.context.lead.empty());
    const SmoothedRun all = smooth_run(run, work.context, options, CandidateScope::kAll);
    const CostScale& scale = all.facts.scale;
    const double known = CandidateBounds({run, work.context, options}, all).least_time();
    const double least = scale.original.times.programmed - scale.alone + 0.99 * known;
    for (const Candidate& form : all.candidates) {
      EXPECT_GE(form.figures.times.programmed, least - work.context.may_win);
      faster += form.figures.times.programmed < least ? 1 : 0;
    }
  }
  EXPECT_GT(faster, 0U) << "the bound need not know it";
}

// Of many moves before and behind it only those are kept that bear on its times.
TEST(KeptNeighbours, AreAsManyAsBearOnTheTimes) {
  const OneRun one(wave_program({.height = 0.2, .length = 40, .feed = 1500}));
  const auto& run = one.run();
  const SmoothOptions options = options_for("linuxcnc");
  const auto steps = [](geometry::Point3 from, const geometry::Point3& to) {
    std::vector<TimedPiece> moves;
    for (int i = 1; i <= 400; ++i) {
      const geometry::Point3 next = from + (to - from) / (401 - i);
      moves.push_back({geometry::Line{from, next}, 1500});
      from = next;
    }
    return moves;
  };
  const auto first = run.points.front();
  const auto last = run.points.back();
  const auto lead = steps(first - geometry::Vector3(20, 0.5, 0), first);
  const auto tail = steps(last, last + geometry::Vector3(20, 0.5, 0));
  auto fast_lead = lead;
  auto fast_tail = tail;
  RunContext few = one.context();
  put_between(lead, tail, run, *options.machine, few);
  EXPECT_LT(few.lead.size() + few.tail.size(), 400U);
  RunContext fast = one.context();
  for (std::vector<TimedPiece>* moves : {&fast_lead, &fast_tail}) {
    for (TimedPiece& move : *moves) move.feed = 1e7;
  }
  put_between(fast_lead, fast_tail, run, *find_machine("linuxcnc"), fast);
  EXPECT_LT(fast.lead.size() + fast.tail.size(), 700U) << "no axis is as fast as they say";
  RunContext all = one.context();
  all.lead = lead;
  all.tail = tail;
  all.of_neighbours.emplace();
  const RunTimes between_few(few, *options.machine);
  const RunTimes between_all(all, *options.machine);
  const auto moves = timed_pieces(run, 0, run.points.size() - 1);
  const std::vector<TimedPiece> straight = {{geometry::Line{first, last}, 1500}};
  const Times before = between_few.of_run(moves);
  EXPECT_NEAR(before.programmed, cutting_time(moves, *options.machine, {}), 1e-6);
  EXPECT_NEAR(between_few.programmed(straight) - before.programmed,
              between_all.programmed(straight) - between_all.of_run(moves).programmed, 1e-6);
}

}  // namespace
}  // namespace batten::postproc
