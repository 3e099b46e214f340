#include "gcode/text/number_format.h"

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

namespace batten::gcode {
namespace {

struct WriteCase {
  std::string name;
  double value;
  NumberFormat format;
  std::string text;
};

constexpr NumberFormat kThree{.decimals = 3};
constexpr NumberFormat kPointed{.decimals = 3, .trailing_zeros = false, .always_point = true};
constexpr NumberFormat kPadded{.decimals = 3, .trailing_zeros = true};

const WriteCase kAppendNumberRows[] = {
    {"Zero", 0.0, kThree, "0"},
    {"NegativeZero", -0.0, kThree, "0"},
    {"NegativeZeroPointed", -0.0, kPointed, "0."},
    {"RoundsToZeroWithoutSign", -0.0004, kThree, "0"},
    {"RoundsToZeroPadded", -0.0004, kPadded, "0.000"},
    {"HalfGoesAway", 0.0005, kThree, "0.001"},
    {"HalfGoesAwayBelowZero", -0.0005, kThree, "-0.001"},
    // 1.0005 is stored as 1.000499999..; what the user wrote is the shortest decimal.
    {"HalfOfTheShortestDecimal", 1.0005, kThree, "1.001"},
    {"HalfOfTheShortestDecimalBelowZero", -1.0005, kThree, "-1.001"},
    {"BelowHalf", 1.00049999, kThree, "1"},
    {"CarriesThroughNines", 9.9996, kThree, "10"},
    {"CarriesIntoAPaddedFraction", 0.9996, kPadded, "1.000"},
    {"CarriesFromNothing", 0.6, NumberFormat{.decimals = 0}, "1"},
    {"NothingKept", 0.04, NumberFormat{.decimals = 0}, "0"},
    {"WholeNumberPointed", 5.0, kPointed, "5."},
    {"WholeNumberPointedNoDecimals", 1200.0,
     NumberFormat{.decimals = 0, .trailing_zeros = true, .always_point = true}, "1200."},
    {"TrailingZerosOfAWholeNumberStay", 1200.0, kThree, "1200"},
    {"TrailingZerosCut", 1.5, kThree, "1.5"},
    {"TrailingZerosKept", 1.5, kPadded, "1.500"},
    {"SmallFraction", 0.001, kThree, "0.001"},
    {"NoExponentWhenSmall", 1e-9, NumberFormat{.decimals = 9}, "0.000000001"},
    {"NoExponentWhenLarge", 999999999.0, kThree, "999999999"},
    {"RoundsUpToTheLimit", 999999999.9996, kThree, "1000000000"},
    {"Denormal", std::numeric_limits<double>::denorm_min(), kThree, "0"},
    {"NineDecimals", 1.0 / 3, NumberFormat{.decimals = 9}, "0.333333333"}};

TEST(AppendNumber, WritesWhatControlsRead) {
  for (const WriteCase& test : kAppendNumberRows) {
    SCOPED_TRACE(test.name);
    EXPECT_EQ(to_text(test.value, test.format), test.text);
  }
}

TEST(AppendNumber, KeepsWhatStandsBefore) {
  std::string line = "G1 X";
  append_number(line, -2.5, kThree);
  EXPECT_EQ(line, "G1 X-2.5");
}

TEST(AppendNumber, RefusesWhatNoControlTakes) {
  for (const double value : {1e9, -1e9, std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_THROW((void)to_text(value, kThree), std::invalid_argument) << value;
  }
  for (const int decimals : {-1, 10}) {
    EXPECT_THROW((void)to_text(1.0, NumberFormat{.decimals = decimals}), std::invalid_argument);
  }
}

// A value of one of many sizes, both signs.
double random_value(std::mt19937_64& random) {
  std::uniform_real_distribution<double> exponent(-12, 8.99);
  const double size = std::pow(10.0, exponent(random));
  return std::uniform_real_distribution<double>(-size, size)(random);
}

TEST(AppendNumber, WritesOnlyPlainDecimalsWithinHalfAUnit) {
  constexpr int kNumbers = 200'000;
  std::mt19937_64 random(1);
  for (int i = 0; i < kNumbers; ++i) {
    SCOPED_TRACE(testing::Message() << "number " << i);
    const double value = random_value(random);
    const NumberFormat format{.decimals = static_cast<int>(random() % 10),
                              .trailing_zeros = random() % 2 == 0,
                              .always_point = random() % 2 == 0};
    const std::string text = to_text(value, format);
    ASSERT_EQ(text.find_first_not_of("-.0123456789"), std::string::npos) << text;
    const auto read = read_number(text);
    ASSERT_TRUE(read) << text;
    ASSERT_LE(read->decimals, format.decimals) << text;
    ASSERT_EQ(read->value, rounded(value, format.decimals)) << text;
    ASSERT_EQ(rounded(read->value, format.decimals), read->value) << text;
    ASSERT_FALSE(read->value == 0 && text.front() == '-') << text;
    // Half a unit of the last digit, and the rounding of two doubles.
    const double unit = std::pow(10.0, -format.decimals);
    ASSERT_LE(std::abs(read->value - value), 0.5 * unit + 1e-15 * std::abs(value)) << text;
  }
}

// All positions of a 0.001 grid from -100 to 100, as a CAM system prints them; and half a unit
// more, as a user would write it.
TEST(AppendNumber, EveryGridPositionComesBackAsItWasAndAHalfGoesAwayFromZero) {
  for (int thousandths = -100'000; thousandths <= 100'000; ++thousandths) {
    const double value = thousandths / 1000.0;
    const std::string text = to_text(value, kThree);
    ASSERT_EQ(read_number(text)->value, value) << text;
    ASSERT_EQ(rounded(value, 3), value) << text;
    if (thousandths == 0) continue;
    const std::string half = to_text(value, kPadded) + "5";
    const double expected = (thousandths + (thousandths > 0 ? 1 : -1)) / 1000.0;
    ASSERT_EQ(rounded(read_number(half)->value, 3), expected) << half;
  }
}

struct ReadCase {
  std::string name;
  std::string text;
  double value;
  int decimals;
  bool has_point;
};

const ReadCase kReadsNumberRows[] = {
    {"Whole", "5", 5, 0, false},
    {"PointLast", "5.", 5, 0, true},
    {"PointFirst", ".5", 0.5, 1, true},
    {"SignedPointFirst", "-.5", -0.5, 1, true},
    {"Plus", "+5", 5, 0, false},
    {"LeadingZeros", "00005", 5, 0, false},
    {"NegativeZero", "-0.000", 0, 3, true},
    {"TrailingZeros", "1.2500", 1.25, 4, true},
    // The standard's own example of blanks inside a number.
    {"BlanksInside", " +0. 12 34", 0.1234, 4, true},
    {"TabAfterSign", "-\t7", -7, 0, false},
    {"BlanksAround", "  3.25 \t", 3.25, 2, true},
    {"ManyDigits", "3.14159265358979323846264338", 3.141592653589793, 26, true},
    {"ManyDigitsWithBlanks", "3.14159265358979323 846264338", 3.141592653589793, 26, true},
    // 2^53 + 1 lies half way between two doubles; ties go to even.
    {"TieToEven", "9007199254740993", 9007199254740992.0, 0, false},
    {"JustAboveTheTie", "9007199254740993.0000000001", 9007199254740994.0, 10, true},
    {"SmallerThanAnyDouble", "0." + std::string(400, '0') + "1", 0, 401, true}};

TEST(ReadsNumber, AsWritten) {
  for (const ReadCase& test : kReadsNumberRows) {
    SCOPED_TRACE(test.name);
    const auto read = read_number(test.text);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->value, test.value);
    EXPECT_FALSE(read->value == 0 && std::signbit(read->value));
    EXPECT_EQ(read->decimals, test.decimals);
    EXPECT_EQ(read->has_point, test.has_point);
  }
}

TEST(ReadNumber, RefusesEverythingElse) {
  for (const std::string text :
       {"",   " ",  "+",   "-",    ".",   "-.",  "+-5", "--5", "1e3", "1E3", "1.2.3",
        "5x", "x5", "1,5", "0x10", "inf", "nan", "5-",  "[1]", "#1",  "1\n"}) {
    EXPECT_FALSE(read_number(text)) << '"' << text << '"';
  }
  EXPECT_FALSE(read_number(std::string(400, '9'))) << "greater than any double";
}

TEST(ReadNumber, AgreesWithCorrectRoundingOnRandomDigits) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 200'000; ++i) {
    const int before = static_cast<int>(random() % 10);
    const int after = static_cast<int>(random() % 14) + (before == 0 ? 1 : 0);
    std::string text;
    for (int k = 0; k < before; ++k) text.push_back(static_cast<char>('0' + random() % 10));
    text.push_back('.');
    for (int k = 0; k < after; ++k) text.push_back(static_cast<char>('0' + random() % 10));
    double expected = 0;
    std::from_chars(text.data(), text.data() + text.size(), expected);
    ASSERT_EQ(read_number(text)->value, expected) << text;
  }
}

TEST(ScanNumber, StopsWhereTheNumberStops) {
  EXPECT_EQ(scan_number("1.5Y2")->length, 3u);
  EXPECT_EQ(scan_number("0. 12 34Y 7")->length, 8u);
  EXPECT_EQ(scan_number("5  (c)")->length, 1u);
  EXPECT_EQ(scan_number("1.2.3")->length, 3u);
  EXPECT_EQ(scan_number("1e3")->length, 1u);
  EXPECT_FALSE(scan_number("Y2"));
}

}  // namespace
}  // namespace batten::gcode
