#include "geometry/distance/free_space.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace batten::geometry {
namespace {

// Is `to` on the edge of the step that ends there, not before `from`?
bool forward(const PlaceOnChord& from, const PlaceOnChord& to) {
  if (to.t < 0 || to.t > 1) return false;
  if (from.edge == to.edge) return from.t <= to.t;
  return from.edge + 1 == to.edge && from.t == 1;
}

// The begin of the next edge where an edge has come to its end; not beyond `last`.
PlaceOnChord leave_end(const PlaceOnChord& place, const PlaceOnChord& last) {
  if (place.t < 1 || place.edge == last.edge) return place;
  return {place.edge + 1, 0};
}

// The begin of an edge as the end of the edge before.
PlaceOnChord as_end(const PlaceOnChord& place) {
  if (place.t > 0 || place.edge == 0) return place;
  return {place.edge - 1, 1};
}

}  // namespace

Matching match_nearest(const ChordPolyline& a, const ChordPolyline& b) {
  return match_nearest(a, b, {{0, 0}, {0, 0}}, {{a.edge_count() - 1, 1}, {b.edge_count() - 1, 1}});
}

Matching match_nearest(const ChordPolyline& a, const ChordPolyline& b, const MatchedPair& from,
                       const MatchedPair& to, double tie) {
  const MatchedPair last{as_end(to.a), as_end(to.b)};
  MatchedPair here{as_end(from.a), as_end(from.b)};
  Matching matching;
  matching.reserve(last.a.edge - here.a.edge + last.b.edge - here.b.edge + 2);
  matching.push_back(here);
  while (true) {
    const PlaceOnChord on_a = leave_end(here.a, last.a);
    const PlaceOnChord on_b = leave_end(here.b, last.b);
    const double stop_a = on_a.edge == last.a.edge ? last.a.t : 1;
    const double stop_b = on_b.edge == last.b.edge ? last.b.t : 1;
    const Point3 next_a = point_at(a, {on_a.edge, stop_a});
    const Point3 next_b = point_at(b, {on_b.edge, stop_b});
    const MatchedPair to_a{{on_a.edge, stop_a},
                           {on_b.edge, nearest_parameter(b, on_b.edge, next_a, on_b.t, stop_b)}};
    const MatchedPair to_b{{on_a.edge, nearest_parameter(a, on_a.edge, next_b, on_a.t, stop_a)},
                           {on_b.edge, stop_b}};
    // A path at its end waits there: the other one can only come to it.
    const bool a_waits = on_a.edge == last.a.edge && on_a.t >= last.a.t;
    const bool b_waits = on_b.edge == last.b.edge && on_b.t >= last.b.t;
    if (a_waits && b_waits) return matching;
    const double step_a = (next_a - point_at(b, to_a.b)).squaredNorm();
    const double step_b = (next_b - point_at(a, to_b.a)).squaredNorm();
    here = !a_waits && (b_waits || step_a <= step_b + tie) ? to_a : to_b;
    matching.push_back(here);
  }
}

bool goes_forward(const Matching& matching, const ChordPolyline& a, const ChordPolyline& b) {
  if (matching.empty()) return false;
  const MatchedPair& first = matching.front();
  const MatchedPair& last = matching.back();
  if (first.a.edge != 0 || first.a.t != 0 || first.b.edge != 0 || first.b.t != 0) return false;
  if (last.a.edge + 1 != a.edge_count() || last.a.t != 1) return false;
  if (last.b.edge + 1 != b.edge_count() || last.b.t != 1) return false;
  for (std::size_t k = 1; k < matching.size(); ++k) {
    if (!forward(matching[k - 1].a, matching[k].a)) return false;
    if (!forward(matching[k - 1].b, matching[k].b)) return false;
  }
  return true;
}

double pair_error(const Matching& matching, std::size_t k, const ChordPolyline& a,
                  const ChordPolyline& b) {
  const auto into = [&](const MatchedPair& pair) {
    return a.errors[pair.a.edge] + b.errors[pair.b.edge];
  };
  const bool last = k + 1 == matching.size();
  return last ? into(matching[k]) : std::max(into(matching[k]), into(matching[k + 1]));
}

MeasuredMatching measure(const Matching& matching, const ChordPolyline& a, const ChordPolyline& b,
                         double noise) {
  MeasuredMatching found;
  for (std::size_t k = 0; k < matching.size(); ++k) {
    const double apart = (point_at(a, matching[k].a) - point_at(b, matching[k].b)).norm();
    // Equal coordinates are one position, without noise.
    const double bound = (apart > 0 ? apart + noise : 0) + pair_error(matching, k, a, b);
    if (bound > found.at_most) found = {bound, k};
  }
  return found;
}

namespace {

// Part of an edge, in t. Empty when from > to.
struct Interval {
  double from = 1;
  double to = 0;
  [[nodiscard]] bool empty() const { return from > to; }
};

constexpr double kUnreached = 2;  // nothing of this side of the cell can be reached

// Cell (i, j) is edge i of `a` against edge j of `b`. Its four sides are a vertex of one against
// the edge of the other. In the figure of the paper: a to the top, b to the right.
//
//   vertex i + 1 of a ---- top ----
//                      left     right
//   vertex i of a     --- bottom --
//                 vertex j      j + 1 of b
//
// Of the reachable part of a side only its begin is kept: it goes as far as the side is free.
struct Cell {
  std::uint32_t column = 0;
  double top = kUnreached;    // t on edge j of b
  double right = kUnreached;  // t on edge i of a
};

class FreeSpace {
 public:
  FreeSpace(const ChordPolyline& a, const ChordPolyline& b, double distance, ChordErrors errors)
      : a_(a), b_(b), distance_(distance), sign_(errors == ChordErrors::kAdded ? 1 : -1) {}

  [[nodiscard]] std::size_t rows() const { return a_.edge_count(); }
  [[nodiscard]] std::size_t columns() const { return b_.edge_count(); }

  // The free part of edge `column` of b against `vertex` of a: the top of row vertex - 1 and the
  // bottom of row vertex.
  [[nodiscard]] Interval across_row(std::size_t vertex, std::size_t column) const {
    const double radius = distance_ + sign_ * b_.errors[column] + shared_error(a_, vertex);
    return free_part(a_.points[vertex], b_.points[column], b_.points[column + 1], radius);
  }

  // The same of edge `row` of a against `vertex` of b: the right side of column vertex - 1 and the
  // left side of column vertex.
  [[nodiscard]] Interval across_column(std::size_t vertex, std::size_t row) const {
    const double radius = distance_ + sign_ * a_.errors[row] + shared_error(b_, vertex);
    return free_part(b_.points[vertex], a_.points[row], a_.points[row + 1], radius);
  }

 private:
  // A side belongs to two cells and must be free in both: the smaller of the two distances. For
  // refuting, that is still no smaller than the truth: the vertex is on the path.
  [[nodiscard]] double shared_error(const ChordPolyline& polyline, std::size_t vertex) const {
    const double before = sign_ * polyline.errors[vertex > 0 ? vertex - 1 : 0];
    const double after = sign_ * polyline.errors[std::min(vertex, polyline.edge_count() - 1)];
    return std::min(before, after);
  }

  // The ends are asked by themselves, so that all four sides that meet in a corner of the free
  // space agree about it. The half chord is measured from the foot: b^2 - a c would lose all digits
  // on long edges.
  static Interval free_part(const Point3& point, const Point3& from, const Point3& to,
                            double radius) {
    if (radius < 0) return {};
    const double radius2 = radius * radius;
    const Vector3 along = to - from;
    const Vector3 towards = point - from;
    const bool begin_free = towards.squaredNorm() <= radius2;
    const bool end_free = (point - to).squaredNorm() <= radius2;
    if (begin_free && end_free) return {0, 1};
    const double length2 = along.squaredNorm();
    if (length2 == 0) return {};
    const double foot = towards.dot(along) / length2;
    const double rest2 = radius2 - (towards - foot * along).squaredNorm();
    const double half = std::sqrt(std::max(rest2, 0.0) / length2);
    if (begin_free) return {0, std::clamp(foot + half, 0.0, 1.0)};
    if (end_free) return {std::clamp(foot - half, 0.0, 1.0), 1};
    if (rest2 < 0 || foot + half < 0 || foot - half > 1) return {};
    return {std::max(foot - half, 0.0), std::min(foot + half, 1.0)};
  }

  const ChordPolyline& a_;
  const ChordPolyline& b_;
  double distance_;
  double sign_;
};

// Where the reachable part of a side begins when the cell is entered at `entered` on the opposite
// side.
double reach_from_opposite(const Interval& side, double entered) {
  const double from = std::max(side.from, entered);
  return from <= side.to ? from : kUnreached;
}

// Visits the reachable cells row by row and keeps them.
class FreeSpaceSweep {
 public:
  FreeSpaceSweep(const FreeSpace& space, std::size_t most_cells)
      : space_(space), most_cells_(most_cells) {
    row_begin_.reserve(space.rows() + 1);
    row_begin_.push_back(0);
  }

  Passage run() {
    if (!start_first_row()) return Passage::kNone;
    for (std::size_t row = 0; row < space_.rows(); ++row) {
      if (!sweep_row(row)) return Passage::kTooWide;
      row_begin_.push_back(cells_.size());
      if (row_begin_[row] == row_begin_[row + 1]) return Passage::kNone;  // nothing reached
    }
    return end_reached() ? Passage::kFound : Passage::kNone;
  }

  // t from which the right side of cell (row, column) can be reached; column -1 is the left
  // border of the free space.
  [[nodiscard]] double reached_right(std::size_t row, std::ptrdiff_t column) const {
    if (column < 0) return row < border_rows_ ? 0 : kUnreached;
    const Cell* cell = find(row, static_cast<std::uint32_t>(column));
    return cell != nullptr ? cell->right : kUnreached;
  }

  // The same for the top; row -1 is the bottom border.
  [[nodiscard]] double reached_top(std::ptrdiff_t row, std::size_t column) const {
    if (row < 0) return column < border_columns_ ? 0 : kUnreached;
    const Cell* cell = find(static_cast<std::size_t>(row), static_cast<std::uint32_t>(column));
    return cell != nullptr ? cell->top : kUnreached;
  }

  // About where the way ends when there is none.
  [[nodiscard]] MatchedPair furthest() const { return furthest_; }

 private:
  // The borders are reached as far as they are free without a break from the start.
  bool start_first_row() {
    const Interval first = space_.across_row(0, 0);
    if (first.empty() || first.from > 0) return false;
    border_columns_ = 1;
    for (Interval side = first; side.to == 1 && border_columns_ < space_.columns();) {
      side = space_.across_row(0, border_columns_);
      if (side.empty() || side.from > 0) break;
      ++border_columns_;
    }
    const Interval up = space_.across_column(0, 0);
    border_rows_ = !up.empty() && up.from == 0 ? 1 : 0;
    border_goes_on_ = border_rows_ == 1 && up.to == 1;
    return true;
  }

  bool sweep_row(std::size_t row) {
    if (row > 0) extend_left_border(row);
    const std::size_t below = row > 0 ? row_begin_[row - 1] : 0;
    const std::size_t below_end = row > 0 ? row_begin_[row] : 0;
    std::size_t next_below = below;
    std::size_t column = 0;
    double left = row < border_rows_ ? 0 : kUnreached;
    while (column < space_.columns()) {
      while (next_below < below_end &&
             (cells_[next_below].column < column || cells_[next_below].top == kUnreached)) {
        ++next_below;
      }
      double bottom = kUnreached;
      if (row == 0) {
        if (column < border_columns_) bottom = 0;
      } else if (next_below < below_end && cells_[next_below].column == column) {
        bottom = cells_[next_below].top;
      }
      if (left == kUnreached && bottom == kUnreached) {
        if (row == 0 || next_below == below_end) break;
        column = cells_[next_below].column;
        continue;
      }
      if (cells_.size() >= most_cells_) return false;
      left = visit(row, column, left, bottom);
      ++column;
    }
    return true;
  }

  // Returns from where the right side is reached: the left of the next cell.
  double visit(std::size_t row, std::size_t column, double left, double bottom) {
    const Interval top_side = space_.across_row(row + 1, column);
    const Interval right_side = space_.across_column(column + 1, row);
    Cell cell{static_cast<std::uint32_t>(column), kUnreached, kUnreached};
    if (!top_side.empty()) {
      cell.top = left != kUnreached ? top_side.from : reach_from_opposite(top_side, bottom);
    }
    if (!right_side.empty()) {
      cell.right = bottom != kUnreached ? right_side.from : reach_from_opposite(right_side, left);
    }
    cells_.push_back(cell);
    furthest_ = left != kUnreached ? MatchedPair{{row, left}, {column, 0}}
                                   : MatchedPair{{row, 0}, {column, bottom}};
    if (cell.right != kUnreached) furthest_ = {{row, cell.right}, {column, 1}};
    if (cell.top != kUnreached) furthest_ = {{row, 1}, {column, cell.top}};
    return cell.right;
  }

  void extend_left_border(std::size_t row) {
    if (!border_goes_on_) return;
    const Interval side = space_.across_column(0, row);
    border_goes_on_ = !side.empty() && side.from == 0;
    if (!border_goes_on_) return;
    border_rows_ = row + 1;
    border_goes_on_ = side.to == 1;
  }

  [[nodiscard]] bool end_reached() const {
    const Cell* last = find(space_.rows() - 1, static_cast<std::uint32_t>(space_.columns() - 1));
    if (last == nullptr) return false;
    const Interval top = space_.across_row(space_.rows(), space_.columns() - 1);
    const Interval right = space_.across_column(space_.columns(), space_.rows() - 1);
    return (last->top != kUnreached && top.to == 1) || (last->right != kUnreached && right.to == 1);
  }

  [[nodiscard]] const Cell* find(std::size_t row, std::uint32_t column) const {
    const auto begin = cells_.begin() + static_cast<std::ptrdiff_t>(row_begin_[row]);
    const auto end = cells_.begin() + static_cast<std::ptrdiff_t>(row_begin_[row + 1]);
    const auto found = std::lower_bound(
        begin, end, column, [](const Cell& c, std::uint32_t j) { return c.column < j; });
    return found != end && found->column == column ? &*found : nullptr;
  }

  const FreeSpace& space_;
  std::size_t most_cells_;
  std::vector<Cell> cells_;
  std::vector<std::size_t> row_begin_;
  std::size_t border_columns_ = 0;
  std::size_t border_rows_ = 0;
  bool border_goes_on_ = false;
  MatchedPair furthest_;  // where the cell visited last is left, or where it is entered
};

bool at_start(const PlaceOnChord& place) { return place.edge == 0 && place.t == 0; }

// As the end of the edge before: in the cell before.
PlaceOnChord begin_of(std::size_t edge) {
  return edge > 0 ? PlaceOnChord{edge - 1, 1} : PlaceOnChord{0, 0};
}

// What of a side between two parameters of its edge is nearest to its vertex.
struct OnSide {
  std::optional<PlaceOnChord> place;
  double apart2 = std::numeric_limits<double>::infinity();

  OnSide(const ChordPolyline& polyline, std::size_t edge, const Point3& vertex, double from,
         double to) {
    if (from > to) return;
    place = PlaceOnChord{edge, nearest_parameter(polyline, edge, vertex, from, to)};
    apart2 = (point_at(polyline, *place) - vertex).squaredNorm();
  }
};

// From the end of both back to their start, each time to the side of the cell by which it can have
// been entered, left or bottom, and there to what is nearest to the vertex.
Matching way_back(const FreeSpace& space, const FreeSpaceSweep& sweep, const ChordPolyline& a,
                  const ChordPolyline& b) {
  MatchedPair here{{a.edge_count() - 1, 1}, {b.edge_count() - 1, 1}};
  Matching way{here};
  while (!at_start(here.a) || !at_start(here.b)) {
    const std::size_t row = here.a.edge;
    const std::size_t column = here.b.edge;
    if (at_start(here.b)) {  // on a border of the free space one path waits at its start
      here.a = begin_of(row);
    } else if (at_start(here.a)) {
      here.b = begin_of(column);
    } else {
      const OnSide left(a, row, b.points[column],
                        sweep.reached_right(row, static_cast<std::ptrdiff_t>(column) - 1),
                        std::min(space.across_column(column, row).to, here.a.t));
      const OnSide bottom(b, column, a.points[row],
                          sweep.reached_top(static_cast<std::ptrdiff_t>(row) - 1, column),
                          std::min(space.across_row(row, column).to, here.b.t));
      // Corners that two cells with different errors see differently can end the way back; the
      // pairs then are no matching, and nobody takes them for a proof.
      if (!left.place && !bottom.place) break;
      here = left.apart2 <= bottom.apart2 ? MatchedPair{*left.place, begin_of(column)}
                                          : MatchedPair{begin_of(row), *bottom.place};
    }
    way.push_back(here);
  }
  std::reverse(way.begin(), way.end());
  return way;
}

}  // namespace

FreeSpaceAnswer find_passage(const ChordPolyline& a, const ChordPolyline& b, double distance,
                             ChordErrors errors, std::size_t most_cells) {
  const FreeSpace space(a, b, distance, errors);
  FreeSpaceSweep sweep(space, most_cells);
  FreeSpaceAnswer answer;
  answer.passage = sweep.run();
  if (answer.passage == Passage::kFound) answer.way = way_back(space, sweep, a, b);
  if (answer.passage == Passage::kNone) answer.furthest = sweep.furthest();
  return answer;
}

}  // namespace batten::geometry
