// Batten as a library: read a CNC program, smooth it within a tolerance, prove that two programs do
// the same, predict how long a machine needs for one.
//
//   find_package(batten REQUIRED)
//   target_link_libraries(my_program PRIVATE batten::batten)
//
// Text in, plain values out: no files are touched but a machine file that is named, nothing is
// printed, there is no state between calls, and any function may be called from several threads at
// once. Lengths are millimetres, feeds mm/min, times seconds; lines and columns count from 1.
//
// The promises are those of the program `batten`: what is not understood is copied byte for byte,
// what is rewritten is proved on the written text, and the same input and options give the same
// bytes. Within one minor version functions and fields are only added.
//
// Wrong options and calls throw std::invalid_argument with every problem, one to a line. What is
// wrong with a program is never thrown: it is in the result.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace batten {

// "0.1.0"
[[nodiscard]] std::string version();

// Names that Options::target and Options::machine can have.
[[nodiscard]] std::vector<std::string> target_names();
[[nodiscard]] std::vector<std::string> machine_names();

// What a program without G20 and G21 means.
enum class ProgramUnits { kAsWritten, kMillimetre, kInch };

enum class Severity { kNote, kWarning, kError };

// Something that was found in a program. `id` is stable and explained in docs/diagnostics.md.
struct Message {
  Severity severity = Severity::kError;
  std::string id;
  std::uint32_t line = 0;
  std::uint32_t column = 0;  // in bytes
  std::string text;
};

// --- read --------------------------------------------------------------------------------------

// A chain of moves, or blocks that are copied.
struct ProgramPart {
  std::uint32_t first_line = 0;
  std::uint32_t last_line = 0;
  std::size_t cutting_moves = 0;
  std::string kept_because;  // the reason's id; empty: it may be smoothed
};

struct ReadResult {
  bool understood = false;  // nothing is rewritten otherwise
  std::size_t blocks = 0;
  std::vector<ProgramPart> parts;  // in order, every line in one of them
  std::vector<Message> messages;
};

// `source`: for which control it was written: auto, ngc, fanuc, haas, grbl, siemens, heidenhain.
[[nodiscard]] ReadResult read(std::string_view program,
                              ProgramUnits units = ProgramUnits::kAsWritten,
                              std::string_view source = "auto");

// --- smooth ------------------------------------------------------------------------------------

// As the options of `batten smooth`, by the same names.
struct Options {
  std::string target;          // required, see target_names
  std::string machine;         // see machine_names, or a file ending in .toml; empty: the target's
  double tolerance_mm = 0.01;  // the full distance allowed, both ways and in order
  bool one_tolerance = false;  // also where the program says less for a part of it
  bool band_reading = false;   // --tolerance-kind band
  std::string method = "best";
  std::string output = "auto";
  std::string prefer = "time";
  std::string linearize;  // empty: what serves `prefer`
  std::optional<double> keep_corners_deg;
  std::vector<std::string> allow;
  std::vector<std::string> words;  // what words of your own do, as --word: "M501 = keeps state"
  bool keep_expressions = false;   // blocks whose numbers are expressions of variables stay
  ProgramUnits units = ProgramUnits::kAsWritten;
  std::string source = "auto";
  // What X5 means on controls like FANUC: auto, explicit, implied, implied:0.0001 .. as --decimals.
  std::string decimals = "auto";
  int threads = 0;  // 0: all cores; the result is the same for any number
};

struct SmoothedPart {
  std::uint32_t first_line = 0;  // of the old program
  std::uint32_t last_line = 0;
  bool rewritten = false;
  std::string kept_because;  // the reason's id; empty where it was rewritten
  std::string method;        // empty where it was kept
  std::size_t blocks_before = 0;
  std::size_t blocks_after = 0;
  double deviation_mm = 0;  // proved bound
  double seconds_before = 0;
  double seconds_after = 0;
};

struct SmoothedProgram {
  bool understood = false;
  // Of the whole text. Where it is false, the program must not be used: `text` is then what could
  // not be proved.
  bool proved = false;
  std::string text;           // the bytes of the input where nothing was rewritten
  double deviation_mm = 0;    // greatest proved bound
  double seconds_before = 0;  // predicted, of the whole program as by time()
  double seconds_after = 0;
  std::size_t blocks_before = 0;
  std::size_t blocks_after = 0;
  std::vector<SmoothedPart> parts;
  std::vector<Message> messages;
};

[[nodiscard]] SmoothedProgram smooth(std::string_view program, const Options& options);

// --- verify ------------------------------------------------------------------------------------

// One place where the new program does something else. `id` as in docs/diagnostics.md.
struct Difference {
  std::string id;
  std::uint32_t old_line = 0;  // 0: none
  std::uint32_t new_line = 0;
  std::string text;
};

struct Proof {
  bool proved = false;
  double deviation_mm = 0;              // greatest proved bound
  std::uint32_t deviation_line = 0;     // of the old program
  std::vector<Difference> differences;  // none where it is proved
  std::vector<Message> messages;        // errors of either program: nothing can be proved then
};

// Does the new program do what the old one did, with paths no further apart than the tolerance,
// both ways and in order? `target` (see target_names): the control whose curve words (G06.2, POLY,
// G5) are read in both; empty: none are. Parts for which the old program says less must keep that,
// unless `one_tolerance` says that the tolerance counts for all.
[[nodiscard]] Proof verify(std::string_view old_program, std::string_view new_program,
                           double tolerance_mm, ProgramUnits units = ProgramUnits::kAsWritten,
                           std::string_view target = {}, std::string_view source = "auto",
                           std::string_view decimals = "auto", bool one_tolerance = false);

// --- time --------------------------------------------------------------------------------------

struct TimeOptions {
  // Required: see machine_names, or a file ending in .toml, or the .ini of a LinuxCNC machine.
  std::string machine;
  // See target_names: what G4 P means, and whose curve words are read; empty: as the machine's
  // control has it, and none.
  std::string target;
  ProgramUnits units = ProgramUnits::kAsWritten;
  std::string source = "auto";
  std::string decimals = "auto";  // as Options::decimals
};

// What the time leaves out or had to assume. `id` as in `batten time`.
struct NotTimed {
  std::string id;
  std::uint32_t first_line = 0;
  std::size_t count = 0;
  std::string text;
};

// Seconds that the machine is predicted to need. The parts sum to the whole.
struct ProgramTime {
  bool understood = false;  // no time otherwise
  double seconds = 0;
  double cutting = 0;
  double rapids = 0;
  double dwells = 0;
  double tool_changes = 0;
  double spindle = 0;          // until it is up to speed
  double rotary = 0;           // moves of rotary axes alone
  double below_half_feed = 0;  // of `cutting`: at less than half of the programmed feed
  std::vector<NotTimed> not_timed;
  std::vector<Message> messages;
};

[[nodiscard]] ProgramTime time(std::string_view program, const TimeOptions& options);

}  // namespace batten
