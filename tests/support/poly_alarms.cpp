#include "tests/support/poly_alarms.h"

#include <string>
#include <utility>
#include <vector>

#include "gcode/curves/siemens_poly.h"
#include "gcode/curves/siemens_words.h"

namespace batten::gcode {
namespace {

class PolyAlarms {
 public:
  explicit PolyAlarms(const Program& program) : program_(program) {}

  CurveAlarms all() {
    for (const Block& block : program_.blocks) follow(block);
    return std::move(alarms_);
  }

 private:
  void say(std::uint32_t line, std::string_view id, std::string message) {
    alarms_.push_back({Severity::kError, line, id, std::move(message)});
  }

  void follow(const Block& block) {
    const std::string_view text = program_.source.text(block.span);
    if (text.size() > kSiemensLine) {
      say(block.line, "line-too-long", std::to_string(text.size()) + " characters, expected 512");
    }
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
    if (block.any_polynomial() && !active_) {
      say(line, "poly-not-active", "PO without POLY: a straight line to the end point");
    }
    if (block.any_polynomial() && compensation_) {
      say(line, "poly-compensation", "POLY under G41 or G42");
    }
    if (!block.any_polynomial()) return;
    const double length = block.length.value_or(1);
    if (length < kShortestPoly || length > kLongestPoly) {
      say(line, "poly-length", "PL=" + std::to_string(length) + ", expected 0.0001 to 99999.9999");
      return;
    }
    check_degrees(line, block);
    if (block.denominator == nullptr) return;
    const std::vector<double>& given = block.denominator->values;
    if (!is_positive_until(polynomial_of(1, given.front(), given, 1, length), length)) {
      say(line, "poly-denominator", "the denominator is 0 inside the block");
    }
  }

  void check_degrees(std::uint32_t line, const PolyWords& block) {
    for (const SiemensWord* word : block.polynomial) {
      if (word == nullptr || word->values.size() <= 3) continue;
      say(line, "poly-degree",
          word->name + " with " + std::to_string(word->values.size()) + " values, expected 3");
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
