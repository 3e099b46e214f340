#include "postproc/smooth/run_smoother.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "gcode/state/reason.h"
#include "geometry/path/joined_curve.h"
#include "postproc/runs/run_cutting.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/curve_forms.h"
#include "postproc/smooth/repeated_runs.h"

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
  // Chords that are so far from the path (rms), in parts of the tolerance of the curve, may leave
  // no room to pass their ends; with so many times the tolerance there is.
  double takes_much = 0.35;
  double more_room = 3;
  // A curve that takes less of its tolerance is not held by it: what it leaves the vertices is
  // scatter.
  double free = 0.8;
  // By the tolerance the ends of chords can be moved so that chords of so many tolerances are
  // clearly nearer.
  double moves_reach = 2;
  double side_margin = 0.25;  // of the form's share, on the side where the run must not be cut
  double far_fewer = 0.7;     // of the blocks that there were
  // Part of the time, of a run of corners: the least that there must be left to win by a curve that
  // rounds them. Little brakes in the bound of the time, and all of them do.
  double left_at_corners = 0.07;
  // So many of the pieces are reverted at once that a long run is timed a few times only.
  std::size_t reverted_share = 4;
};
constexpr RunTuning kRun;

bool has_sharp_corner(const std::vector<geometry::Point3>& points) {
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const geometry::Vector3 in = points[i] - points[i - 1];
    const geometry::Vector3 out = points[i + 1] - points[i];
    if (std::atan2(in.cross(out).norm(), in.dot(out)) > kBounds.sharp_corner) return true;
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
        bounds_(task, result),
        budget_(motion_count(task.run), task.context.moves_of_program),
        result_(result) {}

  // Why the run is kept, or nothing.
  [[nodiscard]] std::string_view smooth() {
    const bool is_hopeless = bounds_.is_hopeless();
    if (is_hopeless && !may_move_vertices()) return gcode::reason::kNoGain;
    // The path that was meant has the corners of the program; they may be rounded where that wins
    // time.
    const Method method = options().method;
    CurveRequest meant = curve_request(Method::kFair);
    meant.accurate = true;
    const bool sharp = !options().keep_corners_deg && has_sharp_corner(run().points);
    if (sharp) meant.keep_found_corner = kBounds.sharp_corner;
    CurveRequest roomy = meant;
    roomy.tolerance *= kRun.more_room;
    const auto fair = curve_by(Method::kFair, is_hopeless ? roomy : meant);
    if (is_hopeless) {
      result_.left_out = true;
      if (fair) {
        find_meant(fair->path, std::nullopt);
        fits_ = true;
        try_vertices(*fair, std::nullopt);
      }
    } else if (method == Method::kBest || method == Method::kFair) {
      if (fair) {
        find_meant(fair->path, roomy);
        add_candidates_of(*fair, CurveRole::kFirst);
        try_simpler(meant);
        try_rounding();
        try_inside(*fair, meant);
        if (method == Method::kBest) {
          try_corners();
          try_tube();
        }
        try_vertices(*fair, roomy);
      }
    } else if (const auto curve = curve_by(method, curve_request(method))) {
      find_meant((fair ? *fair : *curve).path, roomy);
      add_candidates_of(*curve, CurveRole::kFirst);
    }
    if (!fits_) return gcode::reason::kNoFit;
    if (!result_.candidates.empty()) return {};
    return result_.left_out ? gcode::reason::kNoGain : gcode::reason::kTargetCannot;
  }

 private:
  [[nodiscard]] const Run& run() const { return task_.run; }
  [[nodiscard]] const RunContext& context() const { return task_.context; }
  [[nodiscard]] const SmoothOptions& options() const { return task_.options; }

  [[nodiscard]] CurveRequest curve_request(Method method) const {
    CurveRequest request;
    const double lent = method == Method::kFair ? kRun.lent_to_fair : kRun.lent;
    request.tolerance = shares_.smoothing + lent * shares_.form;
    request.kind = options().tolerance_kind;
    request.side = options().side;
    request.side_margin = kRun.side_margin * shares_.form + shares_.rounding;
    request.rounding = rounding_;
    request.keep_corner_angle = keep_corner_angle_of(options());
    request.limits = limits_of(*options().machine, greatest_feed(run()));
    request.jerk = options().machine->max_jerk();
    request.guo_lambda = options().guo_lambda;
    request.seam = options().seam;
    request.scatter = std::min(arc_scatter(run()), kRun.arcs_spend * request.tolerance);
    return request;
  }

  // The path that was meant is what the vertices are on, where that is lines and arcs, and else the
  // curve through them. Where chords take much of the tolerance, the fair curve has to run between
  // vertices and chords: then it is fitted once more by `roomy`, if that is not how it was made.
  void find_meant(const geometry::SmoothCurve& fair, const std::optional<CurveRequest>& roomy) {
    fair_ = fair;
    RunFacts& facts = result_.facts;
    facts.noise = fair.noise;
    facts.fair_curvature = CurvatureProfile(fair.curve).greatest();
    const double within = shares_.smoothing + shares_.form;
    shape_ = line_arcs_of(run(), within, rounded());
    const bool is_known = shape_ && shape_->is_certain;
    meant_.emplace(*fair_, is_known ? moves_along(*shape_, run(), *fair_) : MeantPath::Moves());
    facts.off = meant_->distance_of(run());
    if (!is_known && roomy && facts.off > kRun.takes_much / kRun.more_room * roomy->tolerance) {
      through_ = curve_by(Method::kFair, *roomy);
      if (through_) fair_ = through_->path;
      facts.off = meant_->distance_of(run());
    }
    // A form is printed, and so were the vertices.
    facts.scale.original.distance = std::hypot(facts.off, rounded() / std::sqrt(3.0));
    facts.scale.known = kBounds.known * fair_->noise;
    const bool is_held = through_ || fair_->deviation > kRun.free * shares_.smoothing;
    if (!is_known && !is_held && fair_->noise > rounding_) facts.scattered = facts.scale.known;
  }

  // mm, greatest rounding error that the vertices show. The curve leaves a part of it; those that
  // scatter less are exact in fewer decimals than they could have.
  [[nodiscard]] double rounded() const {
    return std::min(rounding_, fair_->noise / kBounds.rounding_left);
  }

  [[nodiscard]] std::optional<RunCurve> curve_by(Method method, const CurveRequest& request) const {
    return known_curve(method, CurveRole::kFirst, request,
                       [&] { return curve_of(method, run().points, request); });
  }

  // That of the memo, or the one that `make` gives. `role`: of curves that a request alone does not
  // tell apart.
  template <typename Make>
  [[nodiscard]] std::optional<RunCurve> known_curve(Method method, CurveRole role,
                                                    const CurveRequest& request,
                                                    const Make& make) const {
    if (task_.memo == nullptr) return make();
    const RunMemo::CurveKey key{method,
                                role,
                                request.tolerance,
                                request.side_margin,
                                request.scatter,
                                request.keep_found_corner,
                                request.accurate,
                                request.near};
    return task_.memo->curves.get(key, [&](std::size_t number) {
      auto curve = make();
      if (curve) curve->number = number;
      return curve;
    });
  }

  void try_curve(CurveRole role, Method method, const CurveRequest& request,
                 bool for_time = false) {
    if (is_out_of_budget() || is_left_out(role)) return;
    const auto curve = curve_by(method, request);
    if (curve) add_candidates_of(*curve, role, for_time);
  }

  // Whether runs like this one show that none of its forms will be better than what there is.
  bool is_left_out(CurveRole role) {
    if (task_.record == nullptr) return false;
    const auto [best, cost] = best_so_far(result_, options());
    const auto predicted = task_.record->predicted(role, best, cost);
    if (!predicted || *predicted < cost) return false;
    result_.left_out = true;
    return true;
  }

  // Whether less is left than what is to be begun takes at least; then the result says so.
  bool is_out_of_budget(double operations = 1) {
    if (!is_bounded(task_) || static_cast<double>(budget_.left()) >= operations) return false;
    result_.is_cut_short = result_.left_out = true;
    return true;
  }

  // Where it leaves some of the tolerance.
  void add_candidates_of(const RunCurve& curve, CurveRole role, bool for_time = false) {
    const double left = shares_.smoothing + shares_.form - curve.path.deviation;
    if (!(left > 0)) return;
    fits_ = true;
    const CurvatureProfile bends(curve.path.curve);
    add_forms({task_, times_, bounds_, *meant_, shape_, budget_},
              {curve, bends, shares_.form, left, role, for_time}, result_);
  }

  // Whether most chords are so near to a curve that their ends can be moved clearly nearer.
  [[nodiscard]] bool may_move_vertices() const {
    const double reach = kRun.moves_reach * tolerance_of(run(), options().tolerance_mm);
    return (options().method == Method::kBest || options().method == Method::kFair) &&
           coarse_part(run(), reach) < kBounds.coarse;
  }

  // Its own vertices, moved to `fair`, or to a curve with more room where there is one: where no
  // form is better than the run; and in runs of corners, which turn less then, to one by `roomy`.
  void try_vertices(const RunCurve& fair, const std::optional<CurveRequest>& roomy) {
    const Form wanted = options().output;
    if (options().linearize || (wanted != Form::kAuto && wanted != Form::kLines)) return;
    if (!fits_ || is_left_out(CurveRole::kVertices)) return;
    const bool among_corners = is_of_corners();
    const bool nearest = options().prefer == Prefer::kAccuracy;
    if (!among_corners && !nearest && !choose(result_, options()).order.empty()) return;
    if (among_corners && roomy && !through_ && !is_out_of_budget()) {
      through_ = curve_by(Method::kFair, *roomy);
    }
    const RunCurve& along = through_ ? *through_ : fair;
    const CurvatureProfile bends(along.path.curve);
    const double left = shares_.smoothing + shares_.form - along.path.deviation;
    add_vertices({task_, times_, bounds_, *meant_, shape_, budget_},
                 {along, bends, shares_.form, left, CurveRole::kVertices}, result_);
  }

  // Where the path that was meant is slower by its length alone, since chords cut its bends short:
  // one as long as the chords, a little inside of it.
  void try_inside(const RunCurve& meant, const CurveRequest& request) {
    if (options().side != geometry::Side::kBoth || !run().bends.empty()) return;
    const Selection so_far = choose(result_, options(), Among::kFormsAlone);
    if (!so_far.order.empty() || so_far.reason != gcode::reason::kSlower) return;
    if (is_out_of_budget() || is_left_out(CurveRole::kInside)) return;
    const double longer = geometry::length_of(meant.path.curve) / result_.facts.length - 1;
    if (longer <= kCost.longer) return;
    const auto inside = known_curve(Method::kFair, CurveRole::kInside, request,
                                    [&] { return inside_curve(meant, run().points, request); });
    if (inside) add_candidates_of(*inside, CurveRole::kInside);
  }

  // Where few blocks are wanted: a curve that leaves the vertices by some of the tolerance takes
  // fewer of them. Parts of a run are fitted alike.
  void try_simpler(CurveRequest request) {
    const bool few = wants_few_moves(options());
    const bool few_curves = options().output == Form::kCurves && !options().quick;
    if (options().prefer == Prefer::kAccuracy || !(few || few_curves)) return;
    request.near = false;
    if (few) {
      request.tolerance = shares_.smoothing + kRun.lent * shares_.form;
      request.scatter = std::max(request.scatter, kRun.spent * request.tolerance);
    }
    try_curve(CurveRole::kSimpler, Method::kFair, request);
  }

  // The methods of corners: the quick one where it may win time, and those that search for each
  // corner where rounding them has won some.
  void try_corners() {
    if (options().side != geometry::Side::kBoth) return;
    if (!corners_are_worth_trying(corner_part(), bounds_.least_time(), best_time())) return;
    try_curve(CurveRole::kCorners, Method::kGuo, curve_request(Method::kGuo), true);
    if (!may_lead_by_corners()) return;
    for (const Method method : {Method::kOzcan, Method::kTimeOptimal}) {
      if (searches_are_worth_trying(run().points.size(), bounds_.least_time(),
                                    result_.facts.scale.alone, best_time())) {
        try_curve(CurveRole::kCorners, method, curve_request(method));
      }
    }
  }

  // Whether rounding each corner by itself wins time and comes near to the fastest form so far: a
  // search for each is faster by some percent, where the others are not by far.
  [[nodiscard]] bool may_lead_by_corners() const {
    double by_corners = std::numeric_limits<double>::infinity();
    for (const Candidate& c : result_.candidates) {
      if (c.method != name_of(Method::kGuo)) continue;
      by_corners = std::min(by_corners, c.figures.times.programmed);
    }
    const RunFacts& facts = result_.facts;
    const double before = facts.scale.original.times.programmed;
    const bool wins = is_forced(options().output, facts, options()) ||
                      by_corners <= (1 - kFormTuning.wins) * before;
    return wins && by_corners - fastest() <= kBounds.search_wins * best_time();
  }

  // Where jerk is limited, and the run is no run of corners, between which the tube has lines.
  void try_tube() {
    if (options().side != geometry::Side::kBoth || options().prefer == Prefer::kAccuracy) return;
    if (context().is_piece() || !std::isfinite(options().machine->max_jerk())) return;
    if (is_of_corners()) return;
    CurveRequest request = curve_request(Method::kTube);
    const double least = std::max(bounds_.least_time(), straight_time(fair_->curve, request));
    if (!tube_is_worth_trying(run().points.size(), least, best_time())) return;
    // What several settings share does not depend on what one of them has found.
    const bool all = task_.scope == CandidateScope::kAll || task_.memo != nullptr;
    if (!all) request.rival = best_time();
    if (is_out_of_budget(tube_operations(fair_->curve, request))) return;
    try_curve(CurveRole::kTube, Method::kTube, request);
  }

  [[nodiscard]] bool is_of_corners() const {
    return is_run_of_corners(run(), options().tolerance_mm);
  }

  [[nodiscard]] double corner_part() const {
    return coarse_part(run(), tolerance_of(run(), options().tolerance_mm));
  }

  // s, of the forms so far in their place. Where one is asked for by name, the blocks as they are
  // do not count.
  [[nodiscard]] double fastest() const {
    const RunFacts& facts = result_.facts;
    const bool forced = is_forced(options().output, facts, options());
    double time =
        forced ? std::numeric_limits<double>::infinity() : facts.scale.original.times.programmed;
    for (const Candidate& c : result_.candidates) {
      time = std::min(time, c.figures.times.programmed);
    }
    return time;
  }

  // s, from rest to rest; of a piece the times are what it adds to its neighbours'.
  [[nodiscard]] double best_time() const {
    return context().is_piece() ? result_.facts.scale.alone : fastest();
  }

  // A curve that rounds corners and spends the tolerance, where it may be better: as the simpler
  // one, or by its time. Not where the best form is larger than the program: what rounds corners is
  // larger still.
  void try_rounding() {
    if (options().prefer == Prefer::kAccuracy) return;
    const Selection so_far = choose(result_, options(), Among::kFormsAlone);
    const bool fewer = wants_few_moves(options()) || options().target->curves_in_auto;
    if (so_far.reason == gcode::reason::kLarger && !(fewer && any_costs_less())) return;
    const bool in_corners = is_of_corners();
    const bool simpler = may_be_simpler(so_far, fewer);
    if (!simpler && !may_be_faster(in_corners)) return;
    const bool for_time = !simpler && in_corners;
    try_curve(CurveRole::kRounding, Method::kFair, curve_request(Method::kFair), for_time);
  }

  // Whether a form so far costs less than the blocks as they are, whatever speaks against it.
  [[nodiscard]] bool any_costs_less() const {
    const CostScale& scale = result_.facts.scale;
    const double before = cost_of(scale.original, scale, options().prefer);
    return std::ranges::any_of(result_.candidates, [&](const Candidate& c) {
      return cost_of(c.figures, scale, options().prefer) < before;
    });
  }

  // By rounding corners. Not in runs of corners on a control that blends them itself, where the
  // methods of corners win what is left.
  [[nodiscard]] bool may_be_faster(bool in_corners) const {
    const double least = bounds_.least_time();
    if (!rounding_is_worth_trying(least, best_time())) return false;
    if (!in_corners || wants_few_moves(options())) return true;
    const bool blends = options().machine->model == ControllerModel::kLinuxcnc;
    return !blends && 1 - least / best_time() >= kRun.left_at_corners;
  }

  // Where nothing is better so far, a curve of fewer pieces: where few blocks are wanted or the
  // target is told curves, or a form in far fewer blocks is slower.
  [[nodiscard]] bool may_be_simpler(const Selection& so_far, bool fewer) const {
    if (!so_far.order.empty()) return false;
    if (fewer) return true;
    const double few = kRun.far_fewer * result_.facts.scale.original.blocks;
    return so_far.reason == gcode::reason::kSlower &&
           std::ranges::any_of(result_.candidates,
                               [&](const Candidate& c) { return c.figures.blocks <= few; });
  }

  const RunTask& task_;
  const ToleranceShares& shares_;
  double rounding_;  // mm, greatest error of one printed coordinate of the run
  const RunTimes& times_;
  CandidateBounds bounds_;
  RunBudget budget_;
  std::optional<geometry::SmoothCurve> fair_;
  std::optional<RunCurve> through_;  // with more room, where it was fitted beside `fair_`
  std::optional<MeantPath> meant_;
  std::optional<LineArcs> shape_;
  bool fits_ = false;  // a method found a curve inside the tolerance
  SmoothedRun& result_;
};

Form form_of(const Run& run) {
  const bool curves = std::ranges::any_of(run.bends, [](const RunBend& bend) {
    return std::holds_alternative<geometry::CubicBezier>(bend.piece);
  });
  if (curves) return Form::kCurves;
  return run.bends.empty() ? Form::kLines : Form::kArcs;
}

RunFacts facts_of(const Run& run, const RunContext& context, const SmoothOptions& options,
                  const RunTimes& times) {
  const std::vector<TimedPiece> motions = timed_pieces(run, 0, run.points.size() - 1);
  RunFacts facts;
  for (const TimedPiece& motion : motions) facts.length += geometry::length_of(motion.piece);
  facts.max_curvature = greatest_curvature(run.points);
  facts.coarse = coarse_part(run, tolerance_of(run, options.tolerance_mm));
  facts.form = form_of(run);
  CostScale& scale = facts.scale;
  scale.original.blocks = static_cast<double>(context.blocks);
  scale.original.bytes = static_cast<double>(context.bytes);
  scale.original.roughness = roughness_of(motions);
  scale.printed =
      gcode::printed_rms(place_format(*options.target, context.before.units), context.before.units);
  scale.near = kCost.near * tolerance_of(run, options.tolerance_mm);
  scale.period = control_period(*options.machine);
  if (options.method == Method::kNone) {  // nothing is compared: only its time is reported
    scale.original.times.programmed = times.programmed(motions);
    return facts;
  }
  scale.original.times = times.of_run(motions);
  scale.alone = context.is_piece() ? cutting_time(motions, *options.machine, context.after.path)
                                   : scale.original.times.programmed;
  return facts;
}

// Where the tube may be tried, which is found by plans, its rivals are timed by them as well.
WorthAPlan worth_a_plan(const Run& run, const RunContext& context, const SmoothOptions& options) {
  const Machine& machine = *options.machine;
  const double tolerance = tolerance_of(run, options.tolerance_mm);
  if (context.is_piece() || !std::isfinite(machine.max_jerk()) || options.method != Method::kBest ||
      is_run_of_corners(run, options.tolerance_mm)) {
    return kAmongForms;
  }
  const double alone =
      cutting_time(timed_pieces(run, 0, run.points.size() - 1), machine, context.after.path);
  const double least =
      least_time(run, tolerance, machine, context.after.path, options.tolerance_kind);
  return tube_is_worth_trying(run.points.size(), least, alone) ? WorthAPlan{} : kAmongForms;
}

}  // namespace

SmoothedRun smooth_run(const Run& run, const RunContext& context, const SmoothOptions& options,
                       CandidateScope scope, RunMemo* memo, const FormRecord* record) {
  const RunTimes times(context, *options.machine, worth_a_plan(run, context, options));
  SmoothedRun result;
  result.facts = facts_of(run, context, options, times);
  if (options.method == Method::kNone) {
    result.reason = gcode::reason::kMethodNone;
    return result;
  }
  ToleranceShares shares = share_tolerance(options, context.before.units, run.decimals,
                                           tolerance_of(run, options.tolerance_mm));
  if (!(shares.smoothing > 0) && run.stated_tolerance_mm) {
    result.reason = gcode::reason::kStatedTolerance;
    return result;
  }
  shares.smoothing -= run.chord_error;  // the points are not quite where the bends are
  if (!(shares.smoothing > 0)) {
    result.reason = gcode::reason::kNoFit;
    return result;
  }
  const RunTask task{run, context, options, scope, memo, record};
  result.reason = RunSmoother(task, times, shares, result).smooth();
  return result;
}

std::optional<SmoothedRun> smooth_repeat(const Run& run, const RunContext& context,
                                         const SmoothOptions& options, const SmoothedRun& first,
                                         const geometry::Vector3& offset) {
  const RunTimes times(context, *options.machine);
  SmoothedRun result;
  result.facts = facts_of(run, context, options, times);
  result.facts.noise = first.facts.noise;
  result.facts.fair_curvature = first.facts.fair_curvature;
  result.facts.scale.original.distance = first.facts.scale.original.distance;
  result.facts.scale.known = first.facts.scale.known;
  result.facts.scattered = first.facts.scattered;
  result.reason = first.reason;
  result.left_out = first.left_out;
  result.is_cut_short = first.is_cut_short;
  const RunTask task{run, context, options};
  for (const Candidate& there : first.candidates) {
    const auto plan = there.plan ? translated(*there.plan, offset) : std::nullopt;
    if (!plan) return std::nullopt;
    auto here = make_candidate(task, times, *plan, result.facts);
    if (!here) return std::nullopt;
    here->method = there.method;
    here->max_curvature = there.max_curvature;
    here->rounds_seam = there.rounds_seam;
    here->has_vertices = there.has_vertices;
    here->figures.distance = there.figures.distance;
    result.candidates.push_back(std::move(*here));
  }
  return result;
}

namespace {

// Seconds that a rewritten piece costs, summed over the settings of the override.
double cost_of(const RunState& piece) {
  Times cost = piece.chosen()->figures.times;
  cost.add(piece.smoothed.facts.scale.original.times, -1);
  return cost.programmed + cost.at_half + cost.at_one_and_half;
}

// Of the whole, with what was chosen for the pieces.
Times times_with(const CutRun& cut, std::span<const RunState> pieces, const Machine& machine) {
  ChainTimes times(machine, cut.path);
  for (const RunState& piece : pieces) {
    const Candidate* chosen = piece.chosen();
    times.add(chosen != nullptr ? chosen->moves.unpacked()
                                : timed_pieces(cut.run, piece.first, piece.last));
  }
  return times.finish();
}

// Of the whole as it was.
Times times_before(const CutRun& cut, std::span<const RunState> pieces, const Machine& machine) {
  ChainTimes times(machine, cut.path);
  for (const RunState& piece : pieces) times.add(timed_pieces(cut.run, piece.first, piece.last));
  return times.finish();
}

// What the whole has with its pieces as they are, and the scale of what it had.
struct WholeFigures {
  CostScale scale;
  Figures after;
};

WholeFigures figures_with(const CutRun& cut, std::span<const RunState> pieces,
                          const SmoothOptions& options) {
  WholeFigures whole;
  Figures& before = whole.scale.original;
  double length = 0;
  for (const RunState& piece : pieces) {
    const RunFacts& facts = piece.smoothed.facts;
    const Figures& old = facts.scale.original;
    const Candidate* chosen = piece.chosen();
    length += facts.length;
    const auto add = [&](const Figures& figures, Figures& sum) {
      sum.blocks += figures.blocks;
      sum.bytes += figures.bytes;
      sum.distance = std::hypot(sum.distance, figures.distance * std::sqrt(facts.length));
    };
    add(old, before);
    add(chosen != nullptr ? chosen->figures : old, whole.after);
  }
  if (length > 0) {
    before.distance /= std::sqrt(length);
    whole.after.distance /= std::sqrt(length);
  }
  before.times = cut.before;
  whole.after.times = times_with(cut, pieces, *options.machine);
  whole.scale.alone = cut.before.programmed;
  whole.scale.near = kCost.near * tolerance_of(cut.run, options.tolerance_mm);
  whole.scale.period = control_period(*options.machine);
  return whole;
}

bool is_worse_in(const RunState& piece, Objection objection) {
  const Figures& now = piece.chosen()->figures;
  const Figures& old = piece.smoothed.facts.scale.original;
  return objection == Objection::kLarger ? now.blocks > old.blocks || now.bytes > old.bytes
                                         : now.distance > old.distance;
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

void RunState::give_up(std::string_view why) {
  while (chosen() != nullptr) reject(why);
}

bool is_rejected_by_proof(const RunState& work) {
  using namespace gcode::reason;
  const std::string_view why = work.reject_reason;
  return why == kCrossesItself || why == kWrongSide || why == kTargetCannot || why == kNotProved;
}

namespace {

// Assigning an empty one would keep its memory.
template <typename Container>
void release(Container& container) {
  Container().swap(container);
}

}  // namespace

void RunState::surround(const Run& whole) {
  const std::size_t from = first - std::min<std::size_t>(first, kNeighbourBlocks);
  const std::size_t to = std::min(last + kNeighbourBlocks, whole.points.size() - 1);
  context.lead = timed_pieces(whole, from, first);
  context.tail = timed_pieces(whole, last, to);
}

void RunState::start_again(const Run& run, const SmoothOptions& options, const Run* whole) {
  std::vector<std::string> refused;
  for (const std::size_t i : std::span(selection.order).first(tried)) {
    refused.push_back(std::move(smoothed.candidates[i].text.text));
  }
  if (whole != nullptr) surround(*whole);
  smoothed = smooth_run(run, context, options, CandidateScope::kAll);
  selection = choose(smoothed, options);
  std::erase_if(selection.order, [&](std::size_t i) {
    return std::ranges::find(refused, smoothed.candidates[i].text.text) != refused.end();
  });
  tried = 0;
  if (!selection.order.empty()) reject_reason = {};
  drop_all_but(selection.order.size());
  smoothed.left_out = false;  // where these are rejected, too, nothing else is to be made
}

void RunState::drop_what_is_not_written() {
  constexpr std::size_t kOfPiece = 2;
  drop_all_but(cut_run ? kOfPiece : selection.order.size());
}

void RunState::drop_all_but(std::size_t best) {
  if (selection.order.size() > best) {
    selection.order.resize(best);
    smoothed.left_out = true;
  }
  for (std::size_t i = 0; i < smoothed.candidates.size(); ++i) {
    Candidate& candidate = smoothed.candidates[i];
    candidate.plan.reset();
    if (std::ranges::find(selection.order, i) != selection.order.end()) continue;
    release(candidate.text.text);
    candidate.moves = PackedMoves();
  }
  if (!cut_run) return;
  release(context.lead);
  release(context.tail);
}

void revert_costly_pieces(CutRun& cut, std::vector<RunState>& works, const SmoothOptions& options) {
  const std::span<RunState> pieces = std::span(works).subspan(cut.first_work, cut.pieces);
  std::vector<RunState*> rewritten;
  for (RunState& piece : pieces) {
    if (piece.chosen() != nullptr) rewritten.push_back(&piece);
  }
  if (cut.before.programmed == 0) {
    cut.before = times_before(cut, pieces, *options.machine);
  }
  const auto by_cost = [](const RunState* a, const RunState* b) {
    const double cost_a = cost_of(*a);
    const double cost_b = cost_of(*b);
    return cost_a != cost_b ? cost_a < cost_b : a->section < b->section;
  };
  std::sort(rewritten.begin(), rewritten.end(), by_cost);
  while (!rewritten.empty()) {
    const WholeFigures whole = figures_with(cut, pieces, options);
    cut.after = whole.after.times;
    const Objection objection = objection_to(whole.after, whole.scale, options.prefer);
    if (objection == Objection::kSlower) {
      const std::size_t giving = std::max<std::size_t>(1, rewritten.size() / kRun.reverted_share);
      for (RunState* piece : std::span(rewritten).last(giving))
        piece->give_up(reason_for(objection));
    } else if (objection == Objection::kLarger || objection == Objection::kFarther) {
      for (RunState* piece : rewritten) {
        if (is_worse_in(*piece, objection)) piece->give_up(reason_for(objection));
      }
    } else {
      return;
    }
    std::erase_if(rewritten, [](const RunState* piece) { return piece->chosen() == nullptr; });
  }
  cut.after = cut.before;
}

}  // namespace batten::postproc
