// Which candidate replaces a run. The figures are far from the margins, so that these are
// promises and no copy of the margins.
#include "postproc/smooth/selection/selection.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "gcode/state/reason.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using Order = std::vector<std::size_t>;

// Seconds, the same under every setting of the control.
Times all(double seconds) { return {seconds, seconds, seconds, seconds}; }

Candidate candidate(double seconds, std::size_t blocks, double error) {
  Candidate c;
  c.method = "fair";
  c.times = all(seconds);
  c.text.blocks = blocks;
  c.text.text = std::string(20 * blocks, 'x');
  c.error = error;
  return c;
}

// A run of 100 blocks and 2000 bytes that takes 10 s and is 0.004 mm off.
class Choose : public testing::Test {
 protected:
  Choose() { run_.facts = {all(10), 1, 0, 0.004, 0.5}; }

  [[nodiscard]] Selection choose(std::vector<Candidate> candidates) {
    run_.candidates = std::move(candidates);
    const gcode::ModalState& state = read_.meaning.states.front();
    return postproc::choose(run_, {read_.program, state, state, "\n", 100, 2000}, options_);
  }

  ReadText read_{"G21\n"};
  SmoothedRun run_;
  SmoothOptions options_ = options_for("linuxcnc");
};

// Of another one only bounds are known: what is left to chance speaks for it.
TEST_F(Choose, KnowsWhichRivalsACandidateBeatsWhateverTheirTime) {
  const gcode::ModalState& state = read_.meaning.states.front();
  const RunContext context{read_.program, state, state, "\n", 100, 2000};
  const auto beats = [&](const Candidate& c, const Bound& bound) {
    return postproc::beats(c, bound, run_, context, options_);
  };
  const Candidate good = candidate(10, 50, 0.001);
  EXPECT_TRUE(beats(good, {10, 0.004, 1})) << "four times as near";
  EXPECT_TRUE(beats(good, {10, 0.001, 100})) << "half the blocks";
  EXPECT_FALSE(beats(good, {9, 0.004, 1})) << "the other may be faster";
  EXPECT_FALSE(beats(good, {10, 0.0002, 100})) << "the other is nearer";
  EXPECT_FALSE(beats(good, {10, 0.001, 55})) << "the other may have fewer blocks after all";
  EXPECT_FALSE(beats(candidate(12, 50, 0.001), {12, 0.004, 1})) << "slower than the run";
  Candidate kinked = good;
  kinked.times.exact_path = 30;
  EXPECT_FALSE(beats(kinked, {10, 0.004, 1})) << "the other may have fewer kinks";
  options_.prefer = Prefer::kAccuracy;
  EXPECT_FALSE(beats(good, {10, 0.004, 1}));
}

// What a control could not hold its feed for before it can hold now: with the feed turned up, two
// hundredths are a fair price, for no more blocks. As the program has it nothing may be slower.
TEST_F(Choose, TakesWhatHasNoKinksWhereOnlyAFeedTurnedUpCostsALittle) {
  run_.facts.kink = 0.02;
  Candidate smooth = candidate(10, 100, 0.004);
  smooth.times.flat_out = 10.2;
  EXPECT_EQ(choose({smooth}).order, Order{0});
  Candidate kinked = smooth;
  kinked.kink = 0.01;
  EXPECT_TRUE(choose({kinked}).order.empty()) << "half the kink is no tenth";
  Candidate longer = smooth;
  longer.text.blocks = 101;
  EXPECT_TRUE(choose({longer}).order.empty());
  Candidate dear = smooth;
  dear.times.flat_out = 10.4;
  EXPECT_TRUE(choose({dear}).order.empty());
  Candidate slower = smooth;
  slower.times.as_set = 10.2;
  EXPECT_TRUE(choose({slower}).order.empty());
}

TEST_F(Choose, PassesOnWhyThereIsNoCandidate) {
  run_.reason = gcode::reason::kNoFit;
  const Selection selection = choose({});
  EXPECT_TRUE(selection.order.empty());
  EXPECT_EQ(selection.reason, gcode::reason::kNoFit);
}

struct OneCandidate {
  const char* why;
  Candidate candidate;
  Prefer prefer;
  Form output;
  std::string_view reason;  // empty: it is taken
};

TEST_F(Choose, TakesWhatGainsAndSaysWhyItLeavesTheRest) {
  constexpr std::string_view kTaken = "";
  constexpr auto kTime = Prefer::kTime;
  constexpr auto kAuto = Form::kAuto;
  using namespace gcode::reason;
  for (const auto& [why, one, prefer, output, reason] : {
           OneCandidate{"faster", candidate(8, 100, 0.004), kTime, kAuto, kTaken},
           OneCandidate{"smaller", candidate(10, 50, 0.004), kTime, kAuto, kTaken},
           OneCandidate{"nearer", candidate(10, 100, 0.001), kTime, kAuto, kTaken},
           OneCandidate{"the same", candidate(10, 100, 0.004), kTime, kAuto, kNoGain},
           OneCandidate{"hardly better", candidate(9.99, 99, 0.0039), kTime, kAuto, kNoGain},
           OneCandidate{"far more blocks", candidate(10, 300, 0.001), kTime, kAuto, kNoGain},
           OneCandidate{"not fewer bytes", candidate(5, 100, 0), Prefer::kSize, kAuto, kNoGain},
           OneCandidate{"not asked for", candidate(11, 20, 0.004), kTime, kAuto, kSlower},
           OneCandidate{"asked for", candidate(11, 20, 0.004), kTime, Form::kArcs, kTaken},
           OneCandidate{"too slow", candidate(13, 20, 0.004), kTime, Form::kArcs, kSlower},
       }) {
    SCOPED_TRACE(why);
    options_.prefer = prefer;
    options_.output = output;
    const Selection selection = choose({one});
    EXPECT_EQ(selection.order, reason.empty() ? Order{0} : Order{});
    EXPECT_EQ(selection.reason, reason);
  }
}

// Whatever is gained besides, and under whichever setting it is slower.
TEST_F(Choose, NeverTakesWhatIsSlower) {
  std::vector<Candidate> slower(3, candidate(8, 50, 0.0005));
  slower[0].times.as_set = 10.5;
  slower[1].times.without_merging = 10.5;
  slower[2].times.flat_out = 10.5;
  for (const Prefer prefer : {Prefer::kTime, Prefer::kAccuracy, Prefer::kSize}) {
    options_.prefer = prefer;
    const Selection selection = choose(slower);
    EXPECT_TRUE(selection.order.empty()) << name_of(prefer);
    EXPECT_EQ(selection.reason, gcode::reason::kSlower) << name_of(prefer);
  }
}

TEST_F(Choose, SaysNoGainWhereOneWasNotSlower) {
  EXPECT_EQ(choose({candidate(12, 20, 0.001), candidate(10, 100, 0.004)}).reason,
            gcode::reason::kNoGain);
}

TEST_F(Choose, PutsTheBestFirst) {
  const std::vector<Candidate> candidates = {
      candidate(9, 60, 0.002),    // 0
      candidate(8, 70, 0.003),    // 1: least time
      candidate(9, 80, 0.0001),   // 2: nearest
      candidate(9.5, 20, 0.003),  // 3: fewest bytes
  };
  for (const auto& [prefer, best] :
       {std::pair{Prefer::kTime, 1u}, {Prefer::kAccuracy, 2u}, {Prefer::kSize, 3u}}) {
    options_.prefer = prefer;
    const Selection selection = choose(candidates);
    ASSERT_EQ(selection.order.size(), 4u) << name_of(prefer);
    EXPECT_EQ(selection.order.front(), best) << name_of(prefer);
    EXPECT_EQ(selection.reason, "") << name_of(prefer);
  }
}

TEST_F(Choose, PutsTheNearerFirstAmongEqualTimesThenTheSmallerThenThatOfFewerKinks) {
  EXPECT_EQ(choose({candidate(8, 50, 0.002), candidate(8, 60, 0.0001)}).order, (Order{1, 0}));
  EXPECT_EQ(choose({candidate(8, 60, 0.002), candidate(8, 50, 0.002)}).order, (Order{1, 0}));
  // Kinks cost stops under exact path, on any control.
  std::vector<Candidate> candidates(2, candidate(8, 50, 0.002));
  candidates[1].times.exact_path = 3;
  EXPECT_EQ(choose(candidates).order, (Order{1, 0}));
}

TEST_F(Choose, NamesEachCandidateOnce) {
  Selection selection = choose({candidate(8, 50, 0.002), candidate(12, 5, 0),
                                candidate(7, 50, 0.002), candidate(6, 50, 0.002)});
  std::ranges::sort(selection.order);
  EXPECT_EQ(selection.order, (Order{0, 2, 3}));
}

}  // namespace
}  // namespace batten::postproc
