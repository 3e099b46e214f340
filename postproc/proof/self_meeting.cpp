#include "postproc/proof/self_meeting.h"

#include <algorithm>
#include <cmath>
#include <compare>

#include "geometry/distance/chord_polyline.h"

namespace batten::postproc {

namespace {

using geometry::Point3;
using geometry::Vector3;

// As new_crossings have it.
constexpr double kChordPart = 0.01;

// A path with more chords of arcs than twice this is cut into longer ones as a whole, whose error
// is greater by the square (geometry/distance/chord_polyline.h): their number here is known to a
// factor of two.
constexpr double kManyChords = 1 << 19;

// mm: how far chords must be from each other so that neither they meet, nor those into which
// new_crossings cuts the whole path.
double least_distance(double tolerance, std::size_t bent_chords) {
  const double longer = static_cast<double>(bent_chords) / kManyChords;
  if (longer <= 1) return SelfMeeting::kApart;
  return SelfMeeting::kApart + 2 * kChordPart * tolerance * (1 + longer * longer);
}

// Of cells that chords go through, held at a time.
constexpr std::size_t kMostEntries = std::size_t{1} << 21;

// Pairs of chords that are looked at, for each chord: above this the path lies in a heap.
constexpr std::size_t kMostPairs = 1000;

// mm, of two segments that both have a length.
double distance(const Point3& a, const Point3& b, const Point3& c, const Point3& d) {
  const Vector3 first = b - a;
  const Vector3 second = d - c;
  const Vector3 between = a - c;
  const double aa = first.squaredNorm();
  const double ee = second.squaredNorm();
  const double along_first = first.dot(between);
  const double along_second = second.dot(between);
  const double both = first.dot(second);
  const double across = aa * ee - both * both;
  double s =
      across > 0 ? std::clamp((both * along_second - along_first * ee) / across, 0.0, 1.0) : 0;
  double t = (both * s + along_second) / ee;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = std::clamp((both * t - along_first) / aa, 0.0, 1.0);
  }
  return (between + s * first - t * second).norm();
}

double distance(const Point3& point, const Point3& a, const Point3& b) {
  const Vector3 edge = b - a;
  const double t = std::clamp((point - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
  return (a + t * edge - point).norm();
}

struct Entry {
  std::uint32_t cell = 0;  // its number, of few: others may have the same
  std::uint32_t edge = 0;
  auto operator<=>(const Entry&) const = default;  // NOLINT(modernize-use-nullptr): a false alarm
};

// The cells of a grid in space through which the edges of a path go.
class Cells {
 public:
  // `apart`: mm, edges that are so near to each other share a cell.
  Cells(std::span<const Point3> corners, double apart) : corners_(corners), apart_(apart) {
    double length = 0;
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      length += (corners[i + 1] - corners[i]).norm();
    }
    constexpr double kEdgesPerCell = 2;
    size_ = std::max(kEdgesPerCell * length / static_cast<double>(corners.size()), 4 * apart);
    // A step of this length goes through eight cells at the most, mostly one or two.
    entries_ = length / size_ * 8 + static_cast<double>(corners.size()) * 8;
  }

  // Into how many parts the cells have to be divided, so that each has few entries.
  [[nodiscard]] std::uint32_t parts() const {
    return static_cast<std::uint32_t>(std::ceil(entries_ / static_cast<double>(kMostEntries)));
  }

  // Those of the cells whose numbers leave this rest.
  [[nodiscard]] std::vector<Entry> entries(std::uint32_t parts, std::uint32_t rest) const {
    std::vector<Entry> found;
    const auto add = [&](std::uint32_t cell, std::uint32_t edge) {
      if (cell % parts == rest) found.push_back({cell, edge});
    };
    for (std::uint32_t i = 0; i + 1 < corners_.size(); ++i) add_edge(i, add);
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

 private:
  // Calls `add(cell, edge)` for each cell that a step of the edge may go through.
  template <typename Add>
  void add_edge(std::uint32_t edge, const Add& add) const {
    const Point3& from = corners_[edge];
    const Vector3 whole = corners_[edge + 1] - from;
    const auto steps = std::floor(whole.norm() / size_) + 1;
    for (double k = 0; k < steps; ++k) {
      const Point3 a = from + k / steps * whole;
      const Point3 b = from + (k + 1) / steps * whole;
      const Point3 low = a.cwiseMin(b).array() - apart_;
      const Point3 high = a.cwiseMax(b).array() + apart_;
      for (std::int64_t x = index(low.x()); x <= index(high.x()); ++x) {
        for (std::int64_t y = index(low.y()); y <= index(high.y()); ++y) {
          for (std::int64_t z = index(low.z()); z <= index(high.z()); ++z) {
            add(number(x, y, z), edge);
          }
        }
      }
    }
  }

  [[nodiscard]] std::int64_t index(double mm) const {
    return static_cast<std::int64_t>(std::floor(mm / size_));
  }

  static std::uint32_t number(std::int64_t x, std::int64_t y, std::int64_t z) {
    std::uint64_t mixed = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15U;
    mixed = (mixed ^ (mixed >> 31U) ^ static_cast<std::uint64_t>(y)) * 0xBF58476D1CE4E5B9U;
    mixed = (mixed ^ (mixed >> 29U) ^ static_cast<std::uint64_t>(z)) * 0x94D049BB133111EBU;
    return static_cast<std::uint32_t>(mixed >> 32U);
  }

  std::span<const Point3> corners_;
  double apart_;
  double size_ = 1;     // mm
  double entries_ = 0;  // at most
};

bool boxes_apart(const Point3& a, const Point3& b, const Point3& c, const Point3& d, double apart) {
  const Point3 low = a.cwiseMin(b).cwiseMax(c.cwiseMin(d));
  const Point3 high = a.cwiseMax(b).cwiseMin(c.cwiseMax(d));
  return ((low - high).array() > apart).any();
}

// Whether the path goes on from b to c without turning, between edges from a and to d that are much
// longer: then these lie on either side of the short step, with all chords of the same pieces. b
// and c are ends of pieces: chords of one arc are of equal length.
bool goes_on(const Point3& a, const Point3& b, const Point3& c, const Point3& d, double apart) {
  constexpr double kMuchLonger = 10;  // then such chords turn by less than 0.2 radians
  constexpr double kCosine = 0.5;
  const Vector3 before = b - a;
  const Vector3 step = c - b;
  const Vector3 after = d - c;
  const double longer = kMuchLonger * apart;
  if (before.norm() < longer || after.norm() < longer) return false;
  const auto ahead = [](const Vector3& u, const Vector3& v) {
    return u.dot(v) >= kCosine * u.norm() * v.norm();
  };
  return ahead(before, step) && ahead(step, after) && ahead(before, after);
}

// Whether edges that share a cell are so near that they may meet, other than neighbours, or too
// many are to be looked at.
bool may_any_meet(std::span<const Point3> corners, std::span<const Entry> entries, double apart,
                  std::size_t& left) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    for (std::size_t k = i + 1; k < entries.size() && entries[k].cell == entries[i].cell; ++k) {
      if (left-- == 0) return true;
      const std::uint32_t first = entries[i].edge;
      const std::uint32_t second = entries[k].edge;
      if (second == first + 1) continue;
      const Point3& a = corners[first];
      const Point3& b = corners[first + 1];
      const Point3& c = corners[second];
      const Point3& d = corners[second + 1];
      if (boxes_apart(a, b, c, d, apart)) continue;
      if (second == first + 2 && goes_on(a, b, c, d, apart)) continue;
      if (distance(a, b, c, d) <= apart) return true;
    }
  }
  return false;
}

}  // namespace

void SelfMeeting::add(std::span<const geometry::PathPiece> path) {
  if (path.empty()) return;
  const geometry::ChordPolyline chords = geometry::cut_into_chords(path, kChordPart * tolerance_);
  for (std::size_t i = 0; i < chords.edge_count(); ++i) {
    if (!std::holds_alternative<geometry::Line>(path[chords.pieces[i]])) ++bent_chords_;
  }
  for (const Point3& corner : chords.points) {
    if (!corners_.empty()) {
      const double length = (corner - corners_.back()).norm();
      if (length == 0) continue;
      has_short_chords_ = has_short_chords_ || length <= kApart;
    }
    corners_.push_back(corner);
  }
}

bool SelfMeeting::turns_back() const {
  for (std::size_t i = 0; i + 2 < corners_.size(); ++i) {
    const Point3& a = corners_[i];
    const Point3& b = corners_[i + 1];
    const Point3& c = corners_[i + 2];
    if (distance(c, a, b) <= kApart || distance(a, b, c) <= kApart) return true;
  }
  return false;
}

bool SelfMeeting::may_meet() const {
  if (has_short_chords_ || turns_back()) return true;
  if (edges() < 2) return false;
  const double apart = least_distance(tolerance_, bent_chords_);
  const Cells cells(corners_, apart);
  std::size_t left = kMostPairs * edges();
  for (std::uint32_t rest = 0; rest < cells.parts(); ++rest) {
    if (may_any_meet(corners_, cells.entries(cells.parts(), rest), apart, left)) return true;
  }
  return false;
}

}  // namespace batten::postproc
