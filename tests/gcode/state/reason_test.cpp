#include "gcode/state/reason.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "tests/support/places.h"

namespace batten::gcode::reason {
namespace {

std::string text_of(const std::string& file) {
  std::ifstream in(std::string(BATTEN_SOURCE_DIR) + "/" + file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

// The ids as the headers declare them.
std::set<std::string> declared_ids() {
  const std::string header = text_of("gcode/state/reason.h");
  const std::string declaration = "string_view k";
  std::set<std::string> ids;
  for (std::size_t at = header.find(declaration); at != std::string::npos;
       at = header.find(declaration, at)) {
    const std::size_t begin = header.find('"', at) + 1;
    at = header.find('"', begin);
    ids.insert(header.substr(begin, at - begin));
  }
  return ids;
}

TEST(Reason, EveryDeclaredIdIsExplainedOnceHereAndInTheDocumentation) {
  const std::set<std::string> declared = declared_ids();
  ASSERT_GT(declared.size(), 40U);
  const std::string page = text_of("docs/diagnostics.md");
  std::set<std::string> explained;
  for (const Explanation& explanation : explanations()) {
    const std::string id(explanation.id);
    EXPECT_TRUE(explained.insert(id).second) << id;
    EXPECT_FALSE(explanation.text.empty()) << id;
    EXPECT_FALSE(explanation.advice.empty()) << id;
    EXPECT_NE(page.find("`" + id + "`"), std::string::npos) << id;
  }
  EXPECT_EQ(explained, declared);
}

TEST(Reason, OnlyWhatIsSafeWhenAskedForOrSetElsewhereCanBeAllowed) {
  std::set<std::string_view> allowed;
  for (const Explanation& explanation : explanations()) {
    if (explanation.can_be_allowed) allowed.insert(explanation.id);
  }
  EXPECT_EQ(allowed, (std::set{kExactStop, kControlSmoothing, kAlreadySmoothed, kSubprogram,
                               kCallerModes, kWorkOffset, kToolLength, kBlankForm}));
}

TEST(ReasonId, ReadsAsTheReasonThatItWasMadeOf) {
  for (const Explanation& each : explanations()) {
    EXPECT_EQ(ReasonId(each.id).id(), each.id);
    EXPECT_EQ(ReasonId(each.id), each.id);
    EXPECT_FALSE(ReasonId(each.id).empty());
    // The same letters at another place.
    const std::string copy(each.id);
    EXPECT_EQ(ReasonId(copy), ReasonId(each.id));
    for (const Explanation& other : explanations()) {
      EXPECT_EQ(ReasonId(each.id) == ReasonId(other.id), each.id == other.id);
    }
  }
}

TEST(ReasonId, IsNoneAtFirstAndOfNoLettersAndRefusesWhatIsNoReason) {
  EXPECT_TRUE(ReasonId().empty());
  EXPECT_TRUE(ReasonId(std::string_view()).empty());
  EXPECT_EQ(ReasonId(), std::string_view());
  EXPECT_NE(ReasonId(), kRapid);
  EXPECT_THROW(ReasonId("no-such-reason"), std::invalid_argument);
  EXPECT_THROW(ReasonId(kPlunge.substr(0, 3)), std::invalid_argument);
}

}  // namespace
}  // namespace batten::gcode::reason
