// What goes wrong around a program that is being smoothed: disks, folders, files that change,
// memory, odd files and names. The list is in docs/faults.md. Of every fault the same is asked:
//
//   the exit code is the documented one, and there is a message that says what it was;
//   the input has the bytes that it had, and no output is there unless it is whole;
//   nothing half written is left behind.
//
// Signals are in signals_test.cpp.
#include <gtest/gtest.h>

#include <filesystem>

#include "batten_process.h"
#include "tests/support/counts_memory.h"
#include "tests/support/places.h"
#include "tests/support/wavy_programs.h"

namespace batten {
namespace {

namespace fs = std::filesystem;

// A run that is rewritten.
std::string part_program() { return postproc::wave_program(); }

// $B is the program; `smooth_to FILE IN` smooths IN for LinuxCNC.
std::string script(const std::string& lines) {
  return "export B='" BATTEN_BINARY
         "'\nsmooth_to() { out=$1; shift; \"$B\" smooth \"$@\" --target linuxcnc --machine "
         "linuxcnc-fast -o \"$out\"; }\n" +
         lines;
}

// Mounts and other users are for root alone, and not in every container.
bool may_mount(const BattenFolder& folder) {
  return folder.shell("unshare -m mount -t tmpfs none /mnt").exit_code == 0;
}
bool may_be_somebody_else(const BattenFolder& folder) {
  return folder.shell("setpriv --reuid=65534 --regid=65534 --clear-groups true").exit_code == 0;
}

enum class Needs { kNothing, kMounts, kOtherUser };

struct Fault {
  const char* name;
  const char* lines;  // a script of the shell, in a folder with part.nc
  int exit_code;
  const char* message;  // a part of what is said
  bool writes = false;  // is new.nc there afterwards, with what an undisturbed run writes?
  Needs needs = Needs::kNothing;
};

class Faults : public testing::TestWithParam<Fault> {};

TEST_P(Faults, AreToldAndHarmNothing) {
  const Fault& fault = GetParam();
  const BattenFolder folder;
  if (fault.needs == Needs::kMounts && !may_mount(folder)) GTEST_SKIP() << "no mounts here";
  if (fault.needs == Needs::kOtherUser && !may_be_somebody_else(folder)) {
    GTEST_SKIP() << "no other user here";
  }
  folder.put("part.nc", part_program());
  const ProcessResult result = folder.shell("( " + script(fault.lines) + "\n)");
  EXPECT_EQ(result.exit_code, fault.exit_code) << result.err;
  EXPECT_TRUE(contains(result.err, fault.message)) << result.err;
  EXPECT_EQ(folder.text_of("part.nc"), part_program());
  EXPECT_TRUE(half_written_in(folder.file(".")).empty());
  EXPECT_EQ(folder.has("new.nc"), fault.writes);
  if (!fault.writes) return;
  ASSERT_EQ(folder.shell("( " + script("smooth_to whole.nc part.nc") + "\n)").exit_code, 0);
  EXPECT_EQ(folder.text_of("new.nc"), folder.text_of("whole.nc"));
}

// A tmpfs that is full to the last byte, with a program that was there before.
#define FULL_DISK                                                                                \
  "mkdir full; unshare -m sh -c 'mount -t tmpfs -o size=64k none full; cp part.nc full/old.nc; " \
  "cat /dev/zero >full/fill 2>.dd; "
#define KEEPS_OLD                                                                                  \
  "; code=$?; cmp part.nc full/old.nc || exit 90; [ $(ls -A full | wc -l) = 2 ] || exit 91; exit " \
  "$code'"

INSTANTIATE_TEST_SUITE_P(
    Cli, Faults,
    testing::Values(
        // --- where the output goes ---
        Fault{
            "FullDisk",
            FULL_DISK
            "$B smooth part.nc --target linuxcnc --machine linuxcnc-fast -o full/new.nc" KEEPS_OLD,
            4, "full/new.nc: cannot be written: No space left on device", false, Needs::kMounts},
        Fault{
            "FullDiskInPlace",
            FULL_DISK
            "$B smooth full/old.nc --target linuxcnc --machine linuxcnc-fast --in-place" KEEPS_OLD,
            4, "full/old.nc: cannot be written: No space left on device", false, Needs::kMounts},
        Fault{"FullDiskForTheReportAlone",
              FULL_DISK "$B smooth part.nc --target linuxcnc --machine linuxcnc-fast -o new.nc "
                        "--json full/report.json" KEEPS_OLD,
              4, "full/report.json: cannot be written: No space left", true, Needs::kMounts},
        Fault{"FullDiskForThePage",
              FULL_DISK "$B smooth part.nc --target linuxcnc --machine linuxcnc-fast -o new.nc "
                        "--report full/p.html" KEEPS_OLD,
              4, "full/p.html: cannot be written: No space left", true, Needs::kMounts},
        Fault{"FileLargerThanAllowed",
              "for i in 1 2 3 4 5 6 7 8 9; do for j in 1 2 3 4 5 6 7 8 9; do echo '(a comment "
              "of sixty-four bytes, to make a program somewhat longer)'; done; done "
              ">>long.nc; cat part.nc >>long.nc; ulimit -f 8; smooth_to new.nc long.nc",
              4, "new.nc: cannot be written: File too large"},
        Fault{"FullStandardOutput", "smooth_to - part.nc >/dev/full", 4,
              "<stdout>: cannot be written: No space left on device"},
        Fault{"FullStandardOutputOfATable", "\"$B\" targets >/dev/full", 4,
              "<stdout>: cannot be written: No space left on device"},
        Fault{"ReaderWhoWentAway",
              "{ until [ -e gone ]; do sleep 0.02; done; smooth_to - part.nc; echo $? >code; "
              "} | { exec <&-; : >gone; }; exit $(cat code)",
              4, "<stdout>: cannot be written: Broken pipe"},
        Fault{"ClosedStandardOutput", "smooth_to - part.nc >&-", 4, "<stdout>: cannot be written"},
        Fault{"ClosedStandardError", "smooth_to new.nc part.nc 2>&-", 0, "", true},
        Fault{"ClosedStandardInput", "smooth_to new.nc - <&-", 4, "<stdin>: cannot be read"},
        Fault{"ReadOnlyFileSystem",
              "mkdir ro; unshare -m sh -c 'mount -t tmpfs none ro; cp part.nc ro/old.nc; "
              "mount -o remount,ro ro; $B smooth ro/old.nc --target linuxcnc --machine "
              "linuxcnc-fast --in-place; "
              "code=$?; cmp part.nc ro/old.nc || exit 90; exit $code'",
              4, "ro/old.nc: cannot be written: ro: Read-only file system", false, Needs::kMounts},
        Fault{"ReadOnlyFolder",
              "ln \"$B\" program || cp \"$B\" program; chmod 755 . program; mkdir -m 755 ro; "
              "cp part.nc ro/old.nc; setpriv --reuid=65534 --regid=65534 --clear-groups "
              "./program smooth ro/old.nc --target linuxcnc --machine linuxcnc-fast -o ro/new.nc; "
              "code=$?; [ $(ls -A "
              "ro | wc -l) = 1 ] || exit 91; exit $code",
              4, "ro/new.nc: cannot be written: ro: Permission denied", false, Needs::kOtherUser},
        Fault{"OtherFileSystem",
              "mkdir far; unshare -m sh -c 'mount -t tmpfs none far; $B smooth part.nc "
              "--target linuxcnc --machine linuxcnc-fast -o far/new.nc; code=$?; [ $(ls -A far | "
              "wc -l) = 1 ] || exit "
              "91; cp far/new.nc .; exit $code'",
              0, "part.nc -> far/new.nc", true, Needs::kMounts},
        Fault{"NoSuchFolder", "smooth_to no/new.nc part.nc", 4,
              "no/new.nc: cannot be written: no: No such file or directory"},
        Fault{"OutputIsAFolder", "mkdir out; smooth_to out part.nc", 4, "out: cannot be written"},
        Fault{"OutputIsALinkToNothing", "ln -s new.nc link; smooth_to link part.nc", 0, "", true},
        Fault{"OutputIsALinkToItself", "ln -s link link; smooth_to link part.nc", 4,
              "link: cannot be written: Too many levels of symbolic links"},
        Fault{"OutputIsAPipe",
              "mkfifo pipe; cat pipe >new.nc & smooth_to pipe part.nc; code=$?; wait; exit "
              "$code",
              0, "", true},
        // --- what is read ---
        Fault{"InputIsAFolder", "mkdir in; smooth_to new.nc in", 4, "in: Is a directory"},
        Fault{"InputIsALink", "ln -s part.nc link; smooth_to new.nc link", 0, "", true},
        Fault{"InputIsALinkToNothing", "ln -s nothing link; smooth_to new.nc link", 4,
              "link: No such file or directory"},
        Fault{"InputIsAPipe",
              "mkfifo pipe; cat part.nc >pipe & smooth_to new.nc pipe; code=$?; wait; exit "
              "$code",
              0, "", true},
        Fault{"InputThatMayNotBeRead",
              "ln \"$B\" program || cp \"$B\" program; chmod 755 . program; cp part.nc "
              "mine.nc; chmod 600 mine.nc; setpriv --reuid=65534 --regid=65534 --clear-groups "
              "./program smooth mine.nc --target linuxcnc --machine linuxcnc-fast -o new.nc",
              4, "mine.nc: Permission denied", false, Needs::kOtherUser},
        Fault{"InputOfMoreThanPlacesCanCount",
              "truncate -s 5G huge.nc; smooth_to new.nc huge.nc; code=$?; rm huge.nc; exit $code",
              4, "huge.nc: larger than 4 GiB"},
        // --- a file that changes while it is read ---
        // `verify` has opened the old program when the pipe of the new one is opened.
        Fault{"InputCutShortWhileRead",
              "cp part.nc old.nc; mkfifo pipe; \"$B\" verify old.nc pipe & exec 3>pipe; : "
              ">old.nc; cat part.nc >&3; exec 3>&-; wait $!",
              4, "became shorter"},
        Fault{"InputLongerWhileRead",
              "cp part.nc old.nc; mkfifo pipe; \"$B\" verify old.nc pipe & exec 3>pipe; echo "
              "M2 >>old.nc; cat part.nc >&3; exec 3>&-; wait $!",
              4, "old.nc: was changed while it was read"},
        Fault{"InputOverwrittenWhileRead",
              "cp part.nc old.nc; touch -d 2001-01-01 old.nc; mkfifo pipe; \"$B\" verify "
              "old.nc pipe & exec 3>pipe; printf '%s' '(' | dd of=old.nc conv=notrunc 2>.dd; "
              "cat part.nc >&3; exec 3>&-; wait $!",
              4, "old.nc: was changed while it was read"},
        Fault{"InputRemovedWhileRead",
              "cp part.nc old.nc; mkfifo pipe; \"$B\" verify old.nc pipe & exec 3>pipe; rm "
              "old.nc; cat part.nc >&3; exec 3>&-; wait $!",
              0, "the same, byte for byte"},
        Fault{"InputReplacedWhileRead",
              "cp part.nc old.nc; mkfifo pipe; \"$B\" verify old.nc pipe & exec 3>pipe; echo "
              "M2 >x; mv x old.nc; cat part.nc >&3; exec 3>&-; wait $!",
              0, "the same, byte for byte"},
        // --- names ---
        Fault{"NamesWithBlanks", "cp part.nc ' a b '; smooth_to ' c d ' ' a b '; mv ' c d ' new.nc",
              0, " a b  ->  c d ", true},
        Fault{"NamesOfUtf8",
              "cp part.nc 'Gehäuse 部品.nc'; smooth_to 'größer.nc' 'Gehäuse 部品.nc'; mv "
              "größer.nc new.nc",
              0, "Gehäuse 部品.nc -> größer.nc", true},
        Fault{"NamesOfNoText",
              "n=$(printf 'p\\377\\376.nc'); cp part.nc \"$n\"; smooth_to new.nc \"$n\" "
              "--json r.json; python3 -c 'import json; json.load(open(\"r.json\", "
              "encoding=\"utf-8\"))'",
              0, "", true},
        Fault{"NamesLikeOptions", "cp part.nc ./-x.nc; smooth_to new.nc ./-x.nc", 0, "", true},
        Fault{"NamesAsLongAsNamesMayBe",
              "n=$(printf '%0251d' 7).nc; mkdir d; cp part.nc d/$n; \"$B\" smooth d/$n "
              "--target linuxcnc --machine linuxcnc-fast --in-place && mv d/$n new.nc && rmdir d",
              0, "", true},
        Fault{"NamesLongerThanNamesMayBe", "smooth_to $(printf '%0300d' 7) part.nc", 4,
              "File name too long"}),
    [](const auto& test) { return std::string(test.param.name); });

// --- odd programs --------------------------------------------------------------------------------

TEST(OddPrograms, OfNoBytesIsCopied) {
  const BattenFolder folder;
  folder.put("part.nc", "");
  expect_exit(folder.batten("smooth part.nc --target linuxcnc --machine linuxcnc-fast --units mm"),
              0);
  EXPECT_TRUE(folder.has("part.smooth.nc"));
  EXPECT_EQ(folder.text_of("part.smooth.nc"), "");
}

struct LongLine {
  const char* name;
  const char* begin;
  char character;  // so many million times
  int millions;
  const char* end;
};

class LongLines : public testing::TestWithParam<LongLine> {};

// In the middle of a program: neither read wrongly nor for long.
TEST_P(LongLines, AreCopiedAndTheRestIsSmoothed) {
  const LongLine& test = GetParam();
  const std::size_t size = std::size_t{1'000'000} * static_cast<std::size_t>(test.millions);
  const std::string line =
      "\n" + (test.begin + std::string(size, test.character)) + test.end + "\n";
  const BattenFolder folder;
  folder.put("part.nc", part_program() + line + part_program());
  expect_exit(folder.batten("smooth part.nc --target linuxcnc --machine linuxcnc-fast -o new.nc"),
              0);
  const std::string text = folder.text_of("new.nc");
  const std::size_t at = text.find(line);
  ASSERT_NE(at, std::string::npos);
  EXPECT_LT(at, part_program().size() - 1) << "the run before it was rewritten";
  EXPECT_LT(text.size(), 2 * part_program().size() + line.size());
}

INSTANTIATE_TEST_SUITE_P(Cli, LongLines,
                         testing::Values(LongLine{"OfAComment", "(", 'c', 64, ")"},
                                         LongLine{"OfLetters", "", 'X', 8, ""},
                                         LongLine{"OfDigits", "X", '1', 8, ""},
                                         LongLine{"OfBrackets", "X", '[', 8, ""},
                                         LongLine{"OfBracketsOfComments", "", '(', 8, ""},
                                         LongLine{"OfParameters", "X", '#', 8, ""},
                                         LongLine{"OfBlanks", "X1", ' ', 8, "Y1"}),
                         [](const auto& test) { return std::string(test.param.name); });

// --- memory -------------------------------------------------------------------------------------

// With less and less room for addresses: whole, or a message and nothing.
TEST(Memory, ThatIsMissingIsToldAndNothingIsWritten) {
  if (!kCountsMemory) GTEST_SKIP() << "not under this sanitizer";
  const BattenFolder folder;
  const std::string text = postproc::wave_program({.lines = 2000});
  folder.put("part.nc", text);
  ASSERT_EQ(folder.shell("( " + script("smooth_to whole.nc part.nc") + "\n)").exit_code, 0);
  const std::string whole = folder.text_of("whole.nc");
  int refused = 0;
  int done = 0;
  for (int megabytes = 10; megabytes <= 400 && done == 0; megabytes += 1 + megabytes / 20) {
    SCOPED_TRACE(testing::Message() << megabytes << " MB");
    const std::string limit = "ulimit -v " + std::to_string(1024 * megabytes) + "; ";
    // With less than this the system cannot load the program at all.
    if (folder.shell(limit + "'" BATTEN_BINARY "' --version").exit_code != 0) continue;
    const ProcessResult result = folder.shell(
        "( " + script(limit + "smooth_to new.nc part.nc --json r.json --report r.html") + "\n)");
    EXPECT_EQ(folder.text_of("part.nc"), text);
    EXPECT_TRUE(half_written_in(folder.file(".")).empty());
    if (result.exit_code == 0) {
      ++done;
      EXPECT_EQ(folder.text_of("new.nc"), whole);
      continue;
    }
    ++refused;
    EXPECT_TRUE(result.exit_code == 4 || result.exit_code == 5) << result.exit_code << result.err;
    EXPECT_TRUE(contains(result.err, "batten: ") && contains(result.err, "emory")) << result.err;
    EXPECT_FALSE(folder.has("new.nc"));
    EXPECT_FALSE(folder.has("r.json"));
    const std::string told =
        folder
            .shell("( " + script(limit + "smooth_to new.nc part.nc --json - --report r.html") +
                   "\n)")
            .out;
    EXPECT_TRUE(contains(told, "batten-report/1") && contains(told, "\"messages\": [")) << told;
  }
  EXPECT_GT(refused, 0);
  EXPECT_EQ(done, 1);
}

}  // namespace
}  // namespace batten
