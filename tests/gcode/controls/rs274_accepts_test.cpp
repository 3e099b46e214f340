// LinuxCNC's own interpreter reads what is written for it. Skipped where it is not installed.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/support/control_arcs.h"
#include "tests/support/scratch_folder.h"

namespace batten::gcode {
namespace {

bool is_installed() { return std::system("command -v rs274 >/dev/null 2>&1") == 0; }

std::string ten_thousand_arcs(Units units) {
  const Control& linuxcnc = named_control("linuxcnc");
  std::mt19937 random(31);
  std::string text;
  for (int i = 0; i < 10000; ++i) {
    const geometry::Arc wanted = random_arc_for(linuxcnc, units, 1e4, random);
    Writer out = arc_writer(linuxcnc, wanted.start, units);
    if (!out.arc_to(wanted, 1000)) continue;
    text += program_from(wanted.start, units, out.text());
  }
  return text + "M2\n";
}

TEST(Rs274, TakesTenThousandArcsInEitherUnit) {
  if (!is_installed()) GTEST_SKIP() << "no rs274 here";
  const ScratchFolder folder;
  const std::string name = folder.path().string();
  folder.put("tool.tbl", "T1 P1 D0.2 Z0\n");
  folder.put("parameters.var", "");
  for (const Units units : {Units::kMillimetre, Units::kInch}) {
    folder.put("arcs.ngc", ten_thousand_arcs(units));
    const std::string command = "cd '" + name + "' && HOME='" + name +
                                "' rs274 -g -n 2 -t tool.tbl -v parameters.var arcs.ngc "
                                "</dev/null >/dev/null 2>complaints";
    EXPECT_EQ(std::system(command.c_str()), 0);
    // Its exit code is 0 even after some errors.
    std::ifstream said(folder.file("complaints"));
    for (std::string line; std::getline(said, line);) {
      EXPECT_TRUE(line.empty() || line == "executing") << line;
    }
  }
}

}  // namespace
}  // namespace batten::gcode
