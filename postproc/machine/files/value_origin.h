// Where the values of a machine stand in the file that it was read from, so that what is wrong
// with it can be said in the words of that file.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "postproc/machine/machine_fields.h"

namespace batten::postproc {

struct ValueOrigin {
  std::string name;        // as the file calls it: "max-velocity", "$110", "[AXIS_X]MAX_VELOCITY"
  std::size_t line = 0;    // from 1
  std::size_t column = 0;  // from 1; 0: not known
  std::string file = {};   // another one than the first, which includes it; else empty
};

class ValueOrigins {
 public:
  explicit ValueOrigins(std::string file) : file_(std::move(file)) {}

  // `key`: as in MachineProblem. A later origin replaces an earlier one.
  void add(const std::string& key, ValueOrigin origin) { places_[key] = std::move(origin); }

  // A sentence for each problem of the machine, one for those that come from the same place:
  // "router.toml:3:16: max-velocity: -200, expected above 0 (mm/s)".
  void add_problems_of(const Machine& machine, std::vector<std::string>& problems) const;

 private:
  [[nodiscard]] std::string sentence(const MachineProblem& problem) const;

  std::string file_;
  std::map<std::string, ValueOrigin> places_;
};

}  // namespace batten::postproc
