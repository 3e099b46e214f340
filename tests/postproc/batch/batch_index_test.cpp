// The page of all programs of a batch, and the small pictures on it.

#include "postproc/batch/batch_index.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "postproc/report/path_picture.h"
#include "postproc/stream/pipeline.h"
#include "tests/support/report_words.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

ProgramRecord written(const std::string& program) {
  ProgramRecord record;
  record.program = program;
  record.status = ProgramStatus::kSmoothed;
  record.output_sha256 = "cc";
  record.report_sha256 = "dd";
  record.blocks_in = 100;
  record.blocks_out = 30;
  record.time_before = {150, 3, 1.5};
  record.time_after = {90, 2, 0.5};
  record.deviation_mm = 0.0098;
  record.deviation_line = 42;
  record.picture = {.rewritten = "M6 6L90 40", .kept = "M0 0L6 6"};
  return record;
}

std::string index_of(const std::vector<ProgramRecord>& records) {
  return batch_index(records, "shop", linuxcnc_options());
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(BatchIndex, HasThePictureTheFiguresAndTheWorstPlaceOfEachProgram) {
  const std::string page = index_of({written("a/b.nc")});
  for (const char* part :
       {"d=\"M6 6L90 40\"", "d=\"M0 0L6 6\"", "2 min 30 s \u2192 90.00 s", "-40 %", "100 \u2192 30",
        "0.0098 mm", "line 42", "href=\"../a/b.nc\"", "href=\"reports/a/b.nc.json\""}) {
    EXPECT_TRUE(has(page, part)) << part << "\n" << page;
  }
}

TEST(BatchIndex, LeadsToThePagesThatWereWritten) {
  ProgramRecord record = written("a/b.nc");
  EXPECT_FALSE(has(index_of({record}), "reports/a/b.nc.html"));
  record.page_sha256 = "ee";
  EXPECT_TRUE(has(index_of({record}), "<a href=\"reports/a/b.nc.html\">a/b.nc</a>"));
}

TEST(BatchIndex, ShowsWhatWasNotWrittenFirstAndWhy) {
  ProgramRecord refused;
  refused.program = "z.nc";
  refused.status = ProgramStatus::kNotUnderstood;
  refused.message = "z.nc:1:1: error: no units";
  const std::string page = index_of({written("a.nc"), refused});
  EXPECT_LT(page.find("z.nc:1:1: error"), page.find("<h2>a.nc"));
  EXPECT_FALSE(has(page, "href=\"../z.nc\""));
}

// A name is what somebody called a file.
TEST(BatchIndex, NamesCannotLeaveTheirPlace) {
  const std::string page = index_of({written("\"><script>x</script> #?%.nc")});
  EXPECT_FALSE(has(page, "<script"));
  EXPECT_TRUE(has(page, "../%22%3E%3Cscript%3Ex%3C/script%3E%20%23%3F%25.nc")) << page;
}

TEST(BatchIndex, NeedsNothingElse) {
  const std::string page = index_of({written("a.nc")});
  for (const char* part : {"src=", "http:", "https:", "url("})
    EXPECT_FALSE(has(page, part)) << part;
}

// --- pictures -----------------------------------------------------------------------------------

PathPicture picture_of(const std::string& program) {
  const gcode::SourceText source("part.nc", program);
  const SmoothOptions options = linuxcnc_options();
  const SmoothResult result = smooth_program(source, options, {});
  return path_picture({.source = source, .options = options, .result = result, .output_file = ""});
}

// 80 mm wide and 40 high into 320 x 240 with a margin of 6: 308 / 80 = 3.85 to the mm, from x = 6,
// and 154 high around y = 120.
TEST(PathPicture, FitsThePathInItsFrame) {
  const PathPicture picture = picture_of("G21\nG0 X0 Y0 Z0\nG1 X80 F100\nY40\nM2\n");
  EXPECT_EQ(picture.kept, "M6 197L314 197L314 43");
  EXPECT_EQ(picture.rewritten, "");
}

TEST(PathPicture, TellsWhatIsRewritten) {
  EXPECT_FALSE(picture_of(bend_program()).rewritten.empty());
}

// From above it would be a line.
TEST(PathPicture, OfAPathInOnePlaneIsSeenFromItsSide) {
  const PathPicture picture = picture_of("G21\nG0 X0 Y0 Z0\nG1 X80 F100\nZ-40\nM2\n");
  EXPECT_EQ(picture.kept, "M6 43L314 43L314 197");
}

TEST(PathPicture, HasNoRapidsAndNoPlaceThatIsNotKnown) {
  EXPECT_EQ(picture_of("G21\nG0 X0 Y0 Z0\nG0 X80\nM2\n").kept, "");
  EXPECT_EQ(picture_of("M30\n").kept, "");
}

// Some kilobytes for each program, however long: rows over a whole plate.
TEST(PathPicture, StaysSmall) {
  std::string rows = "G21\nG0 X0 Y0 Z0\nG1 F100\n";
  for (int row = 0; row < 2000; ++row) {
    for (int k = 0; k < 20; ++k) {
      const int x = row % 2 == 0 ? k : 19 - k;
      rows += "X" + std::to_string(100 * x) + " Y" + std::to_string(row) + " Z" +
              std::to_string((row * k) % 3) + "\n";
    }
  }
  const PathPicture picture = picture_of(rows);
  const std::size_t size = picture.kept.size() + picture.rewritten.size();
  EXPECT_GT(size, 1000U);
  EXPECT_LT(size, 40000U);
}

}  // namespace
}  // namespace batten::postproc
