// Whether the plan of a program (batten time --planner jerk) keeps the limits of a machine: the
// greatest share of any limit that a sample uses, for each program and for all.
//   plan_limits MACHINE MILLISECONDS FILE...
// Ends with 1 where a limit is exceeded by more than half a percent.
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include "postproc/machine/models/junction_speed.h"
#include "postproc/machine/models/planned_chain.h"
#include "postproc/machine/program_time/program_time_chains.h"
#include "tests/support/interpreted.h"
#include "tests/support/planned_paths.h"

namespace {

using namespace batten;
using namespace batten::postproc;

constexpr double kHalfAPercent = 1.005;

struct Sampled {
  Use use;
  double seconds = 0;
};

Sampled sampled(const RunChain& chain, const Machine& machine, double period) {
  const PlannedMotion motion(chain.pieces, machine, FeedPlanner::kJerk, chain.path);
  geometry::Path path;
  std::vector<KinematicPathLimits> limits;
  for (const TimedPiece& piece : chain.pieces) {
    path.push_back(piece.piece);
    limits.push_back(kinematic_limits(machine, piece.feed, piece.rapid));
  }
  FeedPlan plan;
  plan.nodes = motion.nodes();
  return {greatest_use(path, plan, limits, period), motion.duration()};
}

Sampled sampled(const std::string& file, const Machine& machine, double period) {
  std::ifstream in(file);
  const tests::Interpreted program(std::string(std::istreambuf_iterator<char>(in), {}),
                                   gcode::Units::kMillimetre);
  const ProgramSteps steps = read_steps(program.program, program.read, {});
  Sampled all;
  const auto use = [&](const RunChain& chain) {
    if (chain.pieces.empty()) return;
    const Sampled now = sampled(chain, machine, period);
    all.seconds += now.seconds;
    if (now.use.share > all.use.share) {
      all.use = now.use;
      all.use.where += fmt::format(" after line {}", steps.steps[chain.steps.front()].line);
    }
  };
  ChainCutter cutter(machine, ChainCutter::kMostPieces);
  for (const ProgramStep& step : steps.steps) cutter.add(step, steps.controls, use);
  cutter.finish(use);
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  const Machine* machine = argc > 3 ? find_machine(argv[1]) : nullptr;
  if (machine == nullptr) {
    fmt::print(stderr, "plan_limits MACHINE MILLISECONDS FILE...\n");
    return 2;
  }
  double worst = 0;
  for (int i = 3; i < argc; ++i) {
    const Sampled file = sampled(argv[i], *machine, 1e-3 * std::atof(argv[2]));
    worst = std::max(worst, file.use.share);
    fmt::print("{:8.5f}  {:10.3f} s  {}  {}\n", file.use.share, file.seconds, argv[i],
               file.use.where);
  }
  fmt::print("greatest share of a limit: {:.5f}\n", worst);
  return worst > kHalfAPercent ? 1 : 0;
}
