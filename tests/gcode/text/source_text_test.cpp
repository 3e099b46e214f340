#include "gcode/text/source_text.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "gcode/text/diagnostic.h"
#include "gcode/text/line_cursor.h"
#include "tests/support/scratch_folder.h"

namespace batten::gcode {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  LineCursor cursor(text);
  while (const auto line = cursor.next()) {
    lines.push_back(text.substr(line->begin, line->text_end - line->begin));
  }
  return lines;
}

using Lines = std::vector<std::string>;

TEST(LineCursor, TakesAnyLineEndAndNoneAtTheEnd) {
  const std::pair<std::string, Lines> rows[] = {{"a\nb\n", {"a", "b"}},
                                                {"a\r\nb\r\n", {"a", "b"}},
                                                {"a\rb\r", {"a", "b"}},
                                                {"a\rb\nc\r\nd", {"a", "b", "c", "d"}},
                                                {"a\n\rb", {"a", "", "b"}},
                                                {"a\r\r\nb", {"a", "", "b"}},
                                                {"a\nb", {"a", "b"}},
                                                {"a", {"a"}},
                                                {"a\r", {"a"}},
                                                {"", {}},
                                                {"\n", {""}},
                                                {"\n\n", {"", ""}}};
  for (const auto& [text, lines] : rows) EXPECT_EQ(lines_of(text), lines) << text;
}

TEST(LineCursor, EndsWithTheText) {
  for (const std::string text : {"a", "a\n", "a\r", "a\r\n", "\r", "\n\r", "a\n\r\r"}) {
    LineCursor cursor(text);
    std::uint32_t end = 0;
    while (const auto line = cursor.next()) {
      EXPECT_EQ(line->begin, end);
      end = line->end;
    }
    EXPECT_EQ(end, text.size());
  }
}

TEST(SourceText, KeepsEveryByte) {
  const std::string text("\xEF\xBB\xBFG1\0X1\r\n\x1A", 11);
  const SourceText source("part.nc", text);
  EXPECT_EQ(source.text(), text);
  EXPECT_EQ(source.text(SourceSpan{3, 5}), "G1");
  EXPECT_EQ(source.name(), "part.nc");
}

TEST(SourceText, CopiesShareTheBytes) {
  const SourceText source("part.nc", "G1");  // short enough to live inside a string
  const SourceText copy = source;            // NOLINT(performance-unnecessary-copy-initialization)
  EXPECT_EQ(copy.text().data(), source.text().data());
}

void expect_place(const SourceText& source, std::uint32_t offset, std::uint32_t line,
                  std::uint32_t column) {
  const SourcePlace place = source.place_of(offset);
  EXPECT_EQ(place.line, line) << "offset " << offset;
  EXPECT_EQ(place.column, column) << "offset " << offset;
}

TEST(SourceText, PositionsCountLinesAndBytesFromOne) {
  const SourceText source("part.nc", "ab\ncd\r\ne\rf");
  expect_place(source, 0, 1, 1);
  expect_place(source, 1, 1, 2);
  expect_place(source, 2, 1, 3);  // the LF belongs to its line
  expect_place(source, 3, 2, 1);
  expect_place(source, 6, 2, 4);  // the LF of CR LF
  expect_place(source, 7, 3, 1);
  expect_place(source, 9, 4, 1);
  expect_place(source, 10, 4, 2);  // the end of the text
  expect_place(SourceText("p", "a\n"), 2, 2, 1);
  expect_place(SourceText("p", ""), 0, 1, 1);
}

// The table of lines knows only some of them.
TEST(SourceText, PlacesOfALongTextAreCountedByHand) {
  std::string text;
  for (int i = 0; i < 1000; ++i) {
    text += std::string(static_cast<std::size_t>(i * 7 % 5), 'x');
    text += i % 3 == 0 ? "\n" : i % 3 == 1 ? "\r\n" : "\r";
  }
  const SourceText source("part.nc", text);
  std::uint32_t line = 1;
  std::uint32_t column = 1;
  for (std::uint32_t at = 0; at < text.size(); ++at) {
    const SourcePlace place = source.place_of(at);
    ASSERT_EQ(place.line, line) << "offset " << at;
    ASSERT_EQ(place.column, column) << "offset " << at;
    const bool ends = text[at] == '\n' || (text[at] == '\r' && text[at + 1] != '\n');
    line += ends ? 1 : 0;
    column = ends ? 1 : column + 1;
  }
}

class MapFile : public testing::Test {
 protected:
  [[nodiscard]] SourceText mapped(const std::string& text, const std::string& name = {}) {
    auto source = SourceText::map_file(scratch_.put("part.nc", text), error_, name);
    if (!source) throw std::runtime_error(error_);
    return *source;
  }

  ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
  std::string error_;
};

TEST_F(MapFile, GivesTheBytesOfTheFile) {
  const std::string text("G1 X1\r\n\0%\n", 10);
  const SourceText source = mapped(text);
  EXPECT_EQ(source.text(), text);
  EXPECT_EQ(source.name(), (folder_ / "part.nc").string());
  expect_place(source, 7, 2, 1);
  EXPECT_TRUE(mapped("").text().empty());
}

TEST_F(MapFile, GivesBytesThatWereReleasedAgain) {
  std::string text;
  for (int i = 0; i < 5000; ++i) text += std::to_string(i) + "\n";
  const SourceText source = mapped(text, "a name");
  EXPECT_EQ(source.name(), "a name");
  source.release_pages({5, static_cast<std::uint32_t>(text.size() - 7)});
  EXPECT_EQ(source.text(), text);
  SourceText("short", text).release_pages({0, 10000});  // not mapped: nothing to do
}

TEST_F(MapFile, KeepsItsBytesWhenTheFileIsReplaced) {
  const SourceText source = mapped("G1 X1\n");
  std::ofstream(folder_ / "new.nc", std::ios::binary) << "G1 X2\n";
  std::filesystem::rename(folder_ / "new.nc", folder_ / "part.nc");
  EXPECT_EQ(source.text(), "G1 X1\n");
}

TEST_F(MapFile, SaysWhichFileAndWhy) {
  const auto file = scratch_.put("long.nc", "");
  std::filesystem::resize_file(file, std::uintmax_t{1} << 32);  // sparse: no room is taken
  const std::pair<std::filesystem::path, std::string> rows[] = {
      {folder_ / "none.nc", ": No such file or directory"},
      {folder_, ": Is a directory"},
      {file, ": larger than 4 GiB, which is the most that one program may be"}};
  for (const auto& [path, reason] : rows) {
    EXPECT_FALSE(SourceText::map_file(path, error_));
    EXPECT_EQ(error_, path.string() + reason);
  }
}

// --- diagnostics -------------------------------------------------------------------------------

TEST(Diagnostic, SaysFilePlaceSeverityIdAndMessage) {
  const SourceText source("part.nc", "G21\nG2 X1 R5\n");
  const Diagnostic radius{Severity::kError, "arc-radius-mismatch", SourceSpan{7, 9},
                          "start radius 10.000 mm, end radius 10.412 mm"};
  EXPECT_EQ(to_text(radius, source),
            "part.nc:2:4: error: arc-radius-mismatch: start radius 10.000 mm, end radius "
            "10.412 mm");
  const Diagnostic note{Severity::kNote, "a-note", SourceSpan{0, 3}, "text"};
  EXPECT_EQ(to_text(note, source), "part.nc:1:1: note: a-note: text");
  const Diagnostic warning{Severity::kWarning, "a-warning", SourceSpan{4, 4}, "text"};
  EXPECT_EQ(to_text(warning, source), "part.nc:2:1: warning: a-warning: text");
}

TEST(Diagnostic, OnlyAnErrorIsAnError) {
  Diagnostics found;
  EXPECT_FALSE(has_error(found));
  found.push_back({Severity::kNote, "a-note", {}, ""});
  found.push_back({Severity::kWarning, "a-warning", {}, ""});
  EXPECT_FALSE(has_error(found));
  found.push_back({Severity::kError, "an-error", {}, ""});
  EXPECT_TRUE(has_error(found));
}

}  // namespace
}  // namespace batten::gcode
