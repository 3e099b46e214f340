#include "gcode/reading/foreign_file.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace batten::gcode {
namespace {

using namespace std::string_literals;

TEST(ForeignFiles, AreKnownByTheirBeginning) {
  for (const std::string& text : {"\x7f"
                                  "ELF\2\1\1"s,
                                  "PK\3\4..."s, "%PDF-1.4\n"s, "\x89PNG\r\n"s, "<!DOCTYPE html>\n"s,
                                  "\xef\xbb\xbf<?xml"s, "\n  {\"a\": 1}"s,
                                  "\xff\xfeG\0"
                                  "1\0"s,
                                  "ISO-10303-21;\n"s}) {
    EXPECT_NE(foreign_kind_of(text), "") << text;
  }
}

TEST(ForeignFiles, AreBinary) {
  std::mt19937 random(5);
  for (const int bytes : {100, 1000, 100000}) {
    std::string noise;
    for (int i = 0; i < bytes; ++i) noise.push_back(static_cast<char>(random() % 256));
    noise.front() = 'G';
    EXPECT_EQ(foreign_kind_of(noise), "binary") << bytes;
  }
  EXPECT_EQ(foreign_kind_of(std::string(500, '\0')), "NULs only");
}

TEST(Programs, AreNoForeignFiles) {
  for (const std::string& text :
       {""s, "\n \r\n"s, "G21\nG0 X0\n"s, "\0\0\0\0\0%\nO1\nG1 X1\n%\n\x1a"s, "0 BEGIN PGM X MM\n"s,
        "\xef\xbb\xbfG21\n"s, "%\n\x11G21\n\x13"s, "(M\xc3\xbcller) G1 X1\n"s,
        "solid part left\nG1 X1\n"s, "%MPF100\nG1 X1\n"s, "MSG(\"x\")\n"s,
        "(BELL \x07)\n"s + std::string(200, 'X')}) {
    EXPECT_EQ(foreign_kind_of(text), "") << text;
  }
}

// One character in a hundred: at 1 of 100 it may be a line that was sent badly, at 2 no longer.
TEST(Programs, MayHaveAFewControlCharacters) {
  std::string text(100, 'X');
  text[50] = '\x01';
  EXPECT_EQ(foreign_kind_of(text), "");
  text[60] = '\x02';
  EXPECT_EQ(foreign_kind_of(text), "binary");
}

}  // namespace
}  // namespace batten::gcode
