#include "postproc/smoothing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "gcode/curves/curve_format.h"
#include "gcode/large_pages.h"
#include "gcode/reason.h"
#include "geometry/curve_pieces.h"
#include "geometry/numeric.h"
#include "postproc/machine/junction_speed.h"
#include "postproc/machine/timed_chain.h"
#include "postproc/plan/curve_bends.h"
#include "postproc/plan/piece_plans.h"
#include "postproc/plan/run_choice.h"
#include "postproc/plan/run_curve.h"
#include "postproc/plan/run_prospect.h"
#include "postproc/plan/run_times.h"
#include "postproc/runs/run_path.h"

namespace batten::postproc {

namespace {

constexpr double kMmPerInch = 25.4;

// Where few blocks are wanted, vertices may scatter by this part of the tolerance: fewer arcs
// and chords do for the simpler curve.
constexpr double kSpent = 0.25;

// Arcs that are pieces of a curve scatter about it, but the curve that is looked for stays within
// this part of the tolerance of most of them.
constexpr double kArcsSpend = 0.5;

// Of the share of the form, the curve may use this part too: what it leaves of it, and of its
// own share, the form gets back. The fair curve comes near to all that it may use, and where many
// arcs or chords follow it closely they need more.
constexpr double kLent = 0.6;
constexpr double kLentToFair = 0.5;

// Arcs get no more than this multiple of the form's share, however little the curve used, and
// chords these: long ones are few, fine ones are near to the curve and keep the speed on a
// control that rounds each of their corners.
// Curves are as arcs here.
constexpr double kArcs = 1.5;
constexpr double kFineArcs = 0.25;
constexpr double kLongChords = 1.5;
constexpr double kMiddleChords = 0.6;
constexpr double kFineChords = 0.25;

// Chords that may be as far from the curve as this part of what others may are those again.
constexpr double kAnother = 0.9;

// Radians: vertices that turn more are bends so tight, where they are none of the path that was
// meant, that curves may rather end there.
constexpr double kSharpCorner = 45 * std::numbers::pi / 180;

// Parts of the band around a run of arcs in which few arcs are looked for.
constexpr double kBands[] = {1, 0.97, 0.94};

// Of a run with so many coarse vertices there is nothing left to fit but corners.
constexpr double kCoarse = 0.5;

// The fair curve of scattered vertices is no better known than this part of their scatter: a form
// that is nearer to it than that is not nearer to the path that was meant.
constexpr double kKnown = 0.5;

double step_of(int decimals, gcode::Units units) {
  const double step = std::pow(10.0, -decimals);
  return units == gcode::Units::kInch ? kMmPerInch * step : step;
}

double least_feed(const Run& run) {
  double feed = std::numeric_limits<double>::infinity();
  for (const FeedFrom& from : run.feeds) feed = std::min(feed, from.feed);
  return feed;
}

double greatest_feed(const Run& run) {
  double feed = 0;
  for (const FeedFrom& from : run.feeds) feed = std::max(feed, from.feed);
  return feed;
}

std::vector<TimedPiece> timed_pieces(const OutputPlan& plan) {
  std::vector<TimedPiece> pieces;
  pieces.reserve(plan.moves.size());
  for (const PlannedMove& move : plan.moves) pieces.push_back({move.piece, move.feed});
  return pieces;
}

class RunSmoother {
 public:
  RunSmoother(const Run& run, const RunContext& context, const SmoothOptions& options,
              Making making)
      : run_(run),
        context_(context),
        options_(options),
        may_leave_out_(making == Making::kToChoose && options.prefer == Prefer::kTime &&
                       options.output == Form::kAuto && options.side == geometry::Side::kBoth &&
                       run.arcs.empty() && !context.is_piece()),
        units_(context.before.units),
        times_(context, *options.machine) {}

  SmoothedRun smooth() {
    result_.facts.max_curvature = greatest_curvature(run_.points);
    const std::vector<TimedPiece> motions = timed_pieces(run_, 0, run_.points.size() - 1);
    if (options_.method == Method::kNone) return kept_unasked(motions);
    result_.facts.times = times_.of_run(motions);
    if (!run_.arcs.empty()) result_.facts.kink = greatest_kink(motions);

    ToleranceShares shares = share_tolerance(options_, units_, run_.decimals);
    shares.smoothing -= run_.chord_error;  // the points are not quite where the arcs are
    if (!(shares.smoothing > 0)) return kept(gcode::reason::kNoFit);
    const double rounding = 0.5 * step_of(run_.decimals, units_);
    find_prospect();
    if (is_hopeless()) return kept(gcode::reason::kNoGain);
    const bool best = options_.method == Method::kBest;
    const Method first = best ? Method::kFair : options_.method;
    const CurveRequest request = curve_request(first, shares, rounding);
    const auto curve = curve_of(first, run_.points, request);
    if (curve) {
      look_at(*curve);
      know(curve->path, rounding);
      add_candidates_of(*curve, shares);
      if (first == Method::kFair && request.near) try_simpler(request, shares);
    }
    if (curve && has_curves()) try_kept_corners(shares, rounding);
    if (best && !one_sided()) try_others(shares, rounding);
    if (!fits_) return kept(gcode::reason::kNoFit);
    if (result_.candidates.empty()) {
      return kept(passed_over_ ? gcode::reason::kNoGain : gcode::reason::kTargetCannot);
    }
    if (!context_.is_piece()) {
      for (Candidate& candidate : result_.candidates) candidate.moves = {};
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] CurveRequest curve_request(Method method, const ToleranceShares& shares,
                                           double rounding) const {
    CurveRequest request;
    const double lent = method == Method::kFair && !few_wanted() ? kLentToFair : kLent;
    request.tolerance = shares.smoothing + lent * shares.form;
    request.kind = options_.tolerance_kind;
    request.side = options_.side;
    request.side_margin = kFineChords * shares.form + shares.rounding;
    request.rounding = rounding;
    request.keep_corner_angle = keep_corner_angle();
    request.limits = limits_of(*options_.machine, greatest_feed(run_));
    request.jerk = options_.machine->max_jerk();
    if (few_wanted()) request.scatter = kSpent * request.tolerance;
    const double of_arcs = std::min(arc_scatter(run_), kArcsSpend * request.tolerance);
    request.scatter = std::max(request.scatter, of_arcs);
    request.accurate = options_.prefer == Prefer::kAccuracy;
    // Who asks for curves by name asks for few control points.
    request.near = options_.output != Form::kCurves;
    return request;
  }

  void know(const geometry::FairPath& path, double rounding) {
    result_.facts.noise = path.noise;
    result_.facts.error = chord_error(run_, path, rounding);
    result_.facts.fair_curvature = bends_->greatest();
  }

  // Where the near curve is worth nothing, one that leaves of the vertices what their decimals do
  // may be. Pieces of a run are fitted alike.
  void try_simpler(CurveRequest request, const ToleranceShares& shares) {
    if (request.accurate || request.scatter > 0 || context_.is_piece()) return;
    if (!choose(result_, context_, options_).order.empty()) return;
    request.near = false;
    if (const auto curve = curve_of(Method::kFair, run_.points, request)) try_curve(*curve, shares);
  }

  void try_curve(const RunCurve& curve, const ToleranceShares& shares) {
    look_at(curve);
    add_candidates_of(curve, shares);
  }

  void look_at(const RunCurve& curve) { bends_.emplace(curve.path.curve); }

  // Where it leaves some of the tolerance.
  void add_candidates_of(const RunCurve& curve, const ToleranceShares& shares) {
    const double left = shares.smoothing + shares.form - curve.path.deviation;
    if (!(left > 0)) return;
    fits_ = true;
    add_candidates(curve, shares.form, left);
  }

  // A bend of the tolerance's size in the place of a corner takes a curve some thirty control
  // points. Its end in the corner and the start of the next one are fewer blocks, and often as
  // quick.
  void try_kept_corners(const ToleranceShares& shares, double rounding) {
    if (options_.output != Form::kCurves || options_.keep_corners_deg) return;
    const auto& points = run_.points;
    bool sharp = false;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      const geometry::Vector3 in = points[i] - points[i - 1];
      const geometry::Vector3 out = points[i + 1] - points[i];
      sharp = sharp || std::atan2(in.cross(out).norm(), in.dot(out)) > kSharpCorner;
    }
    if (!sharp) return;
    CurveRequest request = curve_request(Method::kFair, shares, rounding);
    request.keep_corner_angle = kSharpCorner;
    if (const auto curve = curve_of(Method::kFair, run_.points, request)) try_curve(*curve, shares);
  }

  // The other methods, where there is time left to win and they may win it.
  void try_others(const ToleranceShares& shares, double rounding) {
    const auto mean = [](const Times& t) { return 0.5 * (t.as_set + t.without_merging); };
    double time = mean(judged_.times);
    if (!context_.is_piece()) {  // else times are not those of the run alone
      for (const Candidate& c : result_.candidates) time = std::min(time, mean(c.times));
    }
    const double corners = coarse_part(run_, options_.tolerance_mm);
    for (const Method method :
         methods_worth_trying(corners, run_.points.size(), least_time_, time)) {
      const CurveRequest request = curve_request(method, shares, rounding);
      if (const auto curve = curve_of(method, run_.points, request)) try_curve(*curve, shares);
    }
  }

  // Whether the whole tolerance may be spent on fewer moves.
  [[nodiscard]] bool few_wanted() const {
    if (options_.prefer == Prefer::kAccuracy) return false;
    return options_.output == Form::kArcs || options_.prefer == Prefer::kSize;
  }

  [[nodiscard]] double keep_corner_angle() const {
    if (!options_.keep_corners_deg) return geometry::FairOptions{}.keep_corner_angle;
    return *options_.keep_corners_deg * std::numbers::pi / 180;
  }

  // Times of a piece leave out what its neighbours need to stop and start; what it could gain is
  // judged by its time alone.
  void find_prospect() {
    least_time_ =
        least_time(run_, options_.tolerance_mm, *options_.machine, options_.tolerance_kind);
    judged_ = result_.facts;
    if (context_.is_piece()) {
      const std::vector<TimedPiece> alone = timed_pieces(run_, 0, run_.points.size() - 1);
      const SettingTimes times(alone, *options_.machine, context_.after.path);
      judged_.times.as_set = times.as_set();
      judged_.times.without_merging = times.without_merging();
    }
  }

  // The program's own chords are coarser than the tolerance nearly everywhere: a curve could only
  // round their corners, in more blocks than there are.
  [[nodiscard]] bool is_hopeless() const {
    if (coarse_part(run_, options_.tolerance_mm) < kCoarse) return false;
    const Prospect corners{least_time_, 2.0 * static_cast<double>(context_.blocks), judged_.error};
    return !may_gain(corners, judged_, context_.blocks, options_.prefer);
  }

  // About how many lines there will be.
  [[nodiscard]] double chords_wanted(double deviation) const {
    const double step = std::min(greatest_feed(run_) / 60, options_.machine->max_velocity()) *
                        options_.machine->block_period;
    return bends_->chords(0.5 * deviation, 2 * step);
  }

  [[nodiscard]] bool is_hopeless(const PlanOptions& lines) {
    judged_.error = result_.facts.error;
    const Prospect chords{least_time_, chords_wanted(lines.max_deviation),
                          known(lines.max_deviation)};
    const bool hopeless = options_.prefer == Prefer::kTime &&
                          !may_gain(chords, judged_, context_.blocks, options_.prefer);
    passed_over_ = passed_over_ || hopeless;
    return hopeless;
  }

  // Corners between lines, each of which would be more arcs than it has blocks: chords do as well.
  [[nodiscard]] bool arcs_are_hopeless(const geometry::MarkedPieces& curve) {
    const bool hopeless = options_.prefer == Prefer::kTime && options_.output == Form::kAuto &&
                          arcs_for(curve) > static_cast<double>(context_.blocks);
    passed_over_ = passed_over_ || hopeless;
    return hopeless;
  }

  // What no form of the run takes less than, s: `least_time_`, and to start and to stop.
  [[nodiscard]] double least_time_at_rest() const {
    const double speed = std::min(least_feed(run_) / 60, options_.machine->max_velocity());
    const double lost = speed / axis_accelerations(*options_.machine).norm();
    return least_time_ > lost ? least_time_ + lost : least_time_;
  }

  [[nodiscard]] bool keeps_speed(const Times& times) const {
    return batten::postproc::keeps_speed(times, least_time_at_rest());
  }

  // Whether the candidate would be chosen rather than any form at this deviation.
  [[nodiscard]] bool beats_form(const Candidate& candidate, double deviation, double blocks) const {
    const Rival rival{least_time_at_rest(), known(deviation), blocks, 0};
    return beats(candidate, rival, result_, context_, options_);
  }

  // Whether the run must not be cut on one side: then what is written follows the curve closely.
  [[nodiscard]] bool one_sided() const { return options_.side != geometry::Side::kBoth; }

  // `share` of the tolerance belongs to the form; `left` is what the curve leaves.
  void add_candidates(const RunCurve& curve, double share, double left) {
    const geometry::FairPath& fair = curve.path;
    const auto plan_with = [&](double multiple) {
      return PlanOptions{
          options_.target,       options_.machine,       units_,
          context_.before.plane, options_.prefer,        std::min(left, multiple * share),
          keep_corner_angle(),   linearize_of(options_), most_moves_for_accuracy(context_.blocks)};
    };
    if (curves_wanted() && (curve.method == Method::kFair || options_.method != Method::kBest)) {
      add_curves(curve, plan_with);
    }
    if (options_.output == Form::kCurves && has_quick_curves()) return;
    const geometry::MarkedPieces pieces(fair.curve, fair.curve.first(), fair.curve.last());
    Ahead ahead;
    const bool arcs_wanted = options_.output != Form::kLines && !arcs_are_hopeless(pieces);
    // Who asks for few arcs has no use for those that follow the fair curve closely.
    const bool enough = few_wanted() && curve.method == Method::kFair;
    if (arcs_wanted && lies_flat() && !enough && !one_sided()) {
      PlanOptions fine = plan_with(kFineArcs);
      // They are there to be near, not few.
      if (!few_wanted()) fine.arc_effort = geometry::ArcEffort::kBrief;
      ahead.arcs =
          candidate_of(curve, plan_arcs(run_, fair, pieces, *bends_, fine), fine.max_deviation);
    }
    const bool may_leave_out =
        may_leave_out_ && curve.method == Method::kFair && !curves_wanted() && arcs_wanted;
    if (may_leave_out) leave_out_forms(curve, pieces, plan_with, ahead);
    if (arcs_wanted && !ahead.leaves_out_arcs) {
      const PlanOptions arcs = plan_with(one_sided() ? kFineArcs : kArcs);
      push(candidate_of(curve, plan_arcs(run_, fair, pieces, *bends_, arcs), arcs.max_deviation));
    }
    push(std::move(ahead.arcs));
    const bool few = few_wanted() || !run_.arcs.empty();
    if (arcs_wanted && few && !one_sided() && curve.method == Method::kFair) {
      PlanOptions whole = plan_with(kArcs);
      whole.max_deviation = left + fair.deviation;
      add_arc_splines(curve, whole);
    }
    if (options_.output == Form::kArcs || ahead.leaves_out_lines) return;
    if (ahead.lines.empty()) ahead.lines = line_forms(plan_with);
    add_lines(curve, pieces, ahead.lines);
  }

  // Lines that are no further from the curve than the plan says.
  struct LineForm {
    PlanOptions plan;
    std::optional<Candidate> made;
  };

  // Those that are worth looking at, the longest first.
  template <typename PlanWith>
  [[nodiscard]] std::vector<LineForm> line_forms(const PlanWith& plan_with) {
    std::vector<LineForm> forms;
    for (const double multiple : {kLongChords, kMiddleChords, kFineChords}) {
      PlanOptions lines = plan_with(one_sided() ? kFineChords : multiple);
      const double before =
          forms.empty() ? std::numeric_limits<double>::infinity() : forms.back().plan.max_deviation;
      if (lines.max_deviation > kAnother * before || is_hopeless(lines)) continue;
      forms.push_back({lines, {}});
    }
    return forms;
  }

  void make(const RunCurve& curve, const geometry::MarkedPieces& pieces, LineForm& form) const {
    form.made = candidate_of(curve, plan_lines(run_, curve.path, pieces, form.plan),
                             form.plan.max_deviation);
  }

  // But for finer ones that could not be preferred to the best of those before them.
  void add_lines(const RunCurve& curve, const geometry::MarkedPieces& pieces,
                 std::vector<LineForm>& forms) {
    const bool may_leave_out = may_leave_out_ && curve.method == Method::kFair && !curves_wanted();
    std::optional<std::size_t> last;  // of the candidates
    double deviation = 0;
    for (LineForm& form : forms) {
      const double finer = form.plan.max_deviation;
      const bool beaten = may_leave_out && !form.made && last && is_best(*last) &&
                          beats_finer(result_.candidates[*last], deviation, finer);
      result_.left_out = result_.left_out || beaten;
      if (beaten) continue;
      if (!form.made) make(curve, pieces, form);
      if (!form.made) continue;
      last = result_.candidates.size();
      deviation = finer;
      push(std::move(form.made));
    }
  }

  [[nodiscard]] bool is_best(std::size_t candidate) const {
    const Choosing choosing = choose(result_, context_, options_);
    return !choosing.order.empty() && choosing.order.front() == candidate;
  }

  // Whether lines would be chosen rather than finer ones. The kinks of chords go with the root of
  // their deviation.
  [[nodiscard]] bool beats_finer(const Candidate& lines, double deviation, double finer) const {
    constexpr double kEvenLess = 1.1;  // than that: chords differ
    const double time = 0.5 * (lines.times.as_set + lines.times.without_merging);
    Rival rival{time, known(finer), chords_wanted(finer), lines.times.exact_path};
    if (!beats(lines, rival, result_, context_, options_)) return false;
    const double less_kinks = kEvenLess * std::sqrt(deviation / finer);
    rival.exact_path = times_.exact_path_with_less_kinks(lines.moves, less_kinks);
    if (!beats(lines, rival, result_, context_, options_)) return false;
    // Without merging they gain as little as these do.
    const double share = std::min(time / lines.times.as_set, 1.0);
    rival.least_time = std::max(least_time_at_rest(),
                                share * times_.as_set_with_less_kinks(lines.moves, less_kinks));
    return beats(lines, rival, result_, context_, options_);
  }

  // Made before others, to know whether these could be chosen.
  struct Ahead {
    std::optional<Candidate> arcs;  // near to the curve
    std::vector<LineForm> lines;    // some of them made
    bool leaves_out_arcs = false;   // those further away
    bool leaves_out_lines = false;  // all of them
  };

  // The dearest forms are the ones that are seldom chosen: few arcs further away from the curve,
  // where near ones or near lines are as quick, and lines where a few near arcs are.
  template <typename PlanWith>
  void leave_out_forms(const RunCurve& curve, const geometry::MarkedPieces& pieces,
                       const PlanWith& plan_with, Ahead& ahead) {
    const double far = plan_with(kArcs).max_deviation;
    ahead.leaves_out_arcs = ahead.arcs && beats_form(*ahead.arcs, far, 0);
    const auto beats_lines = [&](double multiple) {
      const double deviation = plan_with(multiple).max_deviation;
      return beats_form(*ahead.arcs, deviation, chords_wanted(deviation));
    };
    ahead.leaves_out_lines = ahead.leaves_out_arcs && beats_lines(kLongChords) &&
                             beats_lines(kMiddleChords) && beats_lines(kFineChords);
    const PlanOptions fine = plan_with(kFineChords);
    const bool makes_lines = !ahead.leaves_out_arcs && !is_hopeless(fine) &&
                             fine.max_deviation < plan_with(kMiddleChords).max_deviation;
    if (makes_lines) {
      ahead.lines = line_forms(plan_with);
      make(curve, pieces, ahead.lines.front());
      // Where long ones have many kinks, so have fine ones.
      if (ahead.lines.front().made && !keeps_speed(ahead.lines.front().made->times)) return;
      LineForm& finest = ahead.lines.back();
      if (!finest.made) make(curve, pieces, finest);
      ahead.leaves_out_arcs = finest.made && beats_form(*finest.made, far, 0);
    }
    result_.left_out = result_.left_out || ahead.leaves_out_arcs;
  }

  [[nodiscard]] bool curves_wanted() const {
    const gcode::CurveFormat* format = options_.target->curves();
    if (format == nullptr || !format->complaint(context_.before).empty()) return false;
    return options_.output == Form::kCurves ||
           (options_.output == Form::kAuto && format->is_default());
  }

  [[nodiscard]] bool has_curves() const {
    return std::ranges::any_of(result_.candidates,
                               [](const Candidate& c) { return c.form == OutputForm::kCurves; });
  }

  // Curves that cost no more time than who asks for them by name accepts.
  [[nodiscard]] bool has_quick_curves() const {
    return std::ranges::any_of(result_.candidates, [&](const Candidate& c) {
      return c.form == OutputForm::kCurves && !slower(c.times, result_.facts.times, true, true);
    });
  }

  // With all that the curve leaves of the tolerance, and nearer to the path that was meant.
  template <typename PlanWith>
  void add_curves(const RunCurve& curve, const PlanWith& plan_with) {
    for (const double multiple : {kArcs, kFineArcs}) {
      const PlanOptions options = plan_with(multiple);
      add(curve, plan_curves(run_, curve.path, options), options.max_deviation);
    }
  }

  // Arcs in the band around the vertices themselves. Of arcs no more should come than there were:
  // the search finds one fewer here and there in a band that is a little less wide.
  void add_arc_splines(const RunCurve& curve, const PlanOptions& whole) {
    for (const double part : kBands) {
      PlanOptions band = whole;
      band.max_deviation = part * whole.max_deviation;
      add(curve, plan_arc_spline(run_, curve.path, band), band.max_deviation);
      const bool enough =
          !result_.candidates.empty() && result_.candidates.back().text.blocks <= context_.blocks;
      if (run_.arcs.empty() || enough) return;
    }
  }

  // In a plane across an axis. Helices are dear to find, and a finer chain of them seldom pays.
  [[nodiscard]] bool lies_flat() const {
    for (int axis = 0; axis < 3; ++axis) {
      const double height = run_.points.front()[axis];
      const auto at_height = [&](const geometry::Point3& p) {
        return std::abs(p[axis] - height) <= geometry::kSamePlace;
      };
      if (std::ranges::all_of(run_.points, at_height)) return true;
    }
    return false;
  }

  // How near a form can be said to be to the path that was meant.
  [[nodiscard]] double known(double error) const {
    return std::max(error, kKnown * result_.facts.noise);
  }

  // `error`: mm, moves to curve. The fair curve is the path that was meant; how far the others are
  // from it is not known but for their deviation.
  void add(const RunCurve& curve, const std::optional<OutputPlan>& plan, double error) {
    push(candidate_of(curve, plan, error));
  }

  void push(std::optional<Candidate> candidate) {
    if (candidate) result_.candidates.push_back(std::move(*candidate));
  }

  // Nothing where there is no plan, or the target cannot say it.
  [[nodiscard]] std::optional<Candidate> candidate_of(const RunCurve& curve,
                                                      const std::optional<OutputPlan>& plan,
                                                      double error) const {
    if (!plan) return std::nullopt;
    auto text = write_run(*plan, run_, context_.program, *options_.target, state_before(),
                          context_.after, context_.line_end);
    if (!text || !take_numbers(text->text)) return std::nullopt;
    Candidate candidate;
    candidate.method = name_of(curve.method);
    candidate.form = plan->form;
    const bool meant = curve.method == Method::kFair;
    if (plan->error > 0) error = plan->error;
    candidate.error = known(meant ? error : error + curve.path.deviation);
    candidate.max_curvature = bends_->greatest();
    std::vector<TimedPiece> moves = timed_pieces(*plan);
    if (!run_.arcs.empty()) candidate.kink = greatest_kink(moves);
    candidate.times = times_.of_candidate(moves, text->blocks, result_.facts.times,
                                          compares_kinks(options_), options_.output != Form::kAuto);
    candidate.text = std::move(*text);
    candidate.moves = std::move(moves);
    return candidate;
  }

  // False where there are not enough of them. The comment that says what was done takes one too.
  [[nodiscard]] bool take_numbers(std::string& text) const {
    const NumberRoom& numbers = context_.numbers;
    if (!numbers.first) return true;
    if (numbered_lines(text) + 1 > numbers.blocks) return false;
    text = with_numbers(text, *numbers.first);
    return true;
  }

  // Behind words of a profile the run says its motion and its feed itself.
  [[nodiscard]] gcode::ModalState state_before() const {
    gcode::ModalState before = context_.before;
    if (!options_.words.before_run.empty()) {
      before.motion = gcode::MotionMode::kUnknown;
      before.feed.reset();
    }
    return before;
  }

  // Nothing is compared: what is told of the run is the time that it takes.
  SmoothedRun kept_unasked(const std::vector<TimedPiece>& motions) {
    result_.facts.times.as_set = times_.as_set_of_run(motions);
    return kept(gcode::reason::kMethodNone);
  }

  SmoothedRun kept(std::string_view reason) {
    result_.reason = reason;
    return std::move(result_);
  }

  const Run& run_;
  const RunContext& context_;
  const SmoothOptions& options_;
  bool may_leave_out_;
  gcode::Units units_;
  RunTimes times_;
  double least_time_ = 0;
  RunFacts judged_;                  // what a gain is measured by before the candidates are there
  bool passed_over_ = false;         // a candidate that could not gain was not made
  bool fits_ = false;                // a method found a curve inside the tolerance
  std::optional<CurveBends> bends_;  // of the curve that candidates are made of
  SmoothedRun result_;
};

}  // namespace

std::vector<TimedPiece> timed_pieces(const Run& run, std::size_t first, std::size_t last) {
  std::vector<TimedPiece> pieces;
  std::size_t next = 0;
  double feed = 0;
  gcode::reserve_in_large_pages(pieces, last - first);
  MotionWalk walk(run, first, last);
  while (auto motion = walk.next()) {
    while (next < run.feeds.size() && run.feeds[next].vertex <= motion->first) {
      feed = run.feeds[next++].feed;
    }
    pieces.push_back({std::move(motion->piece), feed});
  }
  return pieces;
}

SmoothedRun smooth_run(const Run& run, const RunContext& context, const SmoothOptions& options,
                       Making making) {
  return RunSmoother(run, context, options, making).smooth();
}

}  // namespace batten::postproc
