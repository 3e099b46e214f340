#include "postproc/report/page_thinning.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "geometry/basic/rounding.h"

namespace batten::postproc {
namespace {

// As many vertices are left out in a row at the most: each step asks all of them again.
constexpr std::size_t kMostInARow = 64;

// Whether the vertices between two places of the list are on the straight way between them.
class StraightWay {
 public:
  StraightWay(const std::vector<PageVertex>& vertices, const Thinning& thinning)
      : vertices_(vertices), thinning_(thinning) {}

  [[nodiscard]] bool holds(std::size_t from, std::size_t to) const {
    const PageVertex& a = vertices_[from];
    const PageVertex& b = vertices_[to];
    const double whole = (b.place - a.place).norm();
    for (std::size_t i = from + 1; i < to; ++i) {
      const PageVertex& v = vertices_[i];
      const double share = whole > geometry::kSamePlace
                               ? (v.place - a.place).norm() / whole
                               : static_cast<double>(i - from) / static_cast<double>(to - from);
      if (share > 1 || !is_near(v, a, b, share)) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] bool is_near(const PageVertex& v, const PageVertex& a, const PageVertex& b,
                             double share) const {
    const double rest = 1 - share;
    const auto near = [&](double value, double from, double to) {
      return std::abs(value - (rest * from + share * to)) <= thinning_.speed_error;
    };
    return (v.place - (rest * a.place + share * b.place)).norm() <= thinning_.error &&
           (v.offset - (rest * a.offset + share * b.offset)).norm() <= thinning_.error &&
           near(v.speed_before, a.speed_before, b.speed_before) &&
           near(v.speed_after, a.speed_after, b.speed_after);
  }

  const std::vector<PageVertex>& vertices_;
  const Thinning& thinning_;
};

// Whether the chain goes on behind the vertex as it came.
bool goes_on(const PageVertex& vertex, const PageVertex& next) {
  return vertex.step != PageStep::kNone && vertex.step == next.step && vertex.run == next.run &&
         vertex.feed == next.feed;
}

}  // namespace

std::vector<PageVertex> thinned(const std::vector<PageVertex>& vertices, const Thinning& thinning) {
  const StraightWay straight(vertices, thinning);
  std::vector<PageVertex> kept;
  if (vertices.empty()) return kept;
  kept.push_back(vertices.front());
  std::size_t from = 0;
  while (from + 1 < vertices.size()) {
    std::size_t to = from + 1;
    while (to + 1 < vertices.size() && to - from < kMostInARow &&
           goes_on(vertices[to], vertices[to + 1]) && straight.holds(from, to + 1)) {
      ++to;
    }
    kept.push_back(vertices[to]);
    from = to;
  }
  return kept;
}

}  // namespace batten::postproc
