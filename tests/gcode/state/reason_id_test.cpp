#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <string_view>

#include "gcode/state/reason.h"

namespace batten::gcode {
namespace {

TEST(ReasonId, ReadsAsTheReasonThatItWasMadeOf) {
  for (const reason::Explanation& each : reason::explanations()) {
    EXPECT_EQ(ReasonId(each.id).id(), each.id);
    EXPECT_EQ(ReasonId(each.id), each.id);
    EXPECT_FALSE(ReasonId(each.id).empty());
    // The same letters at another place.
    const std::string copy(each.id);
    EXPECT_EQ(ReasonId(copy), ReasonId(each.id));
    for (const reason::Explanation& other : reason::explanations()) {
      EXPECT_EQ(ReasonId(each.id) == ReasonId(other.id), each.id == other.id);
    }
  }
}

TEST(ReasonId, IsNoneAtFirstAndOfNoLetters) {
  EXPECT_TRUE(ReasonId().empty());
  EXPECT_TRUE(ReasonId(std::string_view()).empty());
  EXPECT_EQ(ReasonId(), std::string_view());
  EXPECT_NE(ReasonId(), reason::kRapid);
}

TEST(ReasonId, RefusesWhatIsNoReason) {
  EXPECT_THROW(ReasonId("no-such-reason"), std::invalid_argument);
  // A part of one, at the place of the whole.
  EXPECT_THROW(ReasonId(reason::kPlunge.substr(0, 3)), std::invalid_argument);
}

}  // namespace
}  // namespace batten::gcode
