#include "postproc/smooth/run_smoother.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "gcode/state/reason.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/curve_forms.h"

namespace batten::postproc {

namespace {

struct RunTuning {
  // Of the tolerance, by which vertices may scatter: where few blocks are wanted, since fewer arcs
  // and chords do for the simpler curve, and where arcs that scatter are parts of a curve.
  double spent = 0.25;
  double arcs_spend = 0.5;
  // Of the share of the form, which the curve may use, too: what it leaves, the form gets back. The
  // fair curve comes near to all that it may use, and many arcs or chords that follow it closely
  // need more.
  double lent = 0.6;
  double lent_to_fair = 0.5;
  double side_margin = 0.25;  // of the form's share, on the side where the run must not be cut
  // Radians: vertices that turn more are bends so tight, where they are none of the path that was
  // meant, that curves may rather end there.
  double sharp_corner = 45 * geometry::kPi / 180;
  // So many of the pieces are reverted at once that a long run is timed a few times only.
  std::size_t reverted_share = 4;
};
constexpr RunTuning kRun;

bool has_sharp_corner(const std::vector<geometry::Point3>& points) {
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const geometry::Vector3 in = points[i] - points[i - 1];
    const geometry::Vector3 out = points[i + 1] - points[i];
    if (std::atan2(in.cross(out).norm(), in.dot(out)) > kRun.sharp_corner) return true;
  }
  return false;
}

// The curves that may replace a run, one after the other, as long as one of them could be better.
class RunSmoother {
 public:
  // All must live as long. `result` has the facts of the run.
  RunSmoother(const RunTask& task, const RunTimes& times, const ToleranceShares& shares,
              SmoothedRun& result)
      : task_(task),
        shares_(shares),
        rounding_(0.5 * std::pow(10.0, -task.run.decimals) *
                  gcode::millimetres_per(task.context.before.units)),
        times_(times),
        bounds_(task, times, result),
        result_(result) {}

  // Why the run is kept, or nothing.
  [[nodiscard]] std::string_view smooth() {
    if (bounds_.is_hopeless()) return gcode::reason::kNoGain;
    const bool best = options().method == Method::kBest;
    const bool curve = try_first(best ? Method::kFair : options().method);
    if (curve && has_curves()) try_kept_corners();
    if (best && options().side == geometry::Side::kBoth) try_others();
    if (!fits_) return gcode::reason::kNoFit;
    if (!result_.candidates.empty()) return {};
    return result_.passed_over ? gcode::reason::kNoGain : gcode::reason::kTargetCannot;
  }

 private:
  [[nodiscard]] const Run& run() const { return task_.run; }
  [[nodiscard]] const RunContext& context() const { return task_.context; }
  [[nodiscard]] const SmoothOptions& options() const { return task_.options; }

  [[nodiscard]] CurveRequest curve_request(Method method) const {
    const bool few = wants_few_moves(options());
    CurveRequest request;
    const double lent = method == Method::kFair && !few ? kRun.lent_to_fair : kRun.lent;
    request.tolerance = shares_.smoothing + lent * shares_.form;
    request.kind = options().tolerance_kind;
    request.side = options().side;
    request.side_margin = kRun.side_margin * shares_.form + shares_.rounding;
    request.rounding = rounding_;
    request.keep_corner_angle = keep_corner_angle_of(options());
    request.limits = limits_of(*options().machine, greatest_feed(run()));
    request.jerk = options().machine->max_jerk();
    if (few) request.scatter = kRun.spent * request.tolerance;
    const double of_arcs = std::min(arc_scatter(run()), kRun.arcs_spend * request.tolerance);
    request.scatter = std::max(request.scatter, of_arcs);
    request.accurate = options().prefer == Prefer::kAccuracy;
    // Who asks for curves by name asks for few control points.
    request.near = options().output != Form::kCurves;
    return request;
  }

  // False where there is no such curve. The fair curve is the path that was meant.
  bool try_first(Method method) {
    const CurveRequest request = curve_request(method);
    const auto curve = curve_of(method, run().points, request);
    if (!curve) return false;
    const CurvatureProfile bends(curve->path.curve);
    result_.facts.noise = curve->path.noise;
    result_.facts.error = chord_error(run(), curve->path, rounding_);
    result_.facts.fair_curvature = bends.greatest();
    add_candidates_of(*curve, bends);
    if (method == Method::kFair && request.near) try_simpler(request);
    return true;
  }

  void try_curve(Method method, const CurveRequest& request) {
    const auto curve = curve_of(method, run().points, request);
    if (curve) add_candidates_of(*curve, CurvatureProfile(curve->path.curve));
  }

  // Where it leaves some of the tolerance.
  void add_candidates_of(const RunCurve& curve, const CurvatureProfile& bends) {
    const double left = shares_.smoothing + shares_.form - curve.path.deviation;
    if (!(left > 0)) return;
    fits_ = true;
    add_forms(task_, times_, bounds_, {curve, bends, shares_.form, left}, result_);
  }

  // Where the near curve is worth nothing, one that leaves of the vertices what their decimals do
  // may be. Pieces of a run are fitted alike.
  void try_simpler(CurveRequest request) {
    if (request.accurate || request.scatter > 0 || context().is_piece()) return;
    if (!choose(result_, context(), options()).order.empty()) return;
    request.near = false;
    try_curve(Method::kFair, request);
  }

  // A bend of the tolerance's size instead of a corner takes a curve some thirty control points.
  // Its end in the corner and the start of the next one are fewer blocks, and often as quick.
  void try_kept_corners() {
    if (options().output != Form::kCurves || options().keep_corners_deg) return;
    if (!has_sharp_corner(run().points)) return;
    CurveRequest request = curve_request(Method::kFair);
    request.keep_corner_angle = kRun.sharp_corner;
    try_curve(Method::kFair, request);
  }

  // The other methods, where there is time left to win and they may win it.
  void try_others() {
    const auto mean = [](const Times& t) { return 0.5 * (t.as_set + t.without_merging); };
    double time = mean(bounds_.times_before());
    if (!context().is_piece()) {  // else times are not those of the run alone
      for (const Candidate& c : result_.candidates) time = std::min(time, mean(c.times));
    }
    const double corners = coarse_part(run(), options().tolerance_mm);
    for (const Method method :
         methods_worth_trying(corners, run().points.size(), bounds_.least_time(), time)) {
      try_curve(method, curve_request(method));
    }
  }

  [[nodiscard]] bool has_curves() const {
    return std::ranges::any_of(result_.candidates,
                               [](const Candidate& c) { return c.form == Form::kCurves; });
  }

  const RunTask& task_;
  const ToleranceShares& shares_;
  double rounding_;  // mm, greatest error of one printed coordinate of the run
  const RunTimes& times_;
  CandidateBounds bounds_;
  bool fits_ = false;  // a method found a curve inside the tolerance
  SmoothedRun& result_;
};

}  // namespace

SmoothedRun smooth_run(const Run& run, const RunContext& context, const SmoothOptions& options,
                       CandidateScope scope) {
  const RunTimes times(context, *options.machine);
  const std::vector<TimedPiece> motions = timed_pieces(run, 0, run.points.size() - 1);
  SmoothedRun result;
  result.facts.max_curvature = greatest_curvature(run.points);
  if (options.method == Method::kNone) {  // nothing is compared: only its time is reported
    result.facts.times.as_set = times.as_set_of_run(motions);
    result.reason = gcode::reason::kMethodNone;
    return result;
  }
  result.facts.times = times.of_run(motions);
  if (!run.arcs.empty()) result.facts.kink = greatest_kink(motions);
  ToleranceShares shares = share_tolerance(options, context.before.units, run.decimals);
  shares.smoothing -= run.chord_error;  // the points are not quite where the arcs are
  if (!(shares.smoothing > 0)) {
    result.reason = gcode::reason::kNoFit;
    return result;
  }
  const RunTask task{run, context, options, scope};
  result.reason = RunSmoother(task, times, shares, result).smooth();
  if (!context.is_piece()) {
    for (Candidate& candidate : result.candidates) candidate.moves = {};
  }
  return result;
}

namespace {

std::vector<TimedPiece> chain_with(const CutRun& cut, std::span<const RunState> pieces) {
  std::vector<TimedPiece> chain;
  chain.reserve(cut.run.points.size());
  for (const RunState& piece : pieces) {
    const Candidate* chosen = piece.chosen();
    const std::vector<TimedPiece> moves =
        chosen != nullptr ? chosen->moves : timed_pieces(cut.run, piece.first, piece.last);
    chain.insert(chain.end(), moves.begin(), moves.end());
  }
  return chain;
}

// The times of the whole with its pieces as they are, as far as they must be known: once it is
// slower under one setting, the others are those of `cut.before`.
Times times_with(const CutRun& cut, std::span<const RunState> pieces, const Machine& machine,
                 bool wanted) {
  SettingTimes known(chain_with(cut, pieces), machine, cut.path);
  Times times = cut.before;
  times.as_set = known.as_set();
  if (wanted || slower(times, cut.before, false, wanted)) return times;
  times.without_merging = known.without_merging();
  if (slower(times, cut.before, false, wanted)) return times;
  times.flat_out = known.flat_out();
  return times;
}

// Seconds that a rewritten piece costs, summed over the settings of the control.
double cost_of(const RunState& piece) {
  Times cost = piece.chosen()->times;
  cost.add(piece.smoothed.facts.times, -1);
  return cost.as_set + cost.without_merging + cost.flat_out;
}

}  // namespace

const Candidate* RunState::chosen() const {
  if (tried >= selection.order.size()) return nullptr;
  return &smoothed.candidates[selection.order[tried]];
}

void RunState::reject(std::string_view why) {
  ++tried;
  if (chosen() == nullptr) reject_reason = why;
}

void RunState::start_again(const Run& run, const SmoothOptions& options) {
  smoothed = smooth_run(run, context, options, CandidateScope::kAll);
  selection = choose(smoothed, context, options);
  drop_what_is_not_written();
  tried = 0;
  reject_reason = {};
}

void RunState::drop_what_is_not_written() {
  for (std::size_t i = 0; i < smoothed.candidates.size(); ++i) {
    if (std::ranges::find(selection.order, i) != selection.order.end()) continue;
    smoothed.candidates[i].text.text = {};
    smoothed.candidates[i].moves = {};
  }
}

void revert_costly_pieces(CutRun& cut, std::vector<RunState>& works, const SmoothOptions& options) {
  const std::span<RunState> pieces = std::span(works).subspan(cut.first_work, cut.pieces);
  const bool wanted = options.output != Form::kAuto;
  std::vector<RunState*> rewritten;
  for (RunState& piece : pieces) {
    if (piece.chosen() != nullptr) rewritten.push_back(&piece);
  }
  if (cut.before.as_set == 0) {
    cut.before =
        times_of(timed_pieces(cut.run, 0, cut.run.points.size() - 1), *options.machine, cut.path);
  }
  cut.after = cut.before;
  const auto by_cost = [](const RunState* a, const RunState* b) {
    const double cost_a = cost_of(*a);
    const double cost_b = cost_of(*b);
    return cost_a != cost_b ? cost_a < cost_b : a->section < b->section;
  };
  std::sort(rewritten.begin(), rewritten.end(), by_cost);
  while (!rewritten.empty()) {
    cut.after = times_with(cut, pieces, *options.machine, wanted);
    if (!slower(cut.after, cut.before, false, wanted)) return;
    const std::size_t giving = std::max<std::size_t>(1, rewritten.size() / kRun.reverted_share);
    for (std::size_t i = 0; i < giving; ++i) {
      RunState& piece = *rewritten.back();
      rewritten.pop_back();
      while (piece.chosen() != nullptr) piece.reject(gcode::reason::kSlower);
    }
    cut.after = cut.before;
  }
}

}  // namespace batten::postproc
