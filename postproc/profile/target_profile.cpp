#include "postproc/profile/target_profile.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/controls/built_in.h"
#include "postproc/machine/machine.h"
#include "postproc/options/profile_words.h"
#include "postproc/profile/profile_keys.h"

namespace batten::postproc {

namespace {

using gcode::Control;
using Lines = std::vector<std::string>;

constexpr std::string_view kBasedOn = "based-on";
constexpr std::string_view kWords = "words";

struct WordsKey {
  std::string_view name;
  std::string_view remark;
  Lines ProfileWords::*place;
};
constexpr std::array kWordsKeys = {
    WordsKey{"header", "lines before the first block of a program that is rewritten",
             &ProfileWords::header},
    WordsKey{"footer", "lines before its end", &ProfileWords::footer},
    WordsKey{"before-run", "lines before each rewritten run", &ProfileWords::before_run},
    WordsKey{"after-run", "lines behind it", &ProfileWords::after_run},
};

std::string text_of(const toml::node& node) {
  std::ostringstream stream;
  node.visit([&stream](const auto& value) {
    if constexpr (toml::is_table<decltype(value)>) {
      stream << "a table";
    } else {
      stream << toml::toml_formatter(
          value, toml::toml_formatter::default_flags & ~toml::format_flags::allow_literal_strings);
    }
  });
  return stream.str();
}

// A bound or a value as a person writes it.
std::string plain(double value) { return fmt::format("{:.10g}", value); }

std::string joined(std::span<const std::string_view> names) {
  std::string all;
  for (const std::string_view name : names) all += (all.empty() ? "" : ", ") + std::string(name);
  return all;
}

// --- what a key expects, whether a value is that, and the value as text
// ---------------------------

template <typename Number>
std::string range_of(Number least, Number most, std::string_view kind) {
  return fmt::format("{} from {} to {}", kind, plain(static_cast<double>(least)),
                     plain(static_cast<double>(most)));
}

std::string expected(const WholeNumberKey& key) {
  return range_of(key.least, key.most, "a whole number");
}
bool set(const WholeNumberKey& key, const toml::node& node, Control& table) {
  const auto value = node.value_exact<std::int64_t>();
  if (!value || *value < key.least || *value > key.most) return false;
  key.place(table) = static_cast<int>(*value);
  return true;
}
std::string shown(const WholeNumberKey& key, Control& table) {
  return fmt::format("{}", key.place(table));
}

std::string expected(const LengthKey& key) {
  return range_of(key.least, key.most, "a whole number");
}
bool set(const LengthKey& key, const toml::node& node, Control& table) {
  const auto value = node.value_exact<std::int64_t>();
  if (!value || *value < 0 || static_cast<std::size_t>(*value) < key.least ||
      static_cast<std::size_t>(*value) > key.most) {
    return false;
  }
  key.place(table) = static_cast<std::size_t>(*value);
  return true;
}
std::string shown(const LengthKey& key, Control& table) {
  return fmt::format("{}", key.place(table));
}

std::string expected(const DecimalKey& key) { return range_of(key.least, key.most, "a number"); }
bool set(const DecimalKey& key, const toml::node& node, Control& table) {
  const auto value = node.value<double>();
  if (!value || !node.is_number() || !(*value >= key.least && *value <= key.most)) return false;
  key.place(table) = *value;
  return true;
}
std::string shown(const DecimalKey& key, Control& table) { return plain(key.place(table)); }

std::string expected(const FlagKey&) { return "true or false"; }
bool set(const FlagKey& key, const toml::node& node, Control& table) {
  const auto value = node.value_exact<bool>();
  if (value) key.place(table) = *value;
  return value.has_value();
}
std::string shown(const FlagKey& key, Control& table) {
  return key.place(table) ? "true" : "false";
}

std::string expected(const TextKey&) { return "a text that is not empty"; }
bool set(const TextKey& key, const toml::node& node, Control& table) {
  const auto value = node.value_exact<std::string>();
  if (!value || value->empty()) return false;
  key.place(table) = *value;
  return true;
}
std::string shown(const TextKey& key, Control& table) {
  return text_of(toml::value<std::string>(key.place(table)));
}

std::string expected(const NameKey& key) { return "one of " + joined(key.names); }
bool set(const NameKey& key, const toml::node& node, Control& table) {
  const auto value = node.value_exact<std::string>();
  const auto found = value ? std::ranges::find(key.names, *value) : key.names.end();
  if (found == key.names.end()) return false;
  key.set(table, static_cast<std::size_t>(found - key.names.begin()));
  return true;
}
std::string shown(const NameKey& key, Control& table) {
  return text_of(toml::value<std::string>(std::string(key.names[key.index(table)])));
}

std::string expected(const PlanesKey&) { return "a list of " + joined(kPlaneNames); }
bool set(const PlanesKey& key, const toml::node& node, Control& table) {
  const toml::array* list = node.as_array();
  if (list == nullptr) return false;
  std::array<bool, 3> planes = {false, false, false};
  for (const toml::node& each : *list) {
    const auto name = each.value_exact<std::string>();
    const auto found = name ? std::ranges::find(kPlaneNames, *name) : kPlaneNames.end();
    if (found == kPlaneNames.end()) return false;
    planes[static_cast<std::size_t>(found - kPlaneNames.begin())] = true;
  }
  key.place(table) = planes;
  return true;
}
std::string shown(const PlanesKey& key, Control& table) {
  std::string list;
  for (std::size_t i = 0; i < kPlaneNames.size(); ++i) {
    if (!key.place(table)[i]) continue;
    list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", kPlaneNames[i]);
  }
  return "[" + list + "]";
}

// --- reading ------------------------------------------------------------------------------------

class ProfileReader {
 public:
  ProfileReader(const std::string& file, const gcode::Control* target,
                std::vector<std::string>& problems)
      : file_(file), target_(target), problems_(problems) {}

  std::shared_ptr<const TargetProfile> read(const toml::table& root) {
    const std::size_t problems_before = problems_.size();
    find_base(root);
    if (target_ == nullptr) return nullptr;
    table_ = *target_;
    for (const auto& [key, node] : root) read_top(key.str(), node);
    check_together(root);
    if (problems_.size() != problems_before) return nullptr;
    auto profile = std::make_shared<TargetProfile>();
    profile->file = file_;
    profile->base = target_;
    profile->adapted = table_;
    read_words(root, *profile);
    if (problems_.size() != problems_before) return nullptr;
    return profile;
  }

 private:
  void complain(const toml::node& node, std::string_view key, const std::string& wanted) {
    const toml::source_position place = node.source().begin;
    problems_.push_back(fmt::format("{}:{}:{}: {}: {}, expected {}", file_, place.line,
                                    place.column, key, text_of(node), wanted));
  }

  void find_base(const toml::table& root) {
    const toml::node* node = root.get(kBasedOn);
    const auto name = node != nullptr ? node->value_exact<std::string>() : std::nullopt;
    if (node == nullptr) {
      if (target_ != nullptr) return;
      problems_.push_back(fmt::format("{}: {}: nothing given, expected one of {}", file_, kBasedOn,
                                      target_names()));
      return;
    }
    const gcode::Control* base = name ? gcode::find_control(*name) : nullptr;
    if (base == nullptr) {
      complain(*node, kBasedOn, "one of " + target_names());
      target_ = nullptr;
    } else if (target_ != nullptr && target_ != base) {
      complain(*node, kBasedOn,
               fmt::format("\"{}\", which --target names", std::string(target_->name)));
    } else {
      target_ = base;
    }
  }

  static std::string target_names() {
    std::string names;
    for (const gcode::Control& each : gcode::controls()) {
      names += (names.empty() ? "" : ", ") + std::string(each.name);
    }
    return names;
  }

  void read_top(std::string_view name, const toml::node& node) {
    if (name == kBasedOn || name == kWords) return;
    if (const toml::table* section = node.as_table()) {
      if (!has_section(name)) return complain(node, name, "one of the sections " + sections());
      for (const auto& [key, value] : *section) read_key(name, key.str(), value);
      return;
    }
    read_key("", name, node);
  }

  static bool has_section(std::string_view name) {
    return !name.empty() &&
           std::ranges::find(profile_keys(), name, &ProfileKey::section) != profile_keys().end();
  }

  static std::string sections() {
    std::string names;
    std::string_view last;
    for (const ProfileKey& key : profile_keys()) {
      if (key.section == last) continue;
      last = key.section;
      names += std::string(last) + ", ";
    }
    return names + std::string(kWords);
  }

  static std::string keys_of(std::string_view section) {
    std::string names = section.empty() ? std::string(kBasedOn) : "";
    for (const ProfileKey& key : profile_keys()) {
      if (key.section == section) names += (names.empty() ? "" : ", ") + std::string(key.name);
    }
    return names;
  }

  static std::string full_name(std::string_view section, std::string_view name) {
    return section.empty() ? std::string(name) : fmt::format("{}.{}", section, name);
  }

  void read_key(std::string_view section, std::string_view name, const toml::node& node) {
    const auto found = std::ranges::find_if(profile_keys(), [&](const ProfileKey& key) {
      return key.section == section && key.name == name;
    });
    if (found == profile_keys().end()) {
      return complain(node, full_name(section, name), "one of the keys " + keys_of(section));
    }
    const bool fits =
        std::visit([&](const auto& key) { return set(key, node, table_); }, found->value);
    if (!fits) {
      complain(node, full_name(section, name),
               std::visit([](const auto& key) { return expected(key); }, found->value));
    }
  }

  // A value that is right alone and wrong beside another one, which may be the target's.
  void complain_together(const toml::table& root, std::string_view section, std::string_view name,
                         const std::string& wanted) {
    const toml::node* node = section.empty() ? root.get(name) : root[section][name].node();
    if (node != nullptr) return complain(*node, full_name(section, name), wanted);
    const auto key = std::ranges::find_if(profile_keys(), [&](const ProfileKey& each) {
      return each.section == section && each.name == name;
    });
    const std::string value =
        std::visit([this](const auto& each) { return shown(each, table_); }, key->value);
    problems_.push_back(fmt::format("{}: {}: {} from target {}, expected {}", file_,
                                    full_name(section, name), value, target_->name, wanted));
  }

  void check_together(const toml::table& root) {
    const auto numbers = root["numbers"];
    if (!numbers["arc-ends-mm"]) {
      table_.arc_ends.mm = std::max(table_.arc_ends.mm, table_.places.mm);
    }
    if (!numbers["arc-ends-inch"]) {
      table_.arc_ends.inch = std::max(table_.arc_ends.inch, table_.places.inch);
    }
    if (table_.arc_ends.mm < table_.places.mm) {
      complain_together(root, "numbers", "arc-ends-mm", "at least as many as places-mm");
    }
    if (table_.arc_ends.inch < table_.places.inch) {
      complain_together(root, "numbers", "arc-ends-inch", "at least as many as places-inch");
    }
    if (!(table_.min_radius < table_.max_radius)) {
      complain_together(root, "arcs", "min-radius", "less than max-radius");
    }
    constexpr double kMostByRadius = 170;  // R says nothing certain near a half turn
    if (table_.arc_form == gcode::ArcForm::kRadius && table_.max_sweep_deg > kMostByRadius) {
      complain_together(
          root, "arcs", "words",
          fmt::format("max-sweep of {} or less beside \"radius\"", plain(kMostByRadius)));
    }
    if (table_.chords.shortest > table_.chords.longest) {
      complain_together(root, "arcs", "least-chord-length", "chord-length or less");
    }
    if (find_machine(table_.machine) == nullptr) {
      complain_together(root, "", "machine", "one of " + machine_names());
    }
  }

  static std::string machine_names() {
    std::string names;
    for (const Machine& machine : built_in_machines()) {
      names += (names.empty() ? "" : ", ") + machine.name;
    }
    return names;
  }

  void read_words(const toml::table& root, TargetProfile& profile) {
    const toml::node* node = root.get(kWords);
    if (node == nullptr) return;
    const toml::table* section = node->as_table();
    if (section == nullptr) return complain(*node, kWords, "a section");
    for (const auto& [key, value] : *section) read_lines(key.str(), value, profile);
    for (const std::string& problem : problems_of(profile.words)) {
      problems_.push_back(fmt::format("{}:{}: {}", file_, section->source().begin.line, problem));
    }
  }

  void read_lines(std::string_view name, const toml::node& node, TargetProfile& profile) {
    const std::string key = full_name(kWords, name);
    const auto found = std::ranges::find(kWordsKeys, name, &WordsKey::name);
    if (found == kWordsKeys.end()) {
      return complain(node, key, "one of the keys header, footer, before-run, after-run");
    }
    const toml::array* list = node.as_array();
    if (list == nullptr) return complain(node, key, "a list of lines");
    for (const toml::node& each : *list) {
      const auto line = each.value_exact<std::string>();
      if (!line) {
        complain(each, key, "a line of text");
        continue;
      }
      const std::string why = why_not_in_profile(*line, profile.adapted);
      if (why.empty()) {
        (profile.words.*found->place).push_back(*line);
      } else {
        const toml::source_position place = each.source().begin;
        problems_.push_back(fmt::format("{}:{}:{}: {}: {}, {}", file_, place.line, place.column,
                                        key, text_of(each), why));
      }
    }
  }

  const std::string& file_;
  const gcode::Control* target_;
  std::vector<std::string>& problems_;
  Control table_;
};

}  // namespace

std::shared_ptr<const TargetProfile> read_target_profile(const std::string& file,
                                                         const gcode::Control* target,
                                                         std::vector<std::string>& problems) {
  try {
    const toml::table root = toml::parse_file(file);
    return ProfileReader(file, target, problems).read(root);
  } catch (const toml::parse_error& error) {
    const toml::source_position place = error.source().begin;
    problems.push_back(place.line > 0 ? fmt::format("{}:{}:{}: {}", file, place.line, place.column,
                                                    error.description())
                                      : fmt::format("{}: {}", file, error.description()));
  }
  return nullptr;
}

std::string profile_text(const gcode::Control& target) {
  Control table = target;
  std::string text = fmt::format(
      "# A profile for batten: `--target THIS.toml`. Every key stands here as target {} has it;\n"
      "# change what your machine needs, and leave out what stays.\n\n{} = \"{}\"\n",
      target.name, kBasedOn, target.name);
  std::string_view section;
  for (const ProfileKey& key : profile_keys()) {
    if (key.section != section) {
      section = key.section;
      text += fmt::format("\n[{}]\n", section);
    }
    const std::string value =
        std::visit([&](const auto& each) { return shown(each, table); }, key.value);
    text += fmt::format("{:<34}  # {}\n", fmt::format("{} = {}", key.name, value), key.remark);
  }
  text += fmt::format(
      "\n# Lines that are added to a program that is rewritten. What they do on the control is "
      "not\n"
      "# checked; {{tolerance}} stands for the tolerance in the program's units.\n[{}]\n",
      kWords);
  for (const WordsKey& key : kWordsKeys) {
    text += fmt::format("{:<34}  # {}\n", fmt::format("{} = []", key.name), key.remark);
  }
  for (const std::string_view hint : target.smoothing_words) text += fmt::format("# {}\n", hint);
  return text;
}

void tell_of_other_meanings(const gcode::Program& program, const gcode::Control& target,
                            gcode::Diagnostics& found) {
  std::vector<int> told;
  for (const gcode::Word& word : program.words) {
    if (word.letter != 'G' || !word.is_number) continue;
    const int code = tenths_of(word);
    const std::string_view meaning = other_meaning(target, code);
    if (meaning.empty() || std::ranges::find(told, code) != told.end()) continue;
    told.push_back(code);
    found.push_back({gcode::Severity::kError, "word-means-other", word.span,
                     fmt::format("{} for target {}: {}", program.source.text(word.span),
                                 target.name, meaning)});
  }
}

}  // namespace batten::postproc
