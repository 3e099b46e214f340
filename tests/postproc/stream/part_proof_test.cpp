// What becomes of runs whose text does not say what was promised: the next candidate, pieces of the
// run, those that were left out, and in the end the blocks as they were.
#include <gtest/gtest.h>

#include <algorithm>
#include <variant>

#include "gcode/state/reason.h"
#include "postproc/smooth/part_runs.h"
#include "postproc/stream/window.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

constexpr const char* kElsewhere = "G1 X9 Y9\n";  // 9 mm beside every path here

bool go_on(double) { return true; }

// A program with one run, smoothed and not yet proved.
class SmoothedPart {
 public:
  explicit SmoothedPart(const std::string& text, Form form = Form::kAuto, std::size_t runs = 1)
      : read_(text), part_{read_.program, read_.meaning}, runs_(find_runs(part_, options_)) {
    options_.output = form;
    EXPECT_TRUE(smooth_runs(part_, options_, go_on, runs_));
    EXPECT_EQ(runs_.works.size(), runs);
  }

  RunState& work(std::size_t i = 0) { return runs_.works.at(i); }
  const PartRuns& runs() const { return runs_; }

  void make_all() {
    work().start_again(std::get<Run>(runs_.sections.at(work().section).content), options_);
  }

  // Puts a wrong way behind the first block of so many candidates of those that may be chosen.
  void spoil(std::size_t candidates, std::size_t of = 0) {
    RunState& spoiled = work(of);
    for (std::size_t i = 0; i < candidates; ++i) {
      std::string& text = spoiled.smoothed.candidates[spoiled.selection.order.at(i)].text.text;
      text.insert(text.find('\n') + 1, kElsewhere);
    }
  }

  ProvedText proved() {
    rounds_ = 0;
    const auto count = [this](double) {
      ++rounds_;
      return true;
    };
    auto done = prove_text(part_, options_, {}, {}, count, runs_);
    EXPECT_TRUE(done);
    return done.value_or(ProvedText{});
  }

  // Of the last proof, each with the whole text; where something was smoothed anew, that as well.
  std::size_t rounds() const { return rounds_; }

 private:
  ReadText read_;
  SmoothOptions options_ = options_for("linuxcnc");
  ProgramPart part_;
  PartRuns runs_;
  std::size_t rounds_ = 0;
};

// Of shallow waves two forms are good enough to be chosen.
const std::string kTwoForms = wave_program({.lines = 300, .height = 0.5, .length = 6});

// Of steep waves near forms beat all others, which are not made.
const std::string kOthersLeftOut = wave_program({.lines = 300, .height = 4, .length = 40});

const std::string kLong = wave_program({.lines = 1500, .height = 4, .length = 40});

TEST(PartProof, TakesTheNextCandidateWhereOneIsWrong) {
  SmoothedPart part(kTwoForms);
  part.make_all();
  ASSERT_GE(part.work().selection.order.size(), 2U);
  part.spoil(1);
  const ProvedText done = part.proved();
  EXPECT_TRUE(done.proved);
  EXPECT_FALSE(done.unchanged);
  EXPECT_EQ(part.work().tried, 1U);
  EXPECT_EQ(done.text.find(kElsewhere), std::string::npos);
}

TEST(PartProof, MakesWhatWasLeftOutWhereAllThatWasMadeIsWrong) {
  SmoothedPart part(kOthersLeftOut);
  ASSERT_TRUE(part.work().smoothed.left_out);
  part.spoil(part.work().selection.order.size());
  const ProvedText done = part.proved();
  EXPECT_TRUE(done.proved);
  EXPECT_FALSE(done.unchanged);
  EXPECT_FALSE(part.work().smoothed.left_out) << "made anew, all of them";
  EXPECT_EQ(part.work().reject_reason, "");
  EXPECT_EQ(done.text.find(kElsewhere), std::string::npos);
}

TEST(PartProof, CutsALongRunOfWhichNothingIsLeft) {
  SmoothedPart part(kLong);
  part.spoil(part.work().selection.order.size());
  const ProvedText done = part.proved();
  EXPECT_TRUE(done.proved);
  ASSERT_EQ(part.runs().cut_runs.size(), 1U);
  EXPECT_EQ(part.runs().cut_runs[0].reason, gcode::reason::kNotProved);
  EXPECT_GE(part.runs().works.size(), 3U);
  for (const RunState& piece : part.runs().works) EXPECT_NE(piece.chosen(), nullptr);
  EXPECT_EQ(done.text.find(kElsewhere), std::string::npos);
}

// Another candidate of a long run would leave the tolerance elsewhere.
TEST(PartProof, CutsAtOnceWhatIsLongEnoughAndNothingElse) {
  for (const int lines : {1500, 700}) {
    SCOPED_TRACE(lines);
    SmoothedPart part(wave_program({.lines = lines, .height = 0.5, .length = 6}));
    part.make_all();
    ASSERT_GE(part.work().selection.order.size(), 2U);
    part.spoil(1);
    EXPECT_TRUE(part.proved().proved);
    EXPECT_EQ(part.runs().cut_runs.size(), lines == 1500 ? 1U : 0U);
  }
}

TEST(PartProof, KnowsThePiecesOfEachRunThatIsCut) {
  const Wave wave{.lines = 1500, .height = 4, .length = 40};
  const std::string again = "G0 Z5\nG0 X0 Y0\nG1 Z-1 F300\n" + joined(wave_lines(wave), "\n");
  SmoothedPart part(head("G21") + joined(wave_lines(wave), "\n") + again + tail(), Form::kAuto, 2);
  part.spoil(part.work(1).selection.order.size(), 1);
  ASSERT_TRUE(part.proved().proved);
  part.spoil(part.work().selection.order.size());
  ASSERT_TRUE(part.proved().proved);
  ASSERT_EQ(part.runs().cut_runs.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const CutRun& cut = part.runs().cut_runs[i];
    const RunState& first = part.runs().works.at(cut.first_work);
    EXPECT_EQ(first.cut_run, i);
    EXPECT_EQ(first.first, 0U);
    EXPECT_EQ(part.runs().works.at(cut.first_work + cut.pieces - 1).last,
              cut.run.points.size() - 1);
  }
}

TEST(PartProof, KeepsAPieceThatIsWrongAndCutsNoOther) {
  SmoothedPart part(kLong, Form::kLines);
  part.spoil(part.work().selection.order.size());
  ASSERT_TRUE(part.proved().proved);
  const std::size_t pieces = part.runs().works.size();
  part.make_all();
  part.spoil(part.work().selection.order.size());
  const ProvedText done = part.proved();
  EXPECT_TRUE(done.proved);
  EXPECT_EQ(part.runs().works.size(), pieces);
  EXPECT_EQ(part.work().chosen(), nullptr);
  for (const RunState& piece : part.runs().works) {
    EXPECT_EQ(piece.chosen() == nullptr, &piece == &part.work()) << piece.reject_reason;
  }
}

// Each round reads and compares the whole text: it must not tell of one piece only.
TEST(PartProof, TellsOfAllPiecesThatAreWrongAtOnce) {
  SmoothedPart part(kLong, Form::kLines);
  part.spoil(part.work().selection.order.size());
  ASSERT_TRUE(part.proved().proved);
  const std::size_t pieces = part.runs().works.size();
  ASSERT_GE(pieces, 3U);
  std::size_t most = 0;
  for (std::size_t i = 0; i < pieces; ++i) {
    ASSERT_NE(part.work(i).chosen(), nullptr);
    most = std::max(most, part.work(i).selection.order.size());
    part.spoil(part.work(i).selection.order.size(), i);
  }
  EXPECT_TRUE(part.proved().proved);
  EXPECT_LE(part.rounds(), most + 1);
}

// Their moves would take room for nothing: where the proof refuses two, the others are made anew.
TEST(PartProof, HasTwoCandidatesOfAPieceAtHand) {
  SmoothedPart part(wave_program({.lines = 1500, .height = 0.5, .length = 6}));
  part.spoil(part.work().selection.order.size());
  ASSERT_TRUE(part.proved().proved);
  ASSERT_GE(part.runs().works.size(), 3U);
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < part.runs().works.size(); ++i) {
    const RunState& piece = part.work(i);
    EXPECT_LE(piece.selection.order.size(), 2U);
    EXPECT_EQ(piece.context.lead.capacity() + piece.context.tail.capacity(), 0U);
    for (std::size_t k = 0; k < piece.smoothed.candidates.size(); ++k) {
      const Candidate& candidate = piece.smoothed.candidates[k];
      const bool is_kept = std::ranges::count(piece.selection.order, k) > 0;
      EXPECT_EQ(candidate.text.text.empty(), !is_kept);
      EXPECT_TRUE(is_kept || candidate.text.text.capacity() == std::string().capacity());
      EXPECT_EQ(!candidate.moves.empty(), is_kept);
    }
    if (piece.selection.order.size() == 2 && piece.smoothed.left_out) ++left_out;
  }
  ASSERT_GE(left_out, 1U);
  for (std::size_t i = 0; i < part.runs().works.size(); ++i) {
    part.spoil(part.work(i).selection.order.size(), i);
  }
  const ProvedText done = part.proved();
  EXPECT_TRUE(done.proved);
  EXPECT_FALSE(done.unchanged);
  EXPECT_EQ(done.text.find(kElsewhere), std::string::npos);
}

// What was refused once is not tried again.
TEST(PartProof, DoesNotTryTheSameTwice) {
  SmoothedPart part(kTwoForms);
  part.make_all();
  const RunState& work = part.work();
  const std::size_t all = work.selection.order.size();
  ASSERT_GE(all, 3U);
  const std::string best = work.smoothed.candidates[work.selection.order.at(0)].text.text;
  part.work().reject(gcode::reason::kNotProved);
  part.make_all();
  EXPECT_EQ(work.selection.order.size(), all - 1);
  for (const std::size_t i : work.selection.order) {
    EXPECT_NE(work.smoothed.candidates[i].text.text, best);
  }
}

TEST(PartProof, KeepsTheBlocksWhereEveryCandidateIsWrong) {
  SmoothedPart part(kTwoForms);
  part.make_all();
  ASSERT_FALSE(part.work().smoothed.left_out);
  part.spoil(part.work().selection.order.size());
  const ProvedText done = part.proved();
  EXPECT_TRUE(done.proved);
  EXPECT_TRUE(done.unchanged);
  EXPECT_EQ(part.work().chosen(), nullptr);
  EXPECT_EQ(part.work().reject_reason, gcode::reason::kNotProved);
}

}  // namespace
}  // namespace batten::postproc
