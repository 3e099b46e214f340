// A CR alone between words divides no line on some controls (LinuxCNC leaves it out): what verify
// compares with a program whose lines end otherwise there is not proved.
#include <gtest/gtest.h>

#include <string>

#include "batten_process.h"

namespace batten {
namespace {

// In each program ^ is the line end that becomes a CR.
struct LoneReturnCase {
  std::string target;
  std::string program;
};

class LoneReturns : public testing::TestWithParam<LoneReturnCase> {};

TEST_P(LoneReturns, AreNotTakenForLineEnds) {
  const auto with = [&](char end) {
    std::string text = GetParam().program;
    text.at(text.find('^')) = end;
    return text;
  };
  BattenFolder folder;
  folder.put("old.nc", with('\n'));
  folder.put("new.nc", with('\r'));
  const std::string verify = "verify --tolerance 0.01 --target " + GetParam().target + " ";
  expect_exit(folder.batten(verify + "old.nc old.nc"), 0);
  expect_exit(folder.batten(verify + "old.nc new.nc"), 3);
  expect_exit(folder.batten(verify + "new.nc old.nc"), 3);
}

INSTANTIATE_TEST_SUITE_P(
    Languages, LoneReturns,
    testing::Values(
        LoneReturnCase{"linuxcnc", "G21 G90\nG0 X0 Y0 Z0\nG1 X60 F3000^Y60\nX0\nM2\n"},
        // In a state in which blocks are compared as texts.
        LoneReturnCase{"hurco", "G21 G90\nG0 X0. Y0. Z0.\nG41 D1\nG1X60.F3000.^Y60.\nX0.\nM30\n"},
        // Within curves.
        LoneReturnCase{"siemens",
                       "G71 G90\nG0 X0 Y0 Z0\nG1 X1 F500\nPOLY PO[X]=(3,0,0) PO[Y]=(1,0.5,0.1)^"
                       "PO[X]=(5,0,0) PO[Y]=(1,-0.5,-0.1)\nG1 X6\nM30\n"},
        LoneReturnCase{"itnc530",
                       "BEGIN PGM A MM\nL X+0 Y+0 Z+0 R0 F500\nL X+3 Y+0\nSPL X+5 Y+0 ~^"
                       "  K3X+0 K2X+0 K1X-2 ~\n  K3Y+0 K2Y+0.4 K1Y-0.4\nL X+6\nEND PGM A MM\n"},
        LoneReturnCase{
            "fanuc",
            "G21 G90\nG0 X0. Y0. Z0.\nG1 X1. F500.\nG06.2 P4 K0. X1. Y0. R1.^K0. X2. Y0. R1.\n"
            "K0. X3. Y1. R1.\nK0. X4. Y1. R1.\nK1.\nK1.\nK1.\nK1.\nG1 X5.\nM30\n"}),
    [](const auto& info) { return info.param.target; });

}  // namespace
}  // namespace batten
