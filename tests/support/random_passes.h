// Programs that are put together from what programs are made of: passes of short lines between
// rapids, and all that stands between them.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace batten::postproc {

class RandomPasses {
 public:
  explicit RandomPasses(unsigned seed) : random_(seed), line_end_(seed % 4 == 3 ? "\r\n" : "\n") {}

  std::string make() {
    const bool inches = chance(8);
    if (chance(2)) add("%");
    if (chance(2)) add("O1000 (PART)");
    add(inches ? "G20 G90 G17 G94" : "G21 G90 G17");
    add("T1 M6");
    add("S9000 M3");
    scale_ = inches ? 1 / 25.4 : 1;
    add(fmt::format("G0 X{} Y{} Z{}", number(0), number(0), number(5)));
    const int passes = 3 + pick(9);
    for (int i = 0; i < passes; ++i) pass();
    add("G0 Z" + number(20));
    add("M5");
    add("M30");
    if (text_.starts_with("%")) add("%");
    if (chance(4)) text_ += "(the end)";
    return text_;
  }

 private:
  int pick(int below) { return static_cast<int>(random_() % static_cast<unsigned>(below)); }
  bool chance(int one_in) { return pick(one_in) == 0; }
  void add(const std::string& line) { text_ += line + line_end_; }
  [[nodiscard]] std::string number(double mm) const { return fmt::format("{:.4f}", mm * scale_); }

  void pass() {
    between();
    const double x = pick(50);
    const double y = pick(50);
    add(fmt::format("G0 X{} Y{}", number(x), number(y)));
    if (chance(3)) add("G0 Z" + number(1));
    if (chance(4)) add(chance(2) ? "(a pass)" : "");
    add(fmt::format("G1 Z{} F300", number(-1)));
    cut(x, y);
    if (chance(6)) odd_end();
    add("G0 Z" + number(5));
    if (chance(5)) add("");
  }

  // Chords of a wave; short ones are rewritten.
  void cut(double x, double y) {
    const int lines = 2 + pick(chance(3) ? 140 : 40);
    const double step = chance(4) ? 1.5 : 0.2;
    const double height = 0.5 + pick(4);
    const double noise = chance(3) ? 0.02 : 0;
    for (int i = 1; i <= lines; ++i) {
      const double up = height * std::sin(2 * std::numbers::pi * step * i / 17) +
                        noise * (static_cast<double>(pick(200)) / 100 - 1);
      std::string line = fmt::format("X{} Y{}", number(x + step * i), number(y + up));
      if (i == 1) line = fmt::format("G1 {} F{}", line, 900 + 100 * pick(12));
      if (i > 1 && chance(60)) line += fmt::format(" F{}", 700 + 10 * pick(30));
      if (chance(90)) line += " (mark)";
      add(line);
    }
  }

  // What ends a run, changes the state or is not understood.
  void between() {
    static const std::vector<std::string> kLines = {
        "M8",         "M9",      "S8000",        "G17",         "G61",          "G64",
        "G4 P0.5",    "(PASS)",  "/ M7",         "G54",         "G80",          "#100=5",
        "G40",        "T2 M6",   "G90 G21",      "G1 X1 Y1 F0", "M123 this is", "G2 X3 Y3 I9 J2",
        "G91 G0 Z1",  "G90",     "G0 X0 A10",    "G43 H1 Z50",  "X1 X2",        "G0 G53 Z0",
        "(MSG,look)", "; words", "G1 X5 Y5 Z#3", "G18",         "G93",          "G94"};
    const int lines = chance(2) ? pick(4) : 0;
    for (int i = 0; i < lines; ++i) {
      add(kLines[static_cast<std::size_t>(pick(static_cast<int>(kLines.size())))]);
    }
    if (chance(20)) {
      for (int i = 0; i < 60; ++i) add("G2 X3 Y3 I9 J2");
    }
  }

  void odd_end() {
    add(chance(2) ? "G3 X10 Y10 I5 J0 F500" : "M98 is read (as words)");
    add("M9");
  }

  std::mt19937 random_;
  std::string line_end_;
  std::string text_;
  double scale_ = 1;
};

}  // namespace batten::postproc
