#include "geometry/fitting/fair/corner_test.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace batten::geometry {

namespace {

// One value per vertex of a window.
using WindowColumn = std::array<double, 2 * kMostBesideKink + 1>;

double dot_of(const WindowColumn& a, const WindowColumn& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

void take_out(WindowColumn& from, const WindowColumn& other) {
  const double part = dot_of(from, other) / dot_of(other, other);
  for (std::size_t i = 0; i < from.size(); ++i) from[i] -= part * other[i];
}

// A bend that changes along the window must not count as a kink: the higher the degree, the less it
// does, and the less is a kink told from noise. Beyond a short side a bend is known least.
std::size_t degree_for(std::size_t before, std::size_t behind) {
  const std::size_t beside = std::min(before, behind);
  if (beside >= 6) return 4;
  if (beside >= 3) return 3;
  return std::min<std::size_t>(4, before + behind - 3);
}

}  // namespace

// Least squares with the columns 1, t, t^2 .. and |t|: what is left of |t| when the others are
// taken out of it gives its coefficient alone.
std::optional<Kink> kink_at(std::span<const Point3> points, std::span<const double> parameters,
                            std::size_t vertex, double noise) {
  const std::size_t before = std::min(vertex, kMostBesideKink);
  const std::size_t behind = std::min(points.size() - 1 - vertex, kMostBesideKink);
  if (std::min(before, behind) == 0 || before + behind < kFewestAroundKink) return std::nullopt;
  const std::size_t first = vertex - before;
  const std::size_t count = before + behind + 1;
  const double scale = parameters[first + count - 1] - parameters[first];

  WindowColumn place{};  // t; entries beyond the window stay 0
  WindowColumn broken{};
  for (std::size_t i = 0; i < count; ++i) {
    place[i] = (parameters[first + i] - parameters[vertex]) / scale;
    broken[i] = std::abs(place[i]);
  }
  std::array<WindowColumn, 5> powers{};
  const std::size_t degree = degree_for(before, behind);
  for (std::size_t i = 0; i < count; ++i) powers[0][i] = 1;
  for (std::size_t k = 1; k <= degree; ++k) {
    for (std::size_t i = 0; i < count; ++i) powers[k][i] = powers[k - 1][i] * place[i];
  }
  for (std::size_t k = 0; k <= degree; ++k) {
    for (std::size_t j = 0; j < k; ++j) take_out(powers[k], powers[j]);
    take_out(broken, powers[k]);
  }

  Vector3 sum = Vector3::Zero();
  for (std::size_t i = 0; i < count; ++i) sum += broken[i] * (points[first + i] - points[vertex]);
  const double square = dot_of(broken, broken);
  // The directions of the two sides are of unit length, and this is their difference.
  const double jump = 2 / (square * scale) * sum.norm();
  return Kink{2 * std::asin(std::min(1.0, 0.5 * jump)), 2 * noise / (std::sqrt(square) * scale)};
}

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
