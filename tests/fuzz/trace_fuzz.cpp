// Traces of heads and gazes.
#include "client/pose/trace.h"
#include "tests/fuzz/fuzz_target.h"

namespace macula::fuzz {

void try_input(Input input) {
  const auto trace = pose::parse_trace(as_text(input), "input");
  if (!trace) return;
  require(trace->duration() > Nanoseconds{0}, "an accepted trace takes no time");
  (void)trace->at(trace->duration() / 2);
  (void)pose::to_csv(*trace);
}

std::vector<std::string> seeds() {
  return {
      "t_s,px,py,pz,qx,qy,qz,qw,gx,gy,gz\n0,0,1.7,0,0,0,0,1,0,0,-1\n0.01,0,1.7,0,0,0,0,1,,,\n"
      "0.02,0.1,1.7,0,0,0.6,0,0.8,0,0,-1\n",
      "t_s,px,py,pz,qx,qy,qz,qw,gx,gy,gz\r\n-1e3,1,2,3,1,0,0,0,,,\r\n5,1,2,3,0,1,0,0,,,\r\n"};
}

}  // namespace macula::fuzz
