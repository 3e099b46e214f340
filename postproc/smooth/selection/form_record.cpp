#include "postproc/smooth/selection/form_record.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace batten::postproc {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// A mean by weights.
struct Mean {
  double sum = 0;
  double weight = 0;

  void add(double value, double by) {
    sum += by * value;
    weight += by;
  }
  [[nodiscard]] double value() const { return weight > 0 ? sum / weight : 0; }
};

}  // namespace

std::vector<std::size_t> runs_in_full(std::size_t runs) {
  const std::size_t some = (runs + kRecord.one_of - 1) / kRecord.one_of;
  const std::size_t full = runs < kRecord.worth_it ? runs : std::max(kRecord.least, some);
  std::vector<std::size_t> places(full);
  for (std::size_t i = 0; i < full; ++i) places[i] = (2 * i + 1) * runs / (2 * full);
  return places;
}

void FormRecord::add(double blocks, std::vector<Outcome> outcomes) {
  runs_.push_back({blocks, std::move(outcomes)});
}

void FormRecord::learn(double size_weight) {
  size_weight_ = size_weight;
  for (const Run& run : runs_) {
    for (const Outcome& outcome : run.outcomes) {
      const auto at = std::ranges::lower_bound(known_, outcome.tried.key, {}, &Known::key);
      if (at == known_.end() || at->key != outcome.tried.key) {
        known_.insert(at, {outcome.tried.key});
      }
    }
  }
  // By run and form.
  std::vector<std::vector<const Outcome*>> of(runs_.size());
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    of[r].resize(known_.size());
    for (const Outcome& outcome : runs_[r].outcomes) {
      of[r][static_cast<std::size_t>(find(outcome.tried.key) - known_.data())] = &outcome;
    }
  }
  const auto written = [](const Outcome* outcome) {
    return outcome != nullptr && outcome->may_be_written;
  };
  for (std::size_t k = 0; k < known_.size(); ++k) {
    Known& known = known_[k];
    Mean cost;
    Mean blocks;
    Mean of_expected;  // its logarithm
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      const Outcome* outcome = of[r][k];
      if (outcome != nullptr) ++known.made;
      if (!written(outcome)) continue;
      ++known.written;
      cost.add(outcome->cost, runs_[r].blocks);
      blocks.add(outcome->blocks, runs_[r].blocks);
      if (!(outcome->tried.expected > 0 && outcome->blocks > 0)) continue;
      of_expected.add(std::log(outcome->blocks / outcome->tried.expected), runs_[r].blocks);
    }
    known.cost = cost.value();
    known.blocks = blocks.value();
    known.of_expected = of_expected.weight > 0 ? std::exp(of_expected.value()) : 0;
    for (std::size_t other = 0; other < known_.size(); ++other) {
      Mean above;
      std::size_t shared = 0;
      for (std::size_t r = 0; r < runs_.size(); ++r) {
        if (!written(of[r][k]) || !written(of[r][other])) continue;
        above.add(of[r][k]->cost - of[r][other]->cost, runs_[r].blocks);
        ++shared;
      }
      known.beside.push_back(shared >= kRecord.shared ? above.value() : kUnknown);
    }
  }
  runs_.clear();
}

const FormRecord::Known* FormRecord::find(const FormKey& key) const {
  const auto at = std::ranges::lower_bound(known_, key, {}, &Known::key);
  return at != known_.end() && at->key == key ? &*at : nullptr;
}

std::optional<double> FormRecord::predicted(const TriedForm& form,
                                            const std::optional<FormKey>& best,
                                            double best_cost) const {
  const Known* known = find(form.key);
  if (known == nullptr) return std::nullopt;
  if (known->written == 0) {
    return known->made < kRecord.in_vain ? std::nullopt : std::optional(kNever);
  }
  double cost = known->cost;
  if (const Known* other = best ? find(*best) : nullptr) {
    const double above = known->beside[static_cast<std::size_t>(other - known_.data())];
    if (!std::isnan(above)) cost = best_cost + above;
  }
  if (form.expected > 0 && known->of_expected > 0) {
    cost += size_weight_ * (form.expected * known->of_expected - known->blocks);
  }
  return cost - kRecord.margin * size_weight_;
}

std::optional<double> FormRecord::predicted(CurveRole role, const std::optional<FormKey>& best,
                                            double best_cost) const {
  std::optional<double> least;
  for (const Known& known : known_) {
    if (known.key.role != role) continue;
    const auto cost = predicted(TriedForm{known.key}, best, best_cost);
    if (!cost) return std::nullopt;
    least = std::min(least.value_or(kNever), *cost);
  }
  return least;
}

}  // namespace batten::postproc
