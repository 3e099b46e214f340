#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "gcode/curves/bezier_chain.h"
#include "gcode/curves/heidenhain_spl.h"
#include "gcode/curves/klartext_words.h"
#include "gcode/curves/spl_limits.h"
#include "gcode/state/units.h"

namespace batten::gcode {
namespace {

using geometry::CubicBezier;
using geometry::Point3;
using geometry::Vector3;

constexpr std::string_view kSplineAxes = "XYZUVWABC";
constexpr int kGreatestExponent = 255;

// Decimals of the same number, as doubles, differ by less (mm).
constexpr double kDecimalNoise = 1e-9;

bool is_coefficient(const KlartextWord& word) {
  return word.name.size() == 3 && word.name[0] == 'K';
}

bool is_end(const KlartextWord& word) {
  return word.name.size() == 1 && kSplineAxes.find(word.name[0]) != std::string_view::npos &&
         word.value.has_value();
}

// The lines of one block, joined.
struct JoinedBlock {
  std::vector<KlartextWord> words;
  std::uint32_t lines = 0;
  bool understood = true;

  [[nodiscard]] bool is(std::string_view keyword) const {
    return !words.empty() && words.front().is(keyword);
  }
};

JoinedBlock join(const Program& program, std::uint32_t first) {
  JoinedBlock joined;
  bool continues = true;
  for (std::uint32_t at = first; at < program.blocks.size(); ++at) {
    const auto line = read_klartext_line(program.source.text(program.blocks[at].span));
    const bool more = at > first && line && !line->number && !line->words.empty() &&
                      is_coefficient(line->words.front());
    if (!continues && !more) break;
    ++joined.lines;
    if (!line || (at > first && line->number)) {
      joined.understood = false;
      break;
    }
    for (const KlartextWord& word : line->words) joined.words.push_back(word);
    // Only splines are joined where nothing says so.
    continues = line->continues;
    if (!joined.is("SPL") && !continues) break;
  }
  return joined;
}

// What is wrong with the words of a spline, as an alarm's id; empty where nothing is.
std::string_view word_trouble(const JoinedBlock& block) {
  std::string ends;
  std::string coefficients;
  std::string last_axis;
  for (std::size_t i = 1; i < block.words.size(); ++i) {
    const KlartextWord& word = block.words[i];
    if (is_coefficient(word)) {
      coefficients += word.name;
    } else if (is_end(word) && coefficients.empty()) {
      ends += word.name;
    } else if (word.name != "F" && word.name != "FMAX" && word.name != "M") {
      return "spl-words";
    }
  }
  for (std::size_t at = 0; at < coefficients.size(); at += 9) {
    const char axis = coefficients[at + 2];
    const std::string three = {'K', '3', axis, 'K', '2', axis, 'K', '1', axis};
    if (coefficients.substr(at, 9) != three) return "spl-order";
    if (ends.find(axis) == std::string::npos) return "spl-order";
    if (last_axis.find(axis) != std::string::npos) return "spl-order";
    last_axis.push_back(axis);
  }
  if (last_axis.size() != ends.size()) return "spl-order";
  if (ends.size() < 2 || ends.size() > 5) return "spl-axes";
  return {};
}

SplBlock block_of(const JoinedBlock& joined, std::uint32_t at, const Point3& place, double unit) {
  SplBlock block;
  block.block = at;
  block.end = place;
  for (const KlartextWord& word : joined.words) {
    if (word.is("F")) block.feed = word.value;
    if (!is_end(word) && !is_coefficient(word)) continue;
    const char axis = word.name.back();
    if (axis < 'X' || axis > 'Z') continue;
    const int i = axis - 'X';
    if (is_coefficient(word)) {
      block.k[static_cast<std::size_t>(word.name[1] - '1')][i] = *word.value * unit;
    } else {
      block.axes[static_cast<std::size_t>(i)] = true;
      block.end[i] = *word.value * unit;
    }
  }
  return block;
}

// The words that a spline of ours has: no rotary axes, no M.
bool only_main_axes(const JoinedBlock& block) {
  return std::all_of(block.words.begin() + 1, block.words.end(), [](const KlartextWord& word) {
    const char axis = word.name.back();
    const bool main = axis >= 'X' && axis <= 'Z';
    return word.is("F") ? word.value.has_value() : main && (is_end(word) || is_coefficient(word));
  });
}

}  // namespace

Point3 SplBlock::point_at(double t) const { return end + t * (k[0] + t * (k[1] + t * k[2])); }

CubicBezier SplBlock::piece() const {
  return {{point_at(1), end + (2 * k[0] + k[1]) / 3, end + k[0] / 3, end}};
}

std::variant<SplText, CurveRefusal> read_spl_text(const Program& program, std::uint32_t first,
                                                  const CurveStart& start) {
  const double unit = millimetres_per(start.units);
  SplText text;
  Point3 place = start.position.mm;
  for (std::uint32_t at = first; at < program.blocks.size();) {
    const JoinedBlock joined = join(program, at);
    if (!joined.is("SPL")) break;
    if (!joined.understood || !word_trouble(joined).empty() || !only_main_axes(joined)) {
      if (text.pieces.empty()) return CurveRefusal{"an SPL block that is not understood"};
      break;
    }
    const SplBlock block = block_of(joined, at, place, unit);
    if (block.feed && !text.pieces.empty()) break;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (block.axes[axis] && !start.position.known[axis]) {
        return CurveRefusal{"where the tool stands is not known"};
      }
    }
    if ((block.point_at(1) - place).cwiseAbs().maxCoeff() >= kSplClosure) {
      return CurveRefusal{"a spline that starts 1 um or more from where the tool stands"};
    }
    place = block.end;
    text.blocks += joined.lines;
    at += joined.lines;
    text.pieces.push_back(block);
  }
  if (text.pieces.empty()) return CurveRefusal{"no SPL"};
  return text;
}

CurveResult read_spl(const Program& program, std::uint32_t first, const CurveStart& start) {
  auto read = read_spl_text(program, first, start);
  if (auto* refusal = std::get_if<CurveRefusal>(&read)) return std::move(*refusal);
  const SplText& text = std::get<SplText>(read);
  CurveReading reading;
  reading.blocks = text.blocks;
  reading.feed = text.pieces.front().feed;
  Point3 place = start.position.mm;
  for (const SplBlock& block : text.pieces) {
    CubicBezier piece = block.piece();
    if ((piece.control[0] - place).cwiseAbs().maxCoeff() <= kDecimalNoise) {
      piece.control[0] = place;
    }
    place = block.end;
    reading.motions.push_back({block.block, piece});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      reading.axes[axis] = reading.axes[axis] || block.axes[axis];
    }
  }
  return reading;
}

// --- alarms -------------------------------------------------------------------------------------

namespace {

class SplAlarms {
 public:
  SplAlarms(const Program& program, Units units)
      : program_(program), unit_(millimetres_per(units)) {}

  CurveAlarms all() {
    for (std::uint32_t at = 0; at < program_.blocks.size();) {
      const JoinedBlock joined = join(program_, at);
      line_ = program_.blocks[at].line;
      follow(joined, at);
      at += joined.lines;
    }
    return std::move(alarms_);
  }

 private:
  void say(std::string_view id, std::string message, Severity severity = Severity::kError) {
    alarms_.push_back({severity, line_, id, std::move(message)});
  }

  void follow(const JoinedBlock& joined, std::uint32_t at) {
    if (joined.understood && joined.words.empty()) return;
    if (!joined.is("SPL")) {
      before_.reset();
      after_line_ = joined.is("L");
      if (joined.is("L") && joined.understood) move(joined);
      if (!joined.understood || (!joined.is("L") && !joined.words.empty())) known_ = {};
      return;
    }
    if (!after_line_) say("spl-first", "no L before the first SPL");
    after_line_ = true;  // splines follow each other
    const std::string_view trouble = joined.understood ? word_trouble(joined) : "spl-words";
    if (!trouble.empty()) {
      say(trouble, "the words of the block, expected two to five axes, then K3, K2, K1 of each");
      known_ = {};
      before_.reset();
      return;
    }
    check_ranges(joined);
    check_closure(joined);
    check_kink(joined, at);
    move(joined);
  }

  // Where the ends of a block leave the axes, in the program's units.
  void move(const JoinedBlock& joined) {
    for (const KlartextWord& word : joined.words) {
      if (!is_end(word)) continue;
      const auto axis = kSplineAxes.find(word.name[0]);
      place_[axis] = *word.value;
      known_[axis] = true;
    }
  }

  void check_ranges(const JoinedBlock& joined) {
    for (const KlartextWord& word : joined.words) {
      if (is_end(word) && std::abs(*word.value) > kGreatestEnd) {
        say("spl-end", word.name + " beyond 99999.9999");
      }
      if (!is_coefficient(word)) continue;
      if (std::abs(word.mantissa) > kGreatestMantissa || word.decimals > kMantissaDecimals) {
        say("spl-coefficient", word.name + ", expected at most 9.99999999, with an exponent above");
      }
      if (word.exponent && std::abs(*word.exponent) > kGreatestExponent) {
        say("spl-exponent",
            word.name + " with E" + std::to_string(*word.exponent) + ", expected -255 to 255");
      }
    }
  }

  void check_closure(const JoinedBlock& joined) {
    std::array<double, kSplineAxes.size()> implied{};
    for (const KlartextWord& word : joined.words) {
      if (!is_end(word) && !is_coefficient(word)) continue;
      implied[kSplineAxes.find(word.name.back())] += *word.value;
    }
    for (const KlartextWord& word : joined.words) {
      if (!is_end(word)) continue;
      const auto axis = kSplineAxes.find(word.name[0]);
      if (!known_[axis]) continue;
      const double off = std::abs(implied[axis] - place_[axis]) * unit_;
      if (off < kSplClosure) continue;
      say("spl-closure", word.name + " starts " +
                             to_text(std::min(off * 1000, kGreatestEnd), {.decimals = 3}) +
                             " um from where the tool stands, expected less than 1 um");
    }
  }

  void check_kink(const JoinedBlock& joined, std::uint32_t at) {
    Point3 place = Point3::Zero();
    for (int axis = 0; axis < 3; ++axis)
      place[axis] = place_[static_cast<std::size_t>(axis)] * unit_;
    const CubicBezier piece = block_of(joined, at, place, unit_).piece();
    if (before_) {
      const double kink = kink_between(*before_, piece);
      if (kink >= kSplKink) {
        say("spl-kink",
            to_text(kink * 180 / std::numbers::pi, {.decimals = 3}) +
                " degrees between two splines, expected less than 0.1",
            Severity::kWarning);
      }
    }
    before_ = piece;
  }

  const Program& program_;
  double unit_;
  CurveAlarms alarms_;
  std::uint32_t line_ = 0;
  std::array<double, kSplineAxes.size()> place_{};
  std::array<bool, kSplineAxes.size()> known_{};
  bool after_line_ = false;
  std::optional<CubicBezier> before_;
};

}  // namespace

CurveAlarms spl_alarms(const Program& program, Units units) {
  return SplAlarms(program, units).all();
}

}  // namespace batten::gcode
