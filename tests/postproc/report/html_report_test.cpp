#include "postproc/report/html_report.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "gcode/controls/built_in.h"
#include "postproc/report/json_report.h"
#include "postproc/report/page_files.h"
#include "tests/support/places.h"
#include "tests/support/report_words.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

std::string text_of(const std::string& file) {
  std::ifstream stream(std::string(BATTEN_SOURCE_DIR) + "/postproc/report/page/" + file,
                       std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
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
  [[nodiscard]] std::string page() const {
    return html_report(report(), {.command = "batten smooth part.nc"});
  }
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

// A page that did not read the curves could match no stretch of the new path with the old one.
TEST_F(HtmlReport, DrawsCurvesOfTheTarget) {
  options_.target = gcode::find_control("fanuc");
  options_.decimals = gcode::Decimals{};
  options_.output = Form::kCurves;
  const std::string before = bend_program();
  source_ = gcode::SourceText("part.nc", before);
  result_ = smooth_program(source_, options_, {});
  ASSERT_NE(result_.text.find("G06.2"), std::string::npos);
  const Json path = data()["path"];
  EXPECT_EQ(path["stretches"], 1);
  EXPECT_EQ(path["stretches_not_shown"], 0);
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
  for (const char* file :
       {"data.js", "format.js", "tool_path.js", "charts.js", "runs.js", "summary.js", "page.js"}) {
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

}  // namespace
}  // namespace batten::postproc
