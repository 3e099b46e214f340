// What a user's shell and scripts depend on: help, exit codes, which files are written.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>

#include "batten_process.h"
#include "tests/support/places.h"

namespace batten {
namespace {

constexpr const char* kSmooth = "smooth part.nc --target linuxcnc --tolerance 0.01 ";

class CommandLine : public testing::Test {
 protected:
  void SetUp() override { folder_.put("part.nc", wave_program()); }

  [[nodiscard]] ProcessResult batten(const std::string& arguments) const {
    return folder_.batten(arguments);
  }

  BattenFolder folder_;
};

// --- help ------------------------------------------------------------------------------------

TEST_F(CommandLine, HelpOfEachCommandHasAnExampleAndAllAreListed) {
  const ProcessResult all = batten("--help");
  EXPECT_EQ(all.exit_code, 0);
  EXPECT_TRUE(contains(all.out, "3 not proved")) << all.out;
  for (const std::string command : {"smooth", "verify", "inspect", "time", "batch", "freecad",
                                    "targets", "machines", "methods"}) {
    EXPECT_TRUE(contains(all.out, command)) << command;
    const ProcessResult help = expect_exit(batten(command + " --help"), 0);
    EXPECT_TRUE(contains(help.out, "Example")) << help.out;
    EXPECT_TRUE(contains(help.out, "batten " + command)) << help.out;
    EXPECT_EQ(help.err, "");
  }
}

TEST_F(CommandLine, VersionIsOneLine) {
  EXPECT_EQ(expect_exit(batten("--version"), 0).out, "batten " BATTEN_VERSION "\n");
}

TEST_F(CommandLine, ListsWhatIsBuiltIn) {
  EXPECT_TRUE(contains(batten("targets").out, "grbl"));
  EXPECT_TRUE(contains(batten("machines").out, "linuxcnc"));
  EXPECT_TRUE(contains(batten("methods").out, "fair"));
  const auto targets = nlohmann::json::parse(batten("targets --json -").out)["targets"];
  ASSERT_GE(targets.size(), 2u);
  EXPECT_EQ(targets[0]["name"], "linuxcnc");
}

// --- wrong usage -------------------------------------------------------------------------------

constexpr WrongUsage kWrongUsages[] = {
    {"NoCommand", "", "no command given; possible: smooth, explore"},
    {"UnknownCommand", "smoth part.nc", "did you mean 'smooth'?"},
    {"NoFile", "smooth --target linuxcnc", "IN: no file given"},
    {"TwoFiles", "inspect part.nc b.nc", "one file too many"},
    {"NoTarget", "smooth part.nc", "--target: for which control is part.nc? likely"},
    {"UnknownTarget", "smooth part.nc --target linuxcn", "did you mean 'linuxcnc'?"},
    {"UnknownMachine", "smooth part.nc --target grbl --machine x", "--machine"},
    {"MissingMachineFile", "smooth part.nc --target grbl --machine x.toml", "x.toml"},
    {"MissingIni", "smooth part.nc --target grbl --machine x.ini", "x.ini"},
    {"MissingGrblSettings", "smooth part.nc --target grbl --grbl-settings x.txt", "x.txt"},
    {"ShowOfNoMachine", "machines --show mil", "did you mean 'mill'?"},
    {"UnknownOption", "smooth part.nc --target grbl --tolerence 1", "did you mean --tolerance?"},
    {"UnknownForm", "smooth part.nc --target grbl --output splines",
     "possible: auto, curves, arcs, lines"},
    {"UnknownMethod", "smooth part.nc --target grbl --method spline",
     "possible: best, fair, racing, tube, naseath, guo, ozcan"},
    {"ToleranceWithoutAValue", "smooth part.nc --target grbl --tolerance", "--tolerance"},
    {"ToleranceWithAComma", "smooth part.nc --target grbl --tolerance 0,01", "not a comma"},
    {"ToleranceOfAnotherUnit", "smooth part.nc --target grbl --tolerance 0.01cm", "0.0005in"},
    {"NegativeTolerance", "smooth part.nc --target grbl --tolerance=-0.01", "above 0"},
    {"RuleThatCannotBeLifted", "smooth part.nc --target grbl --allow cutter-compensation",
     "cannot be lifted"},
    {"RuleInAListThatIsNone", "smooth part.nc --target grbl --allow exact-stop,nothing",
     "there is no reason 'nothing'"},
    {"ListWithAnEmptyPart", "smooth part.nc --target grbl --allow exact-stop,",
     "there is no reason ''"},
    {"UnknownDecimals", "smooth part.nc --target fanuc --decimals 0.001",
     "expected auto, explicit, implied"},
    {"IncrementsOfAControlWithoutThem", "smooth part.nc --target grbl --decimals implied",
     "takes X5 for 5 mm"},
    {"IncrementsOfNobody", "inspect part.nc --decimals implied", "--source fanuc or haas"},
    {"OutputIsTheInput", "smooth part.nc --target grbl -o ./part.nc --force", "--in-place"},
    {"ReportIsTheInput", "smooth part.nc --target grbl --json part.nc --force", "--json"},
    {"ReportIsTheOutput", "smooth part.nc --target grbl -o x.nc --json x.nc", "--json"},
    {"InPlaceWithOut", "smooth part.nc --target grbl --in-place -o x.nc", "--in-place"},
    {"InPlaceOfStandardInput", "smooth - --target grbl --in-place", "--in-place"},
    {"ProgramAndReportOnStandardOutput", "smooth part.nc --target grbl -o - --json -", "--json"},
    {"MissingConfig", "smooth part.nc --target grbl --config no.toml", "no.toml"},
    {"VerifyWithOneFile", "verify part.nc", "NEW: no file given"},
    {"VerifyStandardInputTwice", "verify - -", "only once"}};

TEST_F(CommandLine, WrongUsagesExitWithOneAndTouchNothing) {
  for (const WrongUsage& wrong : kWrongUsages) {
    SCOPED_TRACE(wrong.name);
    const ProcessResult done = expect_exit(batten(wrong.arguments), 1, {wrong.message});
    EXPECT_EQ(done.out.empty(), !contains(wrong.arguments, "--json -")) << done.out;
    EXPECT_EQ(folder_.text_of("part.nc"), wave_program());
    EXPECT_FALSE(folder_.has("part.smooth.nc"));
  }
}

// What the numbers mean is said once, to every command that reads them.
TEST_F(CommandLine, ReadsImpliedDecimalsWhereTheUserSaysSo) {
  const BattenFolder folder;
  folder.put("old.nc",
             "G21 G90\nG0 X0 Y0 Z5000\nG1 Z-1000 F300\nX10000\nX20000 Y500\nX30000\nM30\n");
  expect_exit(folder.batten("smooth old.nc --target fanuc"), 0,
              {"old.nc:2:10: warning: implied-decimals: Z5000 has no decimal"});
  EXPECT_EQ(folder.text_of("old.smooth.nc"), folder.text_of("old.nc"));
  const ProcessResult read =
      expect_exit(folder.batten("inspect old.nc --source fanuc --decimals implied"), 0);
  EXPECT_FALSE(contains(read.err, "implied-decimals")) << read.err;
  folder.put("new.nc", "G21 G90\nG0 X0 Y0 Z5000\nG1 Z-1000 F300\nX10.\nX20. Y.5\nX30.\nM30\n");
  const std::string verify = "verify old.nc new.nc --target fanuc --decimals ";
  EXPECT_EQ(folder.batten(verify + "implied").exit_code, 0);
  EXPECT_EQ(folder.batten(verify + "explicit").exit_code, 3);
  EXPECT_EQ(folder.batten(verify + "auto").exit_code, 3);
}

TEST_F(CommandLine, TellsAllProblemsAtOnce) {
  const ProcessResult result =
      expect_exit(batten("smooth part.nc --target no --tolerance x --method y --keep-corners 999 "
                         "--threads -1 --nope"),
                  1);
  for (const char* option :
       {"--target", "--tolerance", "--method", "--keep-corners", "--threads", "--nope"}) {
    EXPECT_TRUE(contains(result.err, std::string("batten: ") + option)) << option << result.err;
  }
}

// --- files ---------------------------------------------------------------------------------------

TEST_F(CommandLine, WritesBesideTheInputByDefault) {
  const ProcessResult result = expect_exit(batten(kSmooth), 0);
  EXPECT_TRUE(folder_.has("part.smooth.nc"));
  EXPECT_EQ(folder_.text_of("part.nc"), wave_program());
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(contains(result.err, "part.nc -> part.smooth.nc, for linuxcnc")) << result.err;
}

TEST_F(CommandLine, DoesNotReplaceAFileWithoutForce) {
  folder_.put("part.smooth.nc", "mine");
  expect_exit(batten(kSmooth), 4, {"--force"});
  EXPECT_EQ(folder_.text_of("part.smooth.nc"), "mine");
  EXPECT_EQ(batten(std::string(kSmooth) + "--force").exit_code, 0);
  EXPECT_NE(folder_.text_of("part.smooth.nc"), "mine");
}

TEST_F(CommandLine, DoesNotReplaceAReportWithoutForce) {
  folder_.put("report.json", "mine");
  EXPECT_EQ(batten(std::string(kSmooth) + "--json report.json").exit_code, 4);
  EXPECT_EQ(folder_.text_of("report.json"), "mine");
  EXPECT_FALSE(folder_.has("part.smooth.nc"));
}

TEST_F(CommandLine, ReplacesTheInputOnlyWhenAsked) {
  ASSERT_EQ(batten(kSmooth).exit_code, 0);
  ASSERT_EQ(batten(std::string(kSmooth) + "--in-place").exit_code, 0);
  EXPECT_EQ(folder_.text_of("part.nc"), folder_.text_of("part.smooth.nc"));
}

TEST_F(CommandLine, DryRunWritesNoProgram) {
  const ProcessResult result = expect_exit(batten(std::string(kSmooth) + "--dry-run --json -"), 0);
  EXPECT_FALSE(folder_.has("part.smooth.nc"));
  EXPECT_EQ(nlohmann::json::parse(result.out)["input"]["file"], "part.nc");
}

TEST_F(CommandLine, ReadsStandardInputAndWritesStandardOutput) {
  ASSERT_EQ(batten(kSmooth).exit_code, 0);
  const ProcessResult piped =
      expect_exit(folder_.shell("batten smooth - --target linuxcnc --tolerance 0.01 <part.nc"), 0);
  EXPECT_EQ(piped.out, folder_.text_of("part.smooth.nc"));
  EXPECT_EQ(batten(std::string(kSmooth) + "-o -").out, folder_.text_of("part.smooth.nc"));
}

TEST_F(CommandLine, TellsAMissingFile) {
  expect_exit(batten("smooth missing.nc --target grbl"), 4, {"missing.nc"});
}

TEST_F(CommandLine, RefusesAProgramWithoutUnitsUntilTheyAreGiven) {
  std::string text = wave_program();
  text.replace(0, 4, "");  // without its G21
  folder_.put("part.nc", text);
  expect_exit(batten(kSmooth), 2, {"part.nc:", "--units"});
  EXPECT_FALSE(folder_.has("part.smooth.nc"));
  EXPECT_EQ(batten(std::string(kSmooth) + "--units mm").exit_code, 0);
  EXPECT_TRUE(folder_.has("part.smooth.nc"));
}

// --- verify and inspect --------------------------------------------------------------------------

TEST_F(CommandLine, VerifyAcceptsWhatSmoothWrote) {
  ASSERT_EQ(batten(kSmooth).exit_code, 0);
  const ProcessResult result =
      expect_exit(batten("verify part.nc part.smooth.nc --tolerance 0.01 --json -"), 0, {"proved"});
  const auto report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report["proved"], true);
  EXPECT_LE(report["deviation_mm"].get<double>(), 0.01);
}

TEST_F(CommandLine, VerifyLooksASecondTime) {
  ASSERT_EQ(batten(kSmooth).exit_code, 0);
  const std::string verify = "verify part.nc part.smooth.nc --tolerance 0.01 ";
  expect_exit(batten(verify + "--second-check"), 0, {"second check: 1 of 1 changed sections"});
  const ProcessResult once = expect_exit(batten(verify), 0, {"; 1 changed section, "});
  EXPECT_FALSE(contains(once.err, "second check"));
}

TEST_F(CommandLine, VerifyRejectsAChangedProgram) {
  std::string text = wave_program();
  text.insert(text.find("G0 Z5"), "M9\n");
  folder_.put("new.nc", text);
  expect_exit(batten("verify part.nc new.nc --tolerance 0.01"), 3, {"new.nc:", "NOT PROVED"});
}

TEST_F(CommandLine, VerifyProvesTheSameBytesInAnyUnit) {
  std::string text = wave_program();
  text.replace(0, 4, "");  // without its G21
  folder_.put("part.nc", text);
  folder_.put("same.nc", text);
  const ProcessResult same =
      expect_exit(batten("verify part.nc same.nc --json -"), 0, {"byte for byte"});
  EXPECT_EQ(nlohmann::json::parse(same.out)["proved"], true);

  folder_.put("other.nc", text + "(a comment does nothing, but these are other bytes)\n");
  const ProcessResult other = expect_exit(batten("verify part.nc other.nc"), 2, {"units-missing"});
  EXPECT_EQ(batten("verify part.nc other.nc --units inch").exit_code, 0);
}

// X10 may be 0.010 mm where X10. is 10 mm: which control it is decides.
TEST_F(CommandLine, VerifyAsksForTheControlWhereADecimalPointIsLost) {
  folder_.put("old.nc", "G21 G90\nG0 X0. Y0. Z5.\nG1 X10. F100.\nM30\n");
  folder_.put("new.nc", "G21 G90\nG0 X0. Y0. Z5.\nG1 X10 F100.\nM30\n");
  expect_exit(batten("verify old.nc new.nc"), 3,
              {"new.nc:3: point-spelling: found X10 without", "--target"});
  EXPECT_EQ(batten("verify old.nc new.nc --target linuxcnc").exit_code, 0);
  EXPECT_EQ(batten("verify old.nc new.nc --source ngc").exit_code, 0);
  EXPECT_EQ(batten("verify old.nc new.nc --decimals explicit --source fanuc").exit_code, 0);
  EXPECT_EQ(batten("verify old.nc new.nc --target fanuc").exit_code, 3);
}

// A tolerance needs a unit only where something moves.
TEST_F(CommandLine, VerifyComparesProgramsWithoutMovesInAnyUnit) {
  folder_.put("old.nc", "T1 M6\nM30\n");
  folder_.put("same.nc", "T1 M6 (the long drill)\nM30\n");
  folder_.put("other.nc", "T2 M6\nM30\n");
  EXPECT_EQ(batten("verify old.nc same.nc").exit_code, 0);
  EXPECT_EQ(batten("verify old.nc other.nc").exit_code, 3);
}

TEST_F(CommandLine, InspectShowsRunsAndReasons) {
  const ProcessResult text = expect_exit(batten("inspect part.nc"), 0);
  EXPECT_TRUE(contains(text.out, "1 run that may be rewritten:")) << text.out;
  EXPECT_TRUE(contains(text.out, "rapid: ")) << text.out;
  const ProcessResult json = expect_exit(batten("inspect part.nc --json -"), 0);
  std::size_t runs = 0;
  const auto report = nlohmann::json::parse(json.out);
  for (const auto& section : report["sections"]) {
    if (section["status"] != "run") continue;
    ++runs;
    EXPECT_GE(section["segments"]["count"].get<int>(), 100);
    EXPECT_NEAR(section["segments"]["median_mm"].get<double>(), 0.22361, 1e-4);  // 0.2, 0.1
  }
  EXPECT_EQ(runs, 1u);
}

// --- options in files ----------------------------------------------------------------------------

TEST_F(CommandLine, ConfigGivesTheSameResultAsOptions) {
  folder_.put(
      "options.toml",
      "target = \"linuxcnc\"\ntolerance = 0.01\nstrict = false\nallow = [\"exact-stop\"]\n");
  ASSERT_EQ(batten("smooth part.nc --config options.toml").exit_code, 0);
  ASSERT_EQ(batten(std::string(kSmooth) + "--allow exact-stop -o given.nc").exit_code, 0);
  EXPECT_EQ(folder_.text_of("part.smooth.nc"), folder_.text_of("given.nc"));
}

TEST_F(CommandLine, ListsTakeCommasOrAreRepeated) {
  const char* const kBoth = "allow = [\"exact-stop\", \"work-offset\"]\n";
  folder_.put("options.toml", "allow = \"exact-stop,work-offset\"\n");
  for (const char* options :
       {"--allow exact-stop --allow work-offset", "--allow exact-stop,work-offset",
        "--allow 'exact-stop, work-offset'", "--config options.toml"}) {
    const ProcessResult printed =
        expect_exit(batten(std::string("smooth --print-config --target grbl ") + options), 0);
    EXPECT_TRUE(contains(printed.out, kBoth)) << options << printed.out;
  }
}

TEST_F(CommandLine, PrintedConfigReadsBackTheSame) {
  const std::string options =
      "smooth --print-config --target grbl --tolerance 0.0005in --prefer size --keep-corners 12.5 "
      "--allow exact-stop --strict";
  const ProcessResult printed = expect_exit(batten(options), 0);
  folder_.put("options.toml", printed.out);
  const ProcessResult again = expect_exit(batten("smooth --print-config --config options.toml"), 0);
  const auto without_origins = [](const std::string& text) {
    return std::regex_replace(text, std::regex("# from .*\n"), "");
  };
  EXPECT_EQ(without_origins(again.out), without_origins(printed.out));
  EXPECT_TRUE(contains(printed.out, "keep-corners = \"12.5\"")) << printed.out;
  EXPECT_TRUE(contains(printed.out, "strict = true")) << printed.out;
}

TEST_F(CommandLine, TheCommandLineGoesBeforeTheConfig) {
  folder_.put("options.toml", "target = \"linuxcnc\"\n");
  const ProcessResult result = batten("smooth --print-config --config options.toml --target grbl");
  EXPECT_TRUE(contains(result.out, "target = \"grbl\"")) << result.out;
}

TEST_F(CommandLine, TellsEveryProblemOfAConfigWithItsLine) {
  folder_.put("options.toml", "target = [1]\ntolerence = 1\nforce = true\nstrict = 3\n");
  expect_exit(batten("smooth part.nc --config options.toml"), 1,
              {"options.toml:1: 'target'", "options.toml:2: there is no option 'tolerence'",
               "options.toml:3: 'force' is for the command line",
               "options.toml:4: 'strict', expected true or false"});
}

TEST_F(CommandLine, TakesAMachineFromAFile) {
  folder_.put("router.toml", "based-on = \"linuxcnc\"\nmax-acceleration = 500\n");
  expect_exit(batten(std::string(kSmooth) + "--machine router.toml"), 0, {"machine router"});
  folder_.put("bad.toml", "based-on = \"linuxcn\"\nmax-acceleration = -1\nmax-speed = 3\n");
  const ProcessResult bad =
      expect_exit(batten(std::string(kSmooth) + "--machine bad.toml --force"), 1,
                  {"there is no machine 'linuxcn'",
                   "bad.toml:2:20: max-acceleration: -1, expected above 0 (mm/s2)",
                   "bad.toml:3:1: max-speed: there is no such key"});
  EXPECT_FALSE(contains(bad.err, "no machine given")) << bad.err;
}

TEST_F(CommandLine, TakesAMachineFromTheIniOfLinuxcnc) {
  folder_.put("mill.ini",
              "[TRAJ]\nCOORDINATES = X Y\nLINEAR_UNITS = inch\n"
              "[AXIS_X]\nMAX_VELOCITY = 2\nMAX_ACCELERATION = 20\n"
              "[AXIS_Y]\nMAX_VELOCITY = 2\nMAX_ACCELERATION = 20\n");
  expect_exit(batten(std::string(kSmooth) + "--machine mill.ini"), 0, {"machine mill"});
  const auto shown =
      nlohmann::json::parse(batten("machines --show mill.ini --json -").out)["machine"];
  EXPECT_NEAR(shown["axes"]["x"]["velocity_mm_per_s"], 50.8, 1e-9);
  EXPECT_TRUE(shown["axes"]["x"]["jerk_mm_per_s3"].is_null()) << "no such limit";
}

constexpr const char* kGrblDump =
    "$11=0.010\n$12=0.002\n$110=6000\n$111=6000\n$112=600\n$120=500\n$121=500\n$122=60\nok\n";

TEST_F(CommandLine, TakesTheSettingsOfGrbl) {
  folder_.put("shapeoko.txt", kGrblDump);
  expect_exit(batten("smooth part.nc --target grbl --grbl-settings shapeoko.txt"), 0,
              {"machine shapeoko"});
  folder_.put("bad.txt", "error:8\n");
  expect_exit(batten("smooth part.nc --target grbl --grbl-settings bad.txt --force"), 1,
              {"bad.txt:1:1: 'error:8'"});
  expect_exit(batten(std::string(kSmooth) + "--machine mill --grbl-settings shapeoko.txt --force"),
              1, {"the control of machine mill is look-ahead"});
}

TEST_F(CommandLine, PrintsAMachineAsAFileThatIsReadAgain) {
  folder_.put("shapeoko.txt", kGrblDump);
  const ProcessResult first =
      expect_exit(batten("machines --show router --grbl-settings shapeoko.txt"), 0);
  folder_.put("mine.toml", first.out);
  EXPECT_EQ(expect_exit(batten("machines --show mine.toml"), 0).out, first.out);
  EXPECT_TRUE(contains(first.out, "[axis.z]\nvelocity = 10  # mm/s")) << first.out;
}

TEST_F(CommandLine, ListsTheMachinesAndWhereTheirNumbersComeFrom) {
  const auto machines = nlohmann::json::parse(batten("machines --json -").out)["machines"];
  const std::string table = batten("machines").out;
  ASSERT_GE(machines.size(), 6u);
  for (const auto& machine : machines) {
    EXPECT_TRUE(contains(table, "\n" + std::string(machine["name"]) + " ")) << table;
    EXPECT_TRUE(contains(table, " " + std::string(machine["source"]) + "\n")) << table;
  }
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'),
            2 * static_cast<long>(machines.size()) + 4);
}

// --- progress and interrupts ---------------------------------------------------------------------

TEST_F(CommandLine, ProgressForLinuxcncIsItsLinesAndNothingElse) {
  const ProcessResult result = expect_exit(
      batten(std::string(kSmooth) + "--progress linuxcnc -o -"), 0, {"FILTER_PROGRESS=100\n"});
  EXPECT_FALSE(contains(result.out, "FILTER_PROGRESS"));
  const ProcessResult under_axis = folder_.shell(
      std::string("AXIS_PROGRESS_BAR=1; export AXIS_PROGRESS_BAR; batten ") + kSmooth + "-o -");
  EXPECT_TRUE(contains(under_axis.err, "FILTER_PROGRESS=100\n"));
  EXPECT_FALSE(contains(batten(std::string(kSmooth) + "-o -").err, "FILTER_PROGRESS"));
}

// The program waits for standard input, so the signal comes while it runs, whatever its speed.
TEST_F(CommandLine, ASignalEndsTheProgramAndNothingIsWritten) {
  const std::string wait_and_kill =
      "mkfifo pipe; sleep 20 >pipe & sleeper=$!\n"
      "'" BATTEN_BINARY
      "' smooth - --target linuxcnc -o new.nc <pipe & work=$!\n"
      "sleep 0.5; kill -TERM $work; wait $work; code=$?; kill $sleeper; exit $code";
  expect_exit(folder_.shell("( " + wait_and_kill + " )"), 143);
  EXPECT_FALSE(folder_.has("new.nc"));
}

}  // namespace
}  // namespace batten
