// Any number of threads gives the same proof, of good programs and of wrong ones.
#include <gtest/gtest.h>

#include <string>

#include "postproc/proof/verification.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

// Many stretches, each between two rapids.
std::string rows(double shift, int shifted_row) {
  std::string text = "G21 G90 G17\nM3 S1000\n";
  for (int row = 0; row < 30; ++row) {
    text += fmt::format("G0 Z5\nG0 X0 Y{}\nG1 Z-1 F500\n", row);
    for (int i = 1; i <= 20; ++i) {
      const double off = row == shifted_row && i == 10 ? shift : 0;
      text += fmt::format("X{:.3f} Y{:.4f}\n", 0.5 * i, row + 0.2 * std::sin(0.3 * i) + off);
    }
  }
  return text + "M30\n";
}

void expect_same(const Verification& a, const Verification& b) {
  EXPECT_EQ(a.proved(), b.proved());
  EXPECT_EQ(a.deviation_mm, b.deviation_mm);
  EXPECT_EQ(a.deviation_line, b.deviation_line);
  EXPECT_EQ(a.events_compared, b.events_compared);
  ASSERT_EQ(a.stretches.size(), b.stretches.size());
  for (std::size_t i = 0; i < a.stretches.size(); ++i) {
    EXPECT_EQ(a.stretches[i].old_first_block, b.stretches[i].old_first_block);
    EXPECT_EQ(a.stretches[i].comparison.bounds.at_most, b.stretches[i].comparison.bounds.at_most);
  }
  ASSERT_EQ(a.violations.size(), b.violations.size());
  for (std::size_t i = 0; i < a.violations.size(); ++i) {
    EXPECT_EQ(a.violations[i].id, b.violations[i].id);
    EXPECT_EQ(a.violations[i].old_line, b.violations[i].old_line);
    EXPECT_EQ(a.violations[i].message, b.violations[i].message);
  }
}

TEST(ParallelVerification, GivesTheProofOfOneThread) {
  const ReadText before(rows(0, 0));
  const std::string lost_event = [] {
    std::string text = rows(0.004, 3);
    return text.replace(text.find("G0 X0 Y12\n"), 10, "G0 X0 Y12 M8\n");
  }();
  for (const std::string& text : {rows(0.004, 17), rows(0.02, 17), rows(0.02, 0), lost_event}) {
    const ReadText after(text);
    const ReadProgram old_program{&before.program, &before.meaning};
    const ReadProgram new_program{&after.program, &after.meaning};
    const Verification one = verify(old_program, new_program, 0.01);
    for (const int threads : {0, 1, 2, 3}) {
      SCOPED_TRACE(threads);
      expect_same(verify_in_parallel(old_program, new_program, 0.01, threads), one);
    }
  }
}

TEST(ParallelVerification, FindsTheRowThatIsWrong) {
  const ReadText before(rows(0, 0));
  const ReadText after(rows(0.02, 17));
  const Verification found = verify_in_parallel({&before.program, &before.meaning},
                                                {&after.program, &after.meaning}, 0.01, 2);
  ASSERT_EQ(found.violations.size(), 1U);
  EXPECT_EQ(found.violations[0].id, "distance");
  EXPECT_FALSE(found.proved());
}

}  // namespace
}  // namespace batten::postproc
