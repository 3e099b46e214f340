// explain, completion, man: what the program says about itself, as shells and pagers take it.

#include <gtest/gtest.h>

#include <sstream>

#include "batten_process.h"
#include "postproc/cli/cli.h"
#include "postproc/cli/cli_table.h"
#include "postproc/options/options.h"

namespace batten {
namespace {

TEST(ExplainCommand, SaysWhatAKeptRunMeansAndWhatToDo) {
  const ProcessResult said = expect_exit(BattenFolder().batten("explain exact-stop"), 0);
  EXPECT_TRUE(contains(said.out, "G61")) << said.out;
  EXPECT_TRUE(contains(said.out, "--allow exact-stop")) << said.out;
  EXPECT_EQ(said.err, "");
}

TEST(ExplainCommand, IsAnOptionToo) {
  const BattenFolder folder;
  EXPECT_EQ(folder.batten("--explain no-gain").out, folder.batten("explain no-gain").out);
  EXPECT_EQ(folder.batten("--explain=no-gain").out, folder.batten("explain no-gain").out);
}

TEST(ExplainCommand, ListsAllWithoutAnId) {
  const ProcessResult said = expect_exit(BattenFolder().batten("explain"), 0);
  for (const char* id : {"exact-stop", "units-missing", "feed-moved"}) {
    EXPECT_TRUE(contains(said.out, id)) << id;
  }
}

TEST(ExplainCommand, SuggestsWhatWasMeant) {
  const ProcessResult said =
      expect_exit(BattenFolder().batten("explain exact-stpo"), 1, {"did you mean 'exact-stop'?"});
  EXPECT_EQ(said.out, "");
}

// --- options ------------------------------------------------------------------------------------

TEST(CommandTable, HasAReaderForEveryOption) {
  for (const postproc::CommandRow& command : postproc::command_rows()) {
    if (command.rows.empty()) continue;  // explain, completion, man
    postproc::Arguments in;
    (void)postproc::command_of(command.name, in);
    for (const postproc::OptionRow& row : command.rows) {
      EXPECT_TRUE(in.given.was_read(row.name)) << command.name << " --" << row.name;
    }
  }
}

// Help has these by hand; those of methods, forms and the like it takes from their tables.
TEST(CommandTable, NamesEveryChoice) {
  for (const postproc::OptionRow& row : postproc::option_rows("smooth")) {
    const auto expect_names = [&row](std::string_view option, const auto& choices) {
      if (row.name != option) return;
      std::string names;
      for (const auto& choice : choices) names += "|" + std::string(choice.name);
      EXPECT_EQ("|" + std::string(row.value), names);
    };
    expect_names("tolerance-kind", postproc::tolerance_kinds());
    expect_names("side", postproc::sides());
    expect_names("source", postproc::sources());
    expect_names("progress", postproc::progress_styles());
    expect_names("log-level", postproc::log_levels());
  }
}

// --- completion ---------------------------------------------------------------------------------

// What bash offers for the last of these words.
std::string offered(const std::string& words) {
  std::istringstream stream(words);
  int count = -1;
  for (std::string word; stream >> word;) ++count;
  const ProcessResult result = BattenFolder().shell(
      "batten completion bash > complete; bash -c 'source complete; COMP_WORDS=(" + words +
      "); COMP_CWORD=" + std::to_string(count) +
      "; _batten 2>/dev/null; printf \"%s \" \"${COMPREPLY[@]}\"'");
  return " " + result.out;
}

TEST(BashCompletion, OffersTheCommands) { EXPECT_EQ(offered("batten sm"), " smooth "); }

TEST(BashCompletion, OffersTheOptionsOfTheCommand) {
  EXPECT_EQ(offered("batten smooth --to"), " --tolerance --tolerance-kind ");
  EXPECT_EQ(offered("batten verify --th"), "  ");
}

TEST(BashCompletion, OffersTheNamesThatAnOptionTakes) {
  EXPECT_TRUE(contains(offered("batten smooth --target l"), " linuxcnc "));
  EXPECT_EQ(offered("batten smooth --prefer ti"), " time ");
  EXPECT_EQ(offered("batten smooth --allow e"), " exact-stop ");
}

TEST(BashCompletion, OffersFilesAndTheIdsThatCanBeExplained) {
  EXPECT_TRUE(contains(offered("batten smooth com"), " complete "));
  EXPECT_TRUE(contains(offered("batten explain feed-m"), " feed-moved "));
}

TEST(Completion, OfEitherShellNamesEveryCommandAndOption) {
  const BattenFolder folder;
  for (const char* shell : {"bash", "zsh"}) {
    const ProcessResult result = expect_exit(folder.batten(std::string("completion ") + shell), 0);
    for (const postproc::CommandRow& command : postproc::command_rows()) {
      EXPECT_TRUE(contains(result.out, std::string(command.name))) << command.name;
      for (const postproc::OptionRow& row : command.rows) {
        EXPECT_TRUE(contains(result.out, "--" + std::string(row.name))) << shell << row.name;
      }
    }
  }
}

TEST(Completion, OfAnotherShellIsRefused) {
  const BattenFolder folder;
  EXPECT_EQ(folder.batten("completion tcsh").exit_code, 1);
  EXPECT_EQ(folder.batten("completion").exit_code, 1);
}

TEST(ZshCompletion, IsReadByZsh) {
  const BattenFolder folder;
  if (folder.shell("command -v zsh").exit_code != 0) GTEST_SKIP() << "zsh is not installed";
  expect_exit(folder.shell("batten completion zsh > _batten && zsh -n _batten"), 0);
}

// --- man ----------------------------------------------------------------------------------------

TEST(ManPage, TellsOfEveryCommandAndOption) {
  const std::string page = BattenFolder().batten("man").out;
  EXPECT_TRUE(contains(page, ".TH BATTEN 1"));
  const auto roff = [](std::string_view text) {
    std::string safe;
    for (const char c : text) safe += c == '-' ? std::string("\\-") : std::string(1, c);
    return safe;
  };
  for (const postproc::CommandRow& command : postproc::command_rows()) {
    EXPECT_TRUE(contains(page, ".SS \\fBbatten " + roff(command.name))) << command.name;
    for (const postproc::OptionRow& row : command.rows) {
      EXPECT_TRUE(contains(page, "\\fB\\-\\-" + roff(row.name) + "\\fR")) << row.name;
    }
  }
}

TEST(ManPage, IsSetWithoutAWarning) {
  const BattenFolder folder;
  if (folder.shell("command -v groff").exit_code != 0) GTEST_SKIP() << "groff is not installed";
  const ProcessResult result =
      expect_exit(folder.shell("batten man | groff -man -Tascii -ww -P-cbou > page"), 0);
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(contains(folder.text_of("page"), "EXIT STATUS"));
}

}  // namespace
}  // namespace batten
