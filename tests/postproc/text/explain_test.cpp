#include "postproc/text/explain.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>

#include "gcode/state/reason.h"
#include "tests/support/places.h"
#include "tests/support/scratch_folder.h"

namespace batten::postproc {
namespace {

namespace fs = std::filesystem;
using Ids = std::set<std::string>;

fs::path source_folder() { return BATTEN_SOURCE_DIR; }

// Every string of the file that looks like an id: small words with dashes between.
void add_ids_in(const fs::path& file, Ids& ids) {
  const std::string text = text_of_file(file);
  const std::regex id("\"([a-z]+(-[a-z]+)+)\"");
  for (std::sregex_iterator found(text.begin(), text.end(), id), end; found != end; ++found) {
    ids.insert((*found)[1]);
  }
}

Ids ids_in_sources_of_the_reader() {
  Ids ids;
  for (const std::string_view folder :
       {"text", "state", "rs274", "control", "reading", "interpreter", "writer"}) {
    for (const auto& entry : fs::directory_iterator(source_folder() / "gcode" / folder)) {
      const bool explains = entry.path().filename() == "reason.cpp";
      if (entry.path().extension() == ".cpp" && !explains) add_ids_in(entry.path(), ids);
    }
  }
  return ids;
}

Ids ids_in_sources_of_the_verifier() {
  Ids ids = {"distance"};  // one word
  add_ids_in(source_folder() / "postproc/stream/assembly.cpp", ids);
  for (const std::string_view file : {"event_violations", "verification", "section_comparison",
                                      "part_comparison", "target_chords"}) {
    add_ids_in(source_folder() / "postproc/proof" / (std::string(file) + ".cpp"), ids);
  }
  return ids;
}

TEST(Explain, KnowsEveryMessageOfTheReader) {
  for (const std::string& id : ids_in_sources_of_the_reader()) {
    EXPECT_NE(explanation_of(id).find("a message about a program ("), std::string::npos) << id;
  }
}

TEST(Explain, KnowsEveryViolationOfTheVerifier) {
  for (const std::string& id : ids_in_sources_of_the_verifier()) {
    EXPECT_NE(explanation_of(id).find("a violation found by"), std::string::npos) << id;
  }
}

TEST(Explain, KnowsNothingThatIsNeverSaid) {
  Ids said = {"distance"};
  for (const auto& reason : gcode::reason::explanations()) said.emplace(reason.id);
  for (const std::string_view library : {"gcode", "postproc"}) {
    for (const auto& entry : fs::recursive_directory_iterator(source_folder() / library)) {
      const std::string kind = entry.path().extension().string();
      if (kind == ".cpp" || kind == ".h") add_ids_in(entry.path(), said);
    }
  }
  for (const std::string_view id : explained_ids()) {
    EXPECT_TRUE(said.contains(std::string(id))) << id;
  }
}

// What the page of messages tells of and the program does not would be found by nobody who reads
// the program's own messages.
TEST(Explain, KnowsEveryMessageOfThePage) {
  const std::string page = text_of_file(source_folder() / "docs/diagnostics.md");
  const std::regex row("(^|\n)\\| `([a-z-]+)` \\|");
  std::size_t rows = 0;
  for (std::sregex_iterator found(page.begin(), page.end(), row), end; found != end; ++found) {
    EXPECT_FALSE(explanation_of((*found)[2].str()).empty()) << (*found)[2];
    ++rows;
  }
  EXPECT_GT(rows, 60U);
}

// The page for people says of each message what the program says: its id is there.
TEST(Explain, SaysForEveryIdWhatToDoInShortLines) {
  const auto ids = explained_ids();
  EXPECT_GT(ids.size(), 70U);
  const std::string all = all_explanations();
  const std::string page = text_of_file(source_folder() / "docs/diagnostics.md");
  for (const std::string_view id : ids) {
    std::string text = explanation_of(id);
    EXPECT_TRUE(text.starts_with(std::string(id) + ":")) << text;
    EXPECT_NE(text.find("What to do:\n    "), std::string::npos) << text;
    EXPECT_EQ(text.find("What to do:\n    \n"), std::string::npos) << text;
    EXPECT_EQ(text.find_first_of("`|"), std::string::npos) << text;
    EXPECT_EQ(text.find("]("), std::string::npos) << text;
    EXPECT_NE(all.find("  " + std::string(id) + " "), std::string::npos) << id;
    EXPECT_NE(page.find("`" + std::string(id) + "`"), std::string::npos) << id;
    for (std::size_t end; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1)) {
      EXPECT_LE(end, 80U) << text.substr(0, end);
    }
  }
}

TEST(Explain, TellsBothMeaningsOfAnIdThatIsAReasonAndABreach) {
  const std::string text = explanation_of("not-proved");
  EXPECT_NE(text.find("why blocks are kept"), std::string::npos);
  EXPECT_NE(text.find("a violation found"), std::string::npos);
}

TEST(Explain, NamesTheOptionThatLiftsARule) {
  EXPECT_NE(explanation_of("exact-stop").find("--allow exact-stop"), std::string::npos);
  EXPECT_EQ(explanation_of("cutter-compensation").find("--allow"), std::string::npos);
}

TEST(Explain, HasNothingForUnknownIds) { EXPECT_EQ(explanation_of("no-such-id"), ""); }

}  // namespace
}  // namespace batten::postproc
