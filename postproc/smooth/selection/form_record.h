// Which forms are worth making for a run, as like runs show: of many runs of one program some are
// smoothed in full, and for the others the forms are made in the order of what they are predicted
// to cost, as long as one could be better than what there is.
// Method: docs/algorithms/choice.md, section Runs that are alike.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "postproc/options/options.h"
#include "postproc/smooth/forms/output_plan.h"
#include "postproc/smooth/methods/run_curve.h"

namespace batten::postproc {

// What a curve of a run is tried for; kFirst: it is the path that was meant, or of the method that
// is asked for by name.
enum class CurveRole : std::uint8_t {
  kFirst,
  kInside,
  kSimpler,
  kRounding,
  kCorners,
  kTube,
  kVertices
};

// A form as it is offered for a run: of which curve, and which of those of one kind.
struct FormKey {
  CurveRole role = CurveRole::kFirst;
  Form form = Form::kLines;
  Along along = Along::kCurve;
  std::uint8_t place = 0;  // among those, the nearest first

  auto operator<=>(const FormKey&) const = default;
};

// A form that was made, and its blocks as they were expected before, by those of the run; 0: they
// were not.
struct TriedForm {
  FormKey key;
  double expected = 0;
};

struct RecordTuning {
  // Runs that are smoothed in full: one of so many, and at least so many, spread over all.
  std::size_t one_of = 16;
  std::size_t least = 6;
  std::size_t worth_it = 12;  // of fewer all are
  // Of these, where a form was made and never may be written: then it is hopeless.
  std::size_t in_vain = 3;
  std::size_t shared = 2;  // with two forms, from which on they are compared by these alone
  double margin = 0.01;    // of the size's weight: what a form may be better than it is predicted
};
inline constexpr RecordTuning kRecord;

// Which of so many like runs are smoothed in full, ascending.
[[nodiscard]] std::vector<std::size_t> runs_in_full(std::size_t runs);

// Costs are those of cost_of (postproc/smooth/selection/cost.h).
class FormRecord {
 public:
  // What became of a form that was made: with the run where it is slower alone, the best of these.
  struct Outcome {
    TriedForm tried;
    bool may_be_written = false;  // nothing speaks against it; else it has no cost
    double cost = 0;
    double blocks = 0;  // by those of the run
  };

  // A run that was smoothed in full. One outcome for each key.
  void add(double blocks, std::vector<Outcome> outcomes);

  // After the last one. `size_weight`: of the cost (Weights).
  void learn(double size_weight);

  // The cost of a form that is not made yet, beside one of such a cost; nothing where no form of
  // this key is known, or on too few runs to say that it never may be written. Infinite where it
  // never may be.
  [[nodiscard]] std::optional<double> predicted(const TriedForm& form,
                                                const std::optional<FormKey>& best,
                                                double best_cost) const;

  // The least of a curve for this, of all its forms; nothing where one of them is not predicted.
  [[nodiscard]] std::optional<double> predicted(CurveRole role, const std::optional<FormKey>& best,
                                                double best_cost) const;

 private:
  struct Run {
    double blocks = 0;
    std::vector<Outcome> outcomes;
  };
  struct Known {
    FormKey key;
    std::size_t made = 0;             // runs
    std::size_t written = 0;          // where it may be
    double cost = 0;                  // on average of these
    double blocks = 0;                // by those of the run
    double of_expected = 0;           // what they are of those that were expected; 0: unknown
    std::vector<double> beside = {};  // cost above that of each other known form; NaN: unknown
  };

  [[nodiscard]] const Known* find(const FormKey& key) const;

  double size_weight_ = 0;
  std::vector<Run> runs_;
  std::vector<Known> known_;  // by key
};

}  // namespace batten::postproc
