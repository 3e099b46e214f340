// LinuxCNC's own interpreter goes where the constants are said to lead. Skipped where it is not
// installed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "tests/support/scratch_folder.h"

namespace batten::gcode {
namespace {

bool has_interpreter() { return std::system("command -v rs274 >/dev/null 2>&1") == 0; }

class ExpressionMaker {
 public:
  // Six variables and a thousand moves to places that are expressions of them.
  std::string program() {
    std::string text = "G21 G90 G17 G94\nG0 X0 Y0 Z0\nF100\n";
    for (const char* name : kNames) text += fmt::format("{} = {}\n", name, number());
    for (int i = 0; i < 1000; ++i) {
      text += fmt::format("G1 X[{}] Y[{}] Z{}\n", sum(3), sum(2), variable());
      if (i % 10 == 0) text += fmt::format("{}={}\n", variable(), factor(1));
    }
    return text + "M2\n";
  }

 private:
  static constexpr const char* kNames[] = {"#1",       "#30",          "#100",
                                           "#<scale>", "#<X Off set>", "# 9 9"};

  int below(int bound) { return std::uniform_int_distribution(0, bound - 1)(random_); }
  std::string number() { return fmt::format("{:.3f}", 0.5 + below(1500) / 1000.0); }
  std::string variable() { return kNames[below(std::size(kNames))]; }

  std::string factor(int depth) {
    switch (below(depth > 0 ? 4 : 2)) {
      case 0:
        return number();
      case 1:
        return variable();
      case 2:
        return "-" + variable();
      default:
        return "[" + sum(depth - 1) + "]";
    }
  }
  std::string sum(int depth) {
    std::string text = factor(depth);
    for (int i = below(4); i > 0; --i) {
      // Divisors are numbers: none is 0.
      const int operation = below(4);
      text += std::string(1, "+-*/"[operation]) + (operation == 3 ? number() : factor(depth));
    }
    return text;
  }

  std::mt19937 random_{7};
};

TEST(Rs274, GoesWhereTheConstantsLead) {
  if (!has_interpreter()) GTEST_SKIP() << "no rs274 here";
  const std::string text = ExpressionMaker().program();
  Diagnostics found;
  const Program program = parse(SourceText("constants.ngc", text), found);
  const Interpretation read = interpret(program, {}, found);
  ASSERT_EQ(read.motions.size(), 1001U);

  const ScratchFolder folder;
  const std::string name = folder.path().string();
  folder.put("tool.tbl", "T1 P1 D0.2 Z0\n");
  folder.put("parameters.var", "");
  folder.put("constants.ngc", text);
  const std::string command = "cd '" + name + "' && HOME='" + name +
                              "' rs274 -g -n 2 -t tool.tbl -v parameters.var constants.ngc "
                              "</dev/null >calls 2>complaints";
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::ifstream calls(folder.file("calls"));
  std::size_t next = 1;
  for (std::string line; std::getline(calls, line);) {
    const std::size_t at = line.find("STRAIGHT_FEED(");
    if (at == std::string::npos) continue;
    ASSERT_LT(next, read.motions.size());
    double x = 0;
    double y = 0;
    double z = 0;
    ASSERT_EQ(std::sscanf(line.c_str() + at, "STRAIGHT_FEED(%lf, %lf, %lf", &x, &y, &z), 3);
    const geometry::Point3 there = read.motions[next].piece.end();
    EXPECT_LE((there - geometry::Point3(x, y, z)).norm(), 1e-4)
        << text.substr(program.blocks[read.motions[next].block].span.begin, 80);
    ++next;
  }
  EXPECT_EQ(next, 1001U);
}

}  // namespace
}  // namespace batten::gcode
