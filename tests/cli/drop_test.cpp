// Words of another control, dropped by name.

#include <gtest/gtest.h>

#include "batten_process.h"

namespace batten {
namespace {

TEST(Drop, TakesOutWhatTheRefusalNamesAndVerifyKnowsIt) {
  const BattenFolder folder;
  folder.put("part.nc", "G64 P0.01\n" + wave_program());
  expect_exit(folder.batten("smooth part.nc -t grbl"), 2,
              {"part.nc:1:1: error: other-family", "--drop G64 takes such words out"});
  expect_exit(folder.batten("smooth part.nc -t grbl --drop G64 --json part.json"), 0,
              {"dropped       1 word (G64)", "1 rewritten"});
  EXPECT_TRUE(contains(folder.text_of("part.json"), "\"words\": 1")) << folder.text_of("part.json");
  EXPECT_FALSE(contains(folder.text_of("part.smooth.nc"), "G64"));
  expect_exit(folder.batten("verify part.nc part.smooth.nc"), 3, {"event-lost"});
  expect_exit(folder.batten("verify part.nc part.smooth.nc --drop G64 --json v.json"), 0,
              {"proved", "but for 1 word that --drop takes out of the old program (G64)"});
  EXPECT_TRUE(contains(folder.text_of("v.json"), "\"words\": 1")) << folder.text_of("v.json");
}

TEST(Drop, IsForWordsThatSayHowAPathIsFollowedAlone) {
  const BattenFolder folder;
  folder.put("part.nc", wave_program());
  for (const char* word : {"G41", "M6", "G61", "X"}) {
    expect_exit(folder.batten(std::string("smooth part.nc -t grbl --drop ") + word), 1,
                {std::string("--drop: there is no '") + word, "possible: G64, G187, G5.1, G5"});
  }
}

// The checker reads the program as it was, with the words.
TEST(Drop, HasNoCertificate) {
  const BattenFolder folder;
  folder.put("part.nc", "G64 P0.01\n" + wave_program());
  for (const char* command : {"smooth part.nc -t grbl", "verify part.nc part.nc"}) {
    expect_exit(folder.batten(std::string(command) + " --drop G64 --certificate part.cert"), 1,
                {"--certificate: it is of the program as it was"});
  }
}

TEST(Drop, HoldsInABatchAndInAConfiguration) {
  const BattenFolder folder;
  folder.put("in/part.nc", "G64 P0.01\n" + wave_program());
  folder.put("in/batten.toml", "target = \"grbl\"\ndrop = \"G64\"\n");
  expect_exit(folder.batten("batch in out --jobs 1"), 0);
  EXPECT_FALSE(contains(folder.text_of("out/part.nc"), "G64"));
  expect_exit(folder.batten("verify in/part.nc out/part.nc"), 0, {"proved"});
}

}  // namespace
}  // namespace batten
