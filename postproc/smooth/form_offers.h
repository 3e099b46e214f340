// What one curve could be written as, near to the path that was meant and as far from it as the
// tolerance lets it: plans that are worth a try, and what is known of them before they are made.
#pragma once

#include <optional>
#include <vector>

#include "geometry/path/curve_pieces.h"
#include "postproc/smooth/forms/line_arcs.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/methods/run_curve.h"
#include "postproc/smooth/selection/candidate.h"
#include "postproc/smooth/selection/candidate_bounds.h"
#include "postproc/smooth/selection/meant_path.h"
#include "postproc/smooth/selection/run_budget.h"
#include "postproc/smooth/selection/run_times.h"

namespace batten::postproc {

// How far forms may be from the curve: multiples of what the run itself is from the path that was
// meant (rms), and of the form's share of the tolerance.
struct FormTuning {
  double near_arcs[3] = {0.2, 0.5, 1.6};     // greatest distance of arcs and curves
  double near_chords[3] = {0.6, 1.35, 3.0};  // heights
  // Blocks of the nearest chords at most, in parts of those before: a little less than what is
  // clearly smaller (kCost), since balanced ones may be one more; for accuracy there may be more.
  double near_blocks = 0.89;
  double accurate_blocks = 1.5;
  double far = 1.5;                           // of the share
  double one_sided = 0.25;                    // of that, where the run must not be cut on one side
  double named_chords[3] = {1.5, 0.6, 0.25};  // of the share, for lines laid by a named method
  double links = 0.5;  // of the chords that are as high, for such lines at the least
  // Of lines that are counted quickly, for a bound of their blocks: no fewer than 0.93 of them.
  double counted_links = 0.93 / kBounds.fewer;
  // Blocks, in parts of those before, that curves are expected in at most where none are asked for
  // and no time is left to win: each says several numbers for each axis.
  double curve_blocks = 0.5;
  // Vertices are moved where chords are farther from the path (rms) than so many times what
  // printing them again adds.
  double over_printed = 2;
  // What is printed may be off by half a step in each of three coordinates, three times its rms.
  double printed = 3;
  // Of the time: what corners rounded one by one have to win, for a search of each to be begun.
  double wins = 0.005;
  double another = 0.9;               // of what is farther, at most, or it is the same again
  double bands[3] = {1, 0.97, 0.94};  // parts of the band around arcs in which few are looked for
  double of_height = 0.25;            // the rms of balanced chords by their height, at least
  double of_arcs = 0.25;              // that of arcs by their greatest deviation
  double for_control = 0.5;  // of what the curve leaves, for the target's own chords at the most
};
inline constexpr FormTuning kFormTuning;

// Of one run and one method; all must live as long.
struct FormSetting {
  const RunTask& task;
  const RunTimes& times;
  const CandidateBounds& bounds;
  const MeantPath& meant;
  const std::optional<LineArcs>& shape;  // of the run
  const RunBudget& budget;
};

struct CurveOfRun {
  const RunCurve& curve;
  const CurvatureProfile& bends;
  double share = 0;  // mm, of the tolerance: the form's
  double left = 0;   // mm, what the curve leaves of the tolerance
  CurveRole role = CurveRole::kFirst;
  // There to win time alone: its farthest lines tell whether arcs of it are made.
  bool for_time = false;
};

// A form that could be made, and what it has at least.
struct Offer {
  Form form = Form::kLines;
  double blocks = 0;    // about
  double distance = 0;  // mm, rms from the path that was meant
  PlanOptions options;
  Along along = Along::kCurve;
};

// Of one curve. All must live as long. Empty where the target or the options let there be none;
// in order, the nearest first.
class FormOffers {
 public:
  // `pieces`: all of the curve.
  FormOffers(const FormSetting& setting, const CurveOfRun& given, const RunFacts& facts,
             const geometry::MarkedPieces& pieces);

  // Whether the target is told any.
  [[nodiscard]] bool curves_wanted() const;

  // Of the target, in its own words.
  [[nodiscard]] std::vector<Offer> curves() const;

  // Those that the run's vertices are on. Of the first curve alone, as arc_splines.
  [[nodiscard]] std::vector<Offer> line_arcs() const;

  // Along the curve.
  [[nodiscard]] std::vector<Offer> arcs() const;

  // In the band around the vertices themselves.
  [[nodiscard]] std::vector<Offer> arc_splines() const;

  // Lines between the run's own vertices, moved to the curve. In runs of lines.
  [[nodiscard]] std::vector<Offer> vertices() const;

  // Lines along the curve.
  [[nodiscard]] std::vector<Offer> chords() const;

  // For lines of a named method, so far (mm) from the curve.
  [[nodiscard]] PlanOptions within(double deviation) const;

 private:
  [[nodiscard]] bool is_fair_as_meant() const;
  [[nodiscard]] double distance_before() const;
  [[nodiscard]] double far() const;
  [[nodiscard]] PlanOptions arcs_within(double deviation, double whole) const;
  [[nodiscard]] std::vector<double> deviations() const;
  [[nodiscard]] Offer chords_of(double height, double most, double highest) const;

  const FormSetting& setting_;
  const RunTask& task_;
  const CurveOfRun& given_;
  const RunFacts& facts_;
  const geometry::MarkedPieces& pieces_;
  // The run must not be cut on one side: what is written follows the curve closely.
  bool one_sided_;
};

}  // namespace batten::postproc
