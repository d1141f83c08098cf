// One row for every fault that is tried: what was asked and what was measured. Rows are printed and
// kept in MACULA_FAULT_TABLE, which deploy/test.sh shows at the end of a run.
#pragma once

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

namespace macula::test {

/// Tab-separated: fault, asked, figure.
inline void note_fault(const std::string& fault, const std::string& asked,
                       const std::string& figure) {
  std::ofstream(MACULA_FAULT_TABLE, std::ios::app)
      << fault << '\t' << asked << '\t' << figure << '\n';
  std::cout << "fault: " << fault << " | asked: " << asked << " | " << figure << std::endl;
}

/// How often a fault is tried: few times where every change is tested, `many` in the long run
/// (MACULA_LONG_FAULTS=1).
inline int times(int few, int many) {
  return ::getenv("MACULA_LONG_FAULTS") == nullptr ? few : many;
}

}  // namespace macula::test
