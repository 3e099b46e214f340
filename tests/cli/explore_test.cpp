// `batten explore` as a user's shell sees it.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "batten_process.h"

namespace batten {
namespace {

using Json = nlohmann::json;

TEST(ExploreCommand, ItsCommandGivesTheFiguresThatItShows) {
  const BattenFolder folder;
  folder.put("a wave.nc", wave_program());
  const std::string options = " --target linuxcnc --units mm --keep-corners 80 --threads 1";
  const ProcessResult shown = expect_exit(folder.batten("explore 'a wave.nc'" + options), 0);
  const std::size_t at = shown.out.find("  batten smooth");
  ASSERT_NE(at, std::string::npos) << shown.out;
  const Json json = Json::parse(folder.batten("explore 'a wave.nc' --json -" + options).out);
  const Json& row = json["settings"][json["recommended"].get<std::size_t>()];
  EXPECT_TRUE(row["proved"].get<bool>());
  std::string command = shown.out.substr(at);
  command.pop_back();
  expect_exit(folder.shell(command + " --json smooth.json"), 0);
  const Json smooth = Json::parse(folder.text_of("smooth.json"));
  EXPECT_NEAR(row["after"]["time_s"].get<double>(), smooth["time_after_s"].get<double>(), 1e-9);
  EXPECT_EQ(row["after"]["blocks"].get<double>(), smooth["output"]["blocks"].get<double>());
  EXPECT_EQ(row["after"]["distance_mm"], smooth["path_after"]["distance_mm"]);
  EXPECT_EQ(row["after"]["roughness"], smooth["path_after"]["roughness"]);
}

TEST(ExploreCommand, HasALineForEachSettingAndWritesNothing) {
  const BattenFolder folder;
  folder.put("wave.nc", wave_program());
  const auto shown = expect_exit(
      folder.batten("explore wave.nc --target grbl --tolerance 0.01,0.0008in --prefer time"), 0);
  for (const char* line : {" 0.01    auto   time", " 0.01    arcs   time", " 0.01    lines  time",
                           " 0.02032 auto   time", "as it is", "400 %"}) {
    EXPECT_TRUE(contains(shown.out, line)) << line << "\n" << shown.out;
  }
  EXPECT_FALSE(contains(shown.out, "curves"));
  for (const auto& [target, says] : {std::pair("linuxcnc", true), {"siemens", false}}) {
    const auto other = expect_exit(
        folder.batten(fmt::format("explore wave.nc --target {} --tolerance 0.01", target)), 0);
    EXPECT_EQ(contains(other.out, "--output curves explores it"), says) << target;
  }
  EXPECT_FALSE(folder.has("wave.smooth.nc"));
  const Json json =
      Json::parse(folder.batten("explore wave.nc --target linuxcnc --output curves --json -").out);
  EXPECT_EQ(json["settings"].size(), 12u);
}

TEST(ExploreCommand, ReportsWhatIsWrongAsOtherCommandsDo) {
  const BattenFolder folder;
  folder.put("wave.nc", "G91.7\n" + wave_program());
  folder.put("no_units.nc", "G90\nG1 X1 F100\nX2 Y1\n");
  for (const WrongUsage& row :
       {WrongUsage{"Tolerance", "wave.nc --target grbl --tolerance 0.01,x", "'x', expected"},
        WrongUsage{"Form", "wave.nc --target grbl --output curves", "grbl reads no curves"},
        WrongUsage{"Target", "wave.nc", "--target: for which control is wave.nc?"},
        WrongUsage{"Written", "wave.nc --target grbl --json wave.nc", "wave.nc itself"},
        WrongUsage{"File", "--target grbl", "no file given"}}) {
    SCOPED_TRACE(row.name);
    expect_exit(folder.batten(std::string("explore ") + row.arguments), 1, {row.message});
  }
  expect_exit(folder.batten("explore none.nc --target grbl"), 4, {"none.nc"});
  const auto refused = expect_exit(folder.batten("explore no_units.nc --target grbl --json -"), 2,
                                   {"no_units.nc:", "units-missing", "nothing was written"});
  EXPECT_TRUE(Json::parse(refused.out)["settings"].empty());
}

}  // namespace
}  // namespace batten
