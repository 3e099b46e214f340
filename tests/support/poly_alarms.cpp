#include "tests/support/poly_alarms.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "gcode/curves/siemens_curves.h"

namespace batten::gcode {
namespace {

// By the Bernstein coefficients of halves, which hold the polynomial between them.
bool is_positive(std::vector<double> b, int depth) {
  if (std::ranges::all_of(b, [](double value) { return value > 0; })) return true;
  if (!(b.front() > 0) || !(b.back() > 0) || depth == 0) return false;
  std::vector<double> left;
  std::vector<double> right(b.size());
  for (std::size_t n = b.size(); n > 0; --n) {
    left.push_back(b.front());
    right[n - 1] = b[n - 1];
    for (std::size_t i = 0; i + 1 < n; ++i) b[i] = (b[i] + b[i + 1]) / 2;
  }
  return is_positive(std::move(left), depth - 1) && is_positive(std::move(right), depth - 1);
}

double choose(std::size_t n, std::size_t k) {
  double value = 1;
  for (std::size_t i = 1; i <= k; ++i) {
    value *= static_cast<double>(n - k + i) / static_cast<double>(i);
  }
  return value;
}

// a0, a1, a2 .. of the denominator, which is 1 at 0 and `given` at `length`: its end as printed and
// a2, a3 .. behind it.
std::vector<double> denominator_of(const std::vector<double>& given, double length) {
  std::vector<double> a = {1, 0};
  double rest = given.front() - 1;
  for (std::size_t k = 1; k < given.size(); ++k) {
    a.push_back(given[k]);
    rest -= given[k] * std::pow(length, static_cast<double>(k + 1));
  }
  a[1] = rest / length;
  return a;
}

// Whether it is above 0 on [0, length].
bool is_positive_until(const std::vector<double>& a, double length) {
  const std::size_t n = a.size() - 1;
  std::vector<double> bernstein(n + 1, 0.0);
  for (std::size_t i = 0; i <= n; ++i) {
    for (std::size_t k = 0; k <= i; ++k) {
      bernstein[i] += choose(i, k) / choose(n, k) * a[k] * std::pow(length, static_cast<double>(k));
    }
  }
  // After 40 halvings an interval is below the rounding of its ends.
  return is_positive(std::move(bernstein), 40);
}

class PolyAlarms {
 public:
  explicit PolyAlarms(const Program& program) : program_(program) {}

  CurveAlarms all() {
    for (const Block& block : program_.blocks) follow(block);
    return std::move(alarms_);
  }

 private:
  void say(std::uint32_t line, std::string_view id) { alarms_.push_back({line, id}); }

  void follow(const Block& block) {
    const std::string_view text = program_.source.text(block.span);
    if (text.size() > kSiemensLine) say(block.line, "line-too-long");
    const auto words = read_siemens_words(text);
    if (!words) return;
    for (const SiemensWord& word : *words) set_mode(word);
    check(block.line, words);
  }

  // POLY is ended by the other members of its group.
  void set_mode(const SiemensWord& word) {
    if (word.is("POLY")) active_ = true;
    if (word.is("ASPLINE") || word.is("BSPLINE") || word.is("CSPLINE")) active_ = false;
    if (!word.is("G") || word.values.size() != 1) return;
    const double code = word.value();
    if (code == 0 || code == 1 || code == 2 || code == 3) active_ = false;
    if (code == 40) compensation_ = false;
    if (code == 41 || code == 42) compensation_ = true;
  }

  void check(std::uint32_t line, const std::optional<std::vector<SiemensWord>>& words) {
    const PolyWords block = poly_words_of(words);
    if (block.any_polynomial() && !active_) say(line, "poly-not-active");
    if (block.any_polynomial() && compensation_) say(line, "poly-compensation");
    if (!block.any_polynomial()) return;
    const double length = block.length.value_or(1);
    if (length < kShortestPoly || length > kLongestPoly) {
      say(line, "poly-length");
      return;
    }
    check_degrees(line, block);
    if (block.denominator == nullptr) return;
    const std::vector<double>& given = block.denominator->values;
    if (!is_positive_until(denominator_of(given, length), length)) say(line, "poly-denominator");
  }

  void check_degrees(std::uint32_t line, const PolyWords& block) {
    for (const SiemensWord* word : block.polynomial) {
      if (word == nullptr || word->values.size() <= 3) continue;
      say(line, "poly-degree");
    }
  }

  const Program& program_;
  CurveAlarms alarms_;
  bool active_ = false;
  bool compensation_ = false;
};

}  // namespace

CurveAlarms poly_alarms(const Program& program) { return PolyAlarms(program).all(); }

}  // namespace batten::gcode
