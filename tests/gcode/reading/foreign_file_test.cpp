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

TEST(ForeignFiles, AreKnownByLinesThatOnlyTheirLanguageHas) {
  EXPECT_NE(foreign_kind_of("  0\r\nSECTION\r\n  2\r\nHEADER\r\n").find("DXF"), std::string::npos);
  EXPECT_NE(foreign_kind_of("999\nFreeCAD\n0\nSECTION\n2\n").find("DXF"), std::string::npos);
  EXPECT_EQ(foreign_kind_of("999\nG1 X1\n"), "");
  EXPECT_NE(foreign_kind_of("'Exported\nTR,12000\nC6\nMS,20.0,5.0\nJ2,0.0000,1.0000\nM3,1.0,,-2.0\n"
                            "CG,,5.0,5.0,1.0,0.0,T,1\n")
                .find("ShopBot"),
            std::string::npos);
  EXPECT_NE(foreign_kind_of("PA;PA;\nVS10.0;\n!MC1;\nPU0,400;\nZ40,80,-20;\n").find("plotters"),
            std::string::npos);
}

// Else programs of controls that a line here and there looks like another language would be
// refused.
TEST(Programs, MayHaveLinesThatLookLikeOtherLanguages) {
  const std::string other = "MS,20.0,5.0\nM2,0.0,1.0\nM3,1.0,,-2.0\nPU;\nPD4,5;\nZ1,2,3;\n";
  EXPECT_EQ(foreign_kind_of("G21\n" + other), "");
  EXPECT_EQ(foreign_kind_of(other + "N10 M2\n"), "");
  EXPECT_EQ(foreign_kind_of("MS,20.0,5.0\nM2,0.0,1.0\n"), "");
  EXPECT_EQ(foreign_kind_of("X1,R2\nX2,C3\nX3,R4\nM2\n"), "");
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
