// `batten methods --table` as a user's shell sees it.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "batten_process.h"

namespace batten {
namespace {

class MethodsTable : public testing::Test {
 protected:
  [[nodiscard]] ProcessResult table(const std::string& json, const std::string& options = "") {
    folder_.put("case.json", json);
    return folder_.batten("methods --table case.json " + options);
  }

  // Method -> its row, of the first case, in the strict reading.
  [[nodiscard]] std::map<std::string, nlohmann::json> rows(const std::string& json,
                                                           const std::string& options = "") {
    const ProcessResult result = expect_exit(table(json, options + " --json -"), 0);
    std::map<std::string, nlohmann::json> found;
    const auto report = nlohmann::json::parse(result.out);
    for (const auto& row : report.at("cases").at(0).at("rows")) {
      if (row.value("tolerance_kind", "path") == "path") found[row.at("method")] = row;
    }
    return found;
  }

  BattenFolder folder_;
};

constexpr const char* kCorner =
    R"({"a corner": {"tolerance": 0.1, "points": [[0, 0], [13, 13], [26, 0]]}})";

// Ozcan 2018, and its bound in docs/algorithms/methods.md.
TEST_F(MethodsTable, PlansTheCornerOfThePaper) {
  const auto found = rows(kCorner);
  EXPECT_NEAR(found.at("as it is").at("time_s"), 1.7086, 1e-4);
  EXPECT_NEAR(found.at("guo").at("time_s"), 1.6443, 2e-4);
  EXPECT_NEAR(found.at("guo-literal").at("deviation_mm"), 0.05, 1e-3);
  EXPECT_LT(found.at("racing").at("time_s"), found.at("guo").at("time_s"));
  // Its search takes a feed for the aim, not the time.
  EXPECT_LT(found.at("ozcan").at("greatest_curvature_per_mm"),
            0.5 * found.at("ozcan-usual").at("greatest_curvature_per_mm").get<double>());
}

TEST_F(MethodsTable, TakesAToleranceInPlaceOfTheFiles) {
  EXPECT_NEAR(rows(kCorner, "--tolerance 0.05").at("guo").at("time_s"), 1.6662, 2e-4);
}

// Every corner of a ring is rounded, its first one too.
TEST_F(MethodsTable, RoundsTheFirstPointOfARing) {
  const std::string square = R"("points": [[0, 0], [10, 0], [10, 10], [0, 10]])";
  const auto open = rows(R"({"square": {)" + square + "}}");
  const auto ring = rows(R"({"square": {"ring": true, )" + square + "}}");
  EXPECT_EQ(open.at("guo").at("pieces"), 7);
  EXPECT_EQ(ring.at("guo").at("pieces"), 13);
  EXPECT_EQ(ring.at("as it is").at("pieces"), 5) << "begun within a side";
  // So do the other methods; begun in a corner, that corner stays.
  const auto begun_in_corner =
      rows(R"({"square": {"points": [[0, 0], [10, 0], [10, 10], [0, 10], [0, 0]]}})");
  EXPECT_GT(ring.at("fair").at("pieces").get<int>(),
            begun_in_corner.at("fair").at("pieces").get<int>() + 5);
  EXPECT_LT(ring.at("fair").at("time_s"), ring.at("as it is").at("time_s"));
}

// With the first blend's whole share gone, little is left of a side for the next one.
TEST_F(MethodsTable, GivesTheNextBlendLessWithLambda) {
  const std::string stairs =
      R"({"stairs": {"tolerance": 5, "points": [[0, 0], [4, 0], [4, 4], [8, 4], [8, 8]]}})";
  const auto without = rows(stairs);
  const auto with = rows(stairs, "--guo-lambda 0.5");
  EXPECT_GT(with.at("guo-literal").at("greatest_curvature_per_mm").get<double>(),
            1.5 * without.at("guo-literal").at("greatest_curvature_per_mm").get<double>());
  EXPECT_EQ(with.at("guo"), without.at("guo"));
}

TEST_F(MethodsTable, SmoothsCurvesInATube) {
  const auto found = rows(
      R"({"wave": {"distinct_knots": [0, 1, 2, 3, 4], "tolerance": 0.25, "control_points":
          [[0, 0], [10, 0], [20, 5], [30, -5], [40, 5], [50, 0], [60, 0]]}})");
  EXPECT_EQ(found.size(), 4U);
  EXPECT_LT(found.at("naseath").at("mean_curvature_per_mm"),
            found.at("as it is").at("mean_curvature_per_mm"));
  EXPECT_LE(found.at("best in tube").at("s_curve_time_s"),
            found.at("naseath").at("s_curve_time_s"));
}

// Eight ripples of 0.2 mm bend the curve ten times, where it leaves the line and comes back, too.
// In a tube that is wider than they are high it becomes all but a straight line, in a narrow one
// they stay.
TEST_F(MethodsTable, TellsHowMuchIsLeftOfRipples) {
  std::string knots = "0";
  std::string points = "[0, 0], [1.6667, 0]";
  for (int i = 1; i < 20; ++i) knots += ", " + std::to_string(5 * i);
  for (int i = 1; i < 19; ++i) {
    const char* y = i < 6 || i > 13 ? "0" : i % 2 == 0 ? "0.6" : "-0.6";
    points += ", [" + std::to_string(5 * i) + ", " + y + "]";
  }
  points += ", [93.3333, 0], [95, 0]";
  const auto in_tube = [&](const char* radius) {
    return rows(R"({"ripples": {"distinct_knots": [)" + knots + R"(], "control_points": [)" +
                points + R"(], "tolerance": )" + radius + "}}");
  };
  const auto narrow = in_tube("0.025");
  EXPECT_EQ(narrow.at("as it is").at("bends"), 10);
  EXPECT_EQ(narrow.at("as it is").at("displacement_mm"), 0);
  EXPECT_GE(narrow.at("naseath").at("bends"), 10);
  EXPECT_LE(narrow.at("naseath").at("displacement_mm"), 0.025);
  const auto wide = in_tube("0.25");
  EXPECT_LE(wide.at("best in tube").at("bends"), 2);
  EXPECT_GT(wide.at("naseath").at("mean_curvature_less_percent"), 90);
  EXPECT_GT(wide.at("naseath").at("s_curve_time_less_percent"), 40);
  EXPECT_NEAR(wide.at("naseath").at("mean_feed_mm_per_s").get<double>() *
                  wide.at("naseath").at("s_curve_time_s").get<double>(),
              wide.at("naseath").at("length_mm"), 1e-6);
}

// An oval of control points once round is closed, so that the curve is as long as the ellipse in
// it.
TEST_F(MethodsTable, ClosesACurveThatIsARing) {
  std::string knots = "0";
  std::string points;
  for (int i = 0; i < 36; ++i) {
    const double a = i * 0.17453292519943295;
    knots += ", " + std::to_string(i + 1);
    points += (i == 0 ? "[" : ", [") + std::to_string(30 * std::cos(a)) + ", " +
              std::to_string(20 * std::sin(a)) + "]";
  }
  const std::string curve = R"("distinct_knots": [)" + knots + R"(], "control_points": [)" +
                            points + R"(], "tolerance": 0.1)";
  const auto ring = rows(R"({"oval": {"ring": true, )" + curve + "}}");
  // Ramanujan's length of an ellipse; the curve is 1 - (1 - cos 10 degrees) / 3 of it.
  EXPECT_NEAR(ring.at("as it is").at("length_mm").get<double>(), 158.654 * 0.99494, 0.01);
  EXPECT_EQ(ring.at("as it is").at("bends"), 1);
  for (const char* method : {"naseath-literal", "naseath", "best in tube"}) {
    EXPECT_LE(ring.at(method).at("displacement_mm"), 0.105) << method;
  }
  expect_exit(table(R"({"oval": {)" + curve + "}}"), 2, {"case 'oval'", "control points"});
}

// Hamdan 2005, example I, with the figures of docs/algorithms/hamdan.md.
TEST_F(MethodsTable, LaysLinesAlongCurves) {
  const auto found = rows(
      R"({"parabola": {"distinct_knots": [2, 11], "first_step": 3, "tolerance": 0.05, "control_points":
          [[2, 1.838], [5, 4.322], [8, 5.645], [11, 5.807]]}})");
  EXPECT_EQ(found.at("ilca").at("lines"), 5);
  EXPECT_EQ(found.at("blca").at("lines"), 8);
  EXPECT_EQ(found.at("chord").at("lines"), 4);
  EXPECT_EQ(found.at("minlink").at("lines"), 4);
  EXPECT_NEAR(found.at("ilca").at("length_mm"), 10.000914, 1e-6);
  EXPECT_NEAR(found.at("ilca").at("deviation_mm"), 0.034533, 5e-4);
  // The curve bends to the right: chords are there, tangents on the other side until they are
  // moved.
  EXPECT_NEAR(found.at("ilca").at("right_mm"), 0.034533, 1e-6);
  EXPECT_NEAR(found.at("ilca").at("left_mm"), 0, 1e-9);
  EXPECT_NEAR(found.at("blca-tangents").at("left_mm"), 0.05, 1e-9);
  EXPECT_NEAR(found.at("blca-tangents").at("right_mm"), 0, 1e-9);
  EXPECT_NEAR(found.at("blca-jumps").at("right_mm"), 0.05, 1e-9);
  EXPECT_NEAR(found.at("blca-jumps").at("left_mm"), 0, 1e-9);
  EXPECT_EQ(found.at("blca-jumps").at("lines"), 8);
  EXPECT_EQ(found.at("blca-jumps").at("jumps"), 8);
  EXPECT_NEAR(found.at("blca-jumps").at("jumps_mm"), 0.4, 1e-9);
  EXPECT_NEAR(found.at("blca-jumps").at("length_mm"), 10.397480, 1e-6);
}

// What a paper prints is shown below the row that it is about, and kept in the report.
TEST_F(MethodsTable, ShowsWhatAPaperPrints) {
  const std::string corner = R"({"a corner": {"tolerance": [0.1, 0.05],
      "points": [[0, 0], [13, 13], [26, 0]], "printed": [{"method": "as it is", "time_s": 2.15},
      {"method": "ozcan, band", "tolerance": 0.05, "time_s": 2.028}]}})";
  const std::string text = expect_exit(table(corner), 0).out;
  const auto below = [&](const std::string& row) {
    const std::size_t next = text.find('\n', text.rfind(row)) + 1;
    return text.substr(next, text.find('\n', next) - next);
  };
  EXPECT_TRUE(contains(below("  as it is"), "as printed")) << text;
  EXPECT_TRUE(contains(below("  as it is"), "2.1500")) << text;
  EXPECT_TRUE(contains(below("  ozcan, band"), "2.0280")) << text;
  EXPECT_FALSE(contains(below("  ozcan  "), "printed")) << text;
  const auto report =
      nlohmann::json::parse(expect_exit(table(corner, "--json -"), 0).out).at("cases").at(0);
  EXPECT_EQ(report.at("printed").size(), 3u) << "of both tolerances, and of one";
  expect_exit(
      table(R"({"a": {"points": [[0, 0], [1, 0]], "printed": [{"method": "guo", "t": 3}]}})"), 2,
      {"case 'a': printed: t", "time_s"});
  expect_exit(table(R"({"a": {"points": [[0, 0], [1, 0]], "printed": [{"time_s": 3}]}})"), 2,
              {"printed", "method"});
}

TEST_F(MethodsTable, SaysWhatIsWrongWithTheFile) {
  expect_exit(table("{"), 2, {"case.json", "line 1"});
  expect_exit(table(R"({"a": {"points": [[0, 0, 0, 0]]}})"), 2, {"case 'a'", "[x, y, z] in mm"});
  expect_exit(table(R"({"a": {"points": [[0, 0]]}})"), 2, {"fewer than two points"});
  expect_exit(table(R"({"a": {"vertices": []}})"), 2, {"case 'a'", "expected points"});
  expect_exit(table(R"({"limits": {"feed": 3}, "a": {"points": [[0, 0], [1, 0]]}})"), 2,
              {"limits: feed", "feed_mm_per_s"});
  expect_exit(table("{}"), 2, {"no case"});
  expect_exit(folder_.batten("methods --guo-lambda 0.5"), 1, {"--guo-lambda", "--table"});
  expect_exit(table(kCorner, "--guo-lambda 1"), 1, {"from 0 to below 1"});
}

}  // namespace
}  // namespace batten
