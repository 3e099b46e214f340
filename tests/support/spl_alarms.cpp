#include "tests/support/spl_alarms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "gcode/curves/curve_print.h"
#include "gcode/curves/heidenhain_spl.h"

namespace batten::gcode {
namespace {

using geometry::CubicBezier;
using geometry::Point3;

constexpr int kGreatestExponent = 255;

class SplAlarms {
 public:
  SplAlarms(const Program& program, Units units)
      : program_(program), unit_(millimetres_per(units)) {}

  CurveAlarms all() {
    for (std::uint32_t at = 0; at < program_.blocks.size();) {
      const SplWords joined = joined_at(program_, at);
      line_ = program_.blocks[at].line;
      follow(joined);
      at += joined.lines;
    }
    return std::move(alarms_);
  }

 private:
  void say(std::string_view id) { alarms_.push_back({line_, id}); }

  void follow(const SplWords& joined) {
    if (joined.understood && joined.words.empty()) return;
    if (!joined.is("SPL")) {
      before_.reset();
      after_line_ = joined.is("L");
      if (joined.is("L") && joined.understood) move(joined);
      if (!joined.understood || (!joined.is("L") && !joined.words.empty())) known_ = {};
      return;
    }
    if (!after_line_) say("spl-first");
    after_line_ = true;  // splines follow each other
    const std::string_view trouble = joined.understood ? spl_word_trouble(joined) : "spl-words";
    if (!trouble.empty()) {
      say(trouble);
      known_ = {};
      before_.reset();
      return;
    }
    check_ranges(joined);
    check_closure(joined);
    check_kink(joined);
    move(joined);
  }

  // Where the ends of a block leave the axes, in the program's units.
  void move(const SplWords& joined) {
    for (const KlartextWord& word : joined.words) {
      if (!is_spl_end(word)) continue;
      const auto axis = kSplAxes.find(word.name[0]);
      place_[axis] = *word.value;
      known_[axis] = true;
    }
  }

  void check_ranges(const SplWords& joined) {
    for (const KlartextWord& word : joined.words) {
      if (is_spl_end(word) && std::abs(*word.value) > kGreatestEnd) say("spl-end");
      if (!is_spl_coefficient(word)) continue;
      if (std::abs(word.mantissa) > kGreatestMantissa || word.decimals > kMantissaDecimals) {
        say("spl-coefficient");
      }
      if (word.exponent && std::abs(*word.exponent) > kGreatestExponent) say("spl-exponent");
    }
  }

  void check_closure(const SplWords& joined) {
    std::array<double, kSplAxes.size()> implied{};
    for (const KlartextWord& word : joined.words) {
      if (!is_spl_end(word) && !is_spl_coefficient(word)) continue;
      implied[kSplAxes.find(word.name.back())] += *word.value;
    }
    for (const KlartextWord& word : joined.words) {
      if (!is_spl_end(word)) continue;
      const auto axis = kSplAxes.find(word.name[0]);
      if (!known_[axis]) continue;
      const double off = std::abs(implied[axis] - place_[axis]) * unit_;
      if (off < kSplClosure) continue;
      say("spl-closure");
    }
  }

  void check_kink(const SplWords& joined) {
    Point3 place = Point3::Zero();
    for (int axis = 0; axis < 3; ++axis)
      place[axis] = place_[static_cast<std::size_t>(axis)] * unit_;
    const CubicBezier piece = spl_block_of(joined, place, unit_).piece;
    if (before_) {
      const double kink = kink_between(*before_, piece);
      if (kink >= kSplKink) say("spl-kink");
    }
    before_ = piece;
  }

  const Program& program_;
  double unit_;
  CurveAlarms alarms_;
  std::uint32_t line_ = 0;
  std::array<double, kSplAxes.size()> place_{};
  std::array<bool, kSplAxes.size()> known_{};
  bool after_line_ = false;
  std::optional<CubicBezier> before_;
};

}  // namespace

CurveAlarms spl_alarms(const Program& program, Units units) {
  return SplAlarms(program, units).all();
}

}  // namespace batten::gcode
