// Converted programs there and back; that the proof finds every damage.
#include <gtest/gtest.h>

#include "gcode/controls/built_in.h"
#include "postproc/proof/program_events.h"
#include "tests/support/conversion_programs.h"

namespace batten::postproc {
namespace {

using gcode::Language;

// --- round trips --------------------------------------------------------------------------------

std::vector<std::string> events_of(const std::string& text, Language language) {
  const ReadText as(text, language);
  const ProgramEvents list = list_common_events(as.read());
  std::vector<std::string> all;
  std::size_t next = 0;
  const auto say_place = [&](std::int32_t motion) {
    const geometry::Point3 end =
        geometry::end_point(as.meaning.motions.at(static_cast<std::size_t>(motion)).piece);
    return fmt::format("{:.3f} {:.3f} {:.3f}", end.x() + 0.0, end.y() + 0.0, end.z() + 0.0);
  };
  for (std::size_t i = 0; i <= list.events.size(); ++i) {
    for (; next < list.cuts_before[i]; ++next) {
      const Cut& cut = list.cuts[next];
      all.push_back(fmt::format("cut to {} at {:g}",
                                say_place(static_cast<std::int32_t>(cut.motion)),
                                cut.feed.value_or(0)));
    }
    if (i == list.events.size()) break;
    const ProgramEvent& event = list.events[i];
    all.push_back(event.kind == EventKind::kRapid ? "rapid to " + say_place(event.motion)
                                                  : event.text);
  }
  return all;
}

// What is proved here `batten verify` proves for the target: not so an arc that the target refuses.
TEST(ConversionWays, AreProvedForTheTarget) {
  for (const char* target : {"heidenhain", "itnc530", "siemens"}) {
    const SmoothOptions options = ways_to(target);
    std::vector<bool> proved;
    for (const double radius : {0.03517, 0.05123, 0.31257, 2.71253}) {
      SCOPED_TRACE(testing::Message() << target << " " << radius);
      const std::string text = fmt::format(
          "G21 G17 G40 G90 G94\nG0 X0 Y0 Z5\nG1 X-1 F100\nG2 X{:.5f} Y0.00113 R{:.5f}\nG0 "
          "Z6\nM30\n",
          1.3 * radius - 1, radius);
      const SmoothResult result = smoothed(text, options);
      proved.push_back(result.proved);
      if (!result.proved) {
        EXPECT_NE(testing::PrintToString(told(result, text)).find("arc radius below the least"),
                  std::string::npos);
        continue;
      }
      const ReadText before(text);
      const ReadText after(result.text, options.target->language);
      const Promise promise(options.tolerance_mm, {}, {}, options.target);
      EXPECT_TRUE(verify(before.read(), after.read(), promise).proved());
    }
    EXPECT_TRUE(proved.back());
    EXPECT_EQ(proved.front(), options.target->language != Language::kKlartext)
        << "small arcs become chords there";
  }
}

// There and back, the same events: tools, speeds, functions, rapids, cuts with their feeds. Places
// have three decimals, so nothing is rounded; arcs of Siemens may be cut in two.
TEST(ConversionWays, ThereAndBackDoTheSame) {
  constexpr unsigned kPrograms = 200;
  for (unsigned seed = 1; seed <= kPrograms; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const std::string text = RandomProgram(seed).text();
    for (const char* target : {"heidenhain", "siemens"}) {
      const Language language = gcode::find_control(target)->language;
      const SmoothResult there = smoothed(text, ways_to(target));
      ASSERT_TRUE(there.proved) << target << testing::PrintToString(told(there, text)) << text;
      EXPECT_EQ(events_of(there.text, language), events_of(text, Language::kRs274)) << target;
      const bool not_said = text.find("as it was") != std::string::npos;
      const SmoothResult back = smoothed(there.text, ways_to("linuxcnc"));
      if (not_said && language == Language::kSiemens) {
        EXPECT_FALSE(back.understood);
        continue;
      }
      ASSERT_TRUE(back.proved) << target << testing::PrintToString(told(back, there.text));
      EXPECT_EQ(events_of(back.text, Language::kRs274), events_of(text, Language::kRs274));
    }
  }
}

// --- the proof ----------------------------------------------------------------------------------

constexpr Damage kDamages[] = {
    {"Sense", "G2 X20. I5.", "G3 X20. I5."},
    {"OtherSense", "G3 X25. Y3. J5.", "G2 X25. Y3. J5."},
    {"AbsoluteCentre", "G2 X20. I5.", "G2 X20. I15. J-2."},
    {"CentreBackwards", "J5.", "J-5."},
    {"Feed", "F500.", "F501."},
    {"FeedLost", "X10. F500.", "X10."},
    {"RapidAsCut", "G0 Z50.", "G1 Z50."},
    {"CutAsRapid", "G1 Z-1. F200.", "Z-1. F200."},
    {"Units", "G21", "G20"},
    {"Increments", "G90", "G91"},
    {"Plane", "G17", "G18"},
    {"FeedPerTurn", "G94", "G95"},
    {"SpindleBehindMotion", "S3000 M3\nM8\nG0 X1.5 Y-2.\n", "S3000\nM8\nG0 X1.5 Y-2.\nM3\n"},
    {"CoolantOffEarly", "G0 Z50.\nM9\n", "M9\nG0 Z50.\n"},
    {"StopEarly", "G1 X0.\nM5\n", "M5\nG1 X0.\n"},
    {"Spindle", "M3", "M4"},
    {"CoolantLost", "M8\n", ""},
    {"Speed", "S3000", "S300"},
    {"Tool", "T5", "T6"},
    {"LengthLost", "G43 H5\n", ""},
    {"LengthOfAnother", "G43 H5", "G43 H6"},
    {"LengthOff", "G43 H5", "G49"},
    {"RapidPlace", "Z2.", "Z3."},
    {"Place", "X10. F500.", "X10.02 F500."},
    {"Compensation", "G40", "G41 D1"},
    {"WorkOffset", "T5 M6", "G54\nT5 M6"},
    {"Dwell", "M9\n", "M9\nG4 P1\n"},
    {"Shift", "M9\n", "M9\nG92 X0\n"},
    {"EndLost", "M30\n", ""},
};

TEST(ConversionWays, ProveNoDamagedProgram) {
  const std::string text = smoothed(kKlartextPart, ways_to("fanuc")).text;
  ASSERT_TRUE(is_proved(kKlartextPart, Language::kKlartext, text, Language::kRs274));
  for (const Damage& damage : kDamages) {
    EXPECT_FALSE(is_proved(kKlartextPart, Language::kKlartext,
                           replaced(text, damage.from, damage.to), Language::kRs274))
        << damage.name;
  }
}

// The same from Siemens words.
TEST(ConversionWays, ProveNoDamagedSiemensProgram) {
  const std::string text = siemens_part();
  const std::string written = smoothed(text, ways_to("haas")).text;
  ASSERT_TRUE(is_proved(text, Language::kSiemens, written, Language::kRs274));
  const Damage kOfSiemens[] = {
      {"Units", "G71", "G70"},
      {"Inches", "G71", "G700"},
      {"EdgeLost", "D1 ", ""},
      {"OtherEdge", "D1", "D2"},
      {"NoEdge", "D1", "D0"},
      {"Frame", "N20 G54", "N20 G54 ROT Z10"},
      {"Offset", "G54", "G505"},
      {"Radius", "CR=5", "CR=6"},
      {"Axis", "Z=5", "Z=IC(5)"},
      {"Compressor", "N90 G64", "N90 COMPCAD"},
      {"Rounded", "F500", "F500 RND=2"},
      {"Plane", "G18 G3", "G17 G3"},
  };
  for (const Damage& damage : kOfSiemens) {
    EXPECT_FALSE(is_proved(replaced(text, damage.from, damage.to), Language::kSiemens, written,
                           Language::kRs274))
        << damage.name;
  }
}

}  // namespace
}  // namespace batten::postproc
