#include "postproc/smooth/curve_forms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "gcode/curves/curve_format.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/selection/selection.h"

namespace batten::postproc {

std::optional<Candidate> make_candidate(const RunTask& task, const RunTimes& times,
                                        const OutputPlan& plan, const Times& old) {
  const auto& [run, context, options, scope] = task;
  gcode::ModalState before = context.before;
  if (!options.words.before_run.empty()) {  // after words of a profile it says motion and feed
    before.motion = gcode::MotionMode::kUnknown;
    before.feed.reset();
  }
  auto text = write_run(plan, run, context.program, *options.target, before, context.after,
                        context.line_end);
  if (!text) return std::nullopt;
  if (context.numbers.first) {
    // The comment that says what was done takes a number, too.
    if (numbered_lines(text->text) + 1 > context.numbers.blocks) return std::nullopt;
    text->text = with_numbers(text->text, *context.numbers.first);
  }
  Candidate candidate;
  candidate.form = plan.form;
  candidate.chords_for_steps = plan.chords_for_steps;
  for (const PlannedMove& move : plan.moves) candidate.moves.push_back({move.piece, move.feed});
  if (!run.arcs.empty()) candidate.kink = greatest_kink(candidate.moves);
  candidate.times = times.of_candidate(candidate.moves, text->blocks, old, compares_kinks(options),
                                       options.output != Form::kAuto);
  candidate.text = std::move(*text);
  return candidate;
}

namespace {

bool curves_wanted(const RunTask& task) {
  const SmoothOptions& options = task.options;
  const gcode::CurveFormat* format = options.target->curves;
  if (format == nullptr || !may_start(*format, task.context.before)) return false;
  return options.output == Form::kCurves || (options.output == Form::kAuto && format->is_default);
}

class CurveForms {
 public:
  CurveForms(const RunTask& task, const RunTimes& times, const CandidateBounds& bounds,
             const CurveOfRun& given, SmoothedRun& result)
      : task_(task),
        times_(times),
        bounds_(bounds),
        curve_(given.curve),
        bends_(given.bends),
        share_(given.share),
        left_(given.left),
        few_wanted_(wants_few_moves(task.options)),
        one_sided_(task.options.side != geometry::Side::kBoth),
        pieces_(curve_.path.curve),
        result_(result) {}

  void add() {
    const SmoothOptions& options = task_.options;
    const bool is_fair = curve_.method == Method::kFair;
    if (curves_wanted(task_) && (is_fair || options.method != Method::kBest)) add_curves();
    if (options.output == Form::kCurves && has_quick_curves()) return;
    bool arcs_wanted = options.output != Form::kLines;
    if (arcs_wanted && bounds_.arcs_are_hopeless(pieces_)) {
      result_.passed_over = true;
      arcs_wanted = false;
    }
    if (arcs_wanted) near_arcs_ = near_arcs();
    if (arcs_wanted && may_leave_out()) look_ahead();
    if (arcs_wanted && !leaves_out_arcs_) {
      push(made_arcs(plan_with(one_sided_ ? kFormTuning.fine_arcs : kFormTuning.arcs)));
    }
    push(std::move(near_arcs_));
    const bool few = few_wanted_ || !task_.run.arcs.empty();
    if (arcs_wanted && few && !one_sided_ && is_fair) add_arc_splines();
    if (options.output == Form::kArcs || leaves_out_lines_) return;
    if (lines_.empty()) find_line_forms();
    add_lines();
  }

 private:
  // Lines that are no further from the curve than the plan says.
  struct LineForm {
    PlanOptions plan;
    std::optional<Candidate> made;
  };

  void push(std::optional<Candidate> candidate) {
    if (candidate) result_.candidates.push_back(std::move(*candidate));
  }

  [[nodiscard]] LinesAhead lines_ahead(double deviation) const { return {bends_, deviation}; }

  [[nodiscard]] PlanOptions plan_with(double multiple) const {
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
  [[nodiscard]] std::optional<Candidate> made(const std::optional<OutputPlan>& plan,
                                              double error) const {
    if (!plan) return std::nullopt;
    auto candidate = make_candidate(task_, times_, *plan, bounds_.facts().times);
    if (!candidate) return std::nullopt;
    if (plan->error > 0) error = plan->error;
    if (curve_.method != Method::kFair) error += curve_.path.deviation;
    candidate->method = name_of(curve_.method);
    candidate->error = bounds_.known(error);
    candidate->max_curvature = bends_.greatest();
    return candidate;
  }

  // With all that the curve leaves of the tolerance, and nearer to the path that was meant.
  void add_curves() {
    for (const double multiple : {kFormTuning.arcs, kFormTuning.fine_arcs}) {
      const PlanOptions options = plan_with(multiple);
      push(made(plan_curves(task_.run, curve_.path, options), options.max_deviation));
    }
  }

  // Whether there are some that cost no more time than who asks for them by name accepts.
  [[nodiscard]] bool has_quick_curves() const {
    return std::ranges::any_of(result_.candidates, [&](const Candidate& c) {
      return c.form == Form::kCurves && !slower(c.times, result_.facts.times, true, true);
    });
  }

  [[nodiscard]] std::optional<Candidate> made_arcs(const PlanOptions& options) const {
    return made(plan_arcs(task_.run, curve_.path, pieces_, bends_, options), options.max_deviation);
  }

  [[nodiscard]] std::optional<Candidate> near_arcs() const {
    // Who asks for few arcs has no use for those that follow the fair curve closely. Helices are
    // dear to find, and a finer chain of them seldom pays.
    const bool enough = few_wanted_ && curve_.method == Method::kFair;
    const bool is_flat =
        lies_across(task_.run, 0) || lies_across(task_.run, 1) || lies_across(task_.run, 2);
    if (enough || one_sided_ || !is_flat) return std::nullopt;
    PlanOptions fine = plan_with(kFormTuning.fine_arcs);
    // They are there to be near, not few.
    if (!few_wanted_) fine.arc_effort = geometry::ArcEffort::kBrief;
    return made_arcs(fine);
  }

  // Arcs in the band around the vertices themselves. Of arcs no more should come than there were:
  // the search finds one fewer here and there in a band that is a little less wide.
  void add_arc_splines() {
    const double whole = left_ + curve_.path.deviation;
    for (const double part : kFormTuning.bands) {
      PlanOptions band = plan_with(kFormTuning.arcs);
      band.max_deviation = part * whole;
      push(made(plan_arc_spline(task_.run, curve_.path, band), band.max_deviation));
      const bool enough = !result_.candidates.empty() &&
                          result_.candidates.back().text.blocks <= task_.context.blocks;
      if (task_.run.arcs.empty() || enough) return;
    }
  }

  // Those that are worth looking at, the longest first.
  void find_line_forms() {
    double before = std::numeric_limits<double>::infinity();
    for (const double multiple : kFormTuning.chords) {
      const PlanOptions lines = plan_with(one_sided_ ? kFormTuning.chords[2] : multiple);
      if (lines.max_deviation > kFormTuning.another * before || is_hopeless(lines)) continue;
      before = lines.max_deviation;
      lines_.push_back({lines, {}});
    }
  }

  [[nodiscard]] bool is_hopeless(const PlanOptions& lines) {
    const bool hopeless = bounds_.are_hopeless(lines_ahead(lines.max_deviation));
    result_.passed_over = result_.passed_over || hopeless;
    return hopeless;
  }

  void make(LineForm& form) const {
    if (form.made) return;
    form.made =
        made(plan_lines(task_.run, curve_.path, pieces_, form.plan), form.plan.max_deviation);
  }

  // But for finer ones that could not be preferred to the best of those before them.
  void add_lines() {
    std::optional<std::size_t> last;  // of the candidates
    double deviation = 0;
    for (LineForm& form : lines_) {
      if (!form.made && last && are_beaten(form, *last, deviation)) {
        result_.left_out = true;
        continue;
      }
      make(form);
      if (!form.made) continue;
      last = result_.candidates.size();
      deviation = form.plan.max_deviation;
      push(std::move(form.made));
    }
  }

  [[nodiscard]] bool are_beaten(const LineForm& finer, std::size_t last, double deviation) const {
    if (!may_leave_out()) return false;
    const Selection selection = choose(result_, task_.context, task_.options);
    return !selection.order.empty() && selection.order.front() == last &&
           bounds_.beats_finer(result_.candidates[last], deviation,
                               lines_ahead(finer.plan.max_deviation));
  }

  // Only of what is wanted for its time and alone: of a piece nobody knows what its neighbours will
  // be.
  [[nodiscard]] bool may_leave_out() const {
    const SmoothOptions& options = task_.options;
    return task_.scope == CandidateScope::kToChoose && options.prefer == Prefer::kTime &&
           options.output == Form::kAuto && !one_sided_ && task_.run.arcs.empty() &&
           !task_.context.is_piece() && curve_.method == Method::kFair && !curves_wanted(task_);
  }

  // The dearest forms are the ones that are seldom chosen: few arcs further away from the curve,
  // where near ones or near lines are as quick, and lines where a few near arcs are.
  void look_ahead() {
    const double far = plan_with(kFormTuning.arcs).max_deviation;
    leaves_out_arcs_ = near_arcs_ && bounds_.beats_form(*near_arcs_, far, 0);
    result_.left_out = result_.left_out || leaves_out_arcs_;
    if (leaves_out_arcs_) {
      leaves_out_lines_ = std::ranges::all_of(kFormTuning.chords, [&](double multiple) {
        return bounds_.beats_lines(*near_arcs_, lines_ahead(plan_with(multiple).max_deviation));
      });
      return;
    }
    const PlanOptions fine = plan_with(kFormTuning.chords[2]);
    if (is_hopeless(fine) || fine.max_deviation >= plan_with(kFormTuning.chords[1]).max_deviation) {
      return;
    }
    find_line_forms();
    make(lines_.front());
    // Where long ones have many kinks, so have fine ones.
    const auto& longest = lines_.front().made;
    if (longest && !bounds_.keeps_speed(longest->times)) return;
    LineForm& finest = lines_.back();
    make(finest);
    leaves_out_arcs_ = finest.made && bounds_.beats_form(*finest.made, far, 0);
    result_.left_out = result_.left_out || leaves_out_arcs_;
  }

  const RunTask& task_;
  const RunTimes& times_;
  const CandidateBounds& bounds_;
  const RunCurve& curve_;
  const CurvatureProfile& bends_;
  double share_;
  double left_;
  bool few_wanted_;
  bool
      one_sided_;  // the run must not be cut on one side: what is written follows the curve closely
  geometry::MarkedPieces pieces_;
  SmoothedRun& result_;
  // Made before others, to know whether these could be chosen: arcs near to the curve, and some of
  // the lines.
  std::optional<Candidate> near_arcs_;
  std::vector<LineForm> lines_;
  bool leaves_out_arcs_ = false;   // those further away
  bool leaves_out_lines_ = false;  // all of them
};

}  // namespace

void add_forms(const RunTask& task, const RunTimes& times, const CandidateBounds& bounds,
               const CurveOfRun& curve, SmoothedRun& result) {
  CurveForms(task, times, bounds, curve, result).add();
}

}  // namespace batten::postproc
