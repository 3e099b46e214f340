#include "postproc/smooth/curve_forms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "gcode/curves/curve_format.h"
#include "geometry/basic/rounding.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/selection/selection.h"

namespace batten::postproc {

namespace {

std::vector<TimedPiece> timed_pieces(const OutputPlan& plan) {
  std::vector<TimedPiece> pieces;
  pieces.reserve(plan.moves.size());
  for (const PlannedMove& move : plan.moves) pieces.push_back({move.piece, move.feed});
  return pieces;
}

}  // namespace

std::optional<Candidate> CandidateMaker::make(const OutputPlan& plan, const Times& old) const {
  const auto& [run, context, options, scope] = task_;
  auto text = write_run(plan, run, context.program, *options.target, state_before(), context.after,
                        context.line_end);
  if (!text || !take_numbers(text->text)) return std::nullopt;
  Candidate candidate;
  candidate.form = plan.form;
  candidate.chords_for_steps = plan.chords_for_steps;
  candidate.moves = timed_pieces(plan);
  if (!run.arcs.empty()) candidate.kink = greatest_kink(candidate.moves);
  candidate.times = times_.of_candidate(candidate.moves, text->blocks, old, compares_kinks(options),
                                        options.output != Form::kAuto);
  candidate.text = std::move(*text);
  return candidate;
}

// False where there are not enough of them. The comment that says what was done takes one too.
bool CandidateMaker::take_numbers(std::string& text) const {
  const LineNumberRange& numbers = task_.context.numbers;
  if (!numbers.first) return true;
  if (numbered_lines(text) + 1 > numbers.blocks) return false;
  text = with_numbers(text, *numbers.first);
  return true;
}

// Behind words of a profile the run says its motion and its feed itself.
gcode::ModalState CandidateMaker::state_before() const {
  gcode::ModalState before = task_.context.before;
  if (!task_.options.words.before_run.empty()) {
    before.motion = gcode::MotionMode::kUnknown;
    before.feed.reset();
  }
  return before;
}

namespace {

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

// Parts of the band around a run of arcs in which few arcs are looked for.
constexpr double kBands[] = {1, 0.97, 0.94};

void push(std::optional<Candidate> candidate, SmoothedRun& result) {
  if (candidate) result.candidates.push_back(std::move(*candidate));
}

// In a plane across an axis. Helices are dear to find, and a finer chain of them seldom pays.
bool lies_flat(const Run& run) {
  for (int axis = 0; axis < 3; ++axis) {
    const double height = run.points.front()[axis];
    const auto at_height = [&](const geometry::Point3& p) {
      return std::abs(p[axis] - height) <= geometry::kSamePlace;
    };
    if (std::ranges::all_of(run.points, at_height)) return true;
  }
  return false;
}

bool is_best(std::size_t candidate, const RunTask& task, const SmoothedRun& result) {
  const Selection selection = choose(result, task.context, task.options);
  return !selection.order.empty() && selection.order.front() == candidate;
}

}  // namespace

bool curves_wanted(const RunTask& task) {
  const SmoothOptions& options = task.options;
  const gcode::CurveFormat* format = options.target->curves;
  if (format == nullptr || !may_start(*format, task.context.before)) return false;
  return options.output == Form::kCurves || (options.output == Form::kAuto && format->is_default);
}

CurveForms::CurveForms(const RunTask& task, const CandidateMaker& maker,
                       const CandidateBounds& bounds, const RunCurve& curve,
                       const CurvatureProfile& bends, double share, double left)
    : task_(task),
      maker_(maker),
      bounds_(bounds),
      curve_(curve),
      bends_(bends),
      share_(share),
      left_(left),
      few_wanted_(wants_few_moves(task.options)),
      one_sided_(task.options.side != geometry::Side::kBoth),
      pieces_(curve.path.curve, curve.path.curve.first(), curve.path.curve.last()) {}

void CurveForms::add_to(SmoothedRun& result) {
  const SmoothOptions& options = task_.options;
  const bool is_fair = curve_.method == Method::kFair;
  if (curves_wanted(task_) && (is_fair || options.method != Method::kBest)) add_curves(result);
  if (options.output == Form::kCurves && has_quick_curves(result)) return;
  const bool hopeless_arcs = options.output != Form::kLines && bounds_.arcs_are_hopeless(pieces_);
  result.passed_over = result.passed_over || hopeless_arcs;
  const bool arcs_wanted = options.output != Form::kLines && !hopeless_arcs;
  Ahead ahead;
  if (arcs_wanted) ahead.arcs = near_arcs();
  if (may_leave_out() && arcs_wanted) ahead = look_ahead(std::move(ahead.arcs), result);
  if (arcs_wanted && !ahead.leaves_out_arcs) {
    push(made_arcs(plan_with(one_sided_ ? kFineArcs : kArcs)), result);
  }
  push(std::move(ahead.arcs), result);
  const bool few = few_wanted_ || !task_.run.arcs.empty();
  if (arcs_wanted && few && !one_sided_ && is_fair) add_arc_splines(result);
  if (options.output == Form::kArcs || ahead.leaves_out_lines) return;
  if (ahead.lines.empty()) ahead.lines = line_forms(result);
  add_lines(ahead.lines, result);
}

PlanOptions CurveForms::plan_with(double multiple) const {
  const auto& [run, context, options, scope] = task_;
  return {options.target,
          options.machine,
          context.before.units,
          context.before.plane,
          options.prefer,
          std::min(left_, multiple * share_),
          keep_corner_angle_of(options),
          linearize_of(options),
          most_moves_for_accuracy(context.blocks)};
}

// `error`: mm, moves to curve. The fair curve is the path that was meant; how far the others are
// from it is not known but for their deviation.
std::optional<Candidate> CurveForms::made(const std::optional<OutputPlan>& plan,
                                          double error) const {
  if (!plan) return std::nullopt;
  auto candidate = maker_.make(*plan, bounds_.facts().times);
  if (!candidate) return std::nullopt;
  if (plan->error > 0) error = plan->error;
  if (curve_.method != Method::kFair) error += curve_.path.deviation;
  candidate->method = name_of(curve_.method);
  candidate->error = bounds_.known(error);
  candidate->max_curvature = bends_.greatest();
  return candidate;
}

// With all that the curve leaves of the tolerance, and nearer to the path that was meant.
void CurveForms::add_curves(SmoothedRun& result) const {
  for (const double multiple : {kArcs, kFineArcs}) {
    const PlanOptions options = plan_with(multiple);
    push(made(plan_curves(task_.run, curve_.path, options), options.max_deviation), result);
  }
}

// Whether there are some that cost no more time than who asks for them by name accepts.
bool CurveForms::has_quick_curves(const SmoothedRun& result) const {
  return std::ranges::any_of(result.candidates, [&](const Candidate& c) {
    return c.form == OutputForm::kCurves && !slower(c.times, result.facts.times, true, true);
  });
}

std::optional<Candidate> CurveForms::made_arcs(const PlanOptions& options) const {
  return made(plan_arcs(task_.run, curve_.path, pieces_, bends_, options), options.max_deviation);
}

std::optional<Candidate> CurveForms::near_arcs() const {
  // Who asks for few arcs has no use for those that follow the fair curve closely.
  const bool enough = few_wanted_ && curve_.method == Method::kFair;
  if (enough || one_sided_ || !lies_flat(task_.run)) return std::nullopt;
  PlanOptions fine = plan_with(kFineArcs);
  // They are there to be near, not few.
  if (!few_wanted_) fine.arc_effort = geometry::ArcEffort::kBrief;
  return made_arcs(fine);
}

// Arcs in the band around the vertices themselves. Of arcs no more should come than there were:
// the search finds one fewer here and there in a band that is a little less wide.
void CurveForms::add_arc_splines(SmoothedRun& result) const {
  const double whole = left_ + curve_.path.deviation;
  for (const double part : kBands) {
    PlanOptions band = plan_with(kArcs);
    band.max_deviation = part * whole;
    push(made(plan_arc_spline(task_.run, curve_.path, band), band.max_deviation), result);
    const bool enough =
        !result.candidates.empty() && result.candidates.back().text.blocks <= task_.context.blocks;
    if (task_.run.arcs.empty() || enough) return;
  }
}

// Those that are worth looking at, the longest first.
std::vector<CurveForms::LineForm> CurveForms::line_forms(SmoothedRun& result) const {
  std::vector<LineForm> forms;
  for (const double multiple : {kLongChords, kMiddleChords, kFineChords}) {
    PlanOptions lines = plan_with(one_sided_ ? kFineChords : multiple);
    const double before =
        forms.empty() ? std::numeric_limits<double>::infinity() : forms.back().plan.max_deviation;
    if (lines.max_deviation > kAnother * before || is_hopeless(lines, result)) continue;
    forms.push_back({lines, {}});
  }
  return forms;
}

bool CurveForms::is_hopeless(const PlanOptions& lines, SmoothedRun& result) const {
  const bool hopeless = bounds_.are_hopeless(lines_ahead(lines.max_deviation));
  result.passed_over = result.passed_over || hopeless;
  return hopeless;
}

void CurveForms::make(LineForm& form) const {
  form.made = made(plan_lines(task_.run, curve_.path, pieces_, form.plan), form.plan.max_deviation);
}

// But for finer ones that could not be preferred to the best of those before them.
void CurveForms::add_lines(std::vector<LineForm>& forms, SmoothedRun& result) const {
  std::optional<std::size_t> last;  // of the candidates
  double deviation = 0;
  for (LineForm& form : forms) {
    if (!form.made && are_beaten(form, last, deviation, result)) {
      result.left_out = true;
      continue;
    }
    if (!form.made) make(form);
    if (!form.made) continue;
    last = result.candidates.size();
    deviation = form.plan.max_deviation;
    push(std::move(form.made), result);
  }
}

bool CurveForms::are_beaten(const LineForm& finer, std::optional<std::size_t> last,
                            double deviation, const SmoothedRun& result) const {
  return may_leave_out() && last && is_best(*last, task_, result) &&
         bounds_.beats_finer(result.candidates[*last], deviation,
                             lines_ahead(finer.plan.max_deviation));
}

// Only of what is wanted for its time and alone: of a piece nobody knows what its neighbours will
// be.
bool CurveForms::may_leave_out() const {
  const SmoothOptions& options = task_.options;
  return task_.scope == CandidateScope::kToChoose && options.prefer == Prefer::kTime &&
         options.output == Form::kAuto && !one_sided_ && task_.run.arcs.empty() &&
         !task_.context.is_piece() && curve_.method == Method::kFair && !curves_wanted(task_);
}

// The dearest forms are the ones that are seldom chosen: few arcs further away from the curve,
// where near ones or near lines are as quick, and lines where a few near arcs are.
CurveForms::Ahead CurveForms::look_ahead(std::optional<Candidate> arcs, SmoothedRun& result) const {
  Ahead ahead{std::move(arcs), {}, false, false};
  const double far = plan_with(kArcs).max_deviation;
  ahead.leaves_out_arcs = ahead.arcs && bounds_.beats_form(*ahead.arcs, far, 0);
  const auto beats_lines = [&](double multiple) {
    return bounds_.beats_lines(*ahead.arcs, lines_ahead(plan_with(multiple).max_deviation));
  };
  ahead.leaves_out_lines = ahead.leaves_out_arcs && beats_lines(kLongChords) &&
                           beats_lines(kMiddleChords) && beats_lines(kFineChords);
  const PlanOptions fine = plan_with(kFineChords);
  const bool makes_lines = !ahead.leaves_out_arcs && !is_hopeless(fine, result) &&
                           fine.max_deviation < plan_with(kMiddleChords).max_deviation;
  if (makes_lines) {
    ahead.lines = line_forms(result);
    make(ahead.lines.front());
    // Where long ones have many kinks, so have fine ones.
    if (ahead.lines.front().made && !bounds_.keeps_speed(ahead.lines.front().made->times)) {
      return ahead;
    }
    LineForm& finest = ahead.lines.back();
    if (!finest.made) make(finest);
    ahead.leaves_out_arcs = finest.made && bounds_.beats_form(*finest.made, far, 0);
  }
  result.left_out = result.left_out || ahead.leaves_out_arcs;
  return ahead;
}

}  // namespace batten::postproc
