// `batten methods --table` as a user's shell sees it.

#include <gtest/gtest.h>

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
  EXPECT_EQ(ring.at("as it is").at("pieces"), 4);
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
