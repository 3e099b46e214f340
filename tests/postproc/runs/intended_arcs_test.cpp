// Which arcs were meant as arcs.
#include "postproc/runs/intended_arcs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "gcode/interpreter/motion_words.h"

namespace batten::postproc {
namespace {

using geometry::Arc;
using geometry::Point3;
using geometry::Vector3;

constexpr double kPi = std::numbers::pi;
constexpr double kTolerance = 0.01;
constexpr PrintedErrors kThreeDecimals{0.0005, 0.0005};

double radians(double degrees) { return degrees * kPi / 180; }

// A path drawn with a pen that knows where it heads.
class Pen {
 public:
  Pen& line(double length) {
    const Point3 from = at_;
    at_ += length * forward();
    motions_.push_back({geometry::Line{from, at_}, false});
    return *this;
  }
  // Positive sweeps turn left.
  Pen& arc(double radius, double sweep, double rise = 0) {
    const Point3 from = at_;
    const double side = sweep > 0 ? 1 : -1;
    const Vector3 left(-std::sin(heading_), std::cos(heading_), 0);
    const Point3 center = at_ + side * radius * left;
    heading_ += sweep;
    const Vector3 left_after(-std::sin(heading_), std::cos(heading_), 0);
    at_ = center - side * radius * left_after + Vector3(0, 0, rise);
    motions_.push_back({Arc{from, at_, center, Vector3::UnitZ(), sweep}, false});
    return *this;
  }
  // A cubic piece about so long, that rises evenly.
  Pen& curve(double length, double sweep, double rise = 0) {
    const Point3 from = at_;
    const Vector3 third(0, 0, rise / 3);
    const Point3 second = from + length / 3 * forward() + third;
    heading_ += sweep / 2;
    at_ += length * forward() + 3 * third;
    heading_ += sweep / 2;
    const Point3 before_end = at_ - length / 3 * forward() - third;
    motions_.push_back({geometry::CubicBezier{{from, second, before_end, at_}}, false});
    return *this;
  }
  Pen& turn(double degrees) {
    heading_ += radians(degrees);
    return *this;
  }
  // One letter per motion: p a piece (or a line), K kept; | before what starts a part.
  [[nodiscard]] std::string judged() const {
    const ChainJudgement found = judge_arcs(motions_, kThreeDecimals, kTolerance);
    std::string text;
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      if (i > 0 && found.starts_part[i]) text += '|';
      text += found.kept[i] ? 'K' : 'p';
    }
    return text;
  }

 private:
  [[nodiscard]] Vector3 forward() const { return {std::cos(heading_), std::sin(heading_), 0}; }
  Point3 at_ = Point3::Zero();
  double heading_ = 0.3;
  std::vector<PrintedMotion> motions_;
};

TEST(JudgeArcs, KeepsWhatIsIntendedAndCutsAtCornersBesideArcs) {
  const struct {
    const char* name;
    Pen path;
    const char* judged;
  } rows[] = {
      {"tangent fillets", Pen().line(10).arc(2, kPi / 2).line(10).arc(3, -1).line(5), "pKpKp"},
      {"full circle", Pen().line(10).turn(1).arc(5, 2 * kPi).turn(1).line(10), "pKp"},
      {"corners", Pen().line(10).turn(-45).arc(5, kPi).turn(-45).line(10), "p|K|p"},
      {"other corners", Pen().line(10).turn(90).arc(5, -kPi / 2).turn(20).line(10), "p|K|p"},
      // Two arcs of 20 mm that meet at 15 degrees are no curve of any tolerance near 0.01.
      {"lens", Pen().arc(40, 0.5).turn(15).arc(40, 0.5).turn(15).arc(30, 0.6), "K|K|K"},
      {"tangent chain", Pen().arc(10, 0.4).arc(14, 0.3).arc(20, 0.2).arc(17, -0.3).arc(9, -0.5),
       "KKKKK"},
      {"small kinks", Pen().arc(10, 0.4).turn(1).arc(14, 0.3).turn(-2).arc(20, 0.2), "ppp"},
      {"kinked fillet", Pen().line(2).turn(1).arc(14, 0.3).turn(-2).line(2), "ppp"},
      {"corner among pieces",
       Pen().arc(10, 0.4).turn(1).arc(14, 0.3).turn(140).arc(20, 0.2).turn(1).arc(9, 0.3), "pp|pp"},
      {"tangent to both by chance",
       Pen().arc(10, 0.4).turn(1).arc(14, 0.3).arc(20, 0.2).arc(15, 0.2).turn(1).arc(9, 0.3),
       "ppppp"},
      {"fillet before kinks", Pen().line(9).arc(2, 1).arc(14, 0.3).turn(1).arc(20, 0.2), "pKpp"},
      {"ramp and floor", Pen().arc(5, kPi, -0.2).arc(5, kPi, -0.2).arc(5, kPi).arc(5, kPi),
       "KK|KK"},
      // Curves are never intended: what their forms cost decides.
      {"curve between lines", Pen().line(10).curve(8, 0.5).line(10), "ppp"},
      {"kinks at a curve", Pen().line(0.5).turn(1).curve(8, 0.5).turn(-1).curve(3, 0.5), "ppp"},
      {"corner before a curve", Pen().line(10).turn(40).curve(8, 0.5).line(5), "p|pp"},
      {"corner between curves", Pen().curve(4, 0.5).turn(-35).curve(3, -0.5), "p|p"},
      {"long curves in a kink", Pen().curve(40, 0.5).turn(15).curve(40, 0.5), "p|p"},
      {"arc tangent to a curve", Pen().arc(10, 0.4).curve(8, 0.5), "Kp"},
      {"arc in a kink with a curve", Pen().arc(10, 0.4).turn(1).curve(8, 0.5), "pp"},
      {"curve onto a ramp", Pen().curve(0.8, 0.1).curve(0.8, 0.1, 0.05).curve(0.8, 0.1, 0.05),
       "p|pp"},
  };
  for (const auto& row : rows) EXPECT_EQ(row.path.judged(), row.judged) << row.name;
}

// --- what rounding can do ---------------------------------------------------------------------

double rounded(double x, int decimals) {
  const double steps = std::pow(10.0, decimals);
  return std::round(x * steps) / steps;
}

struct Rounding {
  int decimals;
  bool by_radius;
};

class PrintedJoints : public testing::TestWithParam<Rounding> {};

// An exact tangent joint, printed: two arcs, or an arc and a line, of any size and direction.
TEST_P(PrintedJoints, AreTangentStill) {
  const auto [decimals, by_radius] = GetParam();
  const double error = 0.5 * std::pow(10.0, -decimals);
  constexpr int kJoints = 3000;
  int arcs = 0;
  for (int seed = 0; seed < kJoints; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(static_cast<unsigned>(seed));
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    Point3 at(uniform(-100, 100), uniform(-100, 100), 0);
    double heading = uniform(-kPi, kPi);
    std::vector<PrintedMotion> motions;
    for (int i = 0; i < 2; ++i) {
      const bool bends = i == 0 || uniform(0, 1) < 0.7;
      const double radius = std::exp(uniform(std::log(0.2), std::log(300.0)));
      const double sweep =
          (uniform(0, 1) < 0.5 ? -1 : 1) * std::min(uniform(0.05, 2.8), 60 / radius);
      const Point3 start(rounded(at.x(), decimals), rounded(at.y(), decimals), 0);
      Point3 exact_end = at + 3 * Vector3(std::cos(heading), std::sin(heading), 0);
      Vector3 offset = Vector3::Zero();
      if (bends) {
        const double side = sweep > 0 ? 1 : -1;
        offset = side * radius * Vector3(-std::sin(heading), std::cos(heading), 0);
        heading += sweep;
        exact_end = at + offset - side * radius * Vector3(-std::sin(heading), std::cos(heading), 0);
      }
      const Point3 end(rounded(exact_end.x(), decimals), rounded(exact_end.y(), decimals), 0);
      at = exact_end;
      if (!bends) {
        motions.push_back({geometry::Line{start, end}, false});
        continue;
      }
      gcode::ArcWords words;
      words.start = start;
      words.end = end;
      words.clockwise = sweep < 0;
      if (by_radius) {
        words.radius = rounded(radius, decimals);
      } else {
        words.center = {rounded(offset.x(), decimals), rounded(offset.y(), decimals), {}};
      }
      const auto read = gcode::arc_from_words(words);
      if (!read.arc) break;  // too small for its decimals
      motions.push_back({*read.arc, by_radius});
      ++arcs;
    }
    if (motions.size() < 2) continue;
    const ArcJoint joint = joint_between(motions[0], motions[1], {error, error}, kTolerance);
    EXPECT_EQ(joint, ArcJoint::kTangent);
  }
  EXPECT_GT(arcs, kJoints);
}

INSTANTIATE_TEST_SUITE_P(JointBetween, PrintedJoints,
                         testing::Values(Rounding{2, false}, Rounding{3, false}, Rounding{4, false},
                                         Rounding{3, true}, Rounding{4, true}),
                         [](const auto& test) {
                           return std::to_string(test.param.decimals) +
                                  (test.param.by_radius ? "DecimalsByRadius" : "DecimalsByCenter");
                         });

// The other way round: the bound is not so wide that kinks of CAM systems disappear in it.
TEST(JointBetween, SeesAKinkOfATenthOfADegree) {
  const PrintedMotion before{
      Arc{Point3(10, 0, 0), Point3(10 * std::cos(0.5), 10 * std::sin(0.5), 0), Point3::Zero(),
          Vector3::UnitZ(), 0.5},
      false};
  const double heading = 0.5 + kPi / 2 + radians(0.1);
  const Vector3 left(-std::sin(heading), std::cos(heading), 0);
  const Point3 start = geometry::end_point(before.piece);
  const Point3 center = start + 12 * left;
  const Vector3 out = -12 * left;
  const Vector3 end(std::cos(0.4) * out.x() - std::sin(0.4) * out.y(),
                    std::sin(0.4) * out.x() + std::cos(0.4) * out.y(), 0);
  const PrintedMotion after{Arc{start, center + end, center, Vector3::UnitZ(), 0.4}, false};
  EXPECT_EQ(joint_between(before, after, kThreeDecimals, kTolerance), ArcJoint::kKink);
}

}  // namespace
}  // namespace batten::postproc
