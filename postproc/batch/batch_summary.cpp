#include "postproc/batch/batch_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <nlohmann/json.hpp>

#include "postproc/batch/program_tree.h"
#include "postproc/system/terminal_colour.h"
#include "postproc/text/words.h"

namespace batten::postproc {

namespace {

// By ProgramStatus.
constexpr std::array<std::string_view, kStatuses> kNames = {
    "smoothed", "unchanged", "not understood", "not proved", "failed", "not done"};

// What a record says besides whose it is and its status.
template <typename Record, typename Take>
void each_field(Record& record, const Take& take) {
  take("exit_code", record.exit_code);
  take("message", record.message);
  take("kept_for", record.kept_for);
  take("input_sha256", record.input_sha256);
  take("settings_sha256", record.settings_sha256);
  take("output_sha256", record.output_sha256);
  take("report_sha256", record.report_sha256);
  take("page_sha256", record.page_sha256);
  take("runs_rewritten", record.runs_rewritten);
  take("runs_kept", record.runs_kept);
  take("deviation_line", record.deviation_line);
  each_figure(record, take);
  take("picture_rewritten", record.picture.rewritten);
  take("picture_kept", record.picture.kept);
}

bool is_written(ProgramStatus status) {
  return status == ProgramStatus::kSmoothed || status == ProgramStatus::kUnchanged;
}

std::string counts_line(const BatchTotals& totals) {
  std::string text = plural(totals.programs, "program") + ":";
  for (std::size_t i = 0; i < kStatuses; ++i) {
    const auto status = static_cast<ProgramStatus>(i);
    if (totals.with_status[i] == 0 && !is_written(status)) continue;
    text += fmt::format("{} {} {}", i == 0 ? "" : ",", totals.with_status[i], name_of(status));
  }
  return text + "\n";
}

// A field of RFC 4180.
std::string csv_field(std::string_view text) {
  if (text.find_first_of("\",\r\n") == std::string_view::npos) return std::string(text);
  return "\"" + escaped(text, {{'"', "\"\""}}) + "\"";
}

Json json_of(const BatchTotals& totals) {
  Json json = {{"programs", totals.programs}};
  for (std::size_t i = 0; i < kStatuses; ++i) {
    std::string name(name_of(static_cast<ProgramStatus>(i)));
    std::ranges::replace(name, ' ', '_');
    json[name] = totals.with_status[i];
  }
  each_figure(totals, [&](const char* name, const auto& value) { json[name] = value; });
  json["exit_code"] = totals.exit_code;
  return json;
}

// --- SHA-256 ---

// Names and numbers of sections are those of FIPS 180-4.

using Word = std::uint32_t;
using HashValue = std::array<Word, 8>;

constexpr std::size_t kBlockBytes = 64;

// Section 4.2.2: the first 32 bits behind the point of the cube roots of the first 64 primes.
constexpr std::array<Word, 64> kConstants = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

// Section 5.3.3: the same of the square roots of the first 8 primes.
constexpr HashValue kInitial = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};

// Section 6.2.2, step 1: the message schedule W.
std::array<Word, 64> schedule_of(std::string_view block) {
  std::array<Word, 64> w{};
  for (std::size_t t = 0; t < 16; ++t) {
    for (std::size_t i = 0; i < 4; ++i) {
      w[t] = (w[t] << 8) | static_cast<std::uint8_t>(block[4 * t + i]);
    }
  }
  for (std::size_t t = 16; t < 64; ++t) {
    const Word s0 = std::rotr(w[t - 15], 7) ^ std::rotr(w[t - 15], 18) ^ (w[t - 15] >> 3);
    const Word s1 = std::rotr(w[t - 2], 17) ^ std::rotr(w[t - 2], 19) ^ (w[t - 2] >> 10);
    w[t] = s1 + w[t - 7] + s0 + w[t - 16];
  }
  return w;
}

// Steps 2 to 4. The working variables a .. h stand in `v` in this order.
void take_block(std::string_view block, HashValue& hash) {
  const std::array<Word, 64> w = schedule_of(block);
  HashValue v = hash;
  for (std::size_t t = 0; t < 64; ++t) {
    const auto [a, b, c, d, e, f, g, h] = v;
    const Word sum1 = std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25);
    const Word choice = (e & f) ^ (~e & g);
    const Word t1 = h + sum1 + choice + kConstants[t] + w[t];
    const Word sum0 = std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22);
    const Word majority = (a & b) ^ (a & c) ^ (b & c);
    v = {t1 + sum0 + majority, a, b, c, d + t1, e, f, g};
  }
  for (std::size_t i = 0; i < hash.size(); ++i) hash[i] += v[i];
}

// Section 5.1.1: what is left behind the whole blocks, a bit 1, zeros, and the length in bits.
std::string padded_end(std::string_view rest, std::size_t all_bytes) {
  std::string end(rest);
  end += static_cast<char>(0x80);
  while (end.size() % kBlockBytes != kBlockBytes - 8) end += '\0';
  const std::uint64_t bits = std::uint64_t{all_bytes} * 8;
  for (int shift = 56; shift >= 0; shift -= 8) {
    end += static_cast<char>(static_cast<std::uint8_t>(bits >> shift));
  }
  return end;
}

void take_blocks(std::string_view bytes, HashValue& hash) {
  for (; bytes.size() >= kBlockBytes; bytes.remove_prefix(kBlockBytes)) {
    take_block(bytes.substr(0, kBlockBytes), hash);
  }
}

}  // namespace

std::string_view name_of(ProgramStatus status) {
  return kNames.at(static_cast<std::size_t>(status));
}

Json json_of_record(const ProgramRecord& record) {
  Json json = {{"program", record.program}, {"status", name_of(record.status)}};
  each_field(record, [&](const char* name, const auto& value) { json[name] = value; });
  return json;
}

std::string record_text(const ProgramRecord& record) { return json_text(json_of_record(record)); }

std::optional<ProgramRecord> read_record(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    const auto status = std::ranges::find(kNames, json.at("status").get<std::string>());
    if (status == kNames.end()) return std::nullopt;
    ProgramRecord record;
    record.status = static_cast<ProgramStatus>(status - kNames.begin());
    json.at("program").get_to(record.program);
    each_field(record, [&](const char* name, auto& place) { json.at(name).get_to(place); });
    return record;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

ProgramPlaces places_of(const std::filesystem::path& output_tree, const std::string& program) {
  const std::filesystem::path batch = output_tree / kBatchFolder;
  return {.output = output_tree / program,
          .report = batch / "reports" / (program + ".json"),
          .page = batch / "reports" / (program + ".html"),
          .record = batch / "manifest" / (program + ".json")};
}

BatchTotals totals_of(std::span<const ProgramRecord> records) {
  BatchTotals totals;
  totals.programs = records.size();
  for (const ProgramRecord& record : records) {
    ++totals.with_status[static_cast<std::size_t>(record.status)];
    totals.exit_code = std::max(totals.exit_code, record.exit_code);
    if (!is_written(record.status)) continue;
    totals.bytes_in += record.bytes_in;
    totals.bytes_out += record.bytes_out;
    totals.blocks_in += record.blocks_in;
    totals.blocks_out += record.blocks_out;
    totals.time_before += record.time_before;
    totals.time_after += record.time_after;
    totals.path_before += record.path_before;
    totals.path_after += record.path_after;
    totals.deviation_mm = std::max(totals.deviation_mm, record.deviation_mm);
  }
  return totals;
}

constexpr std::string_view kTableRow =
    "{:<{}}  {:<14}  {:>18}  {:>22}  {:>22}  {:>16}  {:>14}  {:>12}  {:>9}  {}\n";

std::string arrow(double before, double after, int digits) {
  return fmt::format("{:.{}f} -> {:.{}f}", before, digits, after, digits);
}

std::string summary_table(std::span<const ProgramRecord> records) {
  std::size_t width = std::string_view("program").size();
  for (const ProgramRecord& record : records) width = std::max(width, record.program.size());
  std::string text = fmt::format(kTableRow, "program", width, "status", "blocks", "bytes", "time s",
                                 "distance mm", "roughness", "slow %", "within mm", "kept for");
  const auto add_row = [&](std::string_view name, std::string_view status,
                           const ProgramFigures& row, std::string_view kept_for) {
    const PathFigures& old = row.path_before;
    const bool tried = old.length_mm > 0;  // any run
    text += fmt::format(
        kTableRow, name, width, status, arrow(double(row.blocks_in), double(row.blocks_out), 0),
        arrow(double(row.bytes_in), double(row.bytes_out), 0),
        arrow(row.time_before.seconds, row.time_after.seconds, 2),
        tried ? arrow(old.distance_mm, row.path_after.distance_mm, 4) : "-",
        tried ? arrow(old.roughness, row.path_after.roughness, 3) : "-",
        arrow(100 * row.time_before.slow_share(), 100 * row.time_after.slow_share(), 1),
        fmt::format("{:.4f}", row.deviation_mm), kept_for.empty() ? "-" : kept_for);
  };
  for (const ProgramRecord& record : records) {
    if (is_written(record.status)) {
      add_row(record.program, name_of(record.status), record, record.kept_for);
    } else {
      fmt::format_to(std::back_inserter(text), "{:<{}}  {:<14}  {}\n", record.program, width,
                     name_of(record.status), record.message);
    }
  }
  const BatchTotals totals = totals_of(records);
  add_row("all", "", totals, "");
  return text + counts_line(totals);
}

std::string summary_csv(std::span<const ProgramRecord> records) {
  std::string text =
      "program,status,exit_code,blocks_in,blocks_out,bytes_in,bytes_out,runs_rewritten,runs_kept,"
      "time_before_s,time_after_s,distance_before_mm,distance_after_mm,roughness_before,"
      "roughness_after,slow_share_before,slow_share_after,deviation_mm,deviation_line,input_sha256,"
      "output_sha256,kept_for,message\n";
  for (const ProgramRecord& r : records) {
    fmt::format_to(std::back_inserter(text),
                   "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                   csv_field(r.program), name_of(r.status), r.exit_code, r.blocks_in, r.blocks_out,
                   r.bytes_in, r.bytes_out, r.runs_rewritten, r.runs_kept, r.time_before.seconds,
                   r.time_after.seconds, r.path_before.distance_mm, r.path_after.distance_mm,
                   r.path_before.roughness, r.path_after.roughness, r.time_before.slow_share(),
                   r.time_after.slow_share(), r.deviation_mm, r.deviation_line, r.input_sha256,
                   r.output_sha256, csv_field(r.kept_for), csv_field(r.message));
  }
  return text;
}

std::string summary_json(std::span<const ProgramRecord> records) {
  const auto without_picture = [](const ProgramRecord& record) {
    Json json = json_of_record(record);
    json.erase("picture_rewritten");
    json.erase("picture_kept");
    return json;
  };
  return json_text(as_report("batch", {{"totals", json_of(totals_of(records))},
                                       {"programs", json_list(records, without_picture)}}));
}

std::string progress_line(const BatchCount& count) {
  constexpr std::size_t kBarWidth = 20;  // characters, so that the line fits into 80
  const std::size_t full =
      count.programs > 0 ? kBarWidth * count.programs_over / count.programs : kBarWidth;
  std::string line = fmt::format("[{:#<{}}{:->{}}]  {} of {} programs", "", full, "",
                                 kBarWidth - full, count.programs_over, count.programs);
  if (count.bytes_over == 0 || !(count.seconds > 0)) return line;
  const double rate = static_cast<double>(count.bytes_over) / count.seconds;
  line += "  " + rate_text(rate);
  if (count.bytes > count.bytes_over) {
    line += fmt::format("  about {} left",
                        rough_time(static_cast<double>(count.bytes - count.bytes_over) / rate));
  }
  return line;
}

std::string sha256(std::string_view bytes) {
  HashValue hash = kInitial;
  take_blocks(bytes, hash);
  take_blocks(padded_end(bytes.substr(bytes.size() / kBlockBytes * kBlockBytes), bytes.size()),
              hash);
  std::string digits;
  for (const Word word : hash) digits += fmt::format("{:08x}", word);
  return digits;
}

}  // namespace batten::postproc
