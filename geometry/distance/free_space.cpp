#include "geometry/distance/free_space.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
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

// Where on its edge a path stands that may have just come to the edge's end.
PlaceOnChord leave_end(const PlaceOnChord& place, const ChordPolyline& polyline) {
  if (place.t < 1 || place.edge + 1 == polyline.edge_count()) return place;
  return {place.edge + 1, 0};
}

}  // namespace

Matching match_nearest(const ChordPolyline& a, const ChordPolyline& b) {
  Matching matching;
  matching.reserve(a.points.size() + b.points.size());
  MatchedPair here{{0, 0}, {0, 0}};
  matching.push_back(here);
  while (true) {
    const PlaceOnChord on_a = leave_end(here.a, a);
    const PlaceOnChord on_b = leave_end(here.b, b);
    const Point3& next_a = a.points[on_a.edge + 1];
    const Point3& next_b = b.points[on_b.edge + 1];
    const MatchedPair to_a{{on_a.edge, 1},
                           {on_b.edge, nearest_parameter(b, on_b.edge, next_a, on_b.t, 1)}};
    const MatchedPair to_b{{on_a.edge, nearest_parameter(a, on_a.edge, next_b, on_a.t, 1)},
                           {on_b.edge, 1}};
    // A path at its end waits there: the other one can only come to it.
    const bool a_waits = on_a.t == 1;
    const bool b_waits = on_b.t == 1;
    if (a_waits && b_waits) return matching;
    const double step_a = (next_a - point_at(b, to_a.b)).squaredNorm();
    const double step_b = (next_b - point_at(a, to_b.a)).squaredNorm();
    here = !a_waits && (b_waits || step_a <= step_b) ? to_a : to_b;
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
  const double into = step_error(matching, k, a, b);
  if (k + 1 == matching.size()) return into;
  return std::max(into, step_error(matching, k + 1, a, b));
}

MeasuredMatching measure(const Matching& matching, const ChordPolyline& a, const ChordPolyline& b,
                         double noise) {
  MeasuredMatching found;
  for (std::size_t k = 0; k < matching.size(); ++k) {
    const double apart = (point_at(a, matching[k].a) - point_at(b, matching[k].b)).norm();
    // Equal coordinates are one place, without noise.
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

// "No place of this side of the cell can be reached."
constexpr double kUnreached = 2;

// Cell (i, j) is edge i of `a` against edge j of `b`. Its four sides are a vertex of one
// against the edge of the other. In the figure of the paper: a to the top, b to the right.
//
//   vertex i + 1 of a ---- top ----
//                      left     right
//   vertex i of a     --- bottom --
//                 vertex j      j + 1 of b
//
// Of each reachable part of a side only its begin is kept: it goes as far as the side is free.
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

  // The free part of edge `column` of b against vertex `vertex` of a: the top of row
  // vertex - 1 and the bottom of row vertex.
  [[nodiscard]] Interval across_row(std::size_t vertex, std::size_t column) const {
    const double radius = distance_ + sign_ * b_.errors[column] + shared_error(a_, vertex);
    return free_part(a_.points[vertex], b_.points[column], b_.points[column + 1], radius);
  }

  // The free part of edge `row` of a against vertex `vertex` of b: the right side of column
  // vertex - 1 and the left side of column vertex.
  [[nodiscard]] Interval across_column(std::size_t vertex, std::size_t row) const {
    const double radius = distance_ + sign_ * a_.errors[row] + shared_error(b_, vertex);
    return free_part(b_.points[vertex], a_.points[row], a_.points[row + 1], radius);
  }

 private:
  // A side belongs to two cells and must be free in both: the smaller of the two distances.
  // For refuting, that is still no smaller than the truth: the vertex is a place of the path.
  [[nodiscard]] double shared_error(const ChordPolyline& polyline, std::size_t vertex) const {
    const double before = sign_ * polyline.errors[vertex > 0 ? vertex - 1 : 0];
    const double after = sign_ * polyline.errors[std::min(vertex, polyline.edge_count() - 1)];
    return std::min(before, after);
  }

  // The ends are asked by themselves, so that all four sides that meet in a corner of the
  // free space agree about it. The foot is taken first and the half chord measured from it:
  // b^2 - a c would lose all digits on long edges.
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

// Where a reachable part of a side begins, when the whole side is free from `side` on and
// the cell is entered at `entered` on the opposite side.
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

// Goes back from the end of both to their start, each time to the side of the cell by which
// it can have been entered, and there to the place nearest to the vertex.
class WayBack {
 public:
  WayBack(const FreeSpace& space, const FreeSpaceSweep& sweep, const ChordPolyline& a,
          const ChordPolyline& b)
      : space_(space), sweep_(sweep), a_(a), b_(b) {}

  Matching run() {
    MatchedPair here{{a_.edge_count() - 1, 1}, {b_.edge_count() - 1, 1}};
    Matching way{here};
    while (!at_start(here.a) || !at_start(here.b)) {
      const std::optional<MatchedPair> entry = entry_of(here);
      // Corners that two cells with different errors see differently can end the way back;
      // the pairs then do not go forward from the start, and nobody takes them for a proof.
      if (!entry) break;
      here = *entry;
      way.push_back(here);
    }
    std::reverse(way.begin(), way.end());
    return way;
  }

 private:
  struct Choice {
    MatchedPair pair;
    double apart2;
  };

  static bool at_start(const PlaceOnChord& place) { return place.edge == 0 && place.t == 0; }

  // The begin of an edge as the end of the edge before: the place in the cell before.
  static PlaceOnChord begin_of(std::size_t edge) {
    return edge > 0 ? PlaceOnChord{edge - 1, 1} : PlaceOnChord{0, 0};
  }

  // Pair on the left or bottom side of the cell of `exit`, the nearer of the two. On the
  // borders of the free space one path waits at its start.
  [[nodiscard]] std::optional<MatchedPair> entry_of(const MatchedPair& exit) const {
    if (at_start(exit.b)) return MatchedPair{begin_of(exit.a.edge), exit.b};
    if (at_start(exit.a)) return MatchedPair{exit.a, begin_of(exit.b.edge)};
    const std::optional<Choice> left = on_left(exit);
    const std::optional<Choice> bottom = on_bottom(exit);
    if (left && (!bottom || left->apart2 <= bottom->apart2)) return left->pair;
    if (bottom) return bottom->pair;
    return {};
  }

  [[nodiscard]] std::optional<Choice> on_left(const MatchedPair& exit) const {
    const std::size_t row = exit.a.edge;
    const std::size_t column = exit.b.edge;
    const double from = sweep_.reached_right(row, static_cast<std::ptrdiff_t>(column) - 1);
    if (from == kUnreached) return {};
    const double to = std::min(space_.across_column(column, row).to, exit.a.t);
    if (from > to) return {};
    const Point3& vertex = b_.points[column];
    const PlaceOnChord place{row, nearest_parameter(a_, row, vertex, from, to)};
    return Choice{{place, begin_of(column)}, (point_at(a_, place) - vertex).squaredNorm()};
  }

  [[nodiscard]] std::optional<Choice> on_bottom(const MatchedPair& exit) const {
    const std::size_t row = exit.a.edge;
    const std::size_t column = exit.b.edge;
    const double from = sweep_.reached_top(static_cast<std::ptrdiff_t>(row) - 1, column);
    if (from == kUnreached) return {};
    const double to = std::min(space_.across_row(row, column).to, exit.b.t);
    if (from > to) return {};
    const Point3& vertex = a_.points[row];
    const PlaceOnChord place{column, nearest_parameter(b_, column, vertex, from, to)};
    return Choice{{begin_of(row), place}, (point_at(b_, place) - vertex).squaredNorm()};
  }

  const FreeSpace& space_;
  const FreeSpaceSweep& sweep_;
  const ChordPolyline& a_;
  const ChordPolyline& b_;
};

}  // namespace

FreeSpaceAnswer find_passage(const ChordPolyline& a, const ChordPolyline& b, double distance,
                             ChordErrors errors, std::size_t most_cells) {
  const FreeSpace space(a, b, distance, errors);
  FreeSpaceSweep sweep(space, most_cells);
  FreeSpaceAnswer answer;
  answer.passage = sweep.run();
  if (answer.passage == Passage::kFound) answer.way = WayBack(space, sweep, a, b).run();
  if (answer.passage == Passage::kNone) answer.furthest = sweep.furthest();
  return answer;
}

}  // namespace batten::geometry
