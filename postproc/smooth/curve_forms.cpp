#include "postproc/smooth/curve_forms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "gcode/controls/arc_rules.h"
#include "gcode/curves/curve_format.h"
#include "geometry/basic/operations.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/forms/slow_parts.h"
#include "postproc/smooth/selection/selection.h"

namespace batten::postproc {

std::optional<Candidate> make_candidate(const RunTask& task, const RunTimes& times,
                                        const OutputPlan& plan, const RunFacts& facts,
                                        std::span<const Candidate> there) {
  const auto& [run, context, options, scope, memo] = task;
  gcode::ModalState before = context.before;
  if (!options.words.before_run.empty()) {  // after words of a profile it says motion and feed
    before.motion = gcode::MotionMode::kUnknown;
    before.feed.reset();
  }
  geometry::count_operations(100 * plan.moves.size());
  auto text = write_run(plan, run, context.program, *options.target, before, context.after,
                        context.line_end);
  if (!text) return std::nullopt;
  if (context.numbers.first) {
    // The comment that says what was done takes a number, too.
    if (numbered_lines(text->text) + 1 > context.numbers.blocks) return std::nullopt;
    text->text = with_numbers(text->text, *context.numbers.first);
  }
  if (std::ranges::any_of(there, [&](const Candidate& c) { return c.text.text == text->text; })) {
    return std::nullopt;
  }
  Candidate candidate;
  candidate.form = plan.form;
  candidate.chords_for_steps = plan.chords_for_steps;
  candidate.arcs_as_chords = plan.arcs_as_chords;
  std::vector<TimedPiece> moves = std::move(text->moves);
  Figures& figures = candidate.figures;
  figures.times = times.of_candidate(moves, facts.scale.original.times);
  figures.blocks = static_cast<double>(text->blocks);
  figures.bytes = static_cast<double>(text->text.size());
  figures.roughness = roughness_of(moves);
  candidate.text = std::move(*text);
  if (context.is_piece() || memo != nullptr) candidate.moves = std::move(moves);
  return candidate;
}

namespace {

bool curves_wanted(const RunTask& task) {
  const SmoothOptions& options = task.options;
  const gcode::CurveFormat* format = options.target->curves;
  if (format == nullptr || !may_start(*format, task.context.before)) return false;
  return options.output == Form::kCurves ||
         (options.output == Form::kAuto && options.target->curves_in_auto);
}

// A form that could be made, and what it has at least.
struct Offer {
  Form form = Form::kLines;
  double blocks = 0;    // about
  double distance = 0;  // mm, rms from the path that was meant
  PlanOptions options;
  ArcsAlong arcs = ArcsAlong::kCurve;
};

// Of the offer that was made last: its plan, and what of it is slow.
struct PlanOfLast {
  std::optional<OutputPlan> plan;
  std::vector<double> lost;
  std::optional<std::vector<SlowPart>> slow;
};

class CurveForms {
 public:
  CurveForms(const FormSetting& setting, const CurveOfRun& given, SmoothedRun& result)
      : setting_(setting),
        task_(setting.task),
        curve_(given.curve),
        bends_(given.bends),
        share_(given.share),
        left_(given.left),
        is_first_(given.is_first),
        one_sided_(setting.task.options.side != geometry::Side::kBoth),
        pieces_(curve_.path.curve),
        result_(result),
        first_(result.candidates.size()) {}

  void add() {
    const Form wanted = task_.options.output;
    const bool is_fair = curve_.method == Method::kFair;
    if (curves_wanted(task_)) offer_curves();
    if (wanted == Form::kCurves) {
      make_best();
      if (has_form(Form::kCurves)) return;
    }
    if (wanted != Form::kLines && is_fair && is_first_) offer_line_arcs();
    if (wanted != Form::kLines) offer_arcs();
    if (wanted != Form::kLines && is_fair && is_first_) offer_arc_splines();
    if (wanted != Form::kArcs) offer_lines();
    make_best();
  }

 private:
  [[nodiscard]] const RunFacts& facts() const { return result_.facts; }
  [[nodiscard]] double distance_before() const { return std::max(facts().off, facts().scale.near); }

  [[nodiscard]] bool has_form(Form form) const {
    return std::ranges::any_of(result_.candidates,
                               [&](const Candidate& c) { return c.form == form; });
  }

  // Whether there is a candidate of this curve, or one of the form that is asked for by name.
  [[nodiscard]] bool has_one() const {
    const Form wanted = task_.options.output;
    return wanted == Form::kAuto ? result_.candidates.size() > first_ : has_form(wanted);
  }

  // In the order in which they were offered, but for those that what there is then beats.
  void make_best() {
    const bool all = task_.scope == CandidateScope::kAll;
    for (Offer& offer : offers_) {
      if (!all && setting_.bounds.is_beaten(offer.form, offer.blocks, offer.distance)) {
        result_.left_out = true;
        continue;
      }
      if (is_bounded(task_) && setting_.budget.is_spent() && has_one()) {
        result_.left_out = result_.is_cut_short = true;
        continue;
      }
      if (!all && offer.form == Form::kArcs && task_.memo == nullptr) {
        offer.options.most_arcs = setting_.bounds.most_blocks(offer.form, offer.distance);
      }
      last_ = {};
      auto candidate = made(offer);
      const bool limited = offer.options.most_arcs < PlanOptions().most_arcs;
      if (candidate) {
        result_.candidates.push_back(std::move(*candidate));
        put_run_where_slower(offer);
      } else if (limited) {
        result_.left_out = true;  // there may be more arcs than these
      }
    }
    offers_.clear();
  }

  // The last candidate again, with the run where it is slower: at its ends, or else everywhere, and
  // only as much of it as it takes; where it is slower then by next to nothing. Not of a form that
  // is asked for by name.
  void put_run_where_slower(Offer offer) {
    const Figures slower = result_.candidates.back().figures;
    if (offer.form == Form::kCurves || !task_.run.bends.empty()) return;
    if (is_forced(offer.form, facts(), task_.options)) return;
    if (!is_slower(slower.times, facts().scale.original.times, facts().scale.period)) return;
    if (offer.form == Form::kArcs && may_lead(offer.form, slower) &&
        is_added_with_run(offer, RunInPlace::kAtEnds)) {
      return;
    }
    if (!may_be_mended(slower, offer)) return;
    slower_by_ = slower.times.programmed - facts().scale.original.times.programmed;
    if (is_added_with_run(offer, RunInPlace::kEverywhere)) {
      is_added_with_run(offer, RunInPlace::kWhereNeeded);
    }
  }

  // Where it is as fast as the run, but for next to nothing. What was meant may be slower by as much
  // as any form.
  bool is_added_with_run(Offer offer, RunInPlace where) {
    offer.options.run_in_place = where;
    auto candidate = made(offer);
    if (!candidate) return false;
    candidate->has_run_in_place = where != RunInPlace::kAtEnds;
    const double before = facts().scale.original.times.programmed;
    const double part = offer.arcs == ArcsAlong::kVertices ? kCost.longer : kCost.mended;
    const double more = std::max(facts().scale.period, part * before);
    if (candidate->figures.times.programmed > before + more) return false;
    result_.candidates.push_back(std::move(*candidate));
    return true;
  }

  // Whether it could be the best, were it as fast as any form.
  [[nodiscard]] bool may_lead(Form form, const Figures& figures) const {
    if (task_.scope == CandidateScope::kAll || task_.memo != nullptr) return true;
    const double distance = std::min(figures.distance, facts().scale.original.distance);
    return !setting_.bounds.is_beaten(form, figures.blocks, distance);
  }

  // Whether it could be the best, lost it no time against the run.
  bool may_be_mended(Figures mended, const Offer& offer) {
    if (task_.scope == CandidateScope::kAll || task_.memo != nullptr) return true;
    const Figures& before = facts().scale.original;
    for (const double lost : lost_by_last_plan(offer)) {
      mended.times.programmed -= std::max(lost, 0.0);
    }
    mended.blocks = std::min(mended.blocks, before.blocks);
    mended.bytes = std::min(mended.bytes, before.bytes);
    mended.distance = std::min(mended.distance, before.distance);
    mended.roughness = std::min(mended.roughness, before.roughness);
    return cost_of(mended, facts().scale, task_.options.prefer) <
           cost_to_beat(result_, task_.options);
  }

  [[nodiscard]] const SlowParts& slow_parts() {
    if (!slow_parts_) {
      slow_parts_.emplace(task_.run, curve_.path, *task_.options.machine, task_.context.after.path);
    }
    return *slow_parts_;
  }

  // See SlowParts::lost. `offer`: the last one that there is a candidate of.
  [[nodiscard]] const std::vector<double>& lost_by_last_plan(const Offer& offer) {
    if (!last_.plan) last_.plan = plan_of(offer);  // the candidate was made for another setting
    if (last_.lost.empty()) last_.lost = slow_parts().lost(last_.plan.value());
    return last_.lost;
  }

  [[nodiscard]] std::optional<Candidate> made(const Offer& offer) {
    if (task_.memo == nullptr) return newly_made(offer);
    const RunMemo::PlanKey key{curve_.number, offer.form, offer.arcs, offer.options};
    return task_.memo->candidates.get(key, [&](std::size_t) {
      auto candidate = newly_made(offer);
      if (candidate) candidate->text.text.clear();
      return candidate;
    });
  }

  [[nodiscard]] std::optional<OutputPlan> plan_of(const Offer& offer) {
    const Run& run = task_.run;
    if (offer.options.run_in_place != RunInPlace::kNowhere) return with_run_in(offer);
    if (offer.form == Form::kCurves) return plan_curves(run, curve_.path, offer.options);
    if (offer.form == Form::kLines) return plan_lines(run, curve_.path, pieces_, offer.options);
    switch (offer.arcs) {
      case ArcsAlong::kVertices:
        return plan_line_arcs(setting_.shape.value(), run, curve_.path, offer.options);
      case ArcsAlong::kBand:
        return plan_arc_spline(run, curve_.path, offer.options);
      case ArcsAlong::kCurve:
        break;
    }
    return plan_arcs(run, curve_.path, pieces_, bends_, offer.options);
  }

  [[nodiscard]] std::optional<OutputPlan> with_run_in(Offer offer) {
    const RunInPlace where = std::exchange(offer.options.run_in_place, RunInPlace::kNowhere);
    if (where == RunInPlace::kAtEnds) {
      if (!last_.plan) last_.plan = plan_of(offer);
      return slow_parts().with_run_at_ends(last_.plan.value());
    }
    const std::vector<double>& lost = lost_by_last_plan(offer);
    if (!last_.slow) last_.slow = slow_parts().find(*last_.plan, lost);
    const bool all = where == RunInPlace::kEverywhere;
    return slow_parts().with_run(*last_.plan,
                                 all ? *last_.slow : enough_of(*last_.slow, slower_by_));
  }

  [[nodiscard]] std::optional<Candidate> newly_made(const Offer& offer) {
    const std::optional<OutputPlan> plan = plan_of(offer);
    if (!plan) return std::nullopt;
    if (offer.options.run_in_place == RunInPlace::kNowhere) last_.plan = plan;
    auto candidate = make_candidate(task_, setting_.times, *plan, facts(), result_.candidates);
    if (!candidate) return std::nullopt;
    candidate->method = name_of(curve_.method);
    candidate->max_curvature = bends_.greatest();
    candidate->rounds_seam = curve_.path.rounds_seam && offer.arcs == ArcsAlong::kCurve;
    const double off = setting_.meant.distance_of(plan->moves, curve_.path);
    candidate->figures.distance = std::hypot(off, facts().scale.printed);
    if (task_.scope == CandidateScope::kToRepeat) candidate->plan = plan;
    return candidate;
  }

  [[nodiscard]] PlanOptions plan_within(double deviation) const {
    const auto& [run, context, options, scope, memo] = task_;
    PlanOptions plan;
    plan.target = options.target;
    plan.machine = options.machine;
    plan.units = context.before.units;
    plan.active_plane = context.before.plane;
    plan.max_deviation = std::min(left_, deviation);
    plan.chord_height = kPlans.balanced * plan.max_deviation;
    plan.keep_corner_angle = keep_corner_angle_of(options);
    plan.linearize = linearize_of(options);
    return plan;
  }

  [[nodiscard]] double far() const { return std::min(left_, kFormTuning.far * share_); }

  // Of arcs that are no farther than `deviation` from where they are looked for, where `whole` is
  // left.
  [[nodiscard]] PlanOptions arcs_within(double deviation, double whole) const {
    PlanOptions plan = plan_within(left_);
    plan.max_deviation = std::min(deviation, whole);
    plan.chord_height = kPlans.balanced * plan.max_deviation;
    plan.tolerance = left_ + curve_.path.deviation;
    return plan;
  }

  // mm, ascending: near to the curve, where that is much nearer than the tolerance allows, and far.
  // The nearest are dear, and for who asks for them alone.
  [[nodiscard]] std::vector<double> deviations() const {
    std::vector<double> all;
    const double furthest = one_sided_ ? kFormTuning.one_sided * far() : far();
    const bool accurate = task_.options.prefer == Prefer::kAccuracy;
    for (const double multiple : std::span(kFormTuning.near_arcs).subspan(accurate ? 0 : 1)) {
      const double near = std::max(multiple * distance_before(), 2 * facts().scale.printed);
      if (near < kFormTuning.another * furthest) all.push_back(near);
    }
    all.push_back(furthest);
    return all;
  }

  void offer_curves() {
    const bool few = task_.options.quick && !task_.options.target->curves_in_auto;
    const std::vector<double> all = deviations();
    const bool any_number =
        task_.options.output == Form::kCurves || facts().form == Form::kCurves ||
        rounding_is_worth_trying(setting_.bounds.least_time(), facts().scale.alone);
    const double most = kFormTuning.curve_blocks * facts().scale.original.blocks;
    for (const double deviation : std::span(all).last(few ? 1 : all.size())) {
      const PlanOptions plan = plan_within(deviation);
      if (!any_number && curves_expected(pieces_, plan) > most) continue;
      offers_.push_back({Form::kCurves, 0, 0, plan});
    }
  }

  void offer_arcs() {
    // Each straight part is a line, and what joins two of them gently takes two arcs or more.
    const double least = 3.0 * static_cast<double>(pieces_.straight_runs.size());
    const geometry::ArcCount count(pieces_.pieces);
    const std::vector<double> all = deviations();
    const bool flat =
        lies_across(task_.run, 0) || lies_across(task_.run, 1) || lies_across(task_.run, 2);
    for (const double deviation : all) {
      // Were those of the next smaller deviation as near as can be, these would be the same.
      // With the target's own chords they are not as far from it as they may be.
      const bool cut = task_.options.target->chords.any();
      const bool farther = flat && !cut && deviation > all.front();
      PlanOptions plan = arcs_within(std::min(left_, deviation), left_);
      // Those are there to be near, not few.
      const bool near = deviation < all.back() && !wants_few_moves(task_.options);
      if (near) plan.arc_effort = geometry::ArcEffort::kBrief;
      const double blocks = std::max(least, arcs_expected(task_.run, count, plan));
      offers_.push_back({Form::kArcs, blocks, farther ? kFormTuning.of_arcs * deviation : 0, plan});
    }
  }

  void offer_line_arcs() {
    if (one_sided_ || !setting_.shape) return;
    const double whole = left_ + curve_.path.deviation;
    offers_.push_back({Form::kArcs, 0, 0, arcs_within(whole, whole), ArcsAlong::kVertices});
  }

  // Arcs in the band around the vertices themselves. Of arcs no more should come than there were:
  // the search finds one fewer here and there in a band that is a little less wide.
  void offer_arc_splines() {
    const bool cut = task_.options.target->chords.any();  // arcs along the curve have less room
    const bool few = wants_few_moves(task_.options);
    if (one_sided_ || !(few || cut || !task_.run.bends.empty())) return;
    const double whole = left_ + curve_.path.deviation;
    for (const double part : kFormTuning.bands) {
      PlanOptions band = arcs_within(part * whole, whole);
      // What is outside of an arc is farther from the chords that the target makes of it.
      band.outside = whole - std::min(kFormTuning.for_control * whole,
                                      gcode::usual_chord_error(task_.options.target->chords));
      if (few) band.arc_effort = geometry::ArcEffort::kThorough;
      offers_.push_back({Form::kArcs, 0, 0, band, ArcsAlong::kBand});
      if (task_.run.bends.empty()) return;
    }
  }

  void offer_lines() {
    const auto named = task_.options.linearize;
    if (named && *named != Linearize::kChord) return make_named_lines();
    // Where it is known how far the curve is from each edge, chords may take the rest there.
    const bool known = !one_sided_ && !curve_.path.edge_deviations.empty();
    double most = known ? kFormTuning.far * share_ : far();
    if (one_sided_) most = kFormTuning.one_sided * far();
    const double highest = kPlans.balanced * most;
    const bool accurate = task_.options.prefer == Prefer::kAccuracy;
    const double nearest = accurate ? kFormTuning.accurate_blocks : kFormTuning.near_blocks;
    for (std::size_t i = 0; i < std::size(kFormTuning.near_chords); ++i) {
      const double height = std::max(kFormTuning.near_chords[i] * distance_before(),
                                     facts().scale.printed / kFormTuning.of_height);
      if (height > kFormTuning.another * highest) continue;
      offer_chords(height, i == 0 ? nearest : 1, highest);
    }
    offer_chords(highest, 0, highest);
    if (linearize_of(task_.options) == Linearize::kMinLink) make_named_lines();
  }

  // `most`: in parts of the blocks that there were; 0: any number. They may become higher for it.
  void offer_chords(double height, double most, double highest) {
    PlanOptions plan = plan_within(one_sided_ ? kFormTuning.one_sided * far() : far());
    plan.linearize = Linearize::kChord;
    if (!one_sided_) plan.tolerance = left_ + curve_.path.deviation;
    plan.chord_height = height;
    plan.most_moves = static_cast<std::size_t>(most * facts().scale.original.blocks);
    double blocks = bends_.chords(height, 0);
    if (plan.most_moves > 0) {
      blocks = std::min(blocks,
                        std::max(static_cast<double>(plan.most_moves), bends_.chords(highest, 0)));
    }
    offers_.push_back({Form::kLines, blocks, kFormTuning.of_height * height, plan});
  }

  // The farthest first, one by one: of nearer ones there are no fewer.
  void make_named_lines() {
    make_best();
    double before = 0;
    double fewest = 0;
    for (const double multiple : kFormTuning.named_chords) {
      const PlanOptions plan = plan_within(multiple * share_);
      if (before > 0 && plan.max_deviation > kFormTuning.another * before) continue;
      before = plan.max_deviation;
      fewest = std::max(fewest, kFormTuning.links * bends_.chords(plan.max_deviation, 0));
      if (!setting_.bounds.is_beaten(Form::kLines, fewest, 0)) {
        fewest = std::max(fewest, kFormTuning.counted_links * links_about(plan));
      }
      offers_.push_back({Form::kLines, fewest, 0, plan});
      make_best();
    }
  }

  // How many lines of fewest links there will be, in a part of the work that they take; 0 where
  // that is not asked for.
  [[nodiscard]] double links_about(PlanOptions plan) const {
    if (plan.linearize != Linearize::kMinLink || task_.memo != nullptr) return 0;
    plan.counted = true;
    const OutputPlan lines = plan_lines(task_.run, curve_.path, pieces_, plan);
    return static_cast<double>(lines.moves.size());
  }

  const FormSetting& setting_;
  const RunTask& task_;
  const RunCurve& curve_;
  const CurvatureProfile& bends_;
  double share_;
  double left_;
  bool is_first_;
  bool
      one_sided_;  // the run must not be cut on one side: what is written follows the curve closely
  geometry::MarkedPieces pieces_;
  SmoothedRun& result_;
  std::size_t first_;  // candidate of this curve
  std::vector<Offer> offers_;
  std::optional<SlowParts> slow_parts_;
  PlanOfLast last_;
  double slower_by_ = 0;  // s, its candidate
};

}  // namespace

void add_forms(const FormSetting& setting, const CurveOfRun& curve, SmoothedRun& result) {
  CurveForms(setting, curve, result).add();
}

}  // namespace batten::postproc
