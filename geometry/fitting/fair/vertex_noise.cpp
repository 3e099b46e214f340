#include "geometry/fitting/fair/vertex_noise.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace batten::geometry {

namespace {

// Neighbours on either side whose median decides: enough to outvote corners and to know the
// noise to a fifth (with 15, it came out at half its size here and there, and the curve
// followed it), few enough to follow a change of noise along the path.
constexpr std::size_t kWindow = 40;

// For white noise the residuals of neighbours have correlation -1.556 / 1.944 = -0.8, and the
// median of the negative product of two such normal variables of unit variance is 0.36
// (0.9 chi^2 - 0.1 chi^2).
constexpr double kMedianOfProducts = 0.36;

// The distance of vertex i from the cubic through its four neighbours, across the path, scaled
// so that noise of standard deviation s gives residuals of standard deviation s.
Vector3 residual(std::span<const Point3> p, std::span<const double> s, std::size_t i) {
  const std::array<std::size_t, 4> at = {i - 2, i - 1, i + 1, i + 2};
  Vector3 off = p[i];
  double squares = 1;
  for (const std::size_t j : at) {
    double weight = 1;
    for (const std::size_t k : at) {
      if (k != j) weight *= (s[i] - s[k]) / (s[j] - s[k]);
    }
    off -= weight * p[j];
    squares += weight * weight;
  }
  const Vector3 chord = p[i + 1] - p[i - 1];
  const double length = chord.norm();
  if (length > 0) off -= (off.dot(chord) / (length * length)) * chord;
  return off / std::sqrt(squares);
}

// The values of a window that moves along, in order of size.
class SortedWindow {
 public:
  void add(double value) {
    const auto end = values_.begin() + static_cast<std::ptrdiff_t>(size_);
    const auto place = std::upper_bound(values_.begin(), end, value);
    std::copy_backward(place, end, end + 1);
    *place = value;
    ++size_;
  }
  void remove(double value) {
    const auto end = values_.begin() + static_cast<std::ptrdiff_t>(size_);
    const auto place = std::lower_bound(values_.begin(), end, value);
    std::copy(place + 1, end, place);
    --size_;
  }
  [[nodiscard]] double median() const { return values_[size_ / 2]; }

 private:
  std::array<double, 2 * kWindow + 1> values_{};
  std::size_t size_ = 0;
};

}  // namespace

std::vector<double> vertex_noise(std::span<const Point3> points,
                                 std::span<const double> parameters) {
  const std::size_t n = points.size();
  std::vector<double> noise(n, 0);
  if (n < 6) return noise;
  // products[i] belongs to vertices i + 2 and i + 3.
  std::vector<double> products;
  products.reserve(n - 5);
  Vector3 before = residual(points, parameters, 2);
  for (std::size_t i = 3; i + 2 < n; ++i) {
    const Vector3 here = residual(points, parameters, i);
    products.push_back(-before.dot(here));
    before = here;
  }
  SortedWindow window;
  std::size_t begin = 0;
  std::size_t end = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t center = std::clamp<std::size_t>(i, 2, n - 4) - 2;
    while (begin + kWindow < center) window.remove(products[begin++]);
    while (end < products.size() && end <= center + kWindow) window.add(products[end++]);
    noise[i] = std::sqrt(std::max(0.0, window.median()) / kMedianOfProducts);
  }
  return noise;
}

}  // namespace batten::geometry
