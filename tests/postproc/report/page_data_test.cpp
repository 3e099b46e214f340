// The columns that the report's page reads, taken apart again, against figures known by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "postproc/report/html_report.h"
#include "tests/support/machine_limits.h"
#include "tests/support/report_words.h"

namespace batten::postproc {
namespace {

std::vector<std::uint8_t> bytes_of_base64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(letters.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> count));
  }
  return bytes;
}

// Numbers that were packed as steps.
std::vector<std::int64_t> column(const Json& text) {
  std::vector<std::int64_t> numbers;
  std::uint64_t zigzag = 0;
  int shift = 0;
  std::int64_t last = 0;
  for (const std::uint8_t byte : bytes_of_base64(text.get<std::string>())) {
    zigzag |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
    shift += 7;
    if ((byte & 0x80U) != 0) continue;
    const auto half = static_cast<std::int64_t>(zigzag >> 1U);
    last += (zigzag & 1U) != 0 ? -half - 1 : half;
    numbers.push_back(last);
    zigzag = 0;
    shift = 0;
  }
  return numbers;
}

// A kink of 0.02 rad at 50 mm, and the straight line that may stand for it within 1 mm.
constexpr const char* kKinked = "G21 G90\nG0 X0 Y0 Z0\nG1 X50 Y0.5 F6000\nX100 Y0\n";
constexpr const char* kStraight = "G21 G90\nG0 X0 Y0 Z0\nG1 X100 F6000\n";

Machine corner_machine() {
  Machine m;
  m.name = "test";
  set_max_velocity(m, 400);
  set_max_acceleration(m, 100);
  set_rapid_velocity(m, 400);
  m.look_ahead = 1000;
  return m;
}

// At the kink the Y axis turns round, from 0.01 v to -0.01 v, which this control allows by one
// servo period's acceleration; on the straight line there is room to reach the 6000 mm/min.
TEST(PageData, HasTheSpeedOfTheOldProgramBeforeAndOfTheNewOneAfter) {
  const gcode::SourceText source("part.nc", kKinked);
  const Machine machine = corner_machine();
  SmoothOptions options = linuxcnc_options();
  options.machine = &machine;
  options.tolerance_mm = 1;
  SmoothResult result;
  result.understood = true;
  result.proved = true;
  result.text = kStraight;
  const Json path =
      page_data({.source = source, .options = options, .result = result, .output_file = ""},
                {.command = ""})["path"];

  const std::vector<std::int64_t> x = column(path["x"]);
  const std::vector<std::int64_t> before = column(path["speed_before"]);
  const std::vector<std::int64_t> after = column(path["speed_after"]);
  ASSERT_EQ(x.size(), path["count"].get<std::size_t>());
  const double mm = path["unit_mm"];
  const double mm_per_min = path["speed_unit"];
  int kinks = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::abs(mm * static_cast<double>(x[i]) - 50) > 1e-6) continue;
    ++kinks;
    EXPECT_NEAR(mm_per_min * static_cast<double>(before[i]), 60 * 100 * machine.servo_period / 0.02,
                2 * mm_per_min);
    EXPECT_NEAR(mm_per_min * static_cast<double>(after[i]), 6000, 2 * mm_per_min);
  }
  EXPECT_GE(kinks, 1);
}

}  // namespace
}  // namespace batten::postproc
