#include "postproc/smooth/growth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "gcode/state/reason.h"
#include "postproc/smooth/forms/provenance.h"
#include "postproc/smooth/selection/cost.h"
#include "postproc/smooth/selection/selection.h"

namespace batten::postproc {

namespace {

struct Measure {
  double RunSums::*amount;
  Objection objection;
};
constexpr std::array<Measure, 3> kMeasures = {{{&RunSums::blocks, Objection::kLarger},
                                               {&RunSums::bytes, Objection::kLarger},
                                               {&RunSums::squares, Objection::kFarther}}};

RunSums sums_of(const Figures& figures, double length) {
  return {figures.times.programmed, figures.blocks, figures.bytes,
          figures.distance * figures.distance * length};
}

RunSums before_of(const RunState& work) {
  return sums_of(work.smoothed.facts.scale.original, work.smoothed.facts.length);
}

// What the run has more with what is chosen for it.
RunSums change_of(const RunState& work) {
  const Candidate* chosen = work.chosen();
  if (chosen == nullptr) return {};
  return sums_of(chosen->figures, work.smoothed.facts.length).add(before_of(work), -1);
}

bool is_asked_for(const RunState& work, const SmoothOptions& options) {
  const Candidate* chosen = work.chosen();
  return chosen != nullptr && is_forced(chosen->form, work.smoothed.facts, options);
}

Figures figures_of(const RunSums& sums, double length) {
  Figures figures;
  figures.times.programmed = sums.time;
  figures.blocks = sums.blocks;
  figures.bytes = sums.bytes;
  figures.distance = length > 0 ? std::sqrt(std::max(0.0, sums.squares) / length) : 0;
  return figures;
}

bool is_worse_in(const Measure& measure, const PartSums& sums, const SmoothOptions& options) {
  CostScale scale;
  scale.original = figures_of(sums.before, sums.length);
  scale.alone = sums.before.time;
  scale.near = kCost.near * options.tolerance_mm;
  scale.period = std::numeric_limits<double>::infinity();  // no run is slower by itself
  RunSums after = sums.before;
  after.add(sums.change, 1);
  for (const auto size : {&RunSums::blocks, &RunSums::bytes}) {
    if (size != measure.amount) after.*size = std::min(after.*size, sums.before.*size);
  }
  const Figures figures = figures_of(after, sums.length);
  return objection_to(figures, scale, options.prefer) == measure.objection;
}

// Whether a run is clearly better in something else than its size.
bool wins_beside_size(const RunState& work) {
  if (work.chosen() == nullptr) return false;
  const CostScale& scale = work.smoothed.facts.scale;
  Figures figures = work.chosen()->figures;
  figures.blocks = scale.original.blocks;
  figures.bytes = scale.original.bytes;
  return is_clearly_better(figures, scale);
}

// Whether all that is won is less size than the comment takes behind a block, by the measure of the
// cost: the ratios of blocks and of bytes, by halves.
bool is_eaten_by_comment(const std::vector<RunState>& works, const PartSums& sums,
                         const SmoothOptions& options) {
  const std::string comment = provenance_comment(*options.target, options.tolerance_mm);
  if (comment.empty() || std::ranges::any_of(works, wins_beside_size)) return false;
  const auto bytes = static_cast<double>(comment.size() + 1);
  return sums.change.blocks / sums.before.blocks +
             (sums.change.bytes + bytes) / sums.before.bytes >
         0;
}

// Changes runs that grow, those first that gain the least for it.
class Reverter {
 public:
  Reverter(std::vector<RunState>& works, std::vector<CutRun>& cut_runs,
           const SmoothOptions& options, const std::optional<PartSums>& beside)
      : works_(works),
        cut_runs_(cut_runs),
        options_(options),
        weights_(weights_of(options.prefer)),
        sums_(postproc::sums_of(works, cut_runs, options)) {
    if (beside) sums_ += *beside;
  }

  // Returns whether anything was changed: then the times of runs in pieces are others.
  bool revert() {
    bool any = false;
    for (const Measure& measure : kMeasures) {
      if (!is_worse_in(measure, sums_, options_)) continue;
      for (RunState* work : least_worth_first(measure)) {
        change(*work, measure);
        any = true;
        if (!is_worse_in(measure, sums_, options_)) break;
      }
    }
    for (const std::size_t cut : cuts_) {
      revert_costly_pieces(cut_runs_[cut], works_, options_);
    }
    return any;
  }

 private:
  // Seconds and distance that a run gains, in parts of what the whole has, for what it grows.
  [[nodiscard]] double worth(const RunState& work, const Measure& measure) const {
    const RunSums change = change_of(work);
    const RunSums& before = sums_.before;
    const double time = before.time > 0 ? change.time / before.time : 0;
    const double near = before.squares > 0 ? change.squares / before.squares : 0;
    return -(weights_.time * time + weights_.distance * std::min(0.0, near)) /
           (change.*measure.amount);
  }

  [[nodiscard]] std::vector<RunState*> least_worth_first(const Measure& measure) const {
    std::vector<std::pair<double, RunState*>> grown;
    for (RunState& work : works_) {
      if (is_asked_for(work, options_) || !(change_of(work).*measure.amount > 0)) continue;
      grown.emplace_back(worth(work, measure), &work);
    }
    std::ranges::sort(grown, [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first < b.first : a.second->section < b.second->section;
    });
    std::vector<RunState*> works;
    works.reserve(grown.size());
    for (const auto& [worth, work] : grown) works.push_back(work);
    return works;
  }

  void change(RunState& work, const Measure& measure) {
    sums_.change.add(change_of(work), -1);
    while (change_of(work).*measure.amount > 0) work.reject(reason_for(measure.objection));
    sums_.change.add(change_of(work), 1);
    if (work.cut_run) cuts_.insert(*work.cut_run);
  }

  std::vector<RunState>& works_;
  std::vector<CutRun>& cut_runs_;
  const SmoothOptions& options_;
  Weights weights_;
  PartSums sums_;
  std::set<std::size_t> cuts_;  // whose pieces were changed
};

}  // namespace

RunSums& RunSums::add(const RunSums& other, double multiple) {
  time += multiple * other.time;
  blocks += multiple * other.blocks;
  bytes += multiple * other.bytes;
  squares += multiple * other.squares;
  return *this;
}

PartSums& PartSums::operator+=(const PartSums& other) {
  length += other.length;
  before.add(other.before, 1);
  change.add(other.change, 1);
  return *this;
}

bool PartSums::grow() const {
  return std::ranges::any_of(kMeasures,
                             [&](const Measure& measure) { return change.*measure.amount > 0; });
}

PartSums sums_of(const std::vector<RunState>& works, const std::vector<CutRun>& cut_runs,
                 const SmoothOptions& options) {
  PartSums sums;
  for (const RunState& work : works) {
    if (is_asked_for(work, options)) continue;
    PartSums of_work{work.smoothed.facts.length, before_of(work), change_of(work)};
    // Pieces have the times that they add to their neighbours'.
    if (work.cut_run) of_work.before.time = of_work.change.time = 0;
    sums += of_work;
  }
  for (const CutRun& cut : cut_runs) {
    sums.before.time += cut.before.programmed;
    sums.change.time += cut.after.programmed - cut.before.programmed;
  }
  return sums;
}

bool is_worse(const PartSums& sums, const SmoothOptions& options) {
  return std::ranges::any_of(
      kMeasures, [&](const Measure& measure) { return is_worse_in(measure, sums, options); });
}

void revert_growth(std::vector<RunState>& works, std::vector<CutRun>& cut_runs,
                   const SmoothOptions& options, const std::optional<PartSums>& beside) {
  while (Reverter(works, cut_runs, options, beside).revert()) {
  }
  const bool asked_for = options.output != Form::kAuto || beside;
  if (asked_for || !is_eaten_by_comment(works, sums_of(works, cut_runs, options), options)) return;
  for (RunState& work : works) {
    if (work.chosen() != nullptr) work.give_up(gcode::reason::kNoGain);
  }
  for (CutRun& cut : cut_runs) cut.after = cut.before;
}

}  // namespace batten::postproc
