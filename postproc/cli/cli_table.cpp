#include "postproc/cli/cli_table.h"

#include <fmt/format.h>

#include <string_view>

namespace batten::postproc {
namespace {

// Text that roff prints as it stands: backslashes and dashes are meant, a point or an apostrophe at
// the beginning of a line is no request.
std::string roff(std::string_view text) {
  std::string safe;
  bool begins = true;
  for (const char c : text) {
    if (begins && (c == '.' || c == '\'')) safe += "\\&";
    if (c == '\\') {
      safe += "\\e";
    } else if (c == '-') {
      safe += "\\-";
    } else {
      safe += c;
    }
    begins = c == '\n';
  }
  return safe;
}

std::string option_text(const OptionRow& row) {
  std::string head = "\\fB" + roff(fmt::format("--{}", row.name)) + "\\fR";
  const std::string_view brief = short_form_of(row);
  if (!brief.empty()) head = "\\fB" + roff(brief) + "\\fR, " + head;
  if (row.kind != OptionKind::kFlag) head += " \\fI" + roff(row.value) + "\\fR";
  std::string help(row.help);
  if (!row.default_value.empty() && row.kind != OptionKind::kFlag) {
    help += fmt::format("; default: {}", row.default_value);
  }
  return fmt::format(".TP\n{}\n{}.\n", head, roff(help));
}

std::string command_text(const CommandRow& command) {
  std::string synopsis = fmt::format("\\fBbatten {}\\fR", roff(command.name));
  for (const auto& [name, help] : command.files) {
    synopsis += fmt::format(" \\fI{}\\fR", roff(name));
  }
  if (!command.rows.empty()) synopsis += " [\\fIoptions\\fR]";
  std::string text = fmt::format(".SS {}\n{}\n", synopsis, roff(command.description));
  for (const auto& [name, help] : command.files) {
    text += fmt::format(".TP\n\\fI{}\\fR\n{}.\n", roff(name), roff(help));
  }
  for (const OptionRow& row : command.rows) text += option_text(row);
  text += fmt::format(".PP\n.nf\n{}\n.fi\n", roff(command.example));
  return text;
}

constexpr std::string_view kDescription =
    "Batten takes a CNC program that a CAM system wrote as thousands of short G01 lines, bends "
    "smooth\ncurves through them within a tolerance, and writes the program again as arcs or "
    "lines. "
    "It then reads\nits own output back and proves that the new path is nowhere further from the "
    "old one than allowed;\nwhat it does not understand or cannot prove, it copies byte for byte.\n"
    "A - in place of a file is standard input or output. Messages and progress go to standard "
    "error.";

constexpr std::string_view kExitStatus =
    ".TP\n0\nDone; for verify: proved.\n.TP\n1\nWrong options; no file was touched.\n.TP\n2\nThe "
    "input is not understood; nothing was written.\n.TP\n3\nNot proved, or verify found a "
    "breach.\n.TP\n4\nA file could not be read or written.\n.TP\n5\nInternal error; nothing was "
    "written.\n";

constexpr std::string_view kEnvironment =
    ".TP\nAXIS_PROGRESS_BAR\nWhen 1, progress is written as LinuxCNC's filters do it.\n";

}  // namespace

std::string man_page() {
  std::string text = fmt::format(
      ".\\\" Made by `batten man`.\n"
      ".TH BATTEN 1 \"\" \"batten {}\" \"User Commands\"\n"
      ".SH NAME\nbatten \\- smooth CNC programs made of short lines, and prove what was written\n"
      ".SH SYNOPSIS\n\\fBbatten\\fR \\fIcommand\\fR [\\fIoptions\\fR] [\\fIfiles\\fR]\n"
      ".SH DESCRIPTION\n{}\n.SH COMMANDS\n",
      roff(BATTEN_VERSION), roff(kDescription));
  for (const CommandRow& command : command_rows()) text += command_text(command);
  text += ".SH EXIT STATUS\n";
  text += kExitStatus;
  text += ".SH ENVIRONMENT\n";
  text += kEnvironment;
  text +=
      ".SH COPYRIGHT\nFree software under the GNU General Public License, version 3 or later.\n";
  return text;
}

}  // namespace batten::postproc
