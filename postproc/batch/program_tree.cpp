#include "postproc/batch/program_tree.h"

#include <algorithm>
#include <array>
#include <system_error>

#include "gcode/text/characters.h"

namespace batten::postproc {

namespace fs = std::filesystem;

namespace {

// What CAM systems and controls call programs in the language that is read here.
constexpr auto kSuffixes =
    std::to_array<std::string_view>({"nc", "ngc", "tap", "cnc", "gcode", "ncc", "eia", "iso", "h",
                                     "mpf", "spf", "arc", "min", "pim", "anc"});

bool is_program(const fs::path& file, std::span<const std::string> suffixes) {
  const std::string extension = file.extension().string();
  return std::ranges::any_of(suffixes, [&](const std::string& suffix) {
    if (suffix == "all") return true;
    if (suffix == "none") return extension.empty();
    return extension.size() > 1 &&
           gcode::is_same_word(extension.substr(1), gcode::in_capitals(suffix));
  });
}

// One folder, without what lies in its folders; those are added to `folders`.
void list_folder(const fs::path& folder, const fs::path& root,
                 std::span<const std::string> suffixes, ProgramTree& tree,
                 std::vector<fs::path>& folders) {
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const fs::directory_entry& entry = *at;
    std::error_code entry_error;
    if (entry.path().filename().string().starts_with('.')) continue;
    if (entry.is_directory(entry_error)) {
      if (folder == root && entry.path().filename() == kBatchFolder) continue;
      if (entry.is_symlink(entry_error)) {
        ++tree.folder_links;
      } else {
        folders.push_back(entry.path());
      }
    } else if (entry.is_regular_file(entry_error)) {
      if (is_program(entry.path(), suffixes)) {
        const std::uintmax_t bytes = entry.file_size(entry_error);
        tree.programs.push_back({entry.path().lexically_relative(root).generic_string(),
                                 entry_error ? std::uintmax_t{0} : bytes});
      } else {
        ++tree.other_files;
      }
    }
  }
  if (error) tree.problems.push_back(folder.string() + ": cannot be read: " + error.message());
}

// As many links to nowhere one after the other as Linux itself follows.
constexpr int kMostLinks = 40;

// The nearest folder above that exists, with links followed.
fs::path existing_place(const fs::path& path) {
  std::error_code error;
  fs::path place = fs::absolute(path, error);
  int links = 0;
  while (place.has_relative_path()) {
    fs::path real = fs::canonical(place, error);
    if (!error) return real;
    // A link to nowhere: what counts is where a file would be made.
    const fs::path target = fs::read_symlink(place, error);
    const bool follows = !error && !target.empty() && ++links <= kMostLinks;
    place = place.parent_path();
    if (follows) place = target.is_absolute() ? target : place / target;
  }
  return place;
}

}  // namespace

std::span<const std::string_view> default_program_suffixes() { return kSuffixes; }

ProgramTree list_programs(const fs::path& root, std::span<const std::string> suffixes) {
  ProgramTree tree;
  std::vector<fs::path> folders = {root};
  while (!folders.empty()) {
    const fs::path folder = folders.back();
    folders.pop_back();
    list_folder(folder, root, suffixes, tree, folders);
  }
  std::ranges::sort(tree.programs, {}, &TreeProgram::name);
  std::ranges::sort(tree.problems);
  return tree;
}

bool leads_into(const fs::path& path, const fs::path& tree) {
  for (fs::path place = existing_place(path);; place = place.parent_path()) {
    std::error_code error;
    if (fs::equivalent(place, tree, error)) return true;
    if (!place.has_relative_path()) return false;
  }
}

std::vector<std::string> problems_of_trees(const fs::path& input_tree,
                                           const fs::path& output_tree) {
  std::vector<std::string> problems;
  std::error_code error;
  if (!fs::is_directory(input_tree, error)) {
    problems.push_back("IN_TREE: " + input_tree.string() + " is no folder that can be read");
    return problems;
  }
  if (fs::exists(output_tree, error) && !fs::is_directory(output_tree, error)) {
    problems.push_back("OUT_TREE: " + output_tree.string() + " is no folder");
  } else if (leads_into(output_tree, input_tree)) {
    problems.push_back("OUT_TREE: " + output_tree.string() + " lies in the input tree " +
                       input_tree.string() + ", which is never written to");
  } else if (leads_into(output_tree / kBatchFolder, input_tree)) {
    problems.push_back("OUT_TREE: " + (output_tree / kBatchFolder).string() +
                       " leads into the input tree " + input_tree.string());
  } else if (fs::exists(output_tree, error) && leads_into(input_tree, output_tree)) {
    problems.push_back("IN_TREE: " + input_tree.string() + " lies in the output tree " +
                       output_tree.string() + "; give the new programs a folder of their own");
  }
  return problems;
}

std::vector<TreeProgram> programs_of(const Shard& shard, std::span<const TreeProgram> programs) {
  std::vector<TreeProgram> part;
  const auto count = static_cast<std::size_t>(shard.count);
  for (auto i = static_cast<std::size_t>(shard.index - 1); i < programs.size(); i += count) {
    part.push_back(programs[i]);
  }
  return part;
}

}  // namespace batten::postproc
