// The option --certificate of smooth and verify. What a certificate has to be worth is checked by
// tests/attack/damaged_certificates.py, with a checker of its own.
#include <gtest/gtest.h>

#include <string>

#include "batten_process.h"

namespace batten {
namespace {

class Certificates : public testing::Test {
 protected:
  Certificates() {
    std::string text = "G21 G90 G17 G94\nG0 X0 Y0 Z5\nG1 Z0 F300\n";
    for (int i = 1; i <= 40; ++i) {
      text += "X" + std::to_string(i) + (i % 2 == 0 ? " Y0.004\n" : " Y-0.004\n");
    }
    folder_.put("part.nc", text + "G0 Z5\nM2\n");
  }

  BattenFolder folder_;
  const std::string smooth_ =
      "smooth part.nc --target linuxcnc --tolerance 0.01 --prefer size --certificate part.cert ";
};

TEST_F(Certificates, AreTheSameOfSmoothAndOfVerify) {
  expect_exit(folder_.batten(smooth_ + "-o new.nc"), 0);
  const std::string certificate = folder_.text_of("part.cert");
  EXPECT_EQ(certificate.substr(0, 43), "Batten certificate 1\ntolerance 0.01 mm\nrun ");
  EXPECT_LE(certificate.size(), folder_.text_of("new.nc").size());
  expect_exit(folder_.batten("verify part.nc new.nc --tolerance 0.01 --certificate again.cert"), 0);
  EXPECT_EQ(folder_.text_of("again.cert"), certificate);
}

TEST_F(Certificates, AreNotWrittenForWhatIsNotProved) {
  expect_exit(folder_.batten(smooth_ + "-o new.nc"), 0);
  expect_exit(folder_.batten("verify part.nc new.nc --tolerance 0.001 --certificate again.cert"),
              3);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("again.cert")));
}

TEST_F(Certificates, ReplaceNoOtherFile) {
  folder_.put("part.cert", "mine");
  expect_exit(folder_.batten(smooth_ + "-o new.nc"), 4, {"part.cert: exists already"});
  EXPECT_FALSE(std::filesystem::exists(folder_.file("new.nc")));
  EXPECT_EQ(folder_.text_of("part.cert"), "mine");
  for (const std::string output :
       {"-o part.cert", "-o -", "--dry-run", "-o a.nc --tolerance-kind band"}) {
    expect_exit(folder_.batten(smooth_ + output), 1, {"--certificate: "});
  }
}

TEST_F(Certificates, OfTheSameBytesHaveNoRun) {
  expect_exit(folder_.batten("verify part.nc part.nc --tolerance 0.01 --certificate same.cert"), 0);
  EXPECT_EQ(folder_.text_of("same.cert"), "Batten certificate 1\ntolerance 0.01 mm\n");
}

}  // namespace
}  // namespace batten
