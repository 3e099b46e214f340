// A shop's folder of programs: the same bytes however the work is cut up, killed and begun again.

#include <gtest/gtest.h>
#include <sys/file.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "batten_process.h"

namespace batten {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Files = std::map<std::string, std::string>;  // path in the tree, bytes

constexpr const char* kOptions = " --target linuxcnc --tolerance 0.05 ";

// All but the locks, which are empty and tell who ran.
Files files_below(const fs::path& root) {
  Files files;
  if (!fs::exists(root)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = entry.path().lexically_relative(root).string();
    if (!name.starts_with("batten-batch/lock")) files[name] = text_of_file(entry.path());
  }
  return files;
}

Files without_summaries(Files files) {
  std::erase_if(files, [](const auto& file) {
    return file.first.starts_with("batten-batch/summary") ||
           file.first.starts_with("batten-batch/index");
  });
  return files;
}

std::vector<std::string> names_of(const Files& files) {
  std::vector<std::string> names;
  for (const auto& [name, bytes] : files) names.push_back(name);
  return names;
}

void expect_same(const Files& found, const Files& expected) {
  EXPECT_EQ(names_of(found), names_of(expected));
  for (const auto& [name, bytes] : expected) {
    const auto same = found.find(name);
    EXPECT_TRUE(same == found.end() || same->second == bytes) << name;
  }
}

class Batch : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* folder : {"in", "in/mill", "in/mill/old"}) fs::create_directory(file(folder));
    int number = 0;
    for (const char* name : {"noisy_line_arc", "inch_ellipse", "tool_changes", "kept_by_rule"}) {
      const std::string program =
          text_of_file(fs::path(BATTEN_SOURCE_DIR) / "samples" / name / "program.ngc");
      // A comment of its own makes each copy another file.
      for (const char* folder : {"in/", "in/mill/", "in/mill/old/"}) {
        put(folder + std::string(name) + ".ngc",
            program + "(copy " + std::to_string(++number) + ")\n");
      }
    }
    put("in/setup.txt", "no program\n");
  }

  [[nodiscard]] fs::path file(const std::string& name) const { return folder_.file(name); }
  void put(const std::string& name, const std::string& text) const { folder_.put(name, text); }

  [[nodiscard]] ProcessResult batch(const std::string& out, const std::string& more = "") const {
    return folder_.batten("batch in " + out + kOptions + more);
  }

  [[nodiscard]] Json record_of(const std::string& out, const std::string& program) const {
    return Json::parse(text_of_file(file(out) / "batten-batch/manifest" / (program + ".json")));
  }

  BattenFolder folder_;
};

// --- the result ----------------------------------------------------------------------------------

TEST_F(Batch, WritesWhatSmoothWritesWithReportsAndTables) {
  const ProcessResult result = expect_exit(batch("out"), 0);
  EXPECT_TRUE(contains(result.out, "12 programs: ")) << result.out;
  EXPECT_TRUE(contains(result.err, "other files left alone: 1")) << result.err;
  EXPECT_FALSE(contains(result.err, "[#")) << "no progress line where no terminal is";

  ASSERT_EQ(folder_
                .batten(std::string("smooth in/mill/inch_ellipse.ngc -o one.ngc --json one.json") +
                        kOptions)
                .exit_code,
            0);
  EXPECT_EQ(folder_.text_of("out/mill/inch_ellipse.ngc"), folder_.text_of("one.ngc"));
  Json report = Json::parse(folder_.text_of("out/batten-batch/reports/mill/inch_ellipse.ngc.json"));
  Json alone = Json::parse(folder_.text_of("one.json"));
  EXPECT_EQ(report["input"]["file"], "mill/inch_ellipse.ngc");
  EXPECT_EQ(report["output"]["file"], "mill/inch_ellipse.ngc");
  for (Json* each : {&report, &alone}) {
    (*each)["input"].erase("file");
    (*each)["output"].erase("file");
  }
  EXPECT_EQ(report, alone);

  const Json summary = Json::parse(folder_.text_of("out/batten-batch/summary.json"));
  EXPECT_EQ(summary["totals"]["programs"], 12);
  EXPECT_GE(summary["totals"]["smoothed"], 9);
  EXPECT_EQ(summary["programs"][0]["program"], "inch_ellipse.ngc");
  EXPECT_EQ(folder_.text_of("out/batten-batch/summary.txt"), result.out);
  EXPECT_EQ(std::ranges::count(folder_.text_of("out/batten-batch/summary.csv"), '\n'), 13);
}

TEST_F(Batch, IsTheSameForAnyNumberOfJobsAndDoesNothingTwice) {
  ASSERT_EQ(batch("one", "--jobs 1").exit_code, 0);
  ASSERT_EQ(batch("three", "--jobs 3").exit_code, 0);
  const Files expected = files_below(file("one"));
  expect_same(files_below(file("three")), expected);

  const auto written = fs::last_write_time(file("one/inch_ellipse.ngc"));
  expect_exit(batch("one", "--jobs 2"), 0, {"done already: 12 of 12 programs"});
  expect_same(files_below(file("one")), expected);
  EXPECT_EQ(fs::last_write_time(file("one/inch_ellipse.ngc")), written);
}

TEST_F(Batch, DoesAgainWhatChanged) {
  ASSERT_EQ(batch("out").exit_code, 0);
  std::string program = folder_.text_of("in/noisy_line_arc.ngc");
  put("in/noisy_line_arc.ngc", program + "(one comment more)\n");
  fs::remove(file("out/mill/tool_changes.ngc"));
  put("out/batten-batch/reports/mill/inch_ellipse.ngc.json", "{}");
  expect_exit(batch("out"), 0, {"done already: 9 of 12 programs"});
  ASSERT_EQ(batch("fresh").exit_code, 0);
  expect_same(files_below(file("out")), files_below(file("fresh")));

  const ProcessResult other = expect_exit(batch("out", "--prefer size"), 0);
  EXPECT_FALSE(contains(other.err, "done already")) << other.err;
}

// A machine file holds only what differs from the file that it is based on.
TEST_F(Batch, DoesAgainWhatAMachineFileBehindItsOwnChanged) {
  fs::remove_all(file("in/mill"));
  const std::string with_machine = "--machine mine.toml";
  put("mine.toml", "based-on = \"shop.toml\"\n");
  put("shop.toml", "based-on = \"linuxcnc\"\nmax-acceleration = 500\n");
  ASSERT_EQ(batch("out", with_machine).exit_code, 0);
  const ProcessResult same = batch("out", with_machine);
  EXPECT_TRUE(contains(same.err, "done already: 4 of 4 programs")) << same.err;

  const double slow = record_of("out", "inch_ellipse.ngc")["time_before_s"];
  put("shop.toml", "based-on = \"linuxcnc\"\nmax-acceleration = 5000\n");
  const ProcessResult again = expect_exit(batch("out", with_machine), 0);
  EXPECT_FALSE(contains(again.err, "done already")) << again.err;
  EXPECT_LT(record_of("out", "inch_ellipse.ngc")["time_before_s"], slow);
  ASSERT_EQ(batch("fresh", with_machine).exit_code, 0);
  expect_same(files_below(file("out")), files_below(file("fresh")));
}

// --- killed and begun again ----------------------------------------------------------------------

// Kills it as soon as `files` files are in the new tree and some milliseconds went by, which is
// while it works: false when it ended before.
bool kill_at(const BattenFolder& folder, std::size_t files, std::chrono::milliseconds later) {
  const Started started(
      folder, {"batch", "in", "out", "--target", "linuxcnc", "--tolerance", "0.05", "--jobs", "2"});
  const auto there = [&] { return without_summaries(files_below(folder.file("out"))).size(); };
  while (there() < files && started.is_running()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  std::this_thread::sleep_for(later);
  started.send(SIGKILL);
  const int status = started.wait();
  return WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
}

TEST_F(Batch, KilledFiveTimesEndsWithTheBytesOfAnUndisturbedRun) {
  ASSERT_EQ(batch("expected").exit_code, 0);
  const Files expected = files_below(file("expected"));
  std::mt19937 random(5);
  // ms: a program of this tree takes some tens, on a slow machine. Where one ended before it was
  // killed the next gets less, from an empty tree on.
  std::uniform_real_distribution<double> part(0, 1);
  double longest = 40;
  std::size_t files = 0;
  int killed = 0;
  for (int round = 0; killed < 5 && round < 100; ++round) {
    const auto later = std::chrono::milliseconds(static_cast<int>(part(random) * longest));
    const bool in_time = kill_at(folder_, files, later);
    // What has its name has all its bytes, whenever the process died.
    for (const auto& [name, bytes] : files_below(file("out"))) {
      if (name.ends_with(".batten-part")) continue;
      ASSERT_TRUE(expected.contains(name)) << name;
      EXPECT_TRUE(bytes == expected.at(name)) << name << " in round " << round;
    }
    if (in_time) {
      ++killed;
      files = without_summaries(files_below(file("out"))).size() + 2;
    } else {
      fs::remove_all(file("out"));
      longest *= 0.8;
      files = 2;
    }
  }
  EXPECT_EQ(killed, 5);
  expect_exit(batch("out"), 0, {"done already"});
  expect_same(files_below(file("out")), expected);
}

TEST_F(Batch, RemovesWhatAKilledRunLeftHalfWrittenAndNothingElse) {
  fs::create_directories(file("out/mill"));
  put("out/mill/.inch_ellipse.ngc.12345.batten-part", "half");
  put("out/mill/.mine.ngc.12345.batten-part", "of a program that is not in the tree");
  EXPECT_TRUE(contains(batch("out").err, "half-written files of an earlier run removed: 1"));
  EXPECT_FALSE(fs::exists(file("out/mill/.inch_ellipse.ngc.12345.batten-part")));
  EXPECT_TRUE(fs::exists(file("out/mill/.mine.ngc.12345.batten-part")));
}

TEST_F(Batch, GoesOnAfterAnInterrupt) {
  expect_exit(folder_.shell("( '" BATTEN_BINARY
                            "' batch in out --target linuxcnc --tolerance 0.05 --jobs 1 & work=$!\n"
                            "while [ ! -e out/batten-batch/manifest ]; do sleep 0.01; done\n"
                            "kill -TERM $work; wait $work )"),
              143, {"goes on where it stopped"});
  EXPECT_FALSE(fs::exists(file("out/batten-batch/summary.txt")));
  EXPECT_EQ(batch("out").exit_code, 0);
  EXPECT_TRUE(fs::exists(file("out/batten-batch/summary.txt")));
}

// --- several machines ----------------------------------------------------------------------------

TEST_F(Batch, ShardsTogetherAreOneRun) {
  ASSERT_EQ(batch("expected").exit_code, 0);
  const Files expected = files_below(file("expected"));
  expect_exit(
      folder_.shell(
          "for i in 1 2 3; do batten batch in out --target linuxcnc --tolerance 0.05 --jobs 1 "
          "--shard $i/3 & done; wait"),
      0);
  expect_same(without_summaries(files_below(file("out"))), without_summaries(expected));
  for (const char* name :
       {"summary-1-of-3.txt", "summary-2-of-3.csv", "summary-3-of-3.json", "index-1-of-3.html"}) {
    EXPECT_TRUE(fs::exists(file("out/batten-batch") / name)) << name;
  }
  // The closing run finds everything done and writes the summary of the whole tree.
  const ProcessResult closing = batch("out");
  EXPECT_TRUE(contains(closing.err, "done already: 12 of 12 programs")) << closing.err;
  EXPECT_EQ(folder_.text_of("out/batten-batch/summary.json"),
            expected.at("batten-batch/summary.json"));
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at)) {
    text.replace(at, what.size(), by);
  }
  return text;
}

// The block of docs/batch.md with this word, for the trees of the test.
std::string from_the_page(const std::string& word) {
  const std::string page = text_of_file(fs::path(BATTEN_SOURCE_DIR) / "docs/batch.md");
  const std::string fence = "```\n";
  std::size_t begin = page.find(fence);
  while (begin != std::string::npos) {
    begin += fence.size();
    const std::size_t end = page.find(fence, begin);
    const std::string block = page.substr(begin, end - begin);
    if (contains(block, word)) {
      return replaced(replaced(block, "/shop/programs", "in"), "/shop/smooth", "out");
    }
    begin = page.find(fence, end + fence.size());
  }
  throw std::runtime_error("docs/batch.md has no block with " + word);
}

class BatchOnSeveralMachines : public Batch {
 protected:
  void SetUp() override {
    Batch::SetUp();
    fs::create_directory(file("bin"));
    fs::create_symlink(BATTEN_BINARY, file("bin/batten"));
    ASSERT_EQ(run("batten batch in expected --target linuxcnc --tolerance 0.01").exit_code, 0);
  }

  // With `batten` in PATH, for programs that start it.
  [[nodiscard]] ProcessResult run(const std::string& commands) const {
    return folder_.shell("unset -f batten; export HOME=\"$PWD\" PATH=\"$PWD/bin:$PATH\"\n" +
                         commands);
  }
};

TEST_F(BatchOnSeveralMachines, IsOneRunUnderGnuParallelAsThePageSays) {
  if (run("parallel --version | grep -q GNU").exit_code != 0) GTEST_SKIP() << "no GNU parallel";
  const std::string four_machines = "--sshlogin a,b,c,d --jobs 1";
  const std::string page = from_the_page("parallel");
  ASSERT_TRUE(contains(page, four_machines)) << page;
  const std::string commands = replaced(page, four_machines, "--jobs 4");
  expect_exit(run(commands), 0, {"done already: 12 of 12 programs"});
  const Files expected = files_below(file("expected"));
  expect_same(without_summaries(files_below(file("out"))), without_summaries(expected));
  EXPECT_EQ(folder_.text_of("out/batten-batch/summary.json"),
            expected.at("batten-batch/summary.json"));
}

TEST_F(BatchOnSeveralMachines, IsOneRunAsTheSlurmArrayOfThePage) {
  put("shards.sh", from_the_page("SLURM_ARRAY_TASK_ID"));
  const ProcessResult tasks =
      run("for i in 1 2 3 4 5 6 7 8; do SLURM_ARRAY_TASK_ID=$i bash shards.sh & done; wait");
  EXPECT_TRUE(fs::exists(file("out/batten-batch/summary-8-of-8.json"))) << tasks.err;
  expect_same(without_summaries(files_below(file("out"))),
              without_summaries(files_below(file("expected"))));
}

TEST_F(Batch, DoesNotRunTwiceAtATimeOnTheSamePrograms) {
  fs::create_directories(file("out/batten-batch"));
  put("out/batten-batch/lock", "");
  const int lock = ::open(file("out/batten-batch/lock").c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(::flock(lock, LOCK_EX), 0);
  expect_exit(batch("out"), 4, {"another run"});
  ASSERT_EQ(::flock(lock, LOCK_SH), 0);  // as another shard does
  EXPECT_EQ(batch("out", "--shard 1/12").exit_code, 0);
  ::close(lock);
}

// --- what goes wrong -----------------------------------------------------------------------------

TEST_F(Batch, CarriesOnAndEndsWithTheWorstExitCode) {
  put("in/a_klartext.ngc", "BEGIN PGM 1 MM\nL X+1 Y+2\nEND PGM 1 MM\n");
  put("in/without_units.ngc", "G0 X1\nG1 X2 F100\nM2\n");
  const ProcessResult result = expect_exit(batch("out"), 2);
  EXPECT_TRUE(contains(result.out, "not understood  a_klartext.ngc:1:1: error: foreign-language"))
      << result.out;
  EXPECT_TRUE(contains(result.err, "1 program without G20 or G21 (without_units.ngc)"))
      << result.err;
  EXPECT_TRUE(contains(result.out, "without_units.ngc:1:")) << result.out;
  EXPECT_TRUE(contains(result.out, "2 not understood\n")) << result.out;
  EXPECT_FALSE(fs::exists(file("out/a_klartext.ngc")));
  EXPECT_TRUE(fs::exists(file("out/batten-batch/reports/a_klartext.ngc.json")));
  EXPECT_TRUE(fs::exists(file("out/tool_changes.ngc")));
  EXPECT_EQ(batch("out").exit_code, 2) << "what was refused stays refused";
}

TEST_F(Batch, StopsAtTheFirstFailureWhenAsked) {
  // The largest program comes first.
  put("in/large.ngc", "BEGIN PGM 1 MM\n" + std::string(200'000, ' ') + "\nEND PGM 1 MM\n");
  const ProcessResult result = expect_exit(batch("out", "--fail-fast --jobs 1"), 2);
  EXPECT_TRUE(contains(result.out, "12 not done\n")) << result.out;
  EXPECT_FALSE(fs::exists(file("out/tool_changes.ngc")));
}

TEST_F(Batch, LeavesAProgramThatItDidNotWrite) {
  fs::create_directories(file("out"));
  put("out/tool_changes.ngc", "mine\n");
  expect_exit(batch("out"), 4, {"--force replaces it"});
  EXPECT_EQ(folder_.text_of("out/tool_changes.ngc"), "mine\n");
  EXPECT_EQ(batch("out", "--force").exit_code, 0);
  EXPECT_NE(folder_.text_of("out/tool_changes.ngc"), "mine\n");
}

TEST_F(Batch, RemovesTheOldResultOfAProgramThatIsNoLongerUnderstood) {
  ASSERT_EQ(batch("out").exit_code, 0);
  ASSERT_TRUE(fs::exists(file("out/tool_changes.ngc")));
  put("in/tool_changes.ngc", "BEGIN PGM 1 MM\n");
  EXPECT_EQ(batch("out").exit_code, 2);
  EXPECT_FALSE(fs::exists(file("out/tool_changes.ngc")));
  EXPECT_EQ(record_of("out", "tool_changes.ngc")["output_sha256"], "");
}

TEST_F(Batch, NeverWritesIntoItsInput) {
  const Files before = files_below(file("in"));
  fs::create_directory_symlink("in", file("alias"));
  fs::create_directory(file("out"));
  fs::create_directory_symlink("../in/mill", file("out/mill"));
  for (const char* out : {"in", "in/new", "alias", "alias/mill/new", "."}) {
    const ProcessResult refused = batch(out);
    EXPECT_EQ(refused.exit_code, 1) << out;
    EXPECT_TRUE(contains(refused.err, "nothing was done")) << refused.err;
  }
  expect_exit(batch("out", "--force"), 4, {"leads into the input tree"});
  EXPECT_TRUE(fs::exists(file("out/tool_changes.ngc")));
  expect_same(files_below(file("in")), before);
}

TEST_F(Batch, TellsEveryWrongOptionBeforeItStarts) {
  const ProcessResult result = expect_exit(
      folder_.batten(
          "batch in --target linuxcn --jobs=-3 --shard 4/3 --tolerence=1 --progress linuxcnc"),
      1);
  for (const char* part : {"OUT_TREE: no folder given", "did you mean 'linuxcnc'?", "--jobs: '-3'",
                           "--shard: '4/3'", "did you mean --tolerance?", "--progress: "}) {
    EXPECT_TRUE(contains(result.err, part)) << part << "\n" << result.err;
  }
  EXPECT_EQ(batch("out", "--shard 2").exit_code, 1);
  EXPECT_FALSE(fs::exists(file("out")));
}

TEST_F(Batch, TakesItsOptionsFromAFileAsSmoothDoes) {
  put("options.toml", "target = \"linuxcnc\"\ntolerance = 0.05\nthreads = 3\n");
  expect_exit(folder_.batten("batch in out --config options.toml"), 0);
  ASSERT_EQ(batch("given").exit_code, 0);
  EXPECT_EQ(folder_.text_of("out/inch_ellipse.ngc"), folder_.text_of("given/inch_ellipse.ngc"));
}

}  // namespace
}  // namespace batten
