// Google Benchmark of the stages that a program goes through, each for itself: processor time and
// blocks a second, for one run along a wave in space.
//   stage_speed [--benchmark_filter=REGEX] ..
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <variant>

#include "gcode/controls/built_in.h"
#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/text/source_text.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/proof/verification.h"
#include "postproc/runs/run_grouping.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/methods/run_curve.h"
#include "postproc/stream/pipeline.h"

namespace {

using namespace batten;

std::string wave(int blocks) {
  std::string text = "G21 G90 G17\nG0 X0 Y0 Z5\nG1 Z0 F300\nF3000\n";
  for (int i = 1; i <= blocks; ++i) {
    const double x = 0.1 * i;
    text += fmt::format("G1 X{:.4f} Y{:.4f} Z{:.4f}\n", x, 4 * std::sin(0.3 * x),
                        std::sin(0.11 * x) + 0.4 * std::sin(0.7 * x));
  }
  return text + "G0 Z5\nM2\n";
}

postproc::SmoothOptions smooth_options() {
  postproc::SmoothOptions options;
  options.target = gcode::find_control("linuxcnc");
  options.machine = postproc::find_machine("linuxcnc-fast");
  options.method = postproc::Method::kFair;
  options.threads = 1;
  return options;
}

// A wave of so many blocks, read, with its run and its fair curve.
struct Read {
  explicit Read(int blocks)
      : source("wave.ngc", wave(blocks)),
        program(gcode::parse(source, found)),
        meaning(gcode::interpret(program, {}, found)) {
    for (postproc::Section& section : postproc::group_runs(program, meaning, {})) {
      auto* one = std::get_if<postproc::Run>(&section.content);
      if (one != nullptr && one->points.size() > run.points.size()) run = std::move(*one);
    }
    if (run.points.size() < static_cast<std::size_t>(blocks)) throw std::logic_error("no run");
    request.limits = postproc::limits_of(*options.machine, 3000);
  }

  gcode::SourceText source;
  gcode::Diagnostics found;
  gcode::Program program;
  gcode::Interpretation meaning;
  postproc::Run run;
  postproc::SmoothOptions options = smooth_options();
  postproc::CurveRequest request;
};

// `stage` is called with the program that was read.
template <typename Stage>
void measure(benchmark::State& state, const Stage& stage) {
  Read read(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(stage(read));
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetComplexityN(state.range(0));
}

void parse(benchmark::State& state) {
  measure(state, [](Read& read) { return gcode::parse(read.source, read.found).blocks.size(); });
}

void interpret(benchmark::State& state) {
  measure(state,
          [](Read& read) { return gcode::interpret(read.program, {}, read.found).motions.size(); });
}

void group_runs(benchmark::State& state) {
  measure(state,
          [](Read& read) { return postproc::group_runs(read.program, read.meaning, {}).size(); });
}

void fair_curve(benchmark::State& state) {
  measure(state, [](Read& read) {
    return postproc::fair_curve(read.run.points, read.request).value().deviation;
  });
}

template <typename Plan>
void measure_plan(benchmark::State& state, const Plan& plan) {
  const Read read(static_cast<int>(state.range(0)));
  const auto fair = postproc::fair_curve(read.run.points, read.request).value();
  const postproc::PlanOptions options{read.options.target, read.options.machine};
  for (auto _ : state) benchmark::DoNotOptimize(plan(read.run, fair, options));
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetComplexityN(state.range(0));
}

void plan_lines(benchmark::State& state) {
  measure_plan(state, [](const auto& run, const auto& fair, const auto& options) {
    return postproc::plan_lines(run, fair, geometry::MarkedPieces(fair.curve), options)
        .moves.size();
  });
}

void plan_arcs(benchmark::State& state) {
  measure_plan(state, [](const auto& run, const auto& fair, const auto& options) {
    return postproc::plan_arcs(run, fair, geometry::MarkedPieces(fair.curve),
                               postproc::CurvatureProfile(fair.curve), options)
        .has_value();
  });
}

void cutting_time(benchmark::State& state) {
  measure(state, [](Read& read) {
    const auto pieces = postproc::timed_pieces(read.run, 0, read.run.points.size() - 1);
    return postproc::cutting_time(pieces, *read.options.machine, gcode::PathMode::kBlending);
  });
}

void smooth_whole(benchmark::State& state) {
  measure(state, [](Read& read) {
    return postproc::smooth_program(read.source, read.options, {}).text.size();
  });
}

void verify(benchmark::State& state) {
  Read read(static_cast<int>(state.range(0)));
  const std::string text = postproc::smooth_program(read.source, read.options, {}).text;
  const gcode::Program after = gcode::parse(gcode::SourceText("new.ngc", text), read.found);
  const gcode::Interpretation meaning = gcode::interpret(after, {}, read.found);
  const postproc::Promise promise{read.options.tolerance_mm};
  for (auto _ : state) {
    const auto verdict =
        postproc::verify({&read.program, &read.meaning}, {&after, &meaning}, promise);
    if (!verdict.proved()) state.SkipWithError("not proved");
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetComplexityN(state.range(0));
}

void sizes(benchmark::internal::Benchmark* stage) {
  stage->Arg(1'000)->Arg(10'000)->Arg(40'000)->Unit(benchmark::kMillisecond)->Complexity();
}

BENCHMARK(parse)->Apply(sizes);
BENCHMARK(interpret)->Apply(sizes);
BENCHMARK(group_runs)->Apply(sizes);
BENCHMARK(fair_curve)->Apply(sizes)->Arg(1'000'000);
BENCHMARK(plan_lines)->Apply(sizes);
BENCHMARK(plan_arcs)->Apply(sizes);
BENCHMARK(cutting_time)->Apply(sizes);
BENCHMARK(verify)->Apply(sizes);
BENCHMARK(smooth_whole)->Apply(sizes);

}  // namespace

BENCHMARK_MAIN();
