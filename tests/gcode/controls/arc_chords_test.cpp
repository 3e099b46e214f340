// How far the chords that a control makes of an arc leave it: by hand, and as real firmware did.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "gcode/controls/arc_rules.h"
#include "tests/support/places.h"

namespace batten::gcode {
namespace {

geometry::Arc arc_of(double radius, double sweep_deg, double rise = 0) {
  const double sweep = sweep_deg * std::numbers::pi / 180;
  const geometry::Point3 start(radius, 0, 0);
  const geometry::Point3 end(radius * std::cos(sweep), radius * std::sin(sweep), rise);
  return {start, end, geometry::Point3::Zero(), geometry::Vector3::UnitZ(), sweep};
}

// r (1 - cos(sweep / 2n)) by hand, n chords.
TEST(ArcChords, AreSoMuchFartherAsTheirNumberIsRoundedDown) {
  EXPECT_EQ(chord_error({}, arc_of(5, 90)), 0);
  // 5 mm and 90 degrees are 7.85 mm: 7 chords of 1.12 mm.
  EXPECT_NEAR(chord_error({.longest = 1}, arc_of(5, 90)), 0.031439, 1e-6);
  // Shorter than two chords: one, across nearly a full circle.
  EXPECT_NEAR(chord_error({.longest = 1}, arc_of(0.3, 350)), 0.598858, 1e-6);
  // 72 in a circle, but none shorter than 0.1 mm and none longer than 1 mm.
  const ArcChords marlin{.longest = 1, .shortest = 0.1, .per_circle = 72};
  EXPECT_NEAR(chord_error(marlin, arc_of(5, 90)), 0.0047595, 1e-6);
  EXPECT_NEAR(chord_error(marlin, arc_of(100, 90)), 0.0012513, 1e-6);
  // A chord across 7.25 degrees of 1 mm is 0.002 mm off: up to two of them are one.
  const ArcChords grbl{.error = 0.002};
  EXPECT_NEAR(chord_error(grbl, arc_of(1, 14.4)), 0.0078853, 1e-6);
  EXPECT_NEAR(chord_error(grbl, arc_of(1, 14.6)), 0.0020284, 1e-6);
  // Ends that are turned on by a series are nearer to the centre: grbl was 0.00316 mm off here.
  const double turned = chord_error({.error = 0.002, .turned = 12}, arc_of(0.02, 120.029));
  EXPECT_GE(turned, 0.00316);
  EXPECT_LE(turned, 1.3 * 0.00316);
  EXPECT_LT(chord_error(grbl, arc_of(0.02, 120.029)), 0.0027);
}

struct FirmwareRow {
  std::string firmware;
  ArcChords chords;
};

// ../shared/firmware: what the real firmwares made of 688 arcs. Its files say 5 digits, the printed
// ends of the arcs are 0.00007 mm beside their circles, and grbl computes in 32 bits.
TEST(ArcChords, AreNoFartherThanTheBoundOnRealFirmware) {
  const std::filesystem::path file =
      std::filesystem::path(BATTEN_SOURCE_DIR).parent_path() / "shared/firmware/arcs.tsv";
  std::ifstream in(file);
  if (!in) GTEST_SKIP() << "no " << file;
  constexpr double kPrinted = 2e-4;  // mm
  const auto fields_of = [](const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream words(line);
    for (std::string field; std::getline(words, field, '\t');) fields.push_back(field);
    return fields;
  };
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> names = fields_of(line);
  const ArcChords grbl{.error = 0.002, .turned = 12};
  const FirmwareRow rows[] = {{"grbl", grbl},
                              {"grblHAL", grbl},
                              {"klipper_1.0", {.longest = 1}},
                              {"klipper_0.1", {.longest = 0.1}}};
  std::size_t compared = 0;
  while (std::getline(in, line)) {
    std::map<std::string, std::string> at;
    const std::vector<std::string> fields = fields_of(line);
    for (std::size_t i = 0; i < fields.size(); ++i) at[names[i]] = fields[i];
    const geometry::Arc arc =
        arc_of(std::stod(at["radius_mm"]), std::stod(at["sweep_deg"]), std::stod(at["dz_mm"]));
    for (const FirmwareRow& row : rows) {
      const std::string& error = at[row.firmware + "_error_mm"];
      // Full circles that were lost are none that Batten writes.
      if (std::abs(arc.sweep) > 359 * std::numbers::pi / 180 || error == "-") continue;
      const double bound = chord_error(row.chords, arc);
      EXPECT_GE(bound, std::stod(error) - kPrinted) << row.firmware << ": " << line;
      EXPECT_LE(bound, 1.3 * std::stod(error) + kPrinted) << row.firmware << ": " << line;
      ++compared;
    }
  }
  EXPECT_GT(compared, 2000U);
}

}  // namespace
}  // namespace batten::gcode
