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
#include "gcode/controls/built_in.h"
#include "tests/support/interpreted.h"
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
  EXPECT_NEAR(chord_error(marlin, arc_of(5, 91)), 0.0048656, 1e-6);
  // Eighteen by hand, which may be 17.99999 in single precision, and then are seventeen.
  EXPECT_NEAR(chord_error(marlin, arc_of(5, 90)), 0.0053359, 1e-6);
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

TEST(ArcChords, AreCertainInNumberWhereNoLastDigitDecides) {
  const ArcChords klipper{.longest = 1};
  ASSERT_TRUE(certain_chords(klipper, arc_of(5, 90)));
  EXPECT_EQ(certain_chords(klipper, arc_of(5, 90))->count, 7);
  EXPECT_EQ(certain_chords(klipper, arc_of(5, 90))->off, 0);
  EXPECT_EQ(certain_chords(klipper, arc_of(0.1, 90))->count, 1);
  EXPECT_EQ(certain_chords({}, arc_of(5, 90))->count, 0);
  const double eight = 8 / 5.0 * 180 / std::numbers::pi;
  EXPECT_FALSE(certain_chords(klipper, arc_of(5, eight)));
  EXPECT_FALSE(certain_chords(klipper, arc_of(5, eight * 1.00001)));
  EXPECT_EQ(certain_chords(klipper, arc_of(5, eight * 1.0001))->count, 8);
  EXPECT_EQ(certain_chords(klipper, arc_of(5, eight * 0.9999))->count, 7);
  const ArcChords turned{.error = 0.002, .turned = 12};
  EXPECT_NEAR(certain_chords(turned, arc_of(0.02, 120.029))->off +
                  0.02 * (1 - std::cos(120.029 * std::numbers::pi / 360 /
                                       certain_chords(turned, arc_of(0.02, 120.029))->count)),
              chord_error(turned, arc_of(0.02, 120.029)), 1e-12);
}

// A full circle from (x, y) about the centre (x + i, y + j), counterclockwise.
geometry::Arc circle_at(double x, double y, double i, double j, double turn) {
  const geometry::Point3 start(x, y, 0);
  return {start, start, {x + i, y + j, 0}, geometry::Vector3::UnitZ(), turn};
}

TEST(MisreadArcs, AreSmallCirclesWhereRoundingDecides) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const Control& grbl = *find_control("grbl");
  // The centre is a 32-bit number: 0.000004 mm at 100 mm, seen from 1 mm.
  EXPECT_EQ(misreading(grbl, circle_at(100.1, 50.3, 1, 0, kTurn)), "no motion");
  EXPECT_EQ(misreading(grbl, circle_at(100.1, 50.3, 1, 0, -kTurn)), "no motion");
  EXPECT_EQ(misreading(grbl, circle_at(100.1, 50.3, 30, 0, kTurn)), "");
  EXPECT_EQ(misreading(*find_control("fluidnc"), circle_at(100.1, 50.3, 1, 0, kTurn)), "no motion");
  EXPECT_EQ(misreading(*find_control("grblhal"), circle_at(100.1, 50.3, 1, 0, kTurn)), "");
  EXPECT_EQ(misreading(*find_control("linuxcnc"), circle_at(100.1, 50.3, 1, 0, kTurn)), "");
  // An arc that is so short that its sweep may come out as none.
  EXPECT_EQ(misreading(grbl, arc_of(10, 1e-5)), "a full turn");
  EXPECT_EQ(misreading(grbl, arc_of(10, 1)), "");
  // Klipper: one chord from the start to the start.
  EXPECT_EQ(misreading(*find_control("klipper"), circle_at(0, 0, 0.1, 0, kTurn)), "no motion");
  EXPECT_EQ(misreading(*find_control("klipper"), circle_at(0, 0, 10, 0, kTurn)), "");
}

struct FirmwareRow {
  std::string firmware;
  ArcChords chords;
};

using FirmwareArc = std::map<std::string, std::string>;

std::filesystem::path firmware_folder() {
  return std::filesystem::path(BATTEN_SOURCE_DIR).parent_path() / "shared/firmware";
}

// ../shared/firmware: what the real firmwares made of 688 arcs; empty where it is not there.
std::vector<FirmwareArc> firmware_arcs() {
  std::ifstream in(firmware_folder() / "arcs.tsv");
  const auto fields_of = [](const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream words(line);
    for (std::string field; std::getline(words, field, '\t');) fields.push_back(field);
    return fields;
  };
  std::vector<FirmwareArc> all;
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> names = fields_of(line);
  while (std::getline(in, line)) {
    const std::vector<std::string> fields = fields_of(line);
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (i == 0) all.emplace_back();
      all.back()[names[i]] = fields[i];
    }
  }
  return all;
}

bool is_circle(const FirmwareArc& at) { return std::abs(std::stod(at.at("sweep_deg"))) > 359; }

// Its files say 5 digits, the printed ends of the arcs are 0.00007 mm beside their circles, and
// grbl computes in 32 bits.
TEST(ArcChords, AreNoFartherThanTheBoundOnRealFirmware) {
  const std::vector<FirmwareArc> arcs = firmware_arcs();
  if (arcs.empty()) GTEST_SKIP() << "no " << firmware_folder();
  constexpr double kPrinted = 2e-4;  // mm
  const ArcChords grbl = find_control("grbl")->chords;
  EXPECT_EQ(find_control("grblhal")->chords, grbl);
  const FirmwareRow rows[] = {{"grbl", grbl},
                              {"grblHAL", grbl},
                              {"klipper_1.0", find_control("klipper")->chords},
                              {"klipper_0.1", {.longest = 0.1}}};
  std::size_t compared = 0;
  std::size_t counted = 0;
  for (const FirmwareArc& at : arcs) {
    const geometry::Arc arc = arc_of(std::stod(at.at("radius_mm")), std::stod(at.at("sweep_deg")),
                                     std::stod(at.at("dz_mm")));
    for (const FirmwareRow& row : rows) {
      const std::string& error = at.at(row.firmware + "_error_mm");
      // Full circles that were lost are none that Batten writes.
      if (is_circle(at) || error == "-") continue;
      const double bound = chord_error(row.chords, arc);
      const std::string& line = at.at("line");
      if (const auto certain = certain_chords(row.chords, arc)) {
        EXPECT_EQ(certain->count, std::stoi(at.at(row.firmware + "_chords")))
            << row.firmware << ": " << line;
        ++counted;
      }
      EXPECT_GE(bound, std::stod(error) - kPrinted) << row.firmware << ": " << line;
      EXPECT_LE(bound, 1.3 * std::stod(error) + kPrinted) << row.firmware << ": " << line;
      ++compared;
    }
  }
  EXPECT_GT(compared, 2000U);
  EXPECT_GT(counted, compared * 9 / 10);
}

// Every full circle that was lost, and on Klipper no other.
TEST(MisreadArcs, AreThoseThatRealFirmwareLost) {
  std::size_t lost = 0;
  for (const FirmwareArc& at : firmware_arcs()) {
    if (!is_circle(at)) continue;
    std::ifstream in(firmware_folder() / "programs" / (at.at("program") + ".nc"));
    std::ostringstream text;
    text << in.rdbuf();
    const tests::Interpreted read(text.str());
    const Motion* motion = read.motion_of_line(std::stoul(at.at("line")));
    const geometry::Arc* arc = motion == nullptr ? nullptr : motion->piece.arc();
    ASSERT_NE(arc, nullptr) << at.at("program") << ":" << at.at("line");
    const auto is_lost = [&](const std::string& firmware) {
      const double error = std::stod(at.at(firmware + "_error_mm"));
      return error > 1.9 * geometry::radius_of(*arc);
    };
    if (is_lost("grbl")) {
      ++lost;
      EXPECT_EQ(misreading(*find_control("grbl"), *arc), "no motion") << at.at("line");
    }
    for (const double resolution : {1.0, 0.1}) {
      Control klipper = *find_control("klipper");
      klipper.chords.longest = resolution;
      const bool here = is_lost(resolution == 1 ? "klipper_1.0" : "klipper_0.1");
      EXPECT_EQ(!misreading(klipper, *arc).empty(), here) << resolution << ": " << at.at("line");
      lost += here ? 1 : 0;
    }
  }
  if (lost == 0) GTEST_SKIP() << "no " << firmware_folder();
  EXPECT_GE(lost, 16U);
}

}  // namespace
}  // namespace batten::gcode
