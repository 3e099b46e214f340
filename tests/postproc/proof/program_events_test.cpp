#include "postproc/proof/program_events.h"

#include <gtest/gtest.h>

#include <iterator>
#include <random>
#include <string>

#include "tests/support/interpreted.h"

namespace batten::postproc {
namespace {

// Blocks that set modes, feeds and positions, some kept as text, hidden, of a cycle or not
// understood.
constexpr const char* kLines[] = {"G21 G17 G90 G94",
                                  "G0 X0 Y0 Z0",
                                  "G1 X1 Y2 F100",
                                  "X3",
                                  "F200",
                                  "G1 X3 Y2 F300",
                                  "/ G1 X4 F50",
                                  "G20",
                                  "G91 G1 X1",
                                  "G90",
                                  "G18",
                                  "G81 X1 Z-1 R1",
                                  "G2 X5 Y5 I1 J1 F90",
                                  "G28 X0",
                                  "X2 G80 F70",
                                  "N10 G1 X7",
                                  "M3 S100",
                                  "G55 G0 X1",
                                  "%",
                                  "(text)",
                                  "G92 X0",
                                  "G53 G0 X1",
                                  "G1 X[#1] F20",
                                  "#1=2 F30",
                                  "G68 R10",
                                  "M98 P1",
                                  "what F60 is it",
                                  "TRANS X10",
                                  "G64 F40",
                                  "SUPA G0 X1",
                                  "G41 D1 X2",
                                  "N20 GOTOB N10",
                                  "G5.1 X1 Y1 I1 J1",
                                  "G93 F2",
                                  "G1 Z1"};

// What a window takes over is found without the list of its events; `verify` takes it from the
// list.
TEST(EventsBeforeNext, AreThoseAtTheEndOfTheList) {
  std::mt19937 random(7);
  const auto draw = [&] {
    std::string text;
    for (std::size_t count = 1 + random() % 12; count > 0; --count) {
      text += kLines[random() % std::size(kLines)];
      text += '\n';
    }
    return text;
  };
  int feeds = 0;
  for (int i = 0; i < 3000; ++i) {
    EventsBefore before;
    for (const std::string& text : {draw(), draw()}) {
      SCOPED_TRACE(text);
      const tests::Interpreted part(text);
      const ReadProgram read{&part.program, &part.read, before};
      before = events_before_next(read);
      ASSERT_EQ(before, list_events(read).at_end);
      feeds += before.feed_is_new ? 1 : 0;
    }
  }
  EXPECT_GT(feeds, 600);
  EXPECT_LT(feeds, 5400);
}

}  // namespace
}  // namespace batten::postproc
