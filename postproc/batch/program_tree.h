// The programs of a folder tree, and where the results of a batch may be written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace batten::postproc {

struct TreeProgram {
  std::string name;  // path from the root of the tree, with slashes
  std::uintmax_t bytes = 0;
};

struct ProgramTree {
  std::vector<TreeProgram> programs;  // in the order of their names' bytes
  std::size_t other_files = 0;        // without a suffix of a program
  std::size_t folder_links = 0;       // not followed: they may lead round in a circle
  std::vector<std::string> problems;  // folders that cannot be read
};

// Where a batch keeps its manifest, its reports and its summary, in the root of the new tree. Never
// read as a part of a tree of programs.
inline constexpr std::string_view kBatchFolder = "batten-batch";

// Suffixes that count as programs unless the user says others, without the dot.
[[nodiscard]] std::span<const std::string_view> default_program_suffixes();

// Suffixes without the dot, in any case; "none" are names without one, "all" is every file.
// Files and folders whose name begins with a dot are left out, links to files are read.
[[nodiscard]] ProgramTree list_programs(const std::filesystem::path& root,
                                        std::span<const std::string> suffixes);

// Whether `path`, or the folder it would be made in, is `tree` or lies in it, by whatever name:
// links are followed, and folders are compared as the system does, so that a second mount of the
// same folder counts too.
[[nodiscard]] bool leads_into(const std::filesystem::path& path, const std::filesystem::path& tree);

// Why a batch may not read the one tree and write the other; empty when it may. Neither tree lies
// in the other, and the batch's own folder does not lead into the input.
[[nodiscard]] std::vector<std::string> problems_of_trees(const std::filesystem::path& input_tree,
                                                         const std::filesystem::path& output_tree);

// Part `index` of `count` parts of a batch; index counts from 1.
struct Shard {
  int index = 1;
  int count = 1;
};

// Every count-th program, from the index-th on. The shards of one tree have every program once.
[[nodiscard]] std::vector<TreeProgram> programs_of(const Shard& shard,
                                                   std::span<const TreeProgram> programs);

}  // namespace batten::postproc
