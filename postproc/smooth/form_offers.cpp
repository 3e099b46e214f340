#include "postproc/smooth/form_offers.h"

#include <algorithm>
#include <iterator>
#include <span>

#include "gcode/controls/arc_rules.h"
#include "gcode/curves/curve_format.h"
#include "postproc/runs/run_path.h"
#include "postproc/smooth/selection/selection.h"

namespace batten::postproc {

FormOffers::FormOffers(const FormSetting& setting, const CurveOfRun& given, const RunFacts& facts,
                       const geometry::MarkedPieces& pieces)
    : setting_(setting),
      task_(setting.task),
      given_(given),
      facts_(facts),
      pieces_(pieces),
      one_sided_(setting.task.options.side != geometry::Side::kBoth) {}

bool FormOffers::curves_wanted() const {
  const SmoothOptions& options = task_.options;
  const gcode::CurveFormat* format = options.target->curves;
  if (format == nullptr || !may_start(*format, task_.context.before)) return false;
  return options.output == Form::kCurves ||
         (options.output == Form::kAuto && options.target->curves_in_auto);
}

bool FormOffers::is_fair_as_meant() const {
  const bool meant = given_.role == CurveRole::kFirst || given_.role == CurveRole::kVertices;
  return meant && given_.curve.method == Method::kFair;
}

double FormOffers::distance_before() const { return std::max(facts_.off, facts_.scale.near); }

double FormOffers::far() const { return std::min(given_.left, kFormTuning.far * given_.share); }

PlanOptions FormOffers::within(double deviation) const {
  const RunContext& context = task_.context;
  const SmoothOptions& options = task_.options;
  PlanOptions plan;
  plan.target = options.target;
  plan.machine = options.machine;
  plan.units = context.before.units;
  plan.active_plane = context.before.plane;
  plan.max_deviation = std::min(given_.left, deviation);
  plan.chord_height = kPlans.balanced * plan.max_deviation;
  plan.keep_corner_angle = keep_corner_angle_of(options);
  plan.linearize = linearize_of(options);
  return plan;
}

// Of arcs that are no farther than `deviation` from where they are looked for, where `whole` is
// left.
PlanOptions FormOffers::arcs_within(double deviation, double whole) const {
  PlanOptions plan = within(given_.left);
  plan.max_deviation = std::min(deviation, whole);
  plan.chord_height = kPlans.balanced * plan.max_deviation;
  plan.tolerance = given_.left + given_.curve.path.deviation;
  return plan;
}

// mm, ascending: near to the curve, where that is much nearer than the tolerance allows, and far.
// The nearest are dear, and for who asks for them alone.
std::vector<double> FormOffers::deviations() const {
  std::vector<double> all;
  const double furthest = one_sided_ ? kFormTuning.one_sided * far() : far();
  const bool accurate = task_.options.prefer == Prefer::kAccuracy;
  for (const double multiple : std::span(kFormTuning.near_arcs).subspan(accurate ? 0 : 1)) {
    const double near = std::max(multiple * distance_before(), 2 * facts_.scale.printed);
    if (near < kFormTuning.another * furthest) all.push_back(near);
  }
  all.push_back(furthest);
  return all;
}

std::vector<Offer> FormOffers::curves() const {
  std::vector<Offer> offers;
  if (!curves_wanted()) return offers;
  const bool few = task_.options.quick && !task_.options.target->curves_in_auto;
  const std::vector<double> all = deviations();
  const bool any_number =
      task_.options.output == Form::kCurves || facts_.form == Form::kCurves ||
      rounding_is_worth_trying(setting_.bounds.least_time(), facts_.scale.alone);
  const double most = kFormTuning.curve_blocks * facts_.scale.original.blocks;
  for (const double deviation : std::span(all).last(few ? 1 : all.size())) {
    const PlanOptions plan = within(deviation);
    if (!any_number && curves_expected(pieces_, plan) > most) continue;
    offers.push_back({Form::kCurves, 0, 0, plan});
  }
  return offers;
}

std::vector<Offer> FormOffers::arcs() const {
  std::vector<Offer> offers;
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
    PlanOptions plan = arcs_within(std::min(given_.left, deviation), given_.left);
    // Those are there to be near, not few.
    const bool near = deviation < all.back() && !wants_few_moves(task_.options);
    if (near) plan.arc_effort = geometry::ArcEffort::kBrief;
    const double blocks = std::max(least, arcs_expected(task_.run, count, plan));
    offers.push_back({Form::kArcs, blocks, farther ? kFormTuning.of_arcs * deviation : 0, plan});
  }
  return offers;
}

std::vector<Offer> FormOffers::line_arcs() const {
  if (!is_fair_as_meant() || one_sided_ || !setting_.shape) return {};
  const double whole = given_.left + given_.curve.path.deviation;
  return {{Form::kArcs, 0, 0, arcs_within(whole, whole), Along::kVertices}};
}

// Where few are wanted: the search finds one fewer here and there in a band that is a little less
// wide.
std::vector<Offer> FormOffers::arc_splines() const {
  std::vector<Offer> offers;
  const bool cut = task_.options.target->chords.any();  // arcs along the curve have less room
  const bool few = wants_few_moves(task_.options);
  if (!is_fair_as_meant() || one_sided_) return {};
  if (!few && !cut && task_.run.bends.empty()) return {};
  const double whole = given_.left + given_.curve.path.deviation;
  for (const double part : kFormTuning.bands) {
    PlanOptions band = arcs_within(part * whole, whole);
    // What is outside of an arc is farther from the chords that the target makes of it.
    band.outside = whole - std::min(kFormTuning.for_control * whole,
                                    gcode::usual_chord_error(task_.options.target->chords));
    if (few) band.arc_effort = geometry::ArcEffort::kThorough;
    offers.push_back({Form::kArcs, 0, 0, band, Along::kBand});
    if (task_.run.bends.empty() || !few) break;
  }
  return offers;
}

std::vector<Offer> FormOffers::vertices() const {
  if (!is_fair_as_meant() || one_sided_ || !task_.run.bends.empty()) return {};
  if (facts_.off <= kFormTuning.over_printed * facts_.scale.printed) return {};
  PlanOptions plan = within(given_.left);
  plan.max_deviation = std::min(given_.left + given_.curve.path.deviation,
                                tolerance_of(task_.run, task_.options.tolerance_mm) -
                                    kFormTuning.printed * facts_.scale.printed);
  const auto lines = static_cast<double>(task_.run.points.size() - 1);
  return {{Form::kLines, lines, 0, plan, Along::kVertices}};
}

std::vector<Offer> FormOffers::chords() const {
  // Where it is known how far the curve is from each edge, chords may take the rest there.
  const bool known = !one_sided_ && !given_.curve.path.edge_deviations.empty();
  double most = known ? kFormTuning.far * given_.share : far();
  if (one_sided_) most = kFormTuning.one_sided * far();
  const double highest = kPlans.balanced * most;
  const bool accurate = task_.options.prefer == Prefer::kAccuracy;
  const double nearest = accurate ? kFormTuning.accurate_blocks : kFormTuning.near_blocks;
  std::vector<Offer> offers;
  for (std::size_t i = 0; i < std::size(kFormTuning.near_chords); ++i) {
    const double height = std::max(kFormTuning.near_chords[i] * distance_before(),
                                   facts_.scale.printed / kFormTuning.of_height);
    if (height > kFormTuning.another * highest) continue;
    offers.push_back(chords_of(height, i == 0 ? nearest : 1, highest));
  }
  offers.push_back(chords_of(highest, 0, highest));
  return offers;
}

// `most`: in parts of the blocks that there were; 0: any number. They may become higher for it.
Offer FormOffers::chords_of(double height, double most, double highest) const {
  PlanOptions plan = within(one_sided_ ? kFormTuning.one_sided * far() : far());
  plan.linearize = Linearize::kChord;
  if (!one_sided_) plan.tolerance = given_.left + given_.curve.path.deviation;
  plan.chord_height = height;
  plan.most_moves = static_cast<std::size_t>(most * facts_.scale.original.blocks);
  double blocks = given_.bends.chords(height, 0);
  if (plan.most_moves > 0) {
    const auto allowed = static_cast<double>(plan.most_moves);
    blocks = std::min(blocks, std::max(allowed, given_.bends.chords(highest, 0)));
  }
  return {Form::kLines, blocks, kFormTuning.of_height * height, plan};
}

}  // namespace batten::postproc
