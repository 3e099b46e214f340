#include "postproc/system/output_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "tests/support/scratch_folder.h"

namespace batten::postproc {
namespace {

namespace fs = std::filesystem;

class OutputFile : public testing::Test {
 protected:
  [[nodiscard]] fs::path file(const std::string& name) const { return folder_ / name; }

  void put(const std::string& name, const std::string& text) const { scratch_.put(name, text); }

  [[nodiscard]] std::string text_of(const std::string& name) const {
    std::ifstream stream(file(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  [[nodiscard]] std::size_t files_in_folder() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

TEST(DefaultOutputPath, PutsSmoothBeforeTheSuffix) {
  EXPECT_EQ(default_output_path("part.nc"), "part.smooth.nc");
  EXPECT_EQ(default_output_path("a.b/part"), "a.b/part.smooth");
  EXPECT_EQ(default_output_path("a/part.v2.ngc"), "a/part.v2.smooth.ngc");
  EXPECT_EQ(default_output_path(".nc"), ".nc.smooth");
}

TEST_F(OutputFile, IsWrittenWholeAndAloneFromTheLastRestartOn) {
  WriteRequest in_parts;
  in_parts.parts = [](const PartWriter& write) {
    EXPECT_TRUE(write("a text that is worth nothing\n"));
    EXPECT_TRUE(write("and more of it\n"));
    EXPECT_TRUE(write.restart());
    EXPECT_TRUE(write("G1 X1\n"));
  };
  std::size_t files = 0;
  for (WriteRequest request : {WriteRequest{.target = {}, .bytes = "G1 X1\n"}, in_parts}) {
    const std::string name = std::to_string(++files) + ".nc";
    request.target = file(name);
    const WriteResult result = write_file(request);
    EXPECT_EQ(result.status, WriteStatus::kWritten) << result.message;
    EXPECT_EQ(text_of(name), "G1 X1\n");
    EXPECT_EQ(files_in_folder(), files);
  }
}

// What went into a pipe was seen.
TEST_F(OutputFile, DoesNotBeginAPipeAnew) {
  int ends[2] = {};
  ASSERT_EQ(::pipe(ends), 0);
  WriteRequest request;
  request.parts = [](const PartWriter& write) {
    EXPECT_TRUE(write("seen"));
    EXPECT_FALSE(write.restart());
  };
  EXPECT_EQ(write_request_to_descriptor(ends[1], "pipe", request).status, WriteStatus::kWritten);
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST(SpoolFile, HoldsWhatCameBehindTheLastRestart) {
  std::string error;
  auto spool = SpoolFile::make(error);
  ASSERT_TRUE(spool) << error;
  EXPECT_TRUE(spool->append("a text that is worth nothing"));
  EXPECT_TRUE(spool->restart());
  EXPECT_TRUE(spool->append("G1 X1\n"));
  std::string text;
  spool->write_to({[&](std::string_view part) {
                     text += part;
                     return true;
                   },
                   [] { return false; }});
  EXPECT_EQ(text, "G1 X1\n");
}

TEST_F(OutputFile, DoesNotReplaceAnExistingFileUnasked) {
  put("old.nc", "old");
  const WriteResult result = write_file({.target = file("old.nc"), .bytes = "new"});
  EXPECT_EQ(result.status, WriteStatus::kExists);
  EXPECT_NE(result.message.find("old.nc"), std::string::npos);
  EXPECT_EQ(text_of("old.nc"), "old");
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(OutputFile, KeepsThePermissionsOfTheFileItReplaces) {
  put("old.nc", "old");
  fs::permissions(file("old.nc"), fs::perms{0640});
  ASSERT_EQ(write_file({.target = file("old.nc"), .bytes = "new", .replace_existing = true}).status,
            WriteStatus::kWritten);
  EXPECT_EQ(text_of("old.nc"), "new");
  EXPECT_EQ(fs::status(file("old.nc")).permissions(), fs::perms{0640});
}

TEST_F(OutputFile, FollowsLinksAndKeepsThemAlsoToNothing) {
  fs::create_directory(file("real"));
  put("real/part.nc", "old");
  fs::create_symlink("real/part.nc", file("one.nc"));
  fs::create_symlink("one.nc", file("two.nc"));
  ASSERT_EQ(write_file({.target = file("two.nc"), .bytes = "new", .replace_existing = true}).status,
            WriteStatus::kWritten);
  EXPECT_TRUE(fs::is_symlink(file("two.nc")));
  EXPECT_TRUE(fs::is_symlink(file("one.nc")));
  EXPECT_EQ(text_of("real/part.nc"), "new");
  fs::create_symlink("later.nc", file("link.nc"));
  ASSERT_EQ(write_file({.target = file("link.nc"), .bytes = "new"}).status, WriteStatus::kWritten);
  EXPECT_TRUE(fs::is_symlink(file("link.nc")));
  EXPECT_EQ(text_of("later.nc"), "new");
}

TEST_F(OutputFile, LeavesNothingBehindWhenItIsStopped) {
  put("old.nc", "old");
  const std::string big(5 << 20, 'x');
  int asked = 0;
  const WriteResult result =
      write_file({.target = file("old.nc"), .bytes = big, .replace_existing = true, .stop = [&] {
                    return ++asked == 3;
                  }});
  EXPECT_EQ(result.status, WriteStatus::kInterrupted);
  EXPECT_EQ(asked, 3);
  EXPECT_EQ(text_of("old.nc"), "old");
  EXPECT_EQ(files_in_folder(), 1u);
}

// A limit on the size of files stands for a full disk.
TEST_F(OutputFile, LeavesTheOldFileWhenTheDiskIsFull) {
  put("old.nc", "old");
  struct rlimit before = {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const struct rlimit small = {.rlim_cur = 1 << 20, .rlim_max = before.rlim_max};
  auto* const handler = ::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const WriteResult result = write_file(
      {.target = file("old.nc"), .bytes = std::string(3 << 20, 'x'), .replace_existing = true});
  ::setrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, handler);
  EXPECT_EQ(result.status, WriteStatus::kFailed);
  EXPECT_NE(result.message.find("old.nc"), std::string::npos);
  EXPECT_EQ(text_of("old.nc"), "old");
  EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(OutputFile, SaysWhyItCannotBeWritten) {
  const WriteResult nowhere = write_file({.target = file("no/such/part.nc"), .bytes = "new"});
  EXPECT_EQ(nowhere.status, WriteStatus::kFailed);
  EXPECT_NE(nowhere.message.find("No such file"), std::string::npos) << nowhere.message;
  const WriteResult directory =
      write_file({.target = folder_, .bytes = "new", .replace_existing = true});
  EXPECT_EQ(directory.status, WriteStatus::kFailed);
  EXPECT_NE(directory.message.find("directory"), std::string::npos) << directory.message;
}

TEST_F(OutputFile, WritesDevicesInPlace) {
  EXPECT_EQ(write_file({.target = "/dev/null", .bytes = "new"}).status, WriteStatus::kWritten);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_EQ(write_file({.target = "/dev/full", .bytes = "new"}).status, WriteStatus::kFailed);
}

// A child writes one text over the other as fast as it can and is killed at some moment,
// without any chance to clean up. 30 deaths, from 0 to 9 ms after the start of the loop.
TEST_F(OutputFile, HoldsTheOldOrTheNewBytesWhenTheWriterIsKilled) {
  const std::string one(300000, '1');
  const std::string two(200000, '2');
  put("part.nc", one);
  for (int death = 0; death < 30; ++death) {
    SCOPED_TRACE(testing::Message() << "death " << death);
    int ready[2];
    ASSERT_EQ(::pipe(ready), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      if (::write(ready[1], "!", 1) != 1) ::_exit(1);
      for (int i = 0;; ++i) {
        (void)write_file(
            {.target = file("part.nc"), .bytes = i % 2 == 0 ? two : one, .replace_existing = true});
      }
    }
    char byte = 0;
    ASSERT_EQ(::read(ready[0], &byte, 1), 1);
    ::usleep(static_cast<useconds_t>(300 * death));
    ::kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status));
    ::close(ready[0]);
    ::close(ready[1]);
    const std::string text = text_of("part.nc");
    EXPECT_TRUE(text == one || text == two) << text.size() << " bytes";
  }
}

TEST_F(OutputFile, KnowsAFileUnderAllItsNames) {
  put("part.nc", "text");
  put("other.nc", "text");
  fs::create_hard_link(file("part.nc"), file("hard.nc"));
  fs::create_symlink("part.nc", file("soft.nc"));
  EXPECT_TRUE(same_file(file("part.nc"), file("hard.nc")));
  EXPECT_TRUE(same_file(file("part.nc"), file("soft.nc")));
  EXPECT_TRUE(same_file(file("part.nc"), folder_ / "." / "part.nc"));
  EXPECT_FALSE(same_file(file("part.nc"), file("other.nc")));
  EXPECT_FALSE(same_file(file("part.nc"), file("missing.nc")));
  EXPECT_TRUE(same_file(file("missing.nc"), folder_ / "." / "missing.nc"));
}

}  // namespace
}  // namespace batten::postproc
