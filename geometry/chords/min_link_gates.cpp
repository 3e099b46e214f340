#include "geometry/chords/min_link_gates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/chords/chord_proof.h"
#include "geometry/path/cubic_polynomial.h"

namespace batten::geometry {
namespace {

constexpr GateTuning kGates = kGateTuning;

// A part of the curve between two gates, or more where it is long.
struct PieceSteps {
  double from;
  double to;
  double length;     // mm, of its chord
  double steps = 1;  // equal ones of the parameter
};

// A cubic is at most three quarters as far from its chord as its control points are.
double sagitta_bound(const CubicBezier& piece) {
  const StraightLine chord(piece.control[0], piece.control[3]);
  return 0.75 * std::sqrt(std::max(chord.squared_distance(piece.control[1]),
                                   chord.squared_distance(piece.control[2])));
}

// Halves the piece until each part keeps the gap.
void append_parts(const CubicBezier& piece, double from, double to, double gap, int halvings,
                  std::vector<PieceSteps>& parts) {
  if (halvings == 0 || sagitta_bound(piece) <= gap) {
    parts.push_back({from, to, (piece.control[3] - piece.control[0]).norm()});
    return;
  }
  const auto [left, right] = halves(piece);
  const double middle = (from + to) / 2;
  append_parts(left, from, middle, gap, halvings - 1, parts);
  append_parts(right, middle, to, gap, halvings - 1, parts);
}

void cut_long_pieces(std::vector<PieceSteps>& cuts) {
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    double beside = std::numeric_limits<double>::infinity();
    if (i > 0) beside = std::min(beside, cuts[i - 1].length);
    if (i + 1 < cuts.size()) beside = std::min(beside, cuts[i + 1].length);
    if (!(beside > 0)) continue;
    const double wanted = std::ceil(cuts[i].length / (kGates.growth * beside));
    cuts[i].steps = std::clamp(wanted, 1.0, kGates.most_in_line);
  }
}

}  // namespace

GateChain::GateChain(const CurvePieces& pieces, double from, double to, double gap)
    : pieces_(&pieces) {
  std::vector<PieceSteps> cuts;
  for (std::size_t i = pieces.index_of(from); i < pieces.size() && pieces.breaks()[i] < to; ++i) {
    append_parts(pieces.part(i, from, to), std::max(from, pieces.breaks()[i]),
                 std::min(to, pieces.breaks()[i + 1]), gap, kGates.most_halvings, cuts);
  }
  cut_long_pieces(cuts);
  gates_.push_back(gate_at(from));
  for (const PieceSteps& cut : cuts) {
    for (double k = 1; k < cut.steps; ++k) {
      gates_.push_back(gate_at(cut.from + (cut.to - cut.from) * k / cut.steps));
    }
    gates_.push_back(gate_at(cut.to));
  }
  for (Gate& gate : gates_) gate.gap = gap;
  find_bends();
}

Gate GateChain::gate_at(double parameter) const {
  Gate gate;
  gate.parameter = parameter;
  gate.center = pieces_->point_at(parameter);
  gate.along = gates_.empty() ? pieces_->leaving(parameter) : pieces_->arriving(parameter);
  return gate;
}

void GateChain::find_bends() {
  for (std::size_t i = 0; i < gates_.size(); ++i) {
    Gate& gate = gates_[i];
    const Gate& before = gates_[i > 0 ? i - 1 : i];
    const Gate& after = gates_[i + 1 < gates_.size() ? i + 1 : i];
    const Vector3 turn = after.along - before.along;
    gate.bend = turn - turn.dot(gate.along) * gate.along;
    const double size = gate.bend.norm();
    gate.bend = size > kGates.no_bend ? Vector3(gate.bend / size) : Vector3(Vector3::Zero());
  }
}

std::size_t GateChain::index_of(double parameter) const {
  const auto after =
      std::upper_bound(gates_.begin() + 1, gates_.end() - 1, parameter,
                       [](double u, const Gate& gate) { return u < gate.parameter; });
  return static_cast<std::size_t>(after - gates_.begin()) - 1;
}

Gate GateChain::at(double parameter) const {
  const std::size_t i = index_of(parameter);
  const double from = gates_[i].parameter;
  Gate gate = between(i, (parameter - from) / (gates_[i + 1].parameter - from));
  if (gate.parameter != parameter) {  // rounded
    gate.parameter = parameter;
    gate.center = pieces_->point_at(parameter);
  }
  return gate;
}

Gate GateChain::between(std::size_t i, double part) const {
  const Gate& before = gates_[i];
  const Gate& after = gates_[i + 1];
  Gate gate = gate_at(before.parameter + part * (after.parameter - before.parameter));
  gate.gap = before.gap;
  const Vector3 bend = before.bend + after.bend;
  const Vector3 across = bend - bend.dot(gate.along) * gate.along;
  const double size = across.norm();
  gate.bend = size > kGates.no_bend ? Vector3(across / size) : Vector3(Vector3::Zero());
  return gate;
}

}  // namespace batten::geometry
