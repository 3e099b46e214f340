// Which programs a batch reads, and where it may write.

#include "postproc/batch/program_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/support/scratch_folder.h"

namespace batten::postproc {
namespace {

namespace fs = std::filesystem;

class ProgramTrees : public testing::Test {
 protected:
  ProgramTrees() { fs::create_directories(root_ / "in/sub"); }

  void put(const std::string& name, const std::string& text = "G21\n") const {
    scratch_.put(name, text);
  }

  [[nodiscard]] std::vector<std::string> names(const std::vector<std::string>& suffixes) const {
    std::vector<std::string> found;
    for (const TreeProgram& program : list_programs(root_ / "in", suffixes).programs) {
      found.push_back(program.name);
    }
    return found;
  }

  [[nodiscard]] bool is_refused(const std::string& in, const std::string& out) const {
    return !problems_of_trees(root_ / in, root_ / out).empty();
  }

  ScratchFolder scratch_;
  const fs::path root_ = scratch_.path();
};

using Names = std::vector<std::string>;

TEST_F(ProgramTrees, AreListedByNameWhateverTheOrderOnTheDisk) {
  for (const char* name : {"in/z.nc", "in/sub/b.NC", "in/sub/deeper/a.nc", "in/a.nc", "in/O1234",
                           "in/notes.txt", "in/.hidden.nc", "in/.git/c.nc"}) {
    put(name);
  }
  EXPECT_EQ(names({"nc"}), (Names{"a.nc", "sub/b.NC", "sub/deeper/a.nc", "z.nc"}));
  EXPECT_EQ(names({"none"}), Names{"O1234"});
  EXPECT_EQ(names({"txt", "none"}), (Names{"O1234", "notes.txt"}));
  EXPECT_EQ(names({"all"}).size(), 6u);
  EXPECT_EQ(list_programs(root_ / "in", std::vector<std::string>{"nc"}).other_files, 2u);
}

TEST_F(ProgramTrees, LeaveTheReportsOfABatchOut) {
  put("in/batten-batch/summary.nc");
  put("in/sub/batten-batch/part.nc");
  EXPECT_EQ(names({"nc"}), Names{"sub/batten-batch/part.nc"});
}

TEST_F(ProgramTrees, FollowLinksToFilesOnly) {
  put("elsewhere/part.nc");
  fs::create_symlink("../../elsewhere/part.nc", root_ / "in/sub/linked.nc");
  fs::create_directory_symlink("..", root_ / "in/sub/round");
  EXPECT_EQ(names({"nc"}), Names{"sub/linked.nc"});
  EXPECT_EQ(list_programs(root_ / "in", std::vector<std::string>{"nc"}).folder_links, 1u);
}

TEST_F(ProgramTrees, MayNotLieInEachOther) {
  EXPECT_FALSE(is_refused("in", "out"));
  EXPECT_FALSE(is_refused("in", "new/deep/out"));
  EXPECT_TRUE(is_refused("in", "in"));
  EXPECT_TRUE(is_refused("in", "in/sub"));
  EXPECT_TRUE(is_refused("in", "in/new/deeper"));
  EXPECT_TRUE(is_refused("in/sub", "in"));
  EXPECT_TRUE(is_refused("in", "in/sub/../../in/new"));
  EXPECT_TRUE(is_refused("missing", "out"));
}

TEST_F(ProgramTrees, MayNotLeadIntoEachOtherByLinks) {
  fs::create_directory_symlink("in", root_ / "alias");
  fs::create_directory_symlink("in/sub", root_ / "deep_alias");
  fs::create_directory_symlink("in/not-there-yet", root_ / "dangling");
  fs::create_directory_symlink("round", root_ / "round");
  fs::create_directories(root_ / "out");
  EXPECT_TRUE(is_refused("in", "alias"));
  EXPECT_TRUE(is_refused("alias", "in"));
  EXPECT_TRUE(is_refused("in", "alias/new"));
  EXPECT_TRUE(is_refused("in", "deep_alias"));
  EXPECT_TRUE(is_refused("in", "dangling"));
  EXPECT_FALSE(is_refused("in", "out"));
  EXPECT_FALSE(leads_into(root_ / "round/part.nc", root_ / "in"));  // ends, whatever it says
  fs::create_directory_symlink("../in/sub", root_ / "out/batten-batch");
  EXPECT_TRUE(is_refused("in", "out"));
  EXPECT_TRUE(leads_into(root_ / "out/batten-batch/x/y.nc", root_ / "in"));
}

TEST_F(ProgramTrees, ALinkToAProgramLeadsIntoItsTree) {
  put("in/part.nc");
  fs::create_directories(root_ / "out");
  fs::create_symlink("../in/part.nc", root_ / "out/part.nc");
  EXPECT_TRUE(leads_into(root_ / "out/part.nc", root_ / "in"));
  EXPECT_FALSE(leads_into(root_ / "out/other.nc", root_ / "in"));
}

TEST(Shards, HaveEveryProgramOnce) {
  std::vector<TreeProgram> programs;
  for (int i = 0; i < 23; ++i) programs.push_back({std::to_string(i), 1});
  for (int count = 1; count <= 30; ++count) {
    std::multiset<std::string> seen;
    std::size_t least = programs.size();
    std::size_t most = 0;
    for (int index = 1; index <= count; ++index) {
      const auto part = programs_of({index, count}, programs);
      for (const TreeProgram& program : part) seen.insert(program.name);
      least = std::min(least, part.size());
      most = std::max(most, part.size());
    }
    EXPECT_EQ(seen.size(), programs.size()) << count;
    EXPECT_EQ(std::set<std::string>(seen.begin(), seen.end()).size(), programs.size()) << count;
    EXPECT_LE(most - least, 1u) << count;
  }
}

}  // namespace
}  // namespace batten::postproc
