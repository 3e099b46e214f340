#include "geometry/distance/joints.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace batten::geometry {

namespace {

// Of the length between two joints, by which the paths may differ: much more than a path that is
// smoothed gets shorter by, and less than a loop.
constexpr double kLonger = 0.1;

std::size_t hash_of(const Point3& place) {
  const std::hash<double> hash;
  std::size_t sum = 0;
  for (const double mm : place) sum = sum * 31 + hash(mm + 0.0);  // -0 is 0
  return sum;
}

}  // namespace

std::vector<Joint> joints_of(std::span<const PassedPlace> a, std::span<const PassedPlace> b,
                             std::size_t apart) {
  std::vector<std::pair<std::size_t, std::size_t>> places;  // of `a`: hash and index
  places.reserve(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) places.emplace_back(hash_of(a[i].place), i);
  std::ranges::sort(places);
  std::vector<Joint> joints;
  Joint last;
  double length_a = 0;  // up to the last one
  double length_b = 0;
  for (std::size_t k = 0; k < b.size(); ++k) {
    const std::size_t hash = hash_of(b[k].place);
    // The first of them that is behind the last joint.
    for (auto at = std::ranges::lower_bound(places, std::pair(hash, last.a));
         at != places.end() && at->first == hash; ++at) {
      const PassedPlace& other = a[at->second];
      const double on_a = other.length - length_a;
      const double on_b = b[k].length - length_b;
      if (std::abs(on_a - on_b) > kLonger * std::max(on_a, on_b)) continue;
      if (other.place != b[k].place) continue;
      const Joint joint{at->second + 1, k + 1};
      if (joint.a - last.a < apart && joint.b - last.b < apart) break;
      joints.push_back(joint);
      last = joint;
      length_a = other.length;
      length_b = b[k].length;
      break;
    }
  }
  return joints;
}

}  // namespace batten::geometry
