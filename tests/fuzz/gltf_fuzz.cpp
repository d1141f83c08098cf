// glTF scenes: the first byte chooses text or binary.
#include <array>

#include "server/scene/load.h"
#include "shared/base/log.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/server/scene/gltf_file.h"

namespace macula::fuzz {
namespace {

constexpr std::array kNames{"t.gltf", "t.glb"};

std::string seed(std::size_t kind, const std::string& contents) {
  return static_cast<char>(kind) + contents;
}

}  // namespace

void try_input(Input input) {
  if (input.empty()) return;
  base::set_log_level(base::LogLevel::Error);
  const std::string name = kNames[input[0] % kNames.size()];
  InputFile file(name);
  std::ofstream(file.folder() / "t.bin", std::ios::binary) << scene::test::triangle_bytes();
  (void)scene::load_scene(file.write(as_text(input).substr(1)));
}

std::vector<std::string> seeds() {
  return {seed(0, scene::test::triangle_json()), seed(1, scene::test::triangle_glb())};
}

}  // namespace macula::fuzz
