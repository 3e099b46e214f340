// Programs that call others whose files stand beside them, as a user meets them.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "batten_process.h"
#include "tests/support/wavy_programs.h"

namespace batten {
namespace {

// A wave behind a call, under the modes of before it.
std::string caller(const std::string& call) {
  return "G21 G90 G17\nS12000 M3\nG0 X0. Y0. Z5.\n" + call + "\nG0 X0. Y0.\nG1 Z-1. F300.\n" +
         postproc::joined(postproc::wave_lines({}), "\n") + "G0 Z5.\nM30\n";
}

class CalledFilesOfAUser : public testing::Test {
 protected:
  void SetUp() override { folder_.put("part.nc", caller("M98 P1000")); }

  ProcessResult smooth(const std::string& options = "--target haas") const {
    return folder_.batten("smooth part.nc --tolerance 0.01 --force -o new.nc " + options);
  }
  void expect_kept(const std::string& said, const std::string& options = "--target haas") const {
    expect_exit(smooth(options), 0, {said});
    EXPECT_EQ(folder_.text_of("new.nc"), folder_.text_of("part.nc"));
  }

  BattenFolder folder_;
};

TEST_F(CalledFilesOfAUser, AreReadBesideTheProgramAndNamed) {
  expect_kept("calls         O1000: no file of this name stands beside the program");
  for (const char* name : {"O1000", "1000", "O01000.NC", "o1000.tap"}) {
    SCOPED_TRACE(name);
    folder_.put(name, "O1000\nG0 Z9.\nM99\n");
    expect_exit(smooth("--target haas --json report.json"), 0,
                {"1 rewritten", std::string("O1000: ") + name + " was read"});
    const auto report = nlohmann::json::parse(folder_.text_of("report.json"));
    EXPECT_EQ(report["called"][0]["call"], "O1000");
    EXPECT_EQ(report["called"][0]["file"], name);
    EXPECT_EQ(report["called"][0]["why_not"], "");
    expect_exit(folder_.shell(std::string("rm -f ") + name), 0);
  }
}

TEST_F(CalledFilesOfAUser, AreReadByEveryCommand) {
  folder_.put("O1000.nc", "O1000\nG0 Z9.\nM99\n");
  expect_exit(smooth(), 0, {"1 rewritten"});
  expect_exit(folder_.batten("verify part.nc new.nc --tolerance 0.01"), 0, {"O1000.nc was read"});
  EXPECT_TRUE(contains(folder_.batten("inspect part.nc").out, "O1000: O1000.nc was read"));
  EXPECT_TRUE(contains(folder_.batten("time part.nc --machine mill").out,
                       "the time of what is called is not in it"));
}

// What the file says is what holds: under G91 the wave would be another path.
TEST_F(CalledFilesOfAUser, LeaveTheModesThatTheyLeave) {
  for (const char* body : {"G91", "G68 X0 Y0 R30", "G41 D1", "G777", "G93"}) {
    folder_.put("O1000.nc", std::string("O1000\n") + body + "\nM99\n");
    expect_kept("O1000.nc was read");
  }
}

TEST_F(CalledFilesOfAUser, SayNothingWhereItIsNotCertainWhatTheyAre) {
  folder_.put("O1000.nc", "O1000\nM99 P5\n");
  expect_kept("O1000.nc says nothing: it goes back to a block that it names");
  folder_.put("O1000.nc", "O77\nM99\n");
  expect_kept("it says that it is O77");
  folder_.put("O1000.nc", "O1000\nG0 X1.\nM30\n");
  expect_kept("it ends the whole program");
  folder_.put("O1000.nc", "0 BEGIN PGM A MM\n1 L X+1 Y+1 FMAX\n2 END PGM A MM\n");
  expect_kept("it is in another language");
  folder_.put("O1000.nc", std::string("\x7f"
                                      "ELF\0\0\0\1",
                                      8));
  expect_kept("O1000.nc says nothing");
  folder_.put("O1000.nc", "O1000\nM99\n");
  folder_.put("1000.nc", "M99\n");
  expect_kept("1000.nc and O1000.nc may both be it");
}

TEST_F(CalledFilesOfAUser, ThatCallEachOtherEnd) {
  folder_.put("O1000.nc", "O1000\nM98 P1001\nM99\n");
  folder_.put("O1001.nc", "O1001\nM98 P1000\nM99\n");
  expect_kept("O1001: O1001.nc was read");
  // The program itself.
  folder_.put("part.nc", caller("M98 P1002"));
  folder_.put("O1002.nc", "O1002\nM98 P1002\nM99\n");
  expect_kept("O1002.nc was read");
}

// O1000 stands in the program; the file is another one.
TEST_F(CalledFilesOfAUser, AreNotReadWhereTheProgramHoldsThem) {
  folder_.put("part.nc", caller("M98 P1000") + "O1000\nG91\nM99\n");
  folder_.put("O1000.nc", "O1000\nG0 Z9.\nM99\n");
  const ProcessResult said = smooth();
  EXPECT_FALSE(contains(said.err, "was read")) << said.err;
  EXPECT_EQ(folder_.text_of("new.nc"), folder_.text_of("part.nc"));
}

TEST_F(CalledFilesOfAUser, HaveTheirNamesOnEachControl) {
  folder_.put("part.nc", caller("o<lift> call [5]"));
  folder_.put("lift.ngc", "o<lift> sub\nG0 Z9\no<lift> endsub\nM2\n");
  expect_exit(smooth("--target linuxcnc --machine linuxcnc-fast"), 0,
              {"1 rewritten", "o<lift>: lift.ngc was read"});

  folder_.put("part.nc", "; a part\nG71 G90 G17 G94\nG0 X0 Y0 Z5\nL54\nG0 X0 Y0\nG1 Z-1 F300\n" +
                             postproc::joined(postproc::wave_lines({}), "\n") + "M30\n");
  folder_.put("l54.spf", "G0 Z9\nM17\n");
  expect_exit(smooth("--target siemens --source siemens"), 0,
              {"1 rewritten", "L54: l54.spf was read"});

  std::string klartext =
      "0 BEGIN PGM PART MM\n1 L X+0 Y+0 Z+5 R0 FMAX\n2 CALL PGM LIFT\n3 L X+0 Y+0 R0 FMAX\n"
      "4 L Z-1 F300\n";
  int number = 5;
  for (std::string line : postproc::wave_lines({.lines = 100})) {
    if (line.starts_with("G1 ")) line = line.substr(3);
    line.insert(line.find('Y') + 1, line[line.find('Y') + 1] == '-' ? "" : "+");
    klartext += std::to_string(number++) + " L X+" + line.substr(1) + "\n";
  }
  folder_.put("part.nc", klartext + std::to_string(number) + " END PGM PART MM\n");
  folder_.put("LIFT.h", "0 BEGIN PGM LIFT MM\n1 L Z+9 R0 FMAX\n2 END PGM LIFT MM\n");
  expect_exit(smooth("--target heidenhain"), 0, {"1 rewritten", "CALL PGM LIFT: LIFT.h was read"});
}

// A variable that is assigned, then maybe a call, then a wave whose places rest on it.
struct VariableRow {
  const char* control;
  const char* assigned;
  const char* x;     // an expression in place of X's number
  const char* call;  // of a program whose file assigns the variable again
  const char* file;
  const char* text;
};

// By the value of before the call the wave would be half as long.
const VariableRow kVariables[] = {
    {"linuxcnc --machine linuxcnc-fast", "#100=1", "[#100*{}]", "o<twice> call", "twice.ngc",
     "o<twice> sub\n#100=2\no<twice> endsub\nM2\n"},
    {"linuxcnc --machine linuxcnc-fast", "#1=1", "[#1*{}]", "o<twice> call", "twice.ngc",
     "o<twice> sub\n#1=2\no<twice> endsub\nM2\n"},
    {"haas", "#100=1.", "[#100*{}]", "M98 P1000", "O1000.nc", "O1000\n#100=2.\nM99\n"},
    {"fanuc", "#1=1.", "[#1*{}]", "M98 P1000", "O1000.nc", "O1000\n#1=2.\nM99\n"},
    {"haas", "#100=1.", "[#100*{}]", "G65 P1000 A2.", "O1000.nc", "O1000\n#100=#1\nM99\n"},
    {"siemens --source siemens", "R1=1", "=R1*{}", "L54", "L54.SPF", "R1=2\nM17\n"},
};

TEST_F(CalledFilesOfAUser, MayAssignTheVariablesOfTheirCaller) {
  for (const VariableRow& row : kVariables) {
    SCOPED_TRACE(testing::Message() << row.control << ": " << row.call);
    const std::string options = std::string("--target ") + row.control;
    const bool siemens = std::string(row.call) == "L54";
    std::string wave;
    for (const std::string& line : postproc::wave_lines({})) {
      const std::size_t begin = line.find('X') + 1;
      const std::size_t end = line.find(' ', begin);
      std::string x = row.x;
      x.replace(x.find("{}"), 2, line.substr(begin, end - begin));
      wave += line.substr(0, begin) + x + line.substr(end) + "\n";
    }
    const std::string start =
        std::string(siemens ? "; a part\nG71 G94 G90 G17\n" : "G21 G90 G17\n") +
        "S12000 M3\nG0 X0. Y0. Z5.\n";
    const std::string rest = "G0 X0. Y0.\nG1 Z-1. F300.\n" + wave + "G0 Z5.\nM30\n";
    folder_.put(row.file, row.text);
    folder_.put("part.nc", start + row.assigned + "\n" + rest);
    expect_exit(smooth(options), 0, {"1 rewritten"});
    folder_.put("part.nc", start + row.assigned + "\n" + row.call + "\n" + rest);
    expect_kept(std::string(row.file) + " was read", options);
    // It is the variable alone that is not known.
    folder_.put("part.nc", start + row.call + "\n" + row.assigned + "\n" + rest);
    expect_exit(smooth(options), 0, {"1 rewritten"});
    expect_exit(folder_.shell(std::string("rm ") + row.file), 0);
  }
}

TEST_F(CalledFilesOfAUser, MayAssignTheParametersOfTheirCallerInKlartext) {
  std::string wave;
  for (std::string line : postproc::wave_lines({.lines = 100})) {
    if (line.starts_with("G1 ")) line = line.substr(3);
    const std::size_t end = line.find(' ');
    line.insert(line.find('Y') + 1, line[line.find('Y') + 1] == '-' ? "" : "+");
    const std::size_t feed = std::min(line.find(" F"), line.size());
    line.insert(feed, " ZQ5");
    wave += "L X+" + line.substr(1, end - 1) + line.substr(end) + "\n";
  }
  const auto program = [&](const std::string& before) {
    std::string text;
    int number = 1;
    std::istringstream lines("L X+0 Y+0 Z+5 R0 FMAX\n" + before +
                             "L X+0 Y+0 R0 FMAX\nL ZQ5 F300\n" + wave);
    for (std::string line; std::getline(lines, line);) {
      text += std::to_string(number++) + " " + line + "\n";
    }
    return "0 BEGIN PGM PART MM\n" + text + std::to_string(number) + " END PGM PART MM\n";
  };
  folder_.put("DEEP.h", "0 BEGIN PGM DEEP MM\n1 Q5 = -2\n2 END PGM DEEP MM\n");
  folder_.put("part.nc", program("CALL PGM DEEP\nQ5 = -1\n"));
  expect_exit(smooth("--target heidenhain"), 0, {"1 rewritten", "DEEP.h was read"});
  folder_.put("part.nc", program("Q5 = -1\nCALL PGM DEEP\n"));
  expect_kept("DEEP.h was read", "--target heidenhain");
}

// A batch makes a program again whose called program says something else.
TEST_F(CalledFilesOfAUser, AreWhatABatchDependsOn) {
  expect_exit(folder_.shell("mkdir in && mv part.nc in/ && printf 'O1000\\nG0 Z9.\\nM99\\n' > "
                            "in/O1000.nc"),
              0);
  const std::string batch = "batch in out --target haas --tolerance 0.01";
  expect_exit(folder_.batten(batch), 0);
  const std::string smoothed = folder_.text_of("out/part.nc");
  EXPECT_NE(smoothed, folder_.text_of("in/part.nc"));
  folder_.put("in/O1000.nc", "O1000\nG91\nM99\n");
  expect_exit(folder_.batten(batch), 0);
  EXPECT_EQ(folder_.text_of("out/part.nc"), folder_.text_of("in/part.nc"));
}

}  // namespace
}  // namespace batten
