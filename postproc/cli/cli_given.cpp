#include "postproc/cli/cli_given.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "postproc/cli/cli_table.h"
#include "postproc/text/words.h"

namespace batten::postproc {

void Given::add(std::string_view name, std::string value) {
  Values& values = values_[std::string(name)];
  values.texts.push_back(std::move(value));
  values.origin = origin_;
}

void Given::add_list(std::string_view name, std::string_view values) {
  for (std::size_t begin = 0; begin <= values.size();) {
    const std::size_t end = std::min(values.find(',', begin), values.size());
    add(name, std::string(trimmed(values.substr(begin, end - begin), " \t")));
    begin = end + 1;
  }
}

bool Given::has(std::string_view name) const {
  read_.emplace(name);
  return values_.contains(name);
}

bool Given::flag(std::string_view name) const { return value(name) == "true"; }

std::optional<std::string> Given::value(std::string_view name) const {
  read_.emplace(name);
  const auto found = values_.find(name);
  if (found == values_.end() || found->second.texts.empty()) return std::nullopt;
  return found->second.texts.front();
}

std::vector<std::string> Given::values(std::string_view name) const {
  read_.emplace(name);
  const auto found = values_.find(name);
  return found == values_.end() ? std::vector<std::string>{} : found->second.texts;
}

void Given::complete_from(const Given& other, bool goes_together) {
  constexpr std::array<std::string_view, 4> kTogether = {"target", "profile", "machine",
                                                         "grbl-settings"};
  const bool has_target = values_.contains("target") || values_.contains("profile");
  const bool has_machine = values_.contains("machine") || values_.contains("grbl-settings");
  for (const auto& [name, values] : other.values_) {
    const auto* const at = std::ranges::find(kTogether, name);
    const bool is_of_machine = at != kTogether.end() && at - kTogether.begin() > 1;
    if (goes_together && at != kTogether.end() && (has_target || (has_machine && is_of_machine))) {
      continue;
    }
    values_.try_emplace(name, values);
  }
}

std::string Given::origin(std::string_view name) const {
  const auto found = values_.find(name);
  return found == values_.end() ? std::string() : found->second.origin;
}

std::vector<std::pair<std::string, std::string>> Given::origins() const {
  std::vector<std::pair<std::string, std::string>> all;
  for (const auto& [name, values] : values_) {
    if (!values.origin.empty()) all.emplace_back(name, values.origin);
  }
  return all;
}

namespace {

std::string place_of(const std::string& file, const toml::node& node) {
  return fmt::format("{}:{}", file, node.source().begin.line);
}

// The text of a number, string or boolean; nothing for anything else.
std::optional<std::string> text_of(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_integer()) return fmt::format("{}", number->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* truth = node.as_boolean()) return truth->get() ? "true" : "false";
  return std::nullopt;
}

const OptionRow* find_row(std::string_view name) {
  const auto& rows = option_rows("smooth");
  const auto found = std::ranges::find(rows, name, &OptionRow::name);
  return found == rows.end() || !found->in_config ? nullptr : &*found;
}

std::string unknown_key(const std::string& place, std::string_view key) {
  std::vector<std::string_view> names;
  for (const OptionRow& row : option_rows("smooth")) {
    if (row.in_config) names.push_back(row.name);
    if (row.name == key) {
      return fmt::format("{}: '{}' is for the command line only", place, key);
    }
  }
  const std::string_view nearest = nearest_name(key, names);
  return fmt::format("{}: there is no option '{}'{}", place, key,
                     nearest.empty() ? "" : fmt::format(", did you mean '{}'?", nearest));
}

// A name of a file is meant from the folder of the file that has it.
std::string from_folder_of(const std::string& file, const OptionRow& row, const std::string& text) {
  const bool may_be_name = row.value.find('|') != std::string_view::npos;
  const bool is_file = row.value.find("FILE") != std::string_view::npos &&
                       (!may_be_name || text.ends_with(".toml") || text.ends_with(".ini"));
  const auto folder = std::filesystem::path(file).parent_path();
  return is_file && !text.empty() ? (folder / text).lexically_normal().string() : text;
}

void add_value(const OptionRow& row, const toml::node& node, const std::string& file, Given& given,
               Problems& problems) {
  const auto add = [&](const std::string& text) {
    row.kind == OptionKind::kList ? given.add_list(row.name, text) : given.add(row.name, text);
  };
  if (may_be_repeated(row) && node.is_array()) {
    for (const toml::node& element : *node.as_array()) {
      if (const auto text = text_of(element)) {
        add(*text);
      } else {
        problems.push_back(
            fmt::format("{}: '{}', expected a list of strings", place_of(file, element), row.name));
      }
    }
    return;
  }
  const auto text = text_of(node);
  const bool fits = text && (row.kind == OptionKind::kFlag) == node.is_boolean();
  if (fits) {
    add(from_folder_of(file, row, *text));
  } else {
    problems.push_back(fmt::format(
        "{}: '{}', expected {}", place_of(file, node), row.name,
        row.kind == OptionKind::kFlag ? "true or false" : fmt::format("a value ({})", row.value)));
  }
}

std::string line_of(const OptionRow& row, const Given& given) {
  const auto values = given.values(row.name);
  if (may_be_repeated(row)) {
    std::string list;
    for (const std::string& value : values) list += (list.empty() ? "" : ", ") + toml_quoted(value);
    return fmt::format("{} = [{}]", row.name, list);
  }
  if (row.kind == OptionKind::kFlag) {
    return fmt::format("{} = {}", row.name, given.flag(row.name));
  }
  if (!values.empty()) return fmt::format("{} = {}", row.name, toml_quoted(values.front()));
  if (!row.default_value.empty()) {
    return fmt::format("{} = {}", row.name, toml_quoted(row.default_value));
  }
  return fmt::format("# {} = {}", row.name, toml_quoted(row.value));
}

}  // namespace

Given read_config(const std::string& file, Problems& problems) {
  Given given;
  given.come_from(file);
  try {
    const toml::table table = toml::parse_file(file);
    for (const auto& [key, node] : table) {
      if (const OptionRow* row = find_row(key.str())) {
        add_value(*row, node, file, given, problems);
      } else {
        problems.push_back(unknown_key(place_of(file, node), key.str()));
      }
    }
  } catch (const toml::parse_error& error) {
    const auto line = error.source().begin.line;
    problems.push_back(line > 0 ? fmt::format("{}:{}: {}", file, line, error.description())
                                : fmt::format("{}: {}", file, error.description()));
  }
  return given;
}

std::string config_text(const Given& given) {
  std::string text = "# Options of batten smooth, for --config.\n";
  for (const OptionRow& row : option_rows("smooth")) {
    if (!row.in_config) continue;
    const std::string origin = given.origin(row.name);
    text += fmt::format("\n# {}\n{}{}\n", row.help,
                        !given.has(row.name) ? ""
                        : origin.empty()     ? "# from the command line\n"
                                             : fmt::format("# from {}\n", origin),
                        line_of(row, given));
  }
  return text;
}

}  // namespace batten::postproc
