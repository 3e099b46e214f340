// The page for a browser, and the numbers that are packed into it.
#include "postproc/report/html_report.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "gcode/controls/built_in.h"
#include "postproc/report/page_files.h"
#include "postproc/report/page_path.h"
#include "postproc/report/smooth_report.h"
#include "tests/support/places.h"
#include "tests/support/report_words.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

std::string text_of(const std::string& file) {
  return text_of_file(std::string(BATTEN_SOURCE_DIR) + "/postproc/report/page/" + file);
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

class HtmlReport : public testing::Test {
 protected:
  [[nodiscard]] SmoothReport report() const {
    return {
        .source = source_, .options = options_, .result = result_, .output_file = "part.smooth.nc"};
  }
  [[nodiscard]] std::string page() const { return html_report(report(), "batten smooth part.nc"); }
  // What stands in the page's data element.
  [[nodiscard]] Json data() const {
    const std::string text = page();
    const std::string begin = "id=\"data\">";
    const std::size_t from = text.find(begin) + begin.size();
    return Json::parse(text.substr(from, text.find("</script>", from) - from));
  }

  gcode::SourceText source_{"part.nc", "G21\nG1 X1 Y0 Z0 F100\nX2\nX3 Y1\n"};
  SmoothOptions options_ = linuxcnc_options();
  SmoothResult result_ = five_runs();
};

TEST_F(HtmlReport, HasTheFiguresOfTheJsonReport) {
  Json expected = smooth_json(report());
  const Json found = data()["report"];
  const Json runs = found["runs"];
  for (std::size_t i = 0; i < expected["runs"].size(); ++i) {
    for (const auto& [name, value] : expected["runs"][i].items()) {
      EXPECT_EQ(runs[name][i], value) << "run " << i << " " << name;
    }
  }
  expected.erase("runs");
  for (const auto& [name, value] : expected.items()) EXPECT_EQ(found[name], value) << name;
  EXPECT_EQ(data()["command"], "batten smooth part.nc");
}

TEST_F(HtmlReport, IsOnePageWithoutMarksLeftOver) {
  const std::string text = page();
  EXPECT_TRUE(text.starts_with("<!doctype html>"));
  for (const char* mark : {"@TITLE@", "@STYLE@", "@DATA@", "@SCRIPT@"}) {
    EXPECT_EQ(text.find(mark), std::string::npos) << mark;
  }
  EXPECT_EQ(text.find("src=\"http"), std::string::npos);
  EXPECT_EQ(text.find("href=\"http"), std::string::npos);
}

TEST_F(HtmlReport, NamesAndMessagesCannotLeaveTheirPlace) {
  const std::string plain = page();
  source_ = gcode::SourceText("</script><!--<title>.nc", std::string(source_.text()));
  const std::string hostile = page();
  for (const char* mark : {"</script", "<script", "<!--", "<title", "</title"}) {
    EXPECT_EQ(count_of(hostile, mark), count_of(plain, mark)) << mark;
  }
  EXPECT_EQ(data()["report"]["input"]["file"], "</script><!--<title>.nc");
}

TEST_F(HtmlReport, IsTheSameForTheSameResult) { EXPECT_EQ(page(), page()); }

// A page that did not read the curves could match no section of the new path with the old one.
TEST_F(HtmlReport, DrawsCurvesOfTheTarget) {
  options_.target = gcode::find_control("fanuc");
  options_.decimals = gcode::Decimals{};
  options_.output = Form::kCurves;
  const std::string before = bend_program();
  source_ = gcode::SourceText("part.nc", before);
  result_ = smooth_program(source_, options_, {});
  ASSERT_NE(result_.text.find("G06.2"), std::string::npos);
  const Json path = data()["path"];
  EXPECT_EQ(path["sections"], 1);
  EXPECT_EQ(path["sections_not_shown"], 0);
}

TEST_F(HtmlReport, DrawsTheRegionOfWhatIsFlat) {
  options_.decimals = gcode::Decimals{};
  source_ = gcode::SourceText("part.nc", bend_program());
  result_ = smooth_program(source_, options_, {});
  ASSERT_TRUE(result_.proved);
  const Json region = data()["path"]["region"];
  EXPECT_EQ(region["drawn"], 1);
  EXPECT_EQ(region["in_space"], 0);
  EXPECT_EQ(region["left_out"], 0);
  EXPECT_EQ(region["most_edges"], kMostRegionEdges);
  EXPECT_GT(region["x"].get<std::string>().size(), region["sizes"].get<std::string>().size());
}

TEST_F(HtmlReport, IsMadeOfAProgramThatIsNotUnderstoodToo) {
  result_ = SmoothResult();
  EXPECT_EQ(data()["path"]["count"], 0);
  EXPECT_EQ(data()["report"]["understood"], false);
}

TEST(PageFiles, AreInTheProgramAsTheyAre) {
  EXPECT_EQ(page_template(), text_of("page.html"));
  EXPECT_EQ(page_style(), text_of("page.css"));
  const std::string script = page_script();
  for (const char* file : {"data.js", "format.js", "tool_path.js", "charts.js", "runs.js",
                           "summary.js", "kinds.js", "page.js"}) {
    const std::string text = text_of(file);
    ASSERT_FALSE(text.empty()) << file;
    EXPECT_EQ(count_of(script, text), 1U) << file;
  }
}

// Inside <style> and <script> these would end the element.
TEST(PageFiles, HoldNoEndOfTheirElement) {
  EXPECT_EQ(std::string(page_style()).find("</"), std::string::npos);
  EXPECT_EQ(page_script().find("</script"), std::string::npos);
  EXPECT_EQ(page_script().find("<!--"), std::string::npos);
}

// --- packed numbers ------------------------------------------------------------------------------

// The vectors of RFC 4648, section 10.
TEST(Base64, IsThatOfTheStandard) {
  const std::pair<const char*, const char*> kVectors[] = {{"", ""},
                                                          {"f", "Zg=="},
                                                          {"fo", "Zm8="},
                                                          {"foo", "Zm9v"},
                                                          {"foob", "Zm9vYg=="},
                                                          {"fooba", "Zm9vYmE="},
                                                          {"foobar", "Zm9vYmFy"},
                                                          {"\xff\xfe\xfd", "//79"}};
  for (const auto& [bytes, text] : kVectors) EXPECT_EQ(base64(bytes), text);
}

// Zigzag 0, 1, 2, 126 are bytes 00, 01, 02, 7E; 64 is 128 and takes two: 80 01.
TEST(PackedNumbers, AreZigzagInGroupsOfSevenBits) {
  EXPECT_EQ(packed({0, -1, 1, 63, 64}), base64(std::string_view("\x00\x01\x02\x7e\x80\x01", 6)));
}

TEST(PackedNumbers, TakeTheGreatestAndTheLeast) {
  const auto most = std::numeric_limits<std::int64_t>::max();
  const auto least = std::numeric_limits<std::int64_t>::min();
  // 64 bits are nine groups of seven and one bit.
  EXPECT_EQ(packed({most}), base64("\xfe\xff\xff\xff\xff\xff\xff\xff\xff\x01"));
  EXPECT_EQ(packed({least}), base64("\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01"));
}

TEST(PackedNumbers, AsStepsAndRunsAreDifferencesAndCounts) {
  EXPECT_EQ(steps_of({5, 7, 4}), (Column{5, 2, -3}));
  EXPECT_EQ(packed_runs({4, 4, 4, 9}), packed({4, 3, 9, 1}));
  EXPECT_EQ(packed_runs({}), "");
  // A long count in four numbers.
  Column lines;
  for (std::int64_t line = 10; line < 1000; ++line) lines.push_back(line);
  EXPECT_EQ(packed_runs(steps_of(lines)), packed({10, 1, 1, 989}));
}

}  // namespace
}  // namespace batten::postproc
