#include "postproc/smooth/curve_forms.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "geometry/basic/operations.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/forms/slow_parts.h"
#include "postproc/smooth/selection/selection.h"

namespace batten::postproc {

std::optional<Candidate> make_candidate(const RunTask& task, const RunTimes& times,
                                        const OutputPlan& plan, const RunFacts& facts,
                                        std::span<const Candidate> there) {
  const RunContext& context = task.context;
  const SmoothOptions& options = task.options;
  gcode::ModalState before = context.before;
  if (!options.words.before_run.empty()) {  // after words of a profile it says motion and feed
    before.motion = gcode::MotionMode::kUnknown;
    before.feed.reset();
  }
  geometry::count_operations(100 * plan.moves.size());
  auto text = write_run(plan, task.run, context.program, *options.target, before, context.after,
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
  if (context.is_piece() || task.memo != nullptr) candidate.moves = PackedMoves(moves);
  return candidate;
}

namespace {

// The place (FormKey) of the first lines of a named method: behind those of all chords.
constexpr std::uint8_t kFirstNamed = 16;

class CurveForms {
 public:
  CurveForms(const FormSetting& setting, const CurveOfRun& given, SmoothedRun& result)
      : setting_(setting),
        task_(setting.task),
        curve_(given.curve),
        bends_(given.bends),
        share_(given.share),
        role_(given.role),
        pieces_(curve_.path.curve),
        offers_(setting, given, result.facts, pieces_),
        by_lines_(given.for_time && setting.task.options.output == Form::kAuto &&
                  !setting.task.options.linearize && !offers_.curves_wanted()),
        result_(result),
        first_(result.candidates.size()) {}

  void add() {
    const Form wanted = task_.options.output;
    if (by_lines_) return add_fastest();
    std::vector<Offer> offers = offers_.curves();
    if (wanted == Form::kCurves) {
      make_best(std::move(offers));
      if (has_form(Form::kCurves)) return;
      offers.clear();
    }
    const auto append = [&](std::vector<Offer> more) {
      std::ranges::move(more, std::back_inserter(offers));
    };
    if (wanted != Form::kLines) {
      append(offers_.line_arcs());
      append(offers_.arcs());
      append(offers_.arc_splines());
    }
    const auto named = task_.options.linearize;
    const bool chords = !named || *named == Linearize::kChord;
    if (wanted != Form::kArcs && chords) append(offers_.chords());
    make_best(std::move(offers));
    const bool links = linearize_of(task_.options) == Linearize::kMinLink;
    if (wanted != Form::kArcs && (links || !chords)) add_named_lines();
  }

  void add_vertices() { make_best(offers_.vertices()); }

 private:
  [[nodiscard]] const RunFacts& facts() const { return result_.facts; }

  [[nodiscard]] bool has_form(Form form) const {
    return std::ranges::any_of(result_.candidates,
                               [&](const Candidate& c) { return c.form == form; });
  }

  // Whether there is a candidate of this curve, or one of the form that is asked for by name.
  [[nodiscard]] bool has_one() const {
    const Form wanted = task_.options.output;
    return wanted == Form::kAuto ? result_.candidates.size() > first_ : has_form(wanted);
  }

  // Of a curve that is there to win time in a run of corners: its farthest lines, which take little
  // to make; and its farthest arcs, which are about as fast, where they might win by their size.
  void add_fastest() {
    const double best = cost_to_beat(result_, task_.options);
    make_best({offers_.chords().back()});
    const double size = weights_of(task_.options.prefer).size;
    const auto own = std::span(result_.candidates).subspan(first_);
    const bool may_win = std::ranges::any_of(own, [&](const Candidate& c) {
      return cost_of(c.figures, facts().scale, task_.options.prefer) - size <= best;
    });
    if (!may_win) return;
    Offer arcs = offers_.arcs().back();
    arcs.options.arc_effort = geometry::ArcEffort::kBrief;
    make_best({arcs});
  }

  // In the order in which they are offered, or of what they are predicted to cost, but for those
  // that what there is then beats. `place`: of the first of a kind (FormKey).
  void make_best(std::vector<Offer> offers, std::uint8_t place = 0) {
    const bool all = task_.scope == CandidateScope::kAll;
    std::vector<TriedForm> forms;
    for (std::size_t i = 0; i < offers.size(); ++i) {
      const Offer& offer = offers[i];
      const bool another =
          i > 0 && offers[i - 1].form == offer.form && offers[i - 1].along == offer.along;
      const auto at = static_cast<std::uint8_t>(another ? forms.back().key.place + 1 : place);
      forms.push_back(
          {{role_, offer.form, offer.along, at}, offer.blocks / facts().scale.original.blocks});
    }
    for (std::size_t left = offers.size(); left > 0; --left) {
      const std::size_t next = next_of(forms);
      if (next == forms.size()) {
        result_.left_out = true;
        break;
      }
      Offer offer = std::move(offers[next]);
      const TriedForm form = forms[next];
      offers.erase(offers.begin() + static_cast<std::ptrdiff_t>(next));
      forms.erase(forms.begin() + static_cast<std::ptrdiff_t>(next));
      key_ = form.key;
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
      last_plan_.reset();
      mended_.reset();
      result_.tried.push_back(form);
      auto candidate = made(offer);
      const bool limited = offer.options.most_arcs < PlanOptions().most_arcs;
      if (candidate) {
        result_.candidates.push_back(std::move(*candidate));
        write_as_coarse(offer);
        put_run_where_slower(offer);
      } else if (limited) {
        result_.left_out = true;  // there may be more arcs than these
      }
    }
  }

  // The form that is to be made next, or none: where like runs are known the one that is predicted
  // to cost least, if that is less than what there is. Those that are not known come last.
  [[nodiscard]] std::size_t next_of(const std::vector<TriedForm>& forms) const {
    if (task_.record == nullptr || by_lines_) return 0;
    const auto [best, cost] = best_so_far(result_, task_.options);
    std::size_t next = forms.size();
    std::size_t unknown = forms.size();
    double least = cost;
    for (std::size_t i = 0; i < forms.size(); ++i) {
      const auto predicted = task_.record->predicted(forms[i], best, cost);
      if (!predicted) unknown = std::min(unknown, i);
      if (!predicted || *predicted >= least) continue;
      least = *predicted;
      next = i;
    }
    return next < forms.size() ? next : unknown;
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

  // The last candidate again, with no more decimals than the run has, where it is larger by its
  // digits alone. Then `offer` is that of the new one.
  void write_as_coarse(Offer& offer) {
    const Figures& fine = result_.candidates.back().figures;
    const Figures& before = facts().scale.original;
    if (offer.form != Form::kLines) return;
    if (fine.blocks > before.blocks || fine.bytes <= before.bytes) return;
    const double more =
        kFormTuning.printed * (printed_with(task_.run.decimals) - facts().scale.printed);
    // Where the deviation leaves room for it, so does the tolerance.
    if (!(more > 0 && more < offer.options.max_deviation)) return;
    Offer coarse = offer;
    coarse.options.most_decimals = task_.run.decimals;
    coarse.options.max_deviation -= more;
    if (coarse.options.tolerance > 0) coarse.options.tolerance -= more;
    std::optional<OutputPlan> plan = std::exchange(last_plan_, std::nullopt);
    auto candidate = made(coarse);
    if (!candidate) {
      last_plan_ = std::move(plan);
      return;
    }
    result_.candidates.push_back(std::move(*candidate));
    offer = std::move(coarse);
  }

  // Where it is as fast as the run, but for next to nothing. What was meant may be slower by as
  // much as any form.
  bool is_added_with_run(Offer offer, RunInPlace where) {
    offer.options.run_in_place = where;
    auto candidate = made(offer);
    if (!candidate) return false;
    candidate->has_run_in_place = where != RunInPlace::kAtEnds;
    const double before = facts().scale.original.times.programmed;
    const double part = offer.along == Along::kVertices ? kCost.longer : kCost.mended;
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
    mended.times.programmed -= mended_plan(offer).lost();
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

  // Of the last offer that there is a candidate of, which may be one of another setting.
  [[nodiscard]] MendedPlan& mended_plan(Offer offer) {
    offer.options.run_in_place = RunInPlace::kNowhere;
    if (!last_plan_) last_plan_ = plan_of(offer);
    if (!mended_) mended_.emplace(slow_parts(), last_plan_.value());
    return *mended_;
  }

  [[nodiscard]] std::optional<Candidate> made(const Offer& offer) {
    if (task_.memo == nullptr) return newly_made(offer);
    const RunMemo::PlanKey key{curve_.number, offer.form, offer.along, offer.options};
    return task_.memo->candidates.get(key, [&](std::size_t) {
      auto candidate = newly_made(offer);
      if (candidate) candidate->text.text.clear();
      return candidate;
    });
  }

  [[nodiscard]] std::optional<OutputPlan> plan_of(const Offer& offer) {
    const Run& run = task_.run;
    if (offer.options.run_in_place != RunInPlace::kNowhere) {
      return mended_plan(offer).with_run(offer.options.run_in_place, slower_by_);
    }
    if (offer.form == Form::kCurves) return plan_curves(run, curve_.path, offer.options);
    if (offer.form == Form::kLines && offer.along == Along::kVertices) {
      return plan_vertices(run, curve_.path, offer.options);
    }
    if (offer.form == Form::kLines) return plan_lines(run, curve_.path, pieces_, offer.options);
    switch (offer.along) {
      case Along::kVertices:
        return plan_line_arcs(setting_.shape.value(), run, curve_.path, offer.options);
      case Along::kBand:
        return plan_arc_spline(run, curve_.path, offer.options);
      case Along::kCurve:
        break;
    }
    return plan_arcs(run, curve_.path, pieces_, bends_, offer.options);
  }

  [[nodiscard]] std::optional<Candidate> newly_made(const Offer& offer) {
    std::optional<OutputPlan> plan = plan_of(offer);
    if (!plan) return std::nullopt;
    plan->most_decimals = offer.options.most_decimals;
    if (offer.options.run_in_place == RunInPlace::kNowhere) last_plan_ = plan;
    auto candidate = make_candidate(task_, setting_.times, *plan, facts(), result_.candidates);
    if (!candidate) return std::nullopt;
    candidate->method = name_of(curve_.method);
    candidate->key = key_;
    candidate->max_curvature = bends_.greatest();
    candidate->has_vertices = offer.form == Form::kLines && offer.along == Along::kVertices;
    candidate->rounds_seam = curve_.path.rounds_seam && offer.along == Along::kCurve;
    const double off = setting_.meant.distance_of(plan->moves, curve_.path);
    candidate->figures.distance =
        std::hypot(off, printed_with(plan->most_decimals), facts().scattered);
    if (task_.scope == CandidateScope::kToRepeat) candidate->plan = plan;
    return candidate;
  }

  // mm, rms: what lines are off by that are written with no more decimals than so many.
  [[nodiscard]] double printed_with(int most_decimals) const {
    const gcode::Units units = task_.context.before.units;
    gcode::NumberFormat format = place_format(*task_.options.target, units);
    format.decimals = std::min(format.decimals, most_decimals);
    return gcode::printed_rms(format, units);
  }

  // The farthest first, one by one: of nearer ones there are no fewer.
  void add_named_lines() {
    double before = 0;
    double fewest = 0;
    std::uint8_t place = kFirstNamed;
    for (const double multiple : kFormTuning.named_chords) {
      const PlanOptions plan = offers_.within(multiple * share_);
      if (before > 0 && plan.max_deviation > kFormTuning.another * before) continue;
      before = plan.max_deviation;
      const std::uint8_t at = place++;
      if (next_of({{{role_, Form::kLines, Along::kCurve, at}}}) != 0) {
        result_.left_out = true;
        continue;
      }
      fewest = std::max(fewest, kFormTuning.links * bends_.chords(plan.max_deviation, 0));
      if (!setting_.bounds.is_beaten(Form::kLines, fewest, 0)) {
        fewest = std::max(fewest, kFormTuning.counted_links * links_about(plan));
      }
      make_best({{Form::kLines, fewest, 0, plan}}, at);
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
  CurveRole role_;
  geometry::MarkedPieces pieces_;
  FormOffers offers_;
  bool by_lines_;  // whether it wins time is told by its farthest lines
  SmoothedRun& result_;
  std::size_t first_;  // candidate of this curve
  FormKey key_;        // of the offer that is being made
  std::optional<SlowParts> slow_parts_;
  // Of the offer that was made last.
  std::optional<OutputPlan> last_plan_;
  std::optional<MendedPlan> mended_;
  double slower_by_ = 0;  // s, its candidate
};

}  // namespace

void add_forms(const FormSetting& setting, const CurveOfRun& curve, SmoothedRun& result) {
  CurveForms(setting, curve, result).add();
}

void add_vertices(const FormSetting& setting, const CurveOfRun& curve, SmoothedRun& result) {
  CurveForms(setting, curve, result).add_vertices();
}

}  // namespace batten::postproc
