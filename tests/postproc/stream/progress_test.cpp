// What the line of progress says.
#include "postproc/stream/progress.h"

#include <gtest/gtest.h>

namespace batten::postproc {
namespace {

TEST(ProgressLine, SaysThePartAtFirst) {
  EXPECT_EQ(progress_line(0, 1000, 0), "  0 %");
  EXPECT_EQ(progress_line(0.256, 1000, 0.5), " 25 %");
  EXPECT_EQ(progress_line(0, 1000, 30), "  0 %");
}

// A quarter of 8 MB in 5 s: 0.4 MB/s, three times 5 s are left.
TEST(ProgressLine, SaysRateAndWhatIsLeftOnceItIsKnown) {
  EXPECT_EQ(progress_line(0.25, 8'000'000, 5), " 25 %  400 kB/s  about 15 s left");
  EXPECT_EQ(progress_line(0.5, 80'000'000, 200), " 50 %  200 kB/s  about 4 min left");
}

TEST(ProgressLine, OfWhatIsDoneHasNothingLeft) {
  EXPECT_EQ(progress_line(1, 5'000'000, 2), "100 %  2.5 MB/s");
}

}  // namespace
}  // namespace batten::postproc
