// The promises that the fuzzers ask for (tests/fuzz), on programs of samples/ and tests/cases/ that
// were changed by blocks and words: repeated, swapped, dropped, spliced, with other digits and
// words. Seeded.
//
// BATTEN_MUTATIONS=10000 postproc_tests --gtest_filter='MutatedPrograms.*' tries more of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/fuzz/curves_promises.h"
#include "tests/fuzz/interpret_promises.h"
#include "tests/fuzz/parse_promises.h"
#include "tests/fuzz/program_mutation.h"
#include "tests/fuzz/smooth_promises.h"
#include "tests/support/curve_programs.h"
#include "tests/support/places.h"

namespace batten::postproc {
namespace {

namespace fs = std::filesystem;

// Programs that are tried of each kind when nobody asks for more.
constexpr int kPrograms = 150;

// Bytes of a program: a run of some dozen blocks is as good as a longer one.
constexpr std::size_t kMostBytes = 3000;

int programs_to_try() {
  const char* given = std::getenv("BATTEN_MUTATIONS");
  return given == nullptr ? kPrograms : std::atoi(given);
}

// Some lines out of each program, in the order of their names.
std::vector<std::string> seeds() {
  std::vector<fs::path> files;
  for (const char* folder : {"/samples", "/tests/cases"}) {
    for (const auto& entry :
         fs::recursive_directory_iterator(BATTEN_SOURCE_DIR + std::string(folder))) {
      const std::string kind = entry.path().extension().string();
      if (kind == ".nc" || kind == ".ngc" || kind == ".mpf" || kind == ".h") {
        files.push_back(entry.path());
      }
    }
  }
  std::sort(files.begin(), files.end());
  std::vector<std::string> texts;
  for (const fs::path& file : files) {
    std::ifstream stream(file, std::ios::binary);
    std::string text(std::istreambuf_iterator<char>(stream), {});
    if (text.size() > kMostBytes) text.resize(text.rfind('\n', kMostBytes) + 1);
    texts.push_back(std::move(text));
  }
  return texts;
}

// Program `number` of the endless row.
std::string mutated_program(const std::vector<std::string>& texts, int number) {
  const auto seed = static_cast<std::uint32_t>(number);
  std::mt19937 random(seed);
  std::string text = texts[random() % texts.size()];
  fuzz::ProgramMutator mutator(seed);
  const auto times = 1 + random() % 4;
  for (unsigned i = 0; i < times; ++i) {
    const std::string& other = texts[random() % texts.size()];
    text = random() % 6 == 0 ? mutator.crossed(text, other) : mutator.mutated(text, other);
  }
  text.resize(std::min(text.size(), kMostBytes));
  return text;
}

TEST(MutatedPrograms, AreReadAsTheReadersPromise) {
  const auto texts = seeds();
  ASSERT_GE(texts.size(), 50u);
  for (int number = 0; number < programs_to_try(); ++number) {
    const std::string text = mutated_program(texts, number);
    SCOPED_TRACE(testing::Message() << "program " << number << "\n" << text);
    for (const gcode::Language language : gcode::promises::kLanguages) {
      SCOPED_TRACE(gcode::describe(language));
      ASSERT_EQ(gcode::promises::broken_by(text, language), "");
      ASSERT_EQ(promises::broken_meaning(text, language), "");
      ASSERT_EQ(gcode::promises::broken_curves(text, language), "");
    }
  }
}

TEST(MutatedPrograms, AreSmoothedProvedAndOtherwiseCopied) {
  const auto texts = seeds();
  int rewritten = 0;
  for (int number = 0; number < programs_to_try(); ++number) {
    const std::string text = mutated_program(texts, number);
    const SmoothOptions options = promises::options_for_text(text);
    SCOPED_TRACE(testing::Message()
                 << "program " << number << " for " << options.target->name << "\n"
                 << text);
    ASSERT_EQ(promises::broken_by(text, options), "");
    const SmoothResult result = smooth_program(gcode::SourceText("test.nc", text), options);
    rewritten += result.text == text ? 0 : 1;
  }
  EXPECT_GT(rewritten, programs_to_try() / 20);
}

// Chains of curves for the controls that read them, among lines: whole ones, and ones that lost a
// block, a word or a digit.
TEST(MutatedPrograms, OfCurvesAreSmoothedProvedAndOtherwiseCopied) {
  using tests::CurveWord;
  constexpr std::pair<CurveWord, const char*> kWords[] = {
      {CurveWord::kG5, "linuxcnc"},  {CurveWord::kG51, "linuxcnc"},
      {CurveWord::kG52, "linuxcnc"}, {CurveWord::kG062, "fanuc"},
      {CurveWord::kG5, "marlin"},    {CurveWord::kPoly, "siemens"},
      {CurveWord::kSpl, "itnc530"},  {CurveWord::kBspline, "siemens-bspline"}};
  int rewritten = 0;
  for (int number = 0; number < programs_to_try(); ++number) {
    const auto seed = static_cast<unsigned>(number);
    const auto& [word, target] = kWords[seed % std::size(kWords)];
    const tests::CurvePath path{.pieces = 14, .quadratic = word == CurveWord::kG51, .seed = seed};
    const auto pieces = tests::curve_pieces(path);
    std::string curves;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const bool line = i % 5 == 4 && word != CurveWord::kSpl;
      const geometry::Point3& end = pieces[i].control[3];
      const bool begins = i == 0 || i % 5 == 0;
      curves += line ? fmt::format("G1 X{:.3f} Y{:.3f}\n", end.x(), end.y())
                     : tests::words_of(pieces[i], word, begins);
    }
    std::string text =
        tests::curve_head(word, pieces.front().control[0]) + curves + tests::curve_tail(word);
    fuzz::ProgramMutator mutator(seed);
    for (unsigned i = 0; i < seed / std::size(kWords) % 4; ++i) text = mutator.mutated(text, text);
    SmoothOptions options = promises::options_for_text(text);
    options.target = gcode::find_control(target);
    options.machine = find_machine(options.target->machine);
    options.source = gcode::SourceKind::kAuto;
    options.convert = false;
    SCOPED_TRACE(testing::Message() << "program " << number << " for " << target << "\n" << text);
    ASSERT_EQ(promises::broken_by(text, options), "");
    const SmoothResult result = smooth_program(gcode::SourceText("test.nc", text), options);
    rewritten += result.text == text ? 0 : 1;
  }
  EXPECT_GT(rewritten, programs_to_try() / 10);
}

}  // namespace
}  // namespace batten::postproc
