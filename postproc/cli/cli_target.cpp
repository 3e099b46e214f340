#include "postproc/cli/cli_target.h"

#include <optional>

#include "postproc/cli/cli_arguments.h"

namespace batten::postproc {

namespace {

bool is_profile_file(const std::optional<std::string>& name) {
  return name && name->ends_with(".toml");
}

GivenTarget wrong_target() {
  GivenTarget target;
  target.is_wrong = true;
  return target;
}

}  // namespace

GivenTarget target_given(const Given& given, Problems& problems) {
  const auto name = given.value("target");
  const auto file = is_profile_file(name) ? name : given.value("profile");
  if (is_profile_file(name) && given.has("profile")) {
    problems.push_back("--profile: --target names a profile already");
    return wrong_target();
  }
  GivenTarget target;
  if (name && !is_profile_file(name)) {
    target.built_in = built_in_target("target", *name, problems);
    if (target.built_in == nullptr) return wrong_target();
  }
  if (!file) return target;
  const std::size_t problems_before = problems.size();
  target.profile = read_target_profile(*file, target.built_in, problems);
  if (target.profile != nullptr) return target;
  // What was said about the file says enough; the options are not to say it again.
  for (std::size_t i = problems_before; i < problems.size(); ++i) {
    problems[i] = "--target: " + problems[i];
  }
  return wrong_target();
}

}  // namespace batten::postproc
