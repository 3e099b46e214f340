#include "gcode/state/reason.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

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
  const std::string header = text_of("gcode/state/reason.h") + text_of("gcode/state/reason.h");
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

TEST(Reason, EveryDeclaredIdIsExplainedOnce) {
  const std::set<std::string> declared = declared_ids();
  ASSERT_GT(declared.size(), 40U);
  std::set<std::string> explained;
  for (const Explanation& explanation : explanations()) {
    EXPECT_TRUE(explained.insert(std::string(explanation.id)).second) << explanation.id;
    EXPECT_FALSE(explanation.text.empty()) << explanation.id;
    EXPECT_FALSE(explanation.advice.empty()) << explanation.id;
  }
  EXPECT_EQ(explained, declared);
}

TEST(Reason, OnlyWhatIsSafeWhenAskedForAndWhatIsSetAtAControlCanBeAllowed) {
  for (const Explanation& explanation : explanations()) {
    const bool safe = explanation.id == kExactStop || explanation.id == kControlSmoothing ||
                      explanation.id == kAlreadySmoothed;
    const bool set_at_control = explanation.id == kWorkOffset || explanation.id == kToolLength;
    const bool moves_nothing = explanation.id == kBlankForm;
    const bool set_elsewhere = explanation.id == kSubprogram;  // by the program that is called
    EXPECT_EQ(explanation.can_be_allowed, safe || set_at_control || moves_nothing || set_elsewhere)
        << explanation.id;
  }
}

TEST(Reason, EveryIdStandsInTheDocumentation) {
  const std::string page = text_of("docs/diagnostics.md");
  for (const Explanation& explanation : explanations()) {
    EXPECT_NE(page.find("`" + std::string(explanation.id) + "`"), std::string::npos)
        << explanation.id;
  }
}

}  // namespace
}  // namespace batten::gcode::reason
