// Records and tables of a batch say the same, and nothing of how it was run.

#include "postproc/batch/batch_summary.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "postproc/batch/batch_run.h"
#include "postproc/system/terminal_colour.h"

namespace batten::postproc {
namespace {

ProgramRecord smoothed(const std::string& program) {
  ProgramRecord record;
  record.program = program;
  record.status = ProgramStatus::kSmoothed;
  record.input_sha256 = "aa";
  record.settings_sha256 = "bb";
  record.output_sha256 = "cc";
  record.report_sha256 = "dd";
  record.bytes_in = 1000;
  record.bytes_out = 400;
  record.blocks_in = 100;
  record.blocks_out = 30;
  record.runs_rewritten = 2;
  record.runs_kept = 1;
  record.time_before = {3.5, 3, 1.5};
  record.time_after = {2.25, 2, 0.5};
  record.path_before = {10, 0.005, 0.25};
  record.path_after = {10, 0.002, 0.125};
  record.deviation_mm = 0.0098;
  record.deviation_line = 42;
  record.picture = {.rewritten = "M6 6L90 40", .kept = "M0 0L6 6"};
  record.kept_for = "40 % expression, line 7";
  return record;
}

ProgramRecord refused(const std::string& program) {
  ProgramRecord record;
  record.program = program;
  record.status = ProgramStatus::kNotUnderstood;
  record.exit_code = 2;
  record.message = program + ":1:1: error: \"quoted\", and a comma";
  return record;
}

TEST(BatchRecord, ReadsBackTheSame) {
  for (const ProgramRecord& record : {smoothed("a/b.nc"), refused("c.nc")}) {
    const std::string text = record_text(record);
    const auto again = read_record(text);
    ASSERT_TRUE(again.has_value()) << text;
    EXPECT_EQ(record_text(*again), text);
    EXPECT_EQ(again->program, record.program);
    EXPECT_EQ(again->status, record.status);
    EXPECT_EQ(again->exit_code, record.exit_code);
    EXPECT_EQ(again->deviation_mm, record.deviation_mm);
    EXPECT_EQ(again->kept_for, record.kept_for);
  }
}

TEST(BatchRecord, SaysAllOfAProgram) {
  EXPECT_EQ(nlohmann::json::parse(record_text(smoothed("a/b.nc"))), nlohmann::json::parse(R"({
    "program": "a/b.nc", "status": "smoothed", "exit_code": 0, "message": "",
    "kept_for": "40 % expression, line 7",
    "input_sha256": "aa", "settings_sha256": "bb", "output_sha256": "cc", "report_sha256": "dd",
    "page_sha256": "", "deviation_line": 42,
    "bytes_in": 1000, "bytes_out": 400, "blocks_in": 100, "blocks_out": 30,
    "runs_rewritten": 2, "runs_kept": 1,
    "time_before_s": 3.5, "time_after_s": 2.25, "cutting_before_s": 3, "cutting_after_s": 2,
    "slow_before_s": 1.5, "slow_after_s": 0.5,
    "length_before_mm": 10, "length_after_mm": 10, "distance_before_mm": 0.005,
    "distance_after_mm": 0.002, "roughness_before": 0.25, "roughness_after": 0.125,
    "deviation_mm": 0.0098, "picture_rewritten": "M6 6L90 40", "picture_kept": "M0 0L6 6"})"));
}

TEST(BatchRecord, OfOtherTextIsNone) {
  const std::string text = record_text(smoothed("a.nc"));
  EXPECT_FALSE(read_record("").has_value());
  EXPECT_FALSE(read_record(text.substr(0, text.size() / 2)).has_value());
  EXPECT_FALSE(read_record("{}").has_value());
  EXPECT_FALSE(read_record("[1, 2]").has_value());
  std::string other_status = text;
  other_status.replace(other_status.find("smoothed"), 8, "polished");
  EXPECT_FALSE(read_record(other_status).has_value());
  std::string other_kind = text;
  other_kind.replace(other_kind.find("1000"), 4, "\"x\" ");
  EXPECT_FALSE(read_record(other_kind).has_value());
}

TEST(BatchTotals, CountWhatWasWrittenAndTheWorstExitCode) {
  ProgramRecord unchanged = smoothed("u.nc");
  unchanged.status = ProgramStatus::kUnchanged;
  unchanged.deviation_mm = 0;
  ProgramRecord failed = smoothed("f.nc");
  failed.status = ProgramStatus::kFailed;
  failed.exit_code = 4;
  const std::vector<ProgramRecord> records = {smoothed("a.nc"), refused("b.nc"), failed, unchanged};
  const BatchTotals totals = totals_of(records);
  EXPECT_EQ(totals.programs, 4u);
  EXPECT_EQ(totals.with_status, (std::array<std::size_t, kStatuses>{1, 1, 1, 0, 1, 0}));
  EXPECT_EQ(totals.blocks_in, 200u);
  EXPECT_EQ(totals.blocks_out, 60u);
  EXPECT_EQ(totals.time_after.seconds, 4.5);
  EXPECT_EQ(totals.time_after.slow_share(), 0.25);
  EXPECT_EQ(totals.path_before.roughness, 0.25);
  EXPECT_EQ(totals.deviation_mm, 0.0098);
  EXPECT_EQ(totals.exit_code, 4);
  EXPECT_EQ(totals_of({}).exit_code, 0);
}

TEST(BatchSummary, SaysTheSameInAllItsForms) {
  const std::vector<ProgramRecord> records = {smoothed("a/b.nc"), refused("c.nc")};
  const std::string table = summary_table(records);
  EXPECT_NE(table.find("a/b.nc   smoothed"), std::string::npos) << table;
  EXPECT_NE(table.find("100 -> 30"), std::string::npos) << table;
  EXPECT_NE(table.find("3.50 -> 2.25  0.0050 -> 0.0020  0.250 -> 0.125  50.0 -> 25.0     0.0098"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find(records[1].message), std::string::npos) << table;
  EXPECT_NE(table.find("2 programs: 1 smoothed, 0 unchanged, 1 not understood\n"),
            std::string::npos)
      << table;
  const auto json = nlohmann::json::parse(summary_json(records));
  EXPECT_EQ(json["programs"].size(), 2u);
  EXPECT_EQ(json["programs"][0]["blocks_out"], 30);
  EXPECT_EQ(json["totals"]["exit_code"], 2);
  EXPECT_EQ(json["totals"]["time_before_s"], 3.5);
  EXPECT_FALSE(json["programs"][0].contains("picture_kept")) << "pictures are for the page";
}

// Written by hand from RFC 4180: fields with quotes, commas or line ends stand in quotes, quotes
// inside are doubled.
TEST(BatchSummary, QuotesWhatCsvNeedsQuoted) {
  const std::string csv =
      summary_csv(std::vector<ProgramRecord>{smoothed("a.nc"), refused("c.nc")});
  EXPECT_NE(csv.find("\na.nc,smoothed,0,100,30,1000,400,2,1,3.5,2.25,0.005,0.002,0.25,0.125,0.5,0."
                     "25,0.0098,42,aa,cc,\"40 % expression, line 7\",\n"),
            std::string::npos)
      << csv;
  EXPECT_NE(csv.find("\"c.nc:1:1: error: \"\"quoted\"\", and a comma\"\n"), std::string::npos)
      << csv;
}

TEST(BatchProgress, TellsRateAndTimeLeftFromWhatWasSmoothed) {
  EXPECT_EQ(progress_line({.programs = 40, .programs_over = 10, .bytes = 1000, .seconds = 3}),
            "[#####---------------]  10 of 40 programs");
  // 600,000 of 3,000,000 bytes in 2 s: 300 kB/s, 8 s for the rest.
  EXPECT_EQ(progress_line({.programs = 40,
                           .programs_over = 20,
                           .bytes = 3'000'000,
                           .bytes_over = 600'000,
                           .seconds = 2}),
            "[##########----------]  20 of 40 programs  300 kB/s  about 8 s left");
  EXPECT_EQ(progress_line({.programs = 2,
                           .programs_over = 2,
                           .bytes = 4'000'000,
                           .bytes_over = 4'000'000,
                           .seconds = 2}),
            "[####################]  2 of 2 programs  2.0 MB/s");
  EXPECT_EQ(rough_time(61), "2 min");
  EXPECT_EQ(rough_time(2 * 3600 + 61), "2 h 02 min");
}

TEST(HalfWrittenFiles, AreKnownByTheirNames) {
  EXPECT_EQ(intended_name(".part.nc.4711.batten-part"), "part.nc");
  EXPECT_EQ(intended_name("..x.1.batten-part"), ".x");
  for (const char* other : {"part.nc", ".part.nc.batten-part", "part.nc.1.batten-part",
                            ".1.batten-part", ".part.nc..batten-part", ".batten-part"}) {
    EXPECT_FALSE(intended_name(other).has_value()) << other;
  }
}

// SHA-256 against the examples that NIST publishes for it.
TEST(ContentHash, IsThatOfThePublishedExamples) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

// The padding takes one block more from 56 bytes after the last whole block on.
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
