#include "postproc/profile/target_profile.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <type_traits>
#include <variant>

#include "gcode/controls/built_in.h"
#include "gcode/state/mode_words.h"
#include "postproc/machine/machine.h"
#include "postproc/text/words.h"

namespace batten::postproc {

namespace {

using gcode::ArcForm;
using gcode::CommentStyle;
using gcode::Control;
using Lines = std::vector<std::string>;

constexpr std::string_view kBasedOn = "based-on";
constexpr std::string_view kWords = "words";
constexpr std::string_view kOwnWords = "own-words";

struct WordsKey {
  std::string_view name;
  std::string_view remark;
  Lines ProfileWords::*place;
};
constexpr WordsKey kWordsKeys[] = {
    {"header", "lines before the first block of a program that is rewritten",
     &ProfileWords::header},
    {"footer", "lines before its end", &ProfileWords::footer},
    {"before-run", "lines before each rewritten run", &ProfileWords::before_run},
    {"after-run", "lines after it", &ProfileWords::after_run},
};

constexpr std::array<std::string_view, 3> kPlaneNames = {"G17", "G18", "G19"};
constexpr std::array<std::string_view, 3> kCommentNames = {"none", "parentheses", "semicolon"};
constexpr std::array<std::string_view, 3> kArcForms = {"centres", "radius", "shorter"};

std::span<const std::string_view> names_of(CommentStyle) { return kCommentNames; }
std::span<const std::string_view> names_of(ArcForm) { return kArcForms; }

template <typename Value>
using Place = Value& (*)(Control&);

// A key of a profile: where its value lives, what is allowed, what it means.
struct ProfileKey {
  std::string_view section;  // empty: at the top
  std::string_view name;
  std::string_view remark;  // unit and meaning
  std::variant<Place<int>, Place<std::size_t>, Place<double>, Place<bool>, Place<std::string>,
               Place<CommentStyle>, Place<ArcForm>, Place<std::array<bool, 3>>>
      place;
  double least = 0;  // of numbers
  double most = 0;
};

// What can be printed.
constexpr int kMostDecimals = 9;

// Blocks of an arc need the first; no control takes a longer one than the second.
constexpr double kShortestLine = 40;
constexpr double kLongestLine = 100000;

// In the order in which a profile shows them; keys of a section stand together.
constexpr ProfileKey kKeys[] = {
    {"", "name", "what reports call it", [](Control& c) -> std::string& { return c.name; }},
    {"", "description", "one line", [](Control& c) -> std::string& { return c.description; }},
    {"", "machine", "a built-in machine whose time counts when none is given",
     [](Control& c) -> std::string& { return c.machine; }},

    {"numbers", "places-mm", "decimals of X Y Z along lines, millimetre programs",
     [](Control& c) -> int& { return c.places.mm; }, 0, kMostDecimals},
    {"numbers", "places-inch", "the same, inch programs",
     [](Control& c) -> int& { return c.places.inch; }, 0, kMostDecimals},
    {"numbers", "arc-ends-mm", "decimals of X Y Z in runs with arcs",
     [](Control& c) -> int& { return c.arc_ends.mm; }, 0, kMostDecimals},
    {"numbers", "arc-ends-inch", "the same, inch programs",
     [](Control& c) -> int& { return c.arc_ends.inch; }, 0, kMostDecimals},
    {"numbers", "centres-mm", "decimals of I J K R",
     [](Control& c) -> int& { return c.centers.mm; }, 0, kMostDecimals},
    {"numbers", "centres-inch", "the same, inch programs",
     [](Control& c) -> int& { return c.centers.inch; }, 0, kMostDecimals},
    {"numbers", "feeds", "most decimals of F, which is copied",
     [](Control& c) -> int& { return c.feed_decimals; }, 0, kMostDecimals},
    {"numbers", "decimal-point", "X5. rather than X5",
     [](Control& c) -> bool& { return c.decimal_point; }},
    {"numbers", "trailing-zeros", "X1.500 rather than X1.5",
     [](Control& c) -> bool& { return c.trailing_zeros; }},

    {"lines", "max-length", "characters; a run that needs more is kept",
     [](Control& c) -> std::size_t& { return c.max_line_length; }, kShortestLine, kLongestLine},
    {"lines", "blanks", "between words", [](Control& c) -> bool& { return c.blanks; }},
    {"lines", "comments", "none, parentheses or semicolon",
     [](Control& c) -> CommentStyle& { return c.comments; }},
    {"lines", "repeat-words", "G1 in every block, X and Y in every arc",
     [](Control& c) -> bool& { return c.repeats_words; }},

    {"arcs", "planes", "where arcs are taken; [] for none",
     [](Control& c) -> std::array<bool, 3>& { return c.planes; }},
    {"arcs", "helices", "arcs that rise", [](Control& c) -> bool& { return c.helices; }},
    {"arcs", "words",
     "centres (I J K from the start), radius (R), or shorter (R below a sixth of a turn, else I "
     "J K)",
     [](Control& c) -> ArcForm& { return c.arc_form; }},
    {"arcs", "absolute-centres", "G90.1 and G91.1 are known",
     [](Control& c) -> bool& { return c.arc_distance_mode; }},
    {"arcs", "max-sweep", "degrees; longer arcs are written as several",
     [](Control& c) -> double& { return c.max_sweep_deg; }, 1, 360},
    {"arcs", "single-quadrants", "arcs end at the axes",
     [](Control& c) -> bool& { return c.single_quadrants; }},
    {"arcs", "min-radius", "mm; tighter arcs become lines",
     [](Control& c) -> double& { return c.min_radius; }, 0.001, 1e6},
    {"arcs", "max-radius", "mm; flatter arcs become lines",
     [](Control& c) -> double& { return c.max_radius; }, 0.001, 1e6},
    {"arcs", "chord-error", "mm by which the control wants its own chords to leave an arc; 0: none",
     [](Control& c) -> double& { return c.chords.error; }, 0, 10},
    {"arcs", "chord-length", "mm, of the control's own chords; 0: not by length",
     [](Control& c) -> double& { return c.chords.longest; }, 0, 100},
    {"arcs", "least-chord-length", "mm, where there are so many chords in a circle:",
     [](Control& c) -> double& { return c.chords.shortest; }, 0, 100},
    {"arcs", "chords-per-circle", "0: chord-length alone counts",
     [](Control& c) -> double& { return c.chords.per_circle; }, 0, 1e5},

    {"curves", "auto", "the control has the option of its curves: --output auto tries them",
     [](Control& c) -> bool& { return c.curves_in_auto; }},
};

const ProfileKey* find_key(std::string_view section, std::string_view name) {
  const auto found = std::ranges::find_if(
      kKeys, [&](const ProfileKey& key) { return key.section == section && key.name == name; });
  return found == std::end(kKeys) ? nullptr : &*found;
}

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

std::string listed(const Lines& names) { return fmt::format("{}", fmt::join(names, ", ")); }

// A bound or a value as a person writes it.
std::string plain(double value) { return fmt::format("{:.10g}", value); }

// --- what a key expects, whether a value is that, and the value as text ------------------------

std::string expected(const ProfileKey& key) {
  const auto range = [&key](std::string_view kind) {
    return fmt::format("{} from {} to {}", kind, plain(key.least), plain(key.most));
  };
  return std::visit(
      [&]<typename Value>(Place<Value>) -> std::string {
        if constexpr (std::is_same_v<Value, bool>) {
          return "true or false";
        } else if constexpr (std::is_same_v<Value, double>) {
          return range("a number");
        } else if constexpr (std::is_integral_v<Value>) {
          return range("a whole number");
        } else if constexpr (std::is_same_v<Value, std::string>) {
          return "a text that is not empty";
        } else if constexpr (std::is_enum_v<Value>) {
          return fmt::format("one of {}", fmt::join(names_of(Value()), ", "));
        } else {
          return fmt::format("a list of {}", fmt::join(kPlaneNames, ", "));
        }
      },
      key.place);
}

// The place of a name; nothing where the node is none of them.
std::optional<std::size_t> index_of(const toml::node& node,
                                    std::span<const std::string_view> names) {
  const auto name = node.value_exact<std::string>();
  const auto found = name ? std::ranges::find(names, *name) : names.end();
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

std::optional<std::array<bool, 3>> planes_in(const toml::node& node) {
  const toml::array* list = node.as_array();
  if (list == nullptr) return std::nullopt;
  std::array<bool, 3> planes = {false, false, false};
  for (const toml::node& each : *list) {
    const auto plane = index_of(each, kPlaneNames);
    if (!plane) return std::nullopt;
    planes[*plane] = true;
  }
  return planes;
}

// The value that the key takes from the node; nothing where it takes none.
template <typename Value>
std::optional<Value> value_in(const toml::node& node, const ProfileKey& key) {
  if constexpr (std::is_same_v<Value, bool>) {
    return node.value_exact<bool>();
  } else if constexpr (std::is_arithmetic_v<Value>) {
    const bool fits = std::is_same_v<Value, double> ? node.is_number() : node.is_integer();
    const auto value = fits ? node.value<double>() : std::nullopt;
    if (!value || !(*value >= key.least && *value <= key.most)) return std::nullopt;
    return static_cast<Value>(*value);
  } else if constexpr (std::is_same_v<Value, std::string>) {
    const auto value = node.value_exact<std::string>();
    return value && !value->empty() ? value : std::nullopt;
  } else if constexpr (std::is_enum_v<Value>) {
    const auto index = index_of(node, names_of(Value()));
    return index ? std::optional(static_cast<Value>(*index)) : std::nullopt;
  } else {
    return planes_in(node);
  }
}

bool set(const ProfileKey& key, const toml::node& node, Control& control) {
  return std::visit(
      [&]<typename Value>(Place<Value> place) {
        const std::optional<Value> value = value_in<Value>(node, key);
        if (value) place(control) = *value;
        return value.has_value();
      },
      key.place);
}

std::string shown(const ProfileKey& key, Control control) {
  return std::visit(
      [&]<typename Value>(Place<Value> place) -> std::string {
        const Value& value = place(control);
        if constexpr (std::is_same_v<Value, double>) {
          return plain(value);
        } else if constexpr (std::is_arithmetic_v<Value>) {
          return fmt::format("{}", value);
        } else if constexpr (std::is_same_v<Value, std::string>) {
          return toml_quoted(value);
        } else if constexpr (std::is_enum_v<Value>) {
          return toml_quoted(names_of(value)[static_cast<std::size_t>(value)]);
        } else {
          Lines planes;
          for (std::size_t i = 0; i < kPlaneNames.size(); ++i) {
            if (value[i]) planes.push_back(toml_quoted(kPlaneNames[i]));
          }
          return fmt::format("[{}]", fmt::join(planes, ", "));
        }
      },
      key.place);
}

// --- reading ------------------------------------------------------------------------------------

class ProfileReader {
 public:
  ProfileReader(const std::string& file, const Control* target, Lines& problems)
      : file_(file), target_(target), problems_(problems) {}

  std::shared_ptr<const TargetProfile> read(const toml::table& root) {
    const std::size_t problems_before = problems_.size();
    find_base(root);
    if (target_ == nullptr) return nullptr;
    TargetProfile profile = {file_, *target_, false, {}, {}};
    for (const auto& [key, node] : root) read_top(key.str(), node, profile.adapted);
    check_together(root, profile.adapted);
    profile.says_chords = profile.adapted.chords != target_->chords;
    read_own_words(root, profile);
    if (problems_.size() == problems_before) read_words(root, profile);
    if (problems_.size() != problems_before) return nullptr;
    return std::make_shared<TargetProfile>(std::move(profile));
  }

 private:
  void complain(const toml::node& node, std::string_view key, const std::string& wanted) {
    object(node, key, "expected " + wanted);
  }

  void object(const toml::node& node, std::string_view key, const std::string& why) {
    const toml::source_position place = node.source().begin;
    problems_.push_back(fmt::format("{}:{}:{}: {}: {}, {}", file_, place.line, place.column, key,
                                    text_of(node), why));
  }

  void find_base(const toml::table& root) {
    const toml::node* node = root.get(kBasedOn);
    if (node == nullptr && target_ != nullptr) return;
    const std::string possible = "one of " + names_in(gcode::controls());
    if (node == nullptr) {
      problems_.push_back(
          fmt::format("{}: {}: nothing given, expected {}", file_, kBasedOn, possible));
      return;
    }
    const auto name = node->value_exact<std::string>();
    const gcode::Control* base = name ? gcode::find_control(*name) : nullptr;
    if (base == nullptr) {
      complain(*node, kBasedOn, possible);
    } else if (target_ != nullptr && target_ != base) {
      return complain(*node, kBasedOn, fmt::format("\"{}\", which --target names", target_->name));
    }
    target_ = base;
  }

  template <typename Values>
  static std::string names_in(const Values& values) {
    Lines names;
    for (const auto& each : values) names.push_back(each.name);
    return listed(names);
  }

  void read_top(std::string_view name, const toml::node& node, Control& control) {
    if (name == kBasedOn || name == kWords || name == kOwnWords) return;
    const toml::table* section = node.as_table();
    if (section == nullptr) return read_key("", name, node, control);
    if (name.empty() || std::ranges::find(kKeys, name, &ProfileKey::section) == std::end(kKeys)) {
      return complain(node, name, "one of the sections " + sections());
    }
    for (const auto& [key, value] : *section) read_key(name, key.str(), value, control);
  }

  static std::string sections() {
    Lines names;
    for (const ProfileKey& key : kKeys) {
      if (!key.section.empty() && (names.empty() || names.back() != key.section)) {
        names.emplace_back(key.section);
      }
    }
    names.emplace_back(kWords);
    names.emplace_back(kOwnWords);
    return listed(names);
  }

  static std::string keys_of(std::string_view section) {
    Lines names;
    if (section.empty()) names.emplace_back(kBasedOn);
    for (const ProfileKey& key : kKeys) {
      if (key.section == section) names.emplace_back(key.name);
    }
    return listed(names);
  }

  static std::string full_name(std::string_view section, std::string_view name) {
    return section.empty() ? std::string(name) : fmt::format("{}.{}", section, name);
  }

  void read_key(std::string_view section, std::string_view name, const toml::node& node,
                Control& control) {
    const ProfileKey* key = find_key(section, name);
    if (key == nullptr) {
      return complain(node, full_name(section, name), "one of the keys " + keys_of(section));
    }
    if (!set(*key, node, control)) complain(node, full_name(section, name), expected(*key));
  }

  // A value that is right alone and wrong beside another one, which may be the target's.
  void complain_together(const toml::table& root, const Control& control, std::string_view section,
                         std::string_view name, const std::string& wanted) {
    const toml::node* node = section.empty() ? root.get(name) : root[section][name].node();
    if (node != nullptr) return complain(*node, full_name(section, name), wanted);
    problems_.push_back(
        fmt::format("{}: {}: {} from target {}, expected {}", file_, full_name(section, name),
                    shown(*find_key(section, name), control), target_->name, wanted));
  }

  void check_together(const toml::table& root, Control& control) {
    const auto complain_of = [&](std::string_view section, std::string_view name,
                                 const std::string& wanted) {
      complain_together(root, control, section, name, wanted);
    };
    for (const auto& [unit, decimals] :
         {std::pair{"mm", &gcode::DecimalsByUnit::mm}, {"inch", &gcode::DecimalsByUnit::inch}}) {
      int& ends = control.arc_ends.*decimals;
      const int places = control.places.*decimals;
      const std::string key = fmt::format("arc-ends-{}", unit);
      if (!root["numbers"][key]) ends = std::max(ends, places);
      if (ends < places) {
        complain_of("numbers", key, fmt::format("at least as many as places-{}", unit));
      }
    }
    if (control.curves_in_auto && control.curves == nullptr) {
      complain_of("curves", "auto", "false: the target has no curves");
    }
    if (!(control.min_radius < control.max_radius)) {
      complain_of("arcs", "min-radius", "less than max-radius");
    }
    constexpr double kMostByRadius = 170;  // R says nothing certain near a half turn
    if (control.arc_form == ArcForm::kRadius && control.max_sweep_deg > kMostByRadius) {
      complain_of("arcs", "words",
                  fmt::format("max-sweep of {} or less beside \"radius\"", plain(kMostByRadius)));
    }
    if (control.chords.shortest > control.chords.longest) {
      complain_of("arcs", "least-chord-length", "chord-length or less");
    }
    if (find_machine(control.machine) == nullptr) {
      complain_of("", "machine", "one of " + names_in(built_in_machines()));
    }
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

  void read_own_words(const toml::table& root, TargetProfile& profile) {
    const toml::node* node = root.get(kOwnWords);
    if (node == nullptr) return;
    const toml::table* section = node->as_table();
    if (section == nullptr) return complain(*node, kOwnWords, "a section");
    for (const auto& [key, value] : *section) {
      const auto effects = value.value_exact<std::string>();
      if (!effects) {
        complain(value, full_name(kOwnWords, key.str()), "what the word does, as a text");
        continue;
      }
      Lines found;
      profile.own_words.add(key.str(), *effects, found);
      for (const std::string& why : found) object(value, full_name(kOwnWords, key.str()), why);
    }
  }

  void read_lines(std::string_view name, const toml::node& node, TargetProfile& profile) {
    const std::string key = full_name(kWords, name);
    const auto found = std::ranges::find(kWordsKeys, name, &WordsKey::name);
    if (found == std::end(kWordsKeys)) {
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
        object(each, key, why);
      }
    }
  }

  const std::string& file_;
  const Control* target_;
  Lines& problems_;
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
  std::string text = fmt::format(
      "# A profile for batten: `--target THIS.toml`. Every key has the value of target {};\n"
      "# change what your machine needs, and leave out what stays.\n\n{} = \"{}\"\n",
      target.name, kBasedOn, target.name);
  std::string_view section;
  for (const ProfileKey& key : kKeys) {
    if (key.section != section) {
      section = key.section;
      text += fmt::format("\n[{}]\n", section);
    }
    text += fmt::format("{:<34}  # {}\n", fmt::format("{} = {}", key.name, shown(key, target)),
                        key.remark);
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
  text += fmt::format("\n# Behind a block that is not understood all modes are said by: {}\n",
                      fmt::join(gcode::words_of_modes(target), ", "));
  text += fmt::format(
      "\n# What words of your own do, which Batten does not know; you vouch for it. Such as\n"
      "# M501 = \"keeps state\"\n# \"G65 P9810\" = \"moves\"\n[{}]\n",
      kOwnWords);
  return text;
}

void tell_of_other_meanings(const gcode::Program& program, const gcode::Control& target,
                            gcode::Diagnostics& found) {
  std::vector<int> told;
  for (const gcode::Word& word : program.words) {
    if (word.letter != 'G' || !word.is_number) continue;
    const int code = gcode::code_of(word);
    const std::string_view meaning = other_meaning(target, code);
    if (meaning.empty() || std::ranges::find(told, code) != told.end()) continue;
    told.push_back(code);
    found.push_back({gcode::Severity::kError, "word-means-other", word.span,
                     fmt::format("{} for target {}: {}", program.source.text(word.span),
                                 target.name, meaning)});
  }
}

}  // namespace batten::postproc
