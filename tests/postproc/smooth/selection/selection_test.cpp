// Which candidate replaces a run: one order by cost, and what speaks against writing a form at all.
// The figures are far from the margins, so that these are promises and no copy of the margins.
#include "postproc/smooth/selection/selection.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <utility>

#include "gcode/state/reason.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using Order = std::vector<std::size_t>;

constexpr Prefer kAll[] = {Prefer::kTime, Prefer::kAccuracy, Prefer::kSize};

Figures figures(double seconds, double blocks, double distance, double roughness = 0.2) {
  return {{seconds, 2 * seconds, seconds / 1.5}, blocks, 20 * blocks, distance, roughness};
}

Candidate candidate(double seconds, double blocks, double distance) {
  Candidate c;
  c.method = "fair";
  c.figures = figures(seconds, blocks, distance);
  return c;
}

// A run of 100 blocks and 2000 bytes that takes 10 s and is 0.004 mm off.
class Choose : public testing::Test {
 protected:
  Choose() {
    CostScale& scale = run_.facts.scale;
    scale.original = figures(10, 100, 0.004);
    scale.alone = 10;
    scale.printed = 3e-6;
    scale.near = 3e-4;
    scale.period = 0.001;
  }

  [[nodiscard]] Selection choose(std::vector<Candidate> candidates) {
    run_.candidates = std::move(candidates);
    return postproc::choose(run_, options_);
  }

  [[nodiscard]] double cost(const Figures& f) const {
    return cost_of(f, run_.facts.scale, options_.prefer);
  }

  SmoothedRun run_;
  SmoothOptions options_ = options_for("linuxcnc");
};

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
  Candidate arcs = candidate(11, 20, 0.006);
  arcs.form = Form::kArcs;
  Candidate useless = candidate(11, 120, 0.006);
  useless.form = Form::kArcs;
  Candidate overridden = candidate(10, 50, 0.001);
  overridden.figures.times.at_half = 21;
  for (const auto& [why, one, prefer, output, reason] : {
           OneCandidate{"faster", candidate(8, 100, 0.004), kTime, kAuto, kTaken},
           OneCandidate{"faster, but farther", candidate(8, 100, 0.006), kTime, kAuto, kTaken},
           OneCandidate{"faster, but larger", candidate(8, 150, 0.003), kTime, kAuto, kTaken},
           OneCandidate{"smaller", candidate(10, 50, 0.004), kTime, kAuto, kTaken},
           OneCandidate{"nearer", candidate(10, 100, 0.001), kTime, kAuto, kTaken},
           OneCandidate{"half as far", candidate(10, 140, 0.001), Prefer::kAccuracy, kAuto, kTaken},
           OneCandidate{"half as far for time", candidate(10, 140, 0.001), kTime, kAuto, kLarger},
           OneCandidate{"the same", candidate(10, 100, 0.004), kTime, kAuto, kNoGain},
           OneCandidate{"hardly better", candidate(9.99, 99, 0.0039), kTime, kAuto, kNoGain},
           OneCandidate{"larger, a little nearer", candidate(10, 120, 0.003), kTime, kAuto,
                        kLarger},
           OneCandidate{"larger", candidate(5, 101, 0), Prefer::kSize, kAuto, kLarger},
           OneCandidate{"smaller, but farther", candidate(10, 20, 0.006), kTime, kAuto, kFarther},
           OneCandidate{"for accuracy", candidate(10, 20, 0.006), Prefer::kAccuracy, kAuto,
                        kFarther},
           OneCandidate{"for size", candidate(10, 20, 0.006), Prefer::kSize, kAuto, kTaken},
           OneCandidate{"slower", candidate(10.1, 20, 0.001), kTime, kAuto, kSlower},
           OneCandidate{"slower at half the feed", overridden, kTime, kAuto, kSlower},
           OneCandidate{"asked for", arcs, kTime, Form::kArcs, kTaken},
           OneCandidate{"asked for, in vain", useless, kTime, Form::kArcs, kNoGain},
           OneCandidate{"not asked for", arcs, kTime, kAuto, kSlower},
       }) {
    SCOPED_TRACE(why);
    options_.prefer = prefer;
    options_.output = output;
    const Selection selection = choose({one});
    EXPECT_EQ(selection.order, reason.empty() ? Order{0} : Order{});
    EXPECT_EQ(selection.reason, reason);
  }
}

// A control's period is no time, and chords that cut the bends short are no faster path.
TEST_F(Choose, TakesWhatIsSlowerByLessThanAnybodyMeasures) {
  run_.facts.scale.original = figures(0.1, 100, 0.004);
  run_.facts.scale.alone = 0.1;
  EXPECT_EQ(choose({candidate(0.1009, 50, 0.001)}).order, Order{0});
  EXPECT_TRUE(choose({candidate(0.1011, 50, 0.001)}).order.empty());
}

// Both take a sixth of the original's time, and one of them a tenth less.
TEST_F(Choose, CountsATenthOfTheTimeWhereTheOriginalIsFarSlower) {
  EXPECT_EQ(choose({candidate(1.6, 80, 0.001), candidate(1.44, 80, 0.008)}).order, (Order{1, 0}));
}

// So that what is known of figures at least is a bound on the cost.
TEST_F(Choose, CostsNoLessWhereAnyFigureIsMore) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(0.2, 2);
  run_.facts.scale.original.roughness = 0.1;
  for (int i = 0; i < 2000; ++i) {
    options_.prefer = kAll[i % 3];
    Figures less = figures(10 * part(random), 100 * part(random), 0.004 * part(random));
    less.bytes = 2000 * part(random);
    less.roughness = 0.1 * part(random);
    for (int which = 0; which < 5; ++which) {
      Figures more = less;
      double& one = *std::array{&more.times.programmed, &more.blocks, &more.bytes, &more.distance,
                                &more.roughness}[static_cast<std::size_t>(which)];
      one *= 1 + 0.1 * part(random);
      EXPECT_GE(cost(more), cost(less) - 1e-12) << which;
    }
  }
}

// What makes any figure worse costs a hundredth of the time at least, however little it is.
TEST_F(Choose, TakesAFiftiethOfTheTimeForWhatMakesAnyFigureWorse) {
  EXPECT_EQ(choose({candidate(9.7, 100, 0.004), candidate(9.55, 101, 0.004)}).order, (Order{0, 1}));
  EXPECT_EQ(choose({candidate(9.7, 100, 0.004), candidate(9.48, 101, 0.004)}).order, (Order{1, 0}));
  EXPECT_EQ(choose({candidate(9.7, 100, 0.004), candidate(9.55, 90, 0.0041)}).order, (Order{0, 1}));
  run_.facts.scale.original.roughness = 0.1;
  Candidate same = candidate(9.7, 100, 0.004);
  Candidate rougher = candidate(9.55, 90, 0.003);
  same.figures.roughness = 0.1;
  rougher.figures.roughness = 0.104;
  EXPECT_EQ(choose({same, rougher}).order, (Order{1, 0}));
  rougher.figures.roughness = 0.106;
  EXPECT_EQ(choose({same, rougher}).order, (Order{0, 1}));
}

// The path that was meant is longer than its chords: few arcs along it are no slower than they.
TEST_F(Choose, CallsWhatIsLongerByAsMuchAsTheMeantPathNoSlower) {
  EXPECT_EQ(choose({candidate(10, 80, 0.003), candidate(10.008, 50, 0.002)}).order, (Order{1, 0}));
  EXPECT_EQ(choose({candidate(9.8, 80, 0.003), candidate(9.9, 50, 0.002)}).order, (Order{0, 1}));
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

// Who loses blocks or nearness has not asked for a change.
TEST_F(Choose, BuysNoLittleTimeWithManyBlocksOrMuchDistance) {
  EXPECT_EQ(choose({candidate(9.88, 100, 0.004)}).order, Order{0});
  EXPECT_TRUE(choose({candidate(9.88, 150, 0.006)}).order.empty());
  EXPECT_EQ(choose({candidate(9, 1000, 0.04)}).order, Order{0}) << "a tenth is worth them";
}

TEST_F(Choose, PutsTheNearerFirstAmongEqualTimesAndSizesAndTheSmallerAmongEqualTimesAndDistances) {
  EXPECT_EQ(choose({candidate(8, 50, 0.002), candidate(8, 50, 0.0001)}).order, (Order{1, 0}));
  EXPECT_EQ(choose({candidate(8, 60, 0.002), candidate(8, 50, 0.002)}).order, (Order{1, 0}));
  std::vector<Candidate> candidates(2, candidate(8, 50, 0.002));
  candidates[1].figures.roughness = 0.1;
  EXPECT_EQ(choose(candidates).order, (Order{1, 0}));
}

// --- one order, whatever the candidates --------------------------------------------------------

std::vector<Candidate> random_candidates(std::mt19937& random) {
  std::uniform_real_distribution<double> part(0.3, 1.5);
  std::vector<Candidate> all(1 + random() % 8);
  for (Candidate& c : all) {
    c = candidate(10 * (0.9 + 0.12 * part(random)), std::round(100 * part(random)),
                  0.004 * part(random));
  }
  return all;
}

TEST_F(Choose, OneMoreCandidateNeverMakesTheResultWorse) {
  std::mt19937 random(7);
  int better = 0;
  for (int i = 0; i < 2000; ++i) {
    options_.prefer = kAll[i % 3];
    std::vector<Candidate> candidates = random_candidates(random);
    const Selection all = choose(candidates);
    const double least = cost_to_beat(run_, options_);
    EXPECT_LE(least, cost(run_.facts.scale.original));
    if (!all.order.empty()) {
      EXPECT_EQ(least, cost(candidates[all.order.front()].figures));
    }
    candidates.pop_back();
    const Selection fewer = choose(candidates);
    EXPECT_GE(cost_to_beat(run_, options_), least);
    if (cost_to_beat(run_, options_) > least) ++better;
    Order without = all.order;
    std::erase(without, candidates.size());
    EXPECT_EQ(fewer.order, without) << "the others keep their order";
  }
  EXPECT_GE(better, 100);
}

// Each preference has the least of its own figure, but for what the weights give away.
TEST_F(Choose, EachPreferenceIsTheBestInItsOwnFigure) {
  std::mt19937 random(11);
  for (int i = 0; i < 500; ++i) {
    const std::vector<Candidate> candidates = random_candidates(random);
    const auto chosen = [&](Prefer prefer) {
      options_.prefer = prefer;
      const Selection selection = choose(candidates);
      return selection.order.empty() ? run_.facts.scale.original
                                     : candidates[selection.order.front()].figures;
    };
    const Figures fast = chosen(Prefer::kTime);
    const Figures near = chosen(Prefer::kAccuracy);
    const Figures small = chosen(Prefer::kSize);
    for (const Figures& other : {fast, near, small}) {
      EXPECT_LE(fast.times.programmed, 1.03 * other.times.programmed);
      EXPECT_LE(small.blocks, 1.05 * other.blocks);
      EXPECT_LE(near.distance, other.distance + 0.1 * 0.004);
    }
  }
}

}  // namespace
}  // namespace batten::postproc
