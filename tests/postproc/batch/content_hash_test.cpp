// SHA-256 against the examples that NIST publishes for it.

#include "postproc/batch/content_hash.h"

#include <gtest/gtest.h>

namespace batten::postproc {
namespace {

TEST(ContentHash, IsThatOfThePublishedExamples) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

// The padding takes one block more from 56 bytes behind the last whole block on.
TEST(ContentHash, DiffersForEveryLengthAroundABlock) {
  std::string before = sha256("");
  for (std::size_t length = 1; length <= 130; ++length) {
    const std::string hash = sha256(std::string(length, '\0'));
    EXPECT_EQ(hash.size(), 64u);
    EXPECT_NE(hash, before) << length;
    before = hash;
  }
}

}  // namespace
}  // namespace batten::postproc
