// Messages reach readers that stop at the first byte that is not UTF-8.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "postproc/system/terminal_colour.h"

namespace batten::postproc {
namespace {

struct Utf8Case {
  const char* name;
  std::string_view bytes;
  std::string_view expected;
};

#define FFFD "\xEF\xBF\xBD"
const Utf8Case kCases[] = {
    {"Nothing", "", ""},
    {"Ascii", "part.nc:1", "part.nc:1"},
    {"TwoBytes", "30\xC2\xB0", "30\xC2\xB0"},
    {"ThreeBytes", "\xE2\x82\xAC", "\xE2\x82\xAC"},
    {"FourBytes", "\xF0\x9F\x94\xA9", "\xF0\x9F\x94\xA9"},
    {"Latin1", "Fr\xE4ser", "Fr" FFFD "ser"},
    {"LoneContinuation", "a\x80z", "a" FFFD "z"},
    {"CutOff", "a\xE2\x82", "a" FFFD FFFD},
    {"Overlong", "\xC0\xAF", FFFD FFFD},
    {"Surrogate", "\xED\xA0\x80", FFFD FFFD FFFD},
    {"AboveUnicode", "\xF4\x90\x80\x80", FFFD FFFD FFFD FFFD},
};

TEST(ValidUtf8, KeepsCharactersAndMarksOtherBytes) {
  for (const Utf8Case& test : kCases)
    EXPECT_EQ(as_valid_utf8(test.bytes), test.expected) << test.name;
}

// nlohmann's parser decides for itself what is UTF-8.
TEST(ValidUtf8, OfAnyBytesIsTakenByAStrictReader) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> any(0x20, 0xFF);
  std::uniform_int_distribution<int> high(0xBF, 0xF5);
  for (int round = 0; round < 2000; ++round) {
    std::string bytes;
    for (int i = 0; i < 12; ++i) {
      bytes += static_cast<char>(i % 3 == 0 ? high(random) : any(random));
    }
    const std::string text = as_valid_utf8(bytes);
    EXPECT_NO_THROW((void)nlohmann::json(text).dump()) << round;
    EXPECT_EQ(as_valid_utf8(text), text);
  }
}

}  // namespace
}  // namespace batten::postproc
