// Programs that say a path in the curve words of a control, as CAM systems write them, said without
// Batten's own writers.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "geometry/path/path.h"

namespace batten::tests {

// Pieces along a wave in XY at Z-1, whose legs are turned by up to `kink` radians: so much do
// neighbours miss each other's direction. Ends have three decimals.
struct CurvePath {
  int pieces = 40;
  double step = 0.8;   // mm in X
  double height = 3;   // mm
  double length = 20;  // mm of one wave
  double kink = 0.05;
  bool quadratic = false;
  double from = 0;  // where it begins in X
  unsigned seed = 1;
};

inline std::vector<geometry::CubicBezier> curve_pieces(const CurvePath& path = {}) {
  using geometry::Point3;
  using geometry::Vector3;
  constexpr double kTwoPi = 6.283185307179586;
  std::mt19937 random(path.seed);
  std::uniform_real_distribution<double> turn(-path.kink, path.kink);
  const auto rounded = [](double value) { return std::round(value * 1000) / 1000; };
  const auto place = [&](int i) {
    const double x = path.from + path.step * i;
    return Point3(rounded(x), rounded(path.height * std::sin(kTwoPi * x / path.length)), -1);
  };
  // A third of the way to the next end, turned a little.
  const auto leg = [&](int i) {
    const double x = path.from + path.step * i;
    const double slope = path.height * kTwoPi / path.length * std::cos(kTwoPi * x / path.length);
    const double angle = std::atan(slope) + turn(random);
    const double size = path.step / 3 * std::hypot(1, slope);
    return Vector3(size * std::cos(angle), size * std::sin(angle), 0);
  };
  std::vector<geometry::CubicBezier> pieces;
  for (int i = 0; i < path.pieces; ++i) {
    const Point3 start = place(i);
    const Point3 end = place(i + 1);
    geometry::CubicBezier piece{{start, start + leg(i), end - leg(i + 1), end}};
    if (path.quadratic) {
      const Point3 inner = start + 1.5 * (piece.control[1] - start);
      piece.control[1] = start + 2.0 / 3 * (inner - start);
      piece.control[2] = end + 2.0 / 3 * (inner - end);
    }
    pieces.push_back(piece);
  }
  return pieces;
}

// Those with weights say the same piece with w, w^2 and w^3, which only moves its parameter.
enum class CurveWord {
  kG5,
  kG51,
  kG52,
  kG52Weights,
  kG062,
  kG062Weights,
  kPoly,
  kPolyRational,
  kBspline,
  kBsplineWeights,
  kSpl
};

inline bool has_weights(CurveWord word) {
  return word == CurveWord::kG52Weights || word == CurveWord::kG062Weights ||
         word == CurveWord::kPolyRational || word == CurveWord::kBsplineWeights;
}

// The blocks of one piece. The first of a program says the mode of Siemens words.
inline std::string words_of(const geometry::CubicBezier& piece, CurveWord word, bool is_first) {
  const auto& p = piece.control;
  const auto xy = [](const geometry::Point3& at) {
    return fmt::format("X{:.3f} Y{:.3f}", at.x(), at.y());
  };
  const auto of_axis = [&](int axis, auto said) {
    const double a = p[0][axis];
    const double b = p[1][axis];
    const double c = p[2][axis];
    const double d = p[3][axis];
    return said(a, b, c, d);
  };
  constexpr double kW = 1.25;
  switch (word) {
    case CurveWord::kG52Weights:
      return fmt::format("G5.2 P1 L4\n{} P{:.6f}\n{} P{:.6f}\n{} P{:.6f}\nG5.3\n", xy(p[1]), kW,
                         xy(p[2]), kW * kW, xy(p[3]), kW * kW * kW);
    case CurveWord::kG062Weights:
      return fmt::format(
          "G06.2 P4 K0. {} R1.\nK0. {} R{:.6f}\nK0. {} R{:.6f}\nK0. {} R{:.6f}\n"
          "K1.\nK1.\nK1.\nK1.\n",
          xy(p[0]), xy(p[1]), kW, xy(p[2]), kW * kW, xy(p[3]), kW * kW * kW);
    case CurveWord::kBsplineWeights:
      return fmt::format("BSPLINE SD=3 {} PW={:.6f} PL=1\n{} PW={:.6f} PL=0\n{} PW={:.6f} PL=0\n",
                         xy(p[1]), kW, xy(p[2]), kW * kW, xy(p[3]), kW * kW * kW);
    case CurveWord::kPolyRational: {
      const auto said = [](double end, double a, double b, double c, double d) {
        return fmt::format("({:.6f},{:.9f},{:.9f})", end, 3 * (a - 2 * b + c), d - a - 3 * (c - b));
      };
      const auto poly = [&](double a, double b, double c, double d) {
        return said(d, a, kW * b, kW * kW * c, kW * kW * kW * d);
      };
      return (is_first ? "POLY PO[X]=" : "PO[X]=") + of_axis(0, poly) +
             " PO[Y]=" + of_axis(1, poly) +
             " PO[]=" + said(kW * kW * kW, 1, kW, kW * kW, kW * kW * kW) + "\n";
    }
    case CurveWord::kG5:
      return fmt::format("G5 {} I{:.4f} J{:.4f} P{:.4f} Q{:.4f}\n", xy(p[3]), p[1].x() - p[0].x(),
                         p[1].y() - p[0].y(), p[2].x() - p[3].x(), p[2].y() - p[3].y());
    case CurveWord::kG51:
      return fmt::format("G5.1 {} I{:.4f} J{:.4f}\n", xy(p[3]), 1.5 * (p[1].x() - p[0].x()),
                         1.5 * (p[1].y() - p[0].y()));
    case CurveWord::kG52:
      return fmt::format("G5.2 P1 L4\n{} P1\n{} P1\n{} P1\nG5.3\n", xy(p[1]), xy(p[2]), xy(p[3]));
    case CurveWord::kG062:
      return fmt::format("G06.2 P4 K0. {}\nK0. {}\nK0. {}\nK0. {}\nK1.\nK1.\nK1.\nK1.\n", xy(p[0]),
                         xy(p[1]), xy(p[2]), xy(p[3]));
    case CurveWord::kBspline:
      return fmt::format("BSPLINE SD=3 {} PL=1\n{} PL=0\n{} PL=0\n", xy(p[1]), xy(p[2]), xy(p[3]));
    case CurveWord::kPoly: {
      const auto poly = [](double a, double b, double c, double d) {
        return fmt::format("({:.3f},{:.6f},{:.6f})", d, 3 * (a - 2 * b + c), d - a - 3 * (c - b));
      };
      return (is_first ? "POLY PO[X]=" : "PO[X]=") + of_axis(0, poly) +
             " PO[Y]=" + of_axis(1, poly) + "\n";
    }
    case CurveWord::kSpl: {
      std::string line = fmt::format("SPL X{:+.3f} Y{:+.3f}", p[3].x(), p[3].y());
      for (const int axis : {0, 1}) {
        line += of_axis(axis, [axis](double a, double b, double c, double d) {
          const double k1 = std::round(3 * (c - d) * 1e6) / 1e6;
          const double k2 = std::round(3 * (b - 2 * c + d) * 1e6) / 1e6;
          const char name = "XY"[axis];
          return fmt::format(" K3{0}{1:+.6f} K2{0}{2:+.6f} K1{0}{3:+.6f}", name, a - d - k1 - k2,
                             k2, k1);
        });
      }
      return line + "\n";
    }
  }
  return {};
}

inline std::string curve_words(const std::vector<geometry::CubicBezier>& pieces, CurveWord word) {
  std::string text;
  for (const geometry::CubicBezier& piece : pieces) {
    text += words_of(piece, word, text.empty());
  }
  return text;
}

// Down to the begin of a path, and up from its end.
inline std::string curve_head(CurveWord word, const geometry::Point3& start) {
  if (word == CurveWord::kSpl) {
    return fmt::format(
        "BEGIN PGM T MM\nTOOL CALL 1 Z S5000\nL X{:+.3f} Y{:+.3f} Z+5 R0 FMAX\nL Z-1 F300\nL "
        "F2000\n",
        start.x(), start.y());
  }
  const bool siemens = word == CurveWord::kPoly || word == CurveWord::kPolyRational ||
                       word == CurveWord::kBspline || word == CurveWord::kBsplineWeights;
  return fmt::format("{} G90 G17 G94\nG0 X{:.3f} Y{:.3f} Z5.\nG1 Z-1. F300.\nF2000.\n",
                     siemens ? "G71" : "G21", start.x(), start.y());
}

inline std::string curve_tail(CurveWord word) {
  return word == CurveWord::kSpl ? "L Z+5 FMAX\nEND PGM T MM\n" : "G0 Z5.\nM30\n";
}

inline std::string curve_program(const CurvePath& path, CurveWord word) {
  CurvePath said = path;
  said.quadratic = word == CurveWord::kG51;
  const auto pieces = curve_pieces(said);
  return curve_head(word, pieces.front().control[0]) + curve_words(pieces, word) + curve_tail(word);
}

}  // namespace batten::tests
