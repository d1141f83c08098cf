// The target as libFuzzer calls it.
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  macula::fuzz::try_input({data, size});
  return 0;
}
