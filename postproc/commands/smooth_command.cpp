#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

#include "postproc/commands/certificate_file.h"
#include "postproc/commands/commands.h"
#include "postproc/commands/files.h"
#include "postproc/options/options.h"
#include "postproc/report/html_report.h"
#include "postproc/report/smooth_report.h"
#include "postproc/stream/pipeline.h"
#include "postproc/stream/smooth_result.h"
#include "postproc/system/exit_code.h"
#include "postproc/system/interrupt.h"
#include "postproc/system/output_file.h"
#include "postproc/text/words.h"

namespace batten::postproc {

namespace {

std::string output_of(const SmoothCommand& command) {
  if (command.in_place) return command.input;
  if (!command.output.empty()) return command.output;
  if (command.input == "-") return "-";
  return default_output_path(command.input).string();
}

class SmoothWork {
 public:
  SmoothWork(const SmoothCommand& command, std::string output)
      : command_(command),
        options_(command.options),
        output_(std::move(output)),
        watched_(command.input) {}

  int run() {
    source_ = read_program(command_.input, command_.drop, dropped_);
    if (interrupted()) return end_interrupted();
    const bool may_work = source_ && (command_.dry_run || may_be_written(output_, replaces())) &&
                          may_be_written(command_.json_file, command_.force) &&
                          may_be_written(command_.page.file, command_.force) &&
                          may_be_written(command_.certificate_file, command_.force);
    if (!may_work) return static_cast<int>(ExitCode::kFileError);
    called_ = read_called_files(*source_, command_.input, options_);
    if (command_.dry_run) return look_only();
    // The page draws the whole path, and a short program needs no file beside the output.
    const bool in_memory =
        source_->text().size() < StreamLimits{}.bytes_for_windows || command_.page.is_wanted();
    if (in_memory) return write_from_memory();
    return is_seen_at_once() ? write_from_spool() : write_beside();
  }

 private:
  // What is written there is seen before all of it is.
  [[nodiscard]] bool is_seen_at_once() const {
    std::error_code error;
    return output_ == "-" || (std::filesystem::exists(output_, error) &&
                              !std::filesystem::is_regular_file(output_, error));
  }

  // Into the sink; without one the text is in the result.
  void smooth(const ProgramSink* sink = nullptr) {
    const Progress progress = show_progress(command_.progress, source_->text().size());
    result_ = sink != nullptr ? smooth_program(*source_, options_, *sink, progress)
                              : smooth_program(*source_, options_, progress);
    (void)progress(1);  // the progress line is gone
  }

  // Where a rule that the user may lift keeps much of a program that is not long: without it.
  [[nodiscard]] std::optional<LiftedRule> smooth_without_rule() const {
    if (!result_.understood || command_.log_level < LogLevel::kInfo) return std::nullopt;
    if (source_->text().size() >= StreamLimits{}.bytes_for_windows) return std::nullopt;
    const std::string_view id = rule_worth_lifting(result_);
    if (id.empty()) return std::nullopt;
    SmoothOptions options = options_;
    options.allowed.emplace_back(id);
    return LiftedRule{id, smooth_program(*source_, options, [](double) { return !interrupted(); })};
  }

  // All that takes memory before anything is in its place: what ends here has written nothing.
  // False: nothing is to be written.
  bool tell_of_smoothing() {
    const std::optional<LiftedRule> lifted = smooth_without_rule();
    if (interrupted()) code_ = end_interrupted();
    const bool changed = !code_ && (changed_while_read(watched_) || changed_while_read(called_));
    if (changed) code_ = static_cast<int>(ExitCode::kFileError);
    if (code_) return false;
    told_ = true;
    print(result_.diagnostics, *source_, command_.log_level, command_.command_line);
    verdict_ = judge(result_, source_->text(), command_.strict);
    const bool writes = verdict_ == ExitCode::kDone && !command_.dry_run;
    const SmoothReport report = {.source = *source_,
                                 .options = options_,
                                 .result = result_,
                                 .output_file = writes ? output_ : "",
                                 .strict = command_.strict,
                                 .origins = command_.origins,
                                 .drop = command_.drop,
                                 .dropped = dropped_,
                                 .called = called_.files,
                                 .lifted = lifted ? &*lifted : nullptr};
    const bool tells = result_.understood && command_.log_level >= LogLevel::kInfo;
    if (tells) summary_ = summary_text(report);
    if (!command_.json_file.empty()) json_ = json_report(report);
    if (command_.page.is_wanted()) page_ = html_report(report, command_.command_line);
    return verdict_ == ExitCode::kDone;
  }

  // Where nothing is written.
  int end() const { return code_ ? *code_ : finish(static_cast<int>(verdict_)); }

  int look_only() {
    const ProgramSink nowhere = {[](std::string_view) { return true; }, [] { return true; }};
    smooth(command_.page.is_wanted() ? nullptr : &nowhere);
    (void)tell_of_smoothing();
    return end();
  }

  int write_from_memory() {
    smooth();
    if (!tell_of_smoothing()) return end();
    return finish(write({.target = output_,
                         .bytes = result_.text,
                         .replace_existing = replaces(),
                         .objection = [this] { return objection_to_place(); }}));
  }

  int write_beside() {
    WriteRequest request;
    request.target = output_;
    request.replace_existing = replaces();
    request.stop = interrupted;
    bool may_be_told = false;
    request.parts = [&](const PartWriter& writer) {
      bool written = true;
      const ProgramSink sink = {[&](std::string_view part) { return written = writer(part); },
                                writer.restart};
      smooth(&sink);
      may_be_told = written;
    };
    request.objection = [&]() -> std::string {
      if (!may_be_told || !tell_of_smoothing()) return kNotWanted;
      return objection_to_place();
    };
    const WriteResult written = write_file(request);
    if (code_) return *code_;
    if (interrupted()) return end_interrupted();
    if (!told_) return exit_code_of(written);
    const bool refused = written.message == kNotWanted;
    return finish(refused ? static_cast<int>(verdict_) : exit_code_of(written));
  }

  int write_from_spool() {
    std::string error;
    auto spool = SpoolFile::make(error);
    if (!spool) return write_from_memory();  // needs no file
    const ProgramSink sink = {[&](std::string_view part) { return spool->append(part); },
                              [&] { return spool->restart(); }};
    smooth(&sink);
    if (!spool->error().empty()) {
      say(spool->error());
      return static_cast<int>(ExitCode::kFileError);
    }
    if (!tell_of_smoothing()) return end();
    return finish(write({.target = output_,
                         .replace_existing = replaces(),
                         .parts = [&](const PartWriter& writer) { spool->write_to(writer); }}));
  }

  // `code`: of the program's own file.
  int finish(int code) const {
    say_lines(summary_);
    if (verdict_ != ExitCode::kDone) say(complaint(verdict_, command_.strict));
    write_report(command_.json_file, command_.force, [this] { return json_; });
    const int of_page = write_page(command_.page, command_.force, command_.input, page_);
    if (code == 0) code = of_page;
    return code != 0 ? code : certify();
  }

  // Of the file that was written, as it is there now.
  int certify() const {
    if (command_.certificate_file.empty() || verdict_ != ExitCode::kDone) return 0;
    const auto written = read_program(output_);
    if (!written) return static_cast<int>(ExitCode::kFileError);
    const SmoothOptions& options = command_.options;
    VerifyCommand verify;
    verify.old_program = command_.input;  // beside which called programs are
    verify.units = options.units;
    verify.source = options.source;
    verify.decimals = options.decimals;
    verify.target = options.target;
    verify.allowed = options.allowed;
    verify.own_words = options.own_words;
    verify.one_tolerance = options.one_tolerance;
    verify.old_program = command_.input;  // whose called programs are read
    verify.force = command_.force;
    verify.tolerance_mm = options.tolerance_mm;
    verify.profile = command_.profile;
    verify.certificate_file = command_.certificate_file;
    return write_certificate(verify, *source_, *written);
  }

  [[nodiscard]] bool replaces() const { return command_.force || command_.in_place; }

  [[nodiscard]] std::string objection_to_place() const {
    return command_.in_place ? objection_to_place_of(watched_) : "";
  }

  static constexpr const char* kNotWanted = "not wanted";

  const SmoothCommand& command_;
  SmoothOptions options_;  // of the command, with what the program calls
  std::string output_;
  WatchedFile watched_;
  std::optional<gcode::SourceText> source_;
  std::size_t dropped_ = 0;
  CalledFiles called_;
  SmoothResult result_;
  ExitCode verdict_ = ExitCode::kDone;
  std::string summary_;
  std::string json_;
  std::string page_;
  bool told_ = false;
  std::optional<int> code_;  // of a result that is worth nothing
};

}  // namespace

int run(const SmoothCommand& command) {
  if (!can_show(command.page)) return static_cast<int>(ExitCode::kFileError);
  return SmoothWork(command, output_of(command)).run();
}

int run(const SmoothFilesCommand& command) {
  int worst = 0;
  std::size_t done = 0;
  for (const std::string& file : command.left_out) {
    say(file + ": left out; it is the output of another one of these programs");
  }
  for (const SmoothCommand& each : command.each) {
    const int code = run(each);
    worst = std::max(worst, code);
    if (code == 0) ++done;
    if (interrupted()) break;
  }
  const bool tells = worst != 0 || command.each.front().log_level >= LogLevel::kInfo;
  if (tells) {
    say(fmt::format("{}: {} done, {} not", plural(command.each.size(), "program"), done,
                    command.each.size() - done));
  }
  return worst;
}

}  // namespace batten::postproc
