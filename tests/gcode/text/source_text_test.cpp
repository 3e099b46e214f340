#include "gcode/text/source_text.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

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

TEST(LineCursor, TakesAnyLineEnd) {
  EXPECT_EQ(lines_of("a\nb\n"), (Lines{"a", "b"}));
  EXPECT_EQ(lines_of("a\r\nb\r\n"), (Lines{"a", "b"}));
  EXPECT_EQ(lines_of("a\rb\r"), (Lines{"a", "b"}));
  EXPECT_EQ(lines_of("a\rb\nc\r\nd"), (Lines{"a", "b", "c", "d"}));
  EXPECT_EQ(lines_of("a\n\rb"), (Lines{"a", "", "b"}));
  EXPECT_EQ(lines_of("a\r\r\nb"), (Lines{"a", "", "b"}));
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

TEST(LineCursor, AMissingLastLineEndLosesNothing) {
  EXPECT_EQ(lines_of("a\nb"), (Lines{"a", "b"}));
  EXPECT_EQ(lines_of("a"), (Lines{"a"}));
  EXPECT_EQ(lines_of("a\r"), (Lines{"a"}));
  EXPECT_EQ(lines_of(""), Lines{});
  EXPECT_EQ(lines_of("\n"), (Lines{""}));
  EXPECT_EQ(lines_of("\n\n"), (Lines{"", ""}));
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

TEST(SourceText, PlacesCountLinesAndBytesFromOne) {
  const SourceText source("part.nc", "ab\ncd\r\ne\rf");
  expect_place(source, 0, 1, 1);
  expect_place(source, 1, 1, 2);
  expect_place(source, 2, 1, 3);  // the LF belongs to its line
  expect_place(source, 3, 2, 1);
  expect_place(source, 6, 2, 4);  // the LF of CR LF
  expect_place(source, 7, 3, 1);
  expect_place(source, 9, 4, 1);
  expect_place(source, 10, 4, 2);  // the end of the text
}

TEST(SourceText, ThePlaceAfterALastLineEndIsTheNextLine) {
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
  [[nodiscard]] std::filesystem::path file_with(const std::string& text) const {
    return scratch_.put("part.nc", text);
  }

  ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
};

TEST_F(MapFile, GivesTheBytesOfTheFile) {
  const std::string text("G1 X1\r\n\0%\n", 10);
  std::string error;
  const auto source = SourceText::map_file(file_with(text), error);
  ASSERT_TRUE(source) << error;
  EXPECT_EQ(source->text(), text);
  EXPECT_EQ(source->name(), (folder_ / "part.nc").string());
  expect_place(*source, 7, 2, 1);
}

TEST_F(MapFile, GivesBytesThatWereSetAsideAgain) {
  std::string text;
  for (int i = 0; i < 5000; ++i) text += std::to_string(i) + "\n";
  std::string error;
  const auto source = SourceText::map_file(file_with(text), error, "a name");
  ASSERT_TRUE(source) << error;
  EXPECT_EQ(source->name(), "a name");
  source->release_pages({5, static_cast<std::uint32_t>(text.size() - 7)});
  EXPECT_EQ(source->text(), text);
  SourceText("short", text).release_pages({0, 10000});  // not mapped: nothing to do
}

TEST_F(MapFile, TakesAnEmptyFile) {
  std::string error;
  const auto source = SourceText::map_file(file_with(""), error);
  ASSERT_TRUE(source) << error;
  EXPECT_TRUE(source->text().empty());
}

TEST_F(MapFile, KeepsItsBytesWhenTheFileIsReplaced) {
  std::string error;
  const auto source = SourceText::map_file(file_with("G1 X1\n"), error);
  ASSERT_TRUE(source) << error;
  std::ofstream(folder_ / "new.nc", std::ios::binary) << "G1 X2\n";
  std::filesystem::rename(folder_ / "new.nc", folder_ / "part.nc");
  EXPECT_EQ(source->text(), "G1 X1\n");
}

TEST_F(MapFile, SaysWhichFileAndWhy) {
  std::string error;
  EXPECT_FALSE(SourceText::map_file(folder_ / "none.nc", error));
  EXPECT_EQ(error, (folder_ / "none.nc").string() + ": No such file or directory");
  EXPECT_FALSE(SourceText::map_file(folder_, error));
  EXPECT_EQ(error, folder_.string() + ": Is a directory");
}

TEST_F(MapFile, RefusesMoreThanPlacesCanCount) {
  const auto file = file_with("");
  std::filesystem::resize_file(file, std::uintmax_t{1} << 32);  // sparse: no room is taken
  std::string error;
  EXPECT_FALSE(SourceText::map_file(file, error));
  EXPECT_NE(error.find("4 GiB"), std::string::npos) << error;
}

}  // namespace
}  // namespace batten::gcode
