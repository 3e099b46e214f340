#include "tests/support/nurbs_alarms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace batten::gcode {
namespace {

// Two printed numbers that differ by less are the same number: decimals as doubles.
constexpr double kSameNumber = 1e-9;

// One value of one word, and where it stands.
struct Given {
  double value = 0;
  std::uint32_t line = 0;
};

// G codes times ten, so that 6.2 is a whole number.
int tenths(const Word& word) { return static_cast<int>(std::lround(word.value * 10)); }

// Codes of group 01, which end a curve.
bool ends_curve(int code) { return code == 0 || code == 10 || code == 20 || code == 30; }

// What the control calls what is wrong with a block.
struct AlarmNames {
  std::string_view missing_knot = "PS1002";
  std::string_view wrong_mode = "PS1006";   // G06.2 under G41, G93 ..
  std::string_view wrong_start = "PS1009";  // the first point is not the tool's position
  std::string_view decreasing = "knot-decreases";
  std::string_view axis_too_late = "axis-not-in-first-block";
  std::string_view too_many_decimals = "too-many-decimals";
};
constexpr AlarmNames kMitsubishiNames = {"P33", "P29", "start-differs", "P551", "P32", "P33"};

class NurbsAlarms {
 public:
  NurbsAlarms(const Program& program, const NurbsRules& rules)
      : program_(program),
        rules_(rules),
        names_(rules.three_axes ? kMitsubishiNames : AlarmNames()) {}

  CurveAlarms all() {
    for (const Block& block : program_.blocks) follow(block);
    if (in_curve_) cut_short(program_.blocks.empty() ? 1 : program_.blocks.back().line);
    // What is wrong with the first and inner knots is known at the end of the curve only.
    std::stable_sort(alarms_.begin(), alarms_.end(),
                     [](const CurveAlarm& a, const CurveAlarm& b) { return a.line < b.line; });
    return std::move(alarms_);
  }

 private:
  struct Words {
    std::vector<int> codes;
    std::array<const Word*, 3> place{};
    const Word* knot = nullptr;
    const Word* weight = nullptr;
    const Word* order = nullptr;
    const Word* foreign = nullptr;  // the first word that no curve has
  };

  void say(std::uint32_t line, std::string_view id) { alarms_.push_back({line, id}); }

  Words words_of(const Block& block) const {
    Words words;
    for (const Word& word : program_.words_of(block)) {
      switch (word.letter) {
        case 'G':
          words.codes.push_back(tenths(word));
          break;
        case 'X':
        case 'Y':
        case 'Z':
          words.place[static_cast<std::size_t>(word.letter - 'X')] = &word;
          break;
        case 'K':
          words.knot = &word;
          break;
        case 'R':
          words.weight = &word;
          break;
        case 'P':
          words.order = &word;
          break;
        case 'N':
        case 'F':
          break;
        default:
          if (words.foreign == nullptr) words.foreign = &word;
      }
    }
    return words;
  }

  void follow(const Block& block) {
    const Words words = words_of(block);
    if (block.word_count == 0 && block.opacity == ParseStatus::kNone) return;
    const bool begins = std::ranges::count(words.codes, 62) > 0;
    const bool changes_mode = std::ranges::any_of(words.codes, ends_curve);
    if (in_curve_ && (begins || changes_mode)) cut_short(block.line);
    if (begins) {
      begin(block, words);
    } else if (in_curve_) {
      inside(block, words);
    } else {
      outside(words);
    }
  }

  // The curve ends before all its knots have come.
  void cut_short(std::uint32_t line) {
    in_curve_ = false;
    say(line, ending_knots_ == 0 ? "PS1005" : "PS1004");
  }

  void begin(const Block& block, const Words& words) {
    in_curve_ = true;
    ending_knots_ = 0;
    points_ = 0;
    knots_.clear();
    order_ = 4;
    if (words.order != nullptr) {
      order_ = static_cast<std::size_t>(std::max(0.0, words.order->value));
      if (order_ < 2 || order_ > 4) {
        say(block.line, "order");
        order_ = 4;
      }
    }
    if (compensated_ || !per_minute_ || polar_) say(block.line, names_.wrong_mode);
    if (rules_.framed && !framed_) say(block.line, "frame");
    check_first_point(block, words);
    if (words.foreign != nullptr || words.codes.size() > 1) say(block.line, "foreign-word");
    add_point(block, words);
  }

  void check_first_point(const Block& block, const Words& words) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      named_[axis] = words.place[axis] != nullptr;
      if (!named_[axis]) {
        if (rules_.three_axes) say(block.line, names_.axis_too_late);
        continue;
      }
      const double given = words.place[axis]->value;
      const std::optional<double> wanted = incremental_ ? std::optional(0.0) : place_[axis];
      if (wanted && std::abs(given - *wanted) > kSameNumber) say(block.line, names_.wrong_start);
    }
  }

  void inside(const Block& block, const Words& words) {
    const bool has_place =
        words.place[0] != nullptr || words.place[1] != nullptr || words.place[2] != nullptr;
    if (words.foreign != nullptr || words.order != nullptr || !words.codes.empty() ||
        block.opacity != ParseStatus::kNone) {
      say(block.line, "foreign-word");
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (words.place[axis] != nullptr && !named_[axis]) say(block.line, names_.axis_too_late);
    }
    if (has_place) {
      if (ending_knots_ > 0) say(block.line, "point-too-late");
      add_point(block, words);
      return;
    }
    add_knot(block, words);
    ++ending_knots_;
    if (ending_knots_ == order_) finish(block.line);
  }

  void add_point(const Block& block, const Words& words) {
    ++points_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Word* word = words.place[axis];
      if (word == nullptr) continue;
      place_[axis] = incremental_ && place_[axis] ? *place_[axis] + word->value : word->value;
    }
    if (words.weight != nullptr) {
      check_decimals(block, *words.weight);
      if (!(words.weight->value > 0)) say(block.line, "weight");
    }
    add_knot(block, words);
  }

  void add_knot(const Block& block, const Words& words) {
    if (words.knot == nullptr) {
      say(block.line, names_.missing_knot);
      return;
    }
    check_decimals(block, *words.knot);
    const double knot = words.knot->value;
    const double most = std::pow(10.0, rules_.knots.digits - rules_.knots.decimals);
    if (std::abs(knot) >= most) say(block.line, "knot-range");
    if (!knots_.empty() && knot < knots_.back().value) say(block.line, names_.decreasing);
    knots_.push_back({knot, block.line});
  }

  void check_decimals(const Block& block, const Word& word) {
    if (word.decimals <= rules_.knots.decimals) return;
    say(block.line, names_.too_many_decimals);
  }

  // All knots have come.
  void finish(std::uint32_t line) {
    in_curve_ = false;
    if (points_ < order_) {
      say(line, "few-points");
      return;
    }
    if (knots_.size() != points_ + order_) return;  // said already
    const auto same = [this](std::size_t from, std::size_t to) {
      return std::abs(knots_[to].value - knots_[from].value) < kSameNumber;
    };
    if (!same(0, order_ - 1)) say(knots_[0].line, "PS1007");
    if (!same(knots_.size() - order_, knots_.size() - 1)) say(line, "PS1007");
    for (std::size_t i = 0; i + order_ < knots_.size(); ++i) {
      if (same(i, i + order_)) {
        say(knots_[i + order_].line, "PS1008");
        return;
      }
    }
  }

  // A block that is no part of a curve: modes and the place.
  void outside(const Words& words) {
    bool moves = true;
    for (const int code : words.codes) {
      set_mode(code, words);
      // Reference points, offsets and cycles move in ways that are not followed.
      if (code != 0 && code != 10 && code != 20 && code != 30) moves = moves && harmless(code);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Word* word = words.place[axis];
      if (word == nullptr) continue;
      if (!moves || !word->is_number || incremental_) {
        place_[axis].reset();
      } else {
        place_[axis] = word->value;
      }
    }
  }

  static bool harmless(int code) {
    constexpr std::array<int, 20> kCodes = {50,  170, 180, 190, 200, 210, 400, 410, 420, 430,
                                            490, 540, 610, 640, 900, 910, 930, 940, 950, 131};
    return std::ranges::count(kCodes, code) > 0;
  }

  void set_mode(int code, const Words& words) {
    if (code == 400 || code == 410 || code == 420) compensated_ = code != 400;
    if (code == 930 || code == 940 || code == 950) per_minute_ = code == 940;
    if (code == 121 || code == 131) polar_ = code == 121;
    if (code == 900) incremental_ = false;
    if (code == 910) incremental_ = true;
    if (code == 50 && words.order != nullptr) framed_ = words.order->value == 10000;
  }

  const Program& program_;
  const NurbsRules& rules_;
  AlarmNames names_;
  CurveAlarms alarms_;

  std::array<std::optional<double>, 3> place_;  // in the program's units
  bool compensated_ = false;
  bool per_minute_ = true;
  bool polar_ = false;
  bool incremental_ = false;
  bool framed_ = false;

  bool in_curve_ = false;
  std::size_t order_ = 4;
  std::size_t points_ = 0;
  std::size_t ending_knots_ = 0;
  std::array<bool, 3> named_{};
  std::vector<Given> knots_;
};

}  // namespace

CurveAlarms nurbs_alarms(const Program& program, const NurbsRules& rules) {
  return NurbsAlarms(program, rules).all();
}

}  // namespace batten::gcode
