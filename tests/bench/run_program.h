// Runs a program to its end, for tests of command lines: what it printed and how it ended.
#pragma once

#include <string>
#include <vector>

namespace macula::bench {

struct Finished {
  int status = -1;  ///< exit status; -1: it could not be started or a signal ended it
  std::string out;  ///< stdout
  std::string err;  ///< stderr
};
/// arguments[0] is the program's path.
Finished run_program(const std::vector<std::string>& arguments);

}  // namespace macula::bench
